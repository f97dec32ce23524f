# SPDX-License-Identifier: Apache-2.0
"""What tries to notice a mutant: benches in Verilog that compare every node, and the cocotb benches of the tree.

Which of them may notice a change of a file follows from what the file is part of (:func:`killers_of`); whether it is
run at all, from whether Icarus makes the same program of both.
"""

from __future__ import annotations

import hashlib
import importlib
import json
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache, partial
from inspect import signature
from pathlib import Path

from model.dataflow.datapaths import CONFIGURATIONS
from tb.axi.test_ik_axi import MODULES
from tb.mutation import nodes
from tb.mutation.nodes import Nodes
from tb.sim.children import started
from tb.sim.env import ROOT
from tb.sim.runner import alone
from tb.sim.sources import closure, digest, headers, includes, sources

BUILD = ROOT / "build" / "mutants"
BROKEN, SAME, KILLED, PROVED, SURVIVED = "does not build", "no change", "killed", "proved equivalent", "survived"
"""What becomes of a mutant."""
LINT = "lint"
"""The killer of what Verilator or Icarus warns of."""
COMPILE = 120.0
"""Seconds for Icarus; a mutant that takes longer does not build."""

LEAST, TIMES = 30.0, 10.0
"""A simulation may take so many seconds, and so many times as long as that of the RTL."""

MEASURED = "latency or clocks"
"""Begins what is said of a mutant that is right in every bit, and takes another time."""


class BuildError(Exception):
    """A mutant that is no Verilog, or not for these parameters."""


LABEL = re.compile(rb"\b[A-Za-z_]*0x[0-9a-f]+(?:_\d+)*\b")
NO_LOGIC = re.compile(rb"^(?:\S+ )?\s*\.param/.*\n|^:.*\n", re.M)
LINE = re.compile(rb"^(\S+ \.scope .*?, )\d+ \d+", re.M)


def same(program: bytes) -> str:
    """A digest of Icarus' program that does not depend on where in memory it was made, nor on places in the source."""
    numbers: dict[bytes, bytes] = {}
    text = LINE.sub(rb"\1", NO_LOGIC.sub(b"", program.partition(b":file_names")[0]))
    text = LABEL.sub(lambda m: numbers.setdefault(m[0], b"L%d" % len(numbers)), text)
    return hashlib.sha256(text).hexdigest()


def finished(command: list, place: Path, seconds: float) -> tuple[int | None, str]:
    """Runs a program to its end: exit status, None where it does not end in time, and what it said."""
    with open(place / "log", "w+") as log:
        with started(command, place, stdout=log, stderr=log) as process:
            try:
                status = process.wait(seconds)
            except subprocess.TimeoutExpired:
                status = None
        log.seek(0)
        return status, log.read().strip()


def elaborate(place: Path, top: str, own: Path | None = None, **parameters: int) -> str:
    """Makes `place`/program, Icarus' of a module of the copy there and a file of its own; what tells it from others."""
    program = place / "program"
    values = [f"-P{top}.{name}={value}" for name, value in parameters.items()]
    command = ["iverilog", "-g2001", "-s", top, *values, *(f"-I{folder}" for folder in includes(place)), "-o", program]
    status, said = finished([*command, *([own] if own else []), *sources(place)], place, COMPILE)
    if status != 0:
        raise BuildError(said[-300:])
    return same(program.read_bytes())


@dataclass(frozen=True)
class Killer:
    """``elaborated(place)``: its program's digest of the copy of rtl/ there; ``ran(place, seconds)``: why the copy is
    wrong, or None and what it measured."""

    name: str
    elaborated: Callable[[Path], str]
    ran: Callable[[Path, float], tuple[str | None, str]]
    key: str = ""

    def right(self) -> dict:
        """What the RTL itself gives: its program's digest, what was measured and in how many seconds.

        Kept in build/.  Raises :class:`AssertionError` if the RTL is wrong: then nothing can be said of mutants.
        """
        of = hashlib.sha256(f"{self.name} {self.key} {rtl_digest()}".encode()).hexdigest()[:16]
        file = BUILD / "right" / f"{of}.json"
        with alone(BUILD / "right"):
            if not file.exists():
                with tempfile.TemporaryDirectory(prefix="ik_") as folder:
                    place = Path(folder)
                    shutil.copytree(ROOT / "rtl", place / "rtl")
                    program, begin = self.elaborated(place), time.monotonic()
                    wrong, measured = self.ran(place, 1200.0)
                    assert wrong is None, f"{self.name}: the RTL itself is wrong: {wrong}"
                    seconds = time.monotonic() - begin
                    found = {"killer": self.name, "program": program, "measured": measured, "seconds": seconds}
                    file.write_text(json.dumps(found))
        return json.loads(file.read_text())

    def judged(self, place: Path) -> tuple[bool, str | None]:
        """Whether the copy in `place` is another program than the RTL, and why it is wrong.  Raises BuildError."""
        right = self.right()
        if self.elaborated(place) == right["program"]:
            return False, None
        wrong, measured = self.ran(place, max(LEAST, TIMES * right["seconds"]))
        if wrong is None and measured != right["measured"]:
            wrong = f"{MEASURED}: {measured} instead of {right['measured']}"
        return True, wrong


