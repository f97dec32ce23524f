# SPDX-License-Identifier: Apache-2.0
"""Equivalence of a module with and without a mutant, by Yosys' equiv commands.

Wires of the same name are compared bit by bit. Bits left unproven, except ports, are removed from the comparison until
the rest is proved. If a module is not equivalent, the modules that instantiate it may be. The proofs use two-valued
logic: they hold for a chip and ignore X.
"""

import re
import time
from pathlib import Path

from tb.formal.tools import yosys
from tb.mutation.netlists import SECONDS, Mutant, relative, source_name

CLOCKS = {"clk", "CLK", "WR_CLK"}
"""Ports that the equiv commands ignore: mutants there are not proved."""
ROUNDS = 12  # attempts to prove a module, each without the bits left open by the previous one
UNPROVEN = re.compile(r"Unproven \$equiv \S+: \\(\S+)_gold ")
PORT = re.compile(r"^ *wire .*\b(?:input|output) \d+ .*\\(\S+)$", re.M)


def proof(mutant: Mutant, place: Path, deep: bool) -> str:
    """Return the modules in which a mutant is proved equivalent, empty if it is not.

    The search begins with the module of the mutant; `deep`, it continues with the modules that instantiate it. It ends
    after SECONDS.
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
    """Prove a module equal with and without the mutant before `end`, a time of the monotonic clock.

    `deep`: flattened, otherwise inner modules are cut out.
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
        "techmap -map +/pmux2mux.v",  # the first of several hits, as in the Verilog that is simulated
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
        "equiv_induct -seq 4",  # fails on memories, which are only compared by name
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
