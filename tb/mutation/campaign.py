# SPDX-License-Identifier: Apache-2.0
"""Mutation campaign: the mutated designs, the order of the mutants, the verdict on each, and the file of results.

A mutant that no bench kills may be equivalent. Yosys' equiv commands try to prove that a module is the same with and
without the mutant. Wires of the same name are compared bit by bit. Bits that are not proved equal, except ports, are
removed from the comparison, and the proof is tried again. If a mutant changes a module's function, the modules around
that module may still be equivalent. The proofs use two-valued logic: they hold for a chip and ignore X.
"""

import functools
import itertools
import json
import re
import tempfile
import time
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from tb.axi.test_ik_axi import MANY_RECORDS, MODULES
from tb.formal.tools import yosys
from tb.mutation.benches import NodeBench, Replaced, fault, unit_bench
from tb.mutation.netlists import BUILD, SECONDS, Mutant, Netlist, relative, source_name
from tb.sim.sources import closure

KILLED, PROVED, SURVIVED = "killed", "proved", "survived"

CLOCKS = {"clk", "CLK", "WR_CLK"}
"""Clock ports. The equiv commands ignore them, so a mutant there is never proved equivalent."""
ROUNDS = 12  # attempts to prove a module; each removes the bits that the previous one did not prove
UNPROVEN = re.compile(r"Unproven \$equiv \S+: \\(\S+)_gold ")
PORT = re.compile(r"^ *wire .*\b(?:input|output) \d+ .*\\(\S+)$", re.M)


@dataclass(frozen=True)
class Design:
    """Top module to mutate, its parameters, and its benches, the cheapest first."""

    name: str
    top: str
    parameters: dict[str, int]
    benches: tuple[NodeBench | Replaced, ...]


def core(*benches: NodeBench) -> Design:
    """Return the design of the core that these benches test; the benches differ only in their targets."""
    name = " ".join(benches[0].name.split()[1:-1])
    return Design(name, benches[0].path.top, benches[0].parameters, benches)


def memory(log2_burst: int, data_w: int) -> Design:
    """Return a design of ``ik_axi``. Both benches test jobs, faults and registers; the first has only short tests."""
    parameters = {"W": 18, "LOG2_BURST": log2_burst, "DATA_W": data_w}
    env = {"IK_AXI_CORE": "echo", "IK_AXI_JOBS": "16", "IK_AXI_FAULTS": "2"}
    options = {"toplevel": "ik_axi", "module": MODULES, "parameters": parameters, "env": env}
    short = options | {"env": env | {"IK_AXI_JOBS": "4", "COCOTB_TEST_FILTER": f"^(?!.*({MANY_RECORDS}))"}}
    benches = (Replaced("jobs short", "ik_axi", short), Replaced("jobs", "ik_axi", options))
    return Design(f"memory {data_w}", "ik_axi", parameters, benches)


DESIGNS = (
    core(NodeBench("lean", 18, 250), NodeBench("lean", 18, 4000, corners=True)),
    core(NodeBench("lean", 32, 300, corners=True), NodeBench("lean", 32, 3000, corners=True)),
    core(NodeBench("fold", 20, 50), NodeBench("fold", 20, 400)),
    core(NodeBench("fold", 32, 50), NodeBench("fold", 32, 400)),
    core(NodeBench("arm", 16, 100), NodeBench("arm", 16, 2000)),
    core(NodeBench("fold_arm", 20, 40), NodeBench("fold_arm", 20, 400)),
    core(NodeBench("choose", 16, 100), NodeBench("choose", 16, 2000)),
    core(NodeBench("fold_choose", 20, 40), NodeBench("fold_choose", 20, 400)),
    core(NodeBench("paper", 18, 250), NodeBench("paper", 18, 3000)),
    core(NodeBench("paper", 18, 200, digit=1), NodeBench("paper", 18, 3000, digit=1)),
    memory(3, 64),
    memory(1, 32),
)


@functools.cache
def netlist(number: int, seed: int) -> Netlist:
    """Return the netlist of DESIGNS[number] with the mutants of a seed."""
    design = DESIGNS[number]
    return Netlist(design.name, design.top, tuple(design.parameters.items()), seed)


@dataclass(frozen=True)
class Result:
    """Verdict on a mutant. `by` is the bench that kills it, or the modules in which it is proved equivalent."""

    key: str
    file: str
    mutant: str
    verdict: str
    by: str = ""
    why: str = ""
    seconds: float = 0.0

    @property
    def column(self) -> str:
        """Return the column of the table: the kind of the bench that kills the mutant, or the verdict."""
        return self.by.split()[0] if self.verdict == KILLED else self.verdict


COLUMNS = ("nodes", "unit", "jobs", PROVED, SURVIVED)


def order(seed: int, only: str) -> Iterator[tuple[int, int, Mutant]]:
    """Yield design number, seed and mutant for all files whose names contain `only`.

    The files take turns and, within a file, the designs take turns. If several designs share a module, its mutants are
    yielded only for the first of these designs. Every design whose top can contain a matching file is elaborated, even
    if the file belongs to another datapath.
    """
    files: dict[str, list[list]] = {}
    changes: set[tuple[int, str]] = set()
    for design, top in enumerate(design.top for design in DESIGNS):
        if not any(only in relative(path) for path in closure(top)):
            continue
        mutants = [m for m in netlist(design, seed).mutants if only in m.file and m.change not in changes]
        changes |= {mutant.change for mutant in mutants}
        for file, group in itertools.groupby(mutants, key=lambda mutant: mutant.file):
            files.setdefault(file, []).append([(design, seed, mutant) for mutant in group])
    queues = [[job for row in itertools.zip_longest(*lists) for job in row if job] for lists in files.values()]
    for row in itertools.zip_longest(*queues):
        yield from (job for job in row if job)