@cache
def rtl_digest() -> str:
    """Of all Verilog, as it is."""
    return digest([*sources(), *headers()])


# ---- every node, in Verilog ------------------------------------------------------------------------------------------

QUICK = (Nodes("lean", 18, 250), Nodes("fold", 20, 50), Nodes("paper", 18, 250))
WIDE = (
    Nodes("paper", 18, 200, digit=1), Nodes("lean", 32, 300, corners=True), Nodes("fold", 32, 50),
    Nodes("short", 32, 200), Nodes("lean25", 18, 200), Nodes("lean16", 24, 200, corners=True),
    Nodes("fold16", 18, 40), Nodes("paper", 32, 300),
    Nodes("lean", 27, 300, corners=True), Nodes("lean", 18, 4000, corners=True), Nodes("fold", 24, 200),
    Nodes("paper", 18, 3000), Nodes("short", 32, 200, digit=1),
)  # fmt: skip
"""After these what the first leave is tried by the benches of cocotb."""


def _of_nodes(of: Nodes) -> Killer:
    @cache
    def written(kept: Path) -> Path:
        with alone(kept):
            return of.written(kept)

    def bench() -> Path:
        return written(BUILD / "nodes" / of.name.replace(" ", "-"))

    def elaborated(place: Path) -> str:
        return elaborate(place, nodes.TOP, bench())

    def ran(place: Path, seconds: float) -> tuple[str | None, str]:
        return ended(place / "program", bench().with_name(nodes.DATA), place, seconds)

    return Killer(of.name, elaborated, ran, key=hashlib.sha256(nodes.BENCH.encode()).hexdigest()[:8])


def ended(program: Path, data: Path, place: Path, seconds: float, *options: str) -> tuple[str | None, str]:
    """What is wrong by a bench of nodes, and what it said; `place` gets the log."""
    status, said = finished(["vvp", "-n", program, f"+data={data}", *options], place, seconds)
    if status is None:
        return "does not end", ""
    last = said.splitlines()[-1] if said else "nothing said"
    return (None, said) if last.startswith(nodes.RIGHT) else (last[-200:], said)


@cache
def parts(rtl: str) -> frozenset[str]:
    """The files that ik_axis is made of with one of its cores."""
    others = {f"ik_{path.rtl}" for path in CONFIGURATIONS.values()} - {f"ik_{rtl}"}
    return (names("ik_axis") - frozenset().union(*map(names, others))) | names(f"ik_{rtl}")


@cache
def digest_around(file: str) -> str:
    """Of all Verilog that is built where a file of rtl/ is."""
    cores = [parts(path.rtl) for path in CONFIGURATIONS.values()]
    together = frozenset().union(*(files for files in cores if file in files)) or names("ik_axi")
    return digest([*(ROOT / name for name in sorted(together)), *headers()])


@cache
def names(top: str) -> frozenset[str]:
    """The files of a module, from the root."""
    return frozenset(path.relative_to(ROOT).as_posix() for path in closure(top))


# ---- the benches of cocotb -------------------------------------------------------------------------------------------


def _of_cocotb(name: str, options: Callable[[], dict], prepared: Callable[[Path], None] = lambda place: None) -> Killer:
    """`options`: what :func:`tb.sim.runner.simulate` is told; `prepared` changes the copy of the RTL."""
    given = cache(options)

    def elaborated(place: Path) -> str:
        prepared(place)
        own = None
        if "top" in given():
            own = place / "top.v"
            own.write_text(given()["top"])
        return elaborate(place, given()["toplevel"], own, **given().get("parameters", {}))

    def ran(place: Path, seconds: float) -> tuple[str | None, str]:
        shutil.rmtree(place / "sim", ignore_errors=True)
        command = [sys.executable, "-m", "tb.mutation.killers", place, json.dumps(given())]
        status, said = finished(command, place, seconds)
        if status is None:
            return "does not end", ""
        return (None if status == 0 else failing(said)), ""

    return Killer(name, elaborated, ran)


def failing(log: str) -> str:
    """The first cocotb test that failed, by its name in the log."""
    found = re.search(r"Failed: (\S+)::(.*)", log)
    return found[2] if found else (log.splitlines() or ["fails"])[-1][-200:]


