# SPDX-License-Identifier: Apache-2.0
"""Proofs that a module is equivalent with and without a mutant, by Yosys' equiv commands.

Wires of the same name are compared bit by bit. Bits that are not proved equal, except ports, are removed from the
comparison, and the proof is tried again. If a mutant changes a module's function, the modules that instantiate it may
still be equivalent. The proofs use two-valued logic: they hold for a chip and ignore X.
"""

import re
import time
from pathlib import Path

from tb.formal.tools import yosys
from tb.mutation.netlists import SECONDS, Mutant, relative, source_name

CLOCKS = {"clk", "CLK", "WR_CLK"}
"""Clock ports. The equiv commands ignore them, so a mutant there is never proved equivalent."""
ROUNDS = 12  # attempts to prove a module; each removes the bits that the previous one did not prove
UNPROVEN = re.compile(r"Unproven \$equiv \S+: \\(\S+)_gold ")
PORT = re.compile(r"^ *wire .*\b(?:input|output) \d+ .*\\(\S+)$", re.M)


def proof(mutant: Mutant, place: Path, deep: bool) -> str:
    """Return the names of the modules in which a mutant is proved equivalent, "" if it is not proved within SECONDS.

    The first proof is of the mutant's module. If it fails and `deep` is set, all modules that instantiate that module
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
            "opt_clean",
            f"rename -top {path.stem}",
            f"write_rtlil {relative(path)}",
        ]
        if yosys(place, path.stem, lines, max(1.0, end - time.monotonic())):
            return False
    statement = f"tee -q -o {relative(status)} equiv_status"
    lines = [
        *(f"read_rtlil -overwrite {relative(path)}" for path in (right, changed)),
        "techmap -map +/pmux2mux.v",  # of several selects the first wins, as in the simulated Verilog
        "opt_dff",
        "dffunmap",
        "opt_expr",
        "wreduce",
        "opt_clean",
        "splitnets",
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