def proof(mutant: Mutant, place: Path, deep: bool) -> str:
    """Return the names of the modules in which a mutant is proved equivalent, "" if it is not proved within SECONDS.

    The mutant's module is tried first. If this proof fails and `deep` is set, all modules that instantiate that module
    have to be proved, and so on.
    """
    if mutant.options["port"] in CLOCKS:
        return ""
    modules, end = mutant.netlist.modules, time.monotonic() + SECONDS
    wanted, shown = {mutant.options["module"]}, set()
    while wanted:
        left = {name for name in sorted(wanted) if not equivalent(mutant, name, place, end, deep)}
        shown |= wanted - left
        if not all(deep and modules[name]["parents"] for name in left):
            return ""
        wanted = {parent for name in left for parent in modules[name]["parents"]}
    return ", ".join(sorted(map(source_name, shown)))


def equivalent(mutant: Mutant, module: str, place: Path, end: float, deep: bool) -> bool:
    """Return whether a module is proved equivalent with and without the mutant before `end` (time.monotonic).

    If `deep` is set, the module is flattened; else its submodules are black boxes.
    """
    place.mkdir(parents=True, exist_ok=True)
    right, changed, removed, status = (place / name for name in ("right.il", "changed.il", "removed", "status"))
    removed.write_text("")
    for path, command in ((right, []), (changed, [mutant.command])):
        lines = [
            mutant.netlist.design,
            *command,
            f"hierarchy -top {module}",
            "flatten" if deep else "blackbox * A:top %d",
            f"opt_clean; rename -top {path.stem}; write_rtlil {relative(path)}",
        ]
        if yosys(place, path.stem, lines, max(1.0, end - time.monotonic())):
            return False
    statement = f"tee -q -o {relative(status)} equiv_status"
    lines = [
        *(f"read_rtlil -overwrite {relative(path)}" for path in (right, changed)),
        "techmap -map +/pmux2mux.v",  # of several selects the first wins, as in the simulated Verilog
        "opt_dff; dffunmap; opt_expr; wreduce; opt_clean; splitnets",
        f"equiv_make -blacklist {relative(removed)} right changed both",
        "cd both",
        "opt_merge",
        "equiv_simple -seq 10",
        statement,
        "equiv_induct -seq 4",  # fails on memories, so these are only compared by name
        statement,
    ]
    ports = set(PORT.findall(right.read_text()))
    for _ in range(ROUNDS):
        status.unlink(missing_ok=True)
        yosys(place, "prove", lines, max(1.0, end - time.monotonic()))
        if not status.exists():
            return False
        report = status.read_text()
        if "Equivalence successfully proven!" in report:
            return True
        more = set(UNPROVEN.findall(report)) - ports - set(removed.read_text().split())
        if not more:
            return False
        with removed.open("a") as file:
            file.writelines(f"{name}\n" for name in sorted(more))
    return False


def judge(job: tuple[int, int, int]) -> Result:
    """Return the verdict on a mutant (design, seed, number); benches and equivalence proofs run cheapest first."""
    design, seed, number = job
    first, *more = DESIGNS[design].benches
    mutant = netlist(design, seed).mutants[number - 1]
    begin = time.monotonic()

    def result(verdict: str, by: str = "", why: str = "") -> Result:
        seconds = round(time.monotonic() - begin, 1)
        return Result(mutant.key, mutant.file, mutant.describe(), verdict, by, why, seconds)

    (BUILD / "work").mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=BUILD / "work") as folder:
        place = Path(folder)
        if why := fault(first, mutant, place):
            return result(KILLED, first.name, why)
        if where := proof(mutant, place / "own", deep=False):
            return result(PROVED, where)
        for bench in filter(None, [unit_bench(mutant), *more]):
            if why := fault(bench, mutant, place):
                return result(KILLED, bench.name, why)
        where = proof(mutant, place / "around", deep=True)
    return result(PROVED if where else SURVIVED, where)


def recorded(path: Path) -> dict[str, Result]:
    """Return key -> result from a file. Survivors, which are to be tried again, and incomplete lines are left out."""
    results = {}
    for line in path.read_text(encoding="utf-8").splitlines() if path.exists() else []:
        with suppress(ValueError):
            row = Result(**json.loads(line))
            results[row.key] = row
    return {key: row for key, row in results.items() if row.verdict != SURVIVED}


def rows(results: list[Result]) -> list[list]:
    """Return the rows of the table: file, number of mutants, a number for each of COLUMNS; totals in the last row."""
    groups = {name: [r for r in results if r.file == name] for name in sorted({r.file for r in results})}
    return [
        [name.removeprefix("rtl/"), len(group), *(sum(r.column == column for r in group) for column in COLUMNS)]
        for name, group in [*groups.items(), ("all", results)]
    ]