def _child(place: str, options: str) -> None:
    """In a process of its own: cocotb-test changes signal handlers and the logging of its process."""
    from tb.sim import runner

    runner.BUILD = Path(place) / "sim"
    given = json.loads(options)
    env = given.pop("env", {}) | {"COCOTB_MAX_FAILURES": "1"}
    runner.simulate(**given, env=env, sim="icarus", root=Path(place))


def _simulations() -> Iterator[tuple[str, dict[str, partial]]]:
    """Module of rtl/ -> what makes the simulations of its bench, as :func:`tb.units.unit.runs` has it."""
    for file in sorted((ROOT / "tb" / "units").glob("test_*.py")):
        module = importlib.import_module(f"tb.units.{file.stem}")
        yield from (value.simulations for value in vars(module).values() if hasattr(value, "simulations"))


@cache
def units() -> dict[str, dict[str, Killer]]:
    """Module of rtl/lib -> its benches, the few parameter sets first."""
    return {
        of: {group: _of_cocotb(f"unit {of} {group}", make) for group, make in groups.items()}
        for of, groups in _simulations()
    }


def flat_unit(module: str, parameters: dict[str, int]) -> Killer | None:
    """The bench of a module for a netlist of it with these parameters; none if there is none of such ones."""
    few = dict(_simulations()).get(module, {}).get("few")
    if not few:
        return None
    *_, bench = few.args
    try:
        signature(bench).bind(**parameters)
    except TypeError:
        return None
    return _of_cocotb(f"unit {module}", partial(few.func, module, [parameters], bench, flat=True))


def _stream(path: str, width: int) -> Killer:
    parameters = {"W": width, "TAG_W": 3, **CONFIGURATIONS[path].parameters}
    given = {"toplevel": "ik_axis", "module": "tb.core.stream_tests", "parameters": parameters}
    return _of_cocotb(f"streams {path}", lambda: given)


STREAMS = _stream("lean", 18), _stream("fold", 24)
PAPER = _stream("paper", 18)
"""Which core a divider or a root is, no node tells."""


def memory(bursts: int, data: int, jobs: int = 80) -> Killer:
    """Jobs of memory to memory, with an echo in the place of the datapath."""

    def echo(place: Path) -> None:
        shutil.copy2(ROOT / "tb" / "axi" / "ik_lean.v", place / "rtl" / "lean" / "ik_lean.v")

    env = {"IK_AXI_CORE": "echo", "IK_AXI_JOBS": str(jobs), "IK_AXI_FAULTS": str(jobs * 3 // 20)}
    parameters = {"W": 18, "LOG2_BURST": bursts, "DATA_W": data}
    given = {"toplevel": "ik_axi", "module": MODULES, "parameters": parameters, "env": env}
    return _of_cocotb(f"memory {bursts} {data}", lambda: given, echo)


MEMORY = memory(3, 64), memory(1, 32)


# ---- who may notice what ---------------------------------------------------------------------------------------------


@cache
def _nodes(of: Nodes) -> Killer:
    return _of_nodes(of)


def around_the_core(file: str) -> bool:
    return file in names("ik_axi") - names("ik_axis")


def _units_of(file: str) -> list[dict[str, Killer]]:
    module = Path(file).stem
    return [units()[of] for of in ([module] if module in units() else [top for top in units() if file in names(top)])]


def first_of(file: str) -> list[Killer]:
    """What notices most changes of a file of rtl/, the cheapest first: before a proof is tried."""
    if around_the_core(file):
        return list(MEMORY[:1])
    return [_nodes(of) for of in QUICK if file in parts(of.path.rtl)] + [own["few"] for own in _units_of(file)]


def killers_of(file: str) -> list[Killer]:
    """What may notice a change of a file of rtl/, the cheapest first."""
    if around_the_core(file):
        return list(MEMORY)
    found = first_of(file) + [_nodes(of) for of in WIDE if file in parts(of.path.rtl)]
    found += [own["more"] for own in _units_of(file) if "more" in own]
    datapaths = frozenset().union(*(names(f"ik_{path.rtl}") for path in CONFIGURATIONS.values()))
    if file not in datapaths or "s_axis_tvalid" in (ROOT / file).read_text():
        found += STREAMS
    if file in names("ik_paper") - names("ik_lean"):
        found.append(PAPER)
    return found


def linted(place: Path, file: str) -> str:
    """What `make lint` says of the modules of a copy that hold a file; empty if nothing."""
    modules = [path.stem for path in sources() if file in names(path.stem)]
    command = [sys.executable, "-m", "scripts.lint", "--root", place, *modules]
    status, said = finished(command, place, COMPILE)
    return next((line for line in said.splitlines() if "arning" in line), said)[:200] if status == 1 else ""


if __name__ == "__main__":
    _child(*sys.argv[1:])
