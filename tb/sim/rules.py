# SPDX-License-Identifier: Apache-2.0
"""Insertion of the AXI rules (tb/rules) into ``ik_axis`` and ``ik_axi``, under any top.

Icarus 11 has no ``bind``: tb/rules/NAME.vh is inserted before the end of a copy of module NAME.
"""

from __future__ import annotations

from pathlib import Path

from tb.sim.env import ROOT

RULES = ROOT / "tb" / "rules"

END = "\nendmodule\n"


def with_rules(files: list[Path], folder: Path) -> list[Path]:
    """Return the Verilog files, with copies in ``folder`` where rules apply (kept if unchanged), and the rule files."""
    return [_bound(path, folder) for path in files] + sorted(RULES.glob("*.v"))


def _bound(path: Path, folder: Path) -> Path:
    added = RULES / f"{path.stem}.vh"
    if not added.exists():
        return path
    text = path.read_text(encoding="utf-8")
    if text.count(END) != 1:
        raise LookupError(f"{path} has not exactly one end of a module")
    text = text.replace(END, f"\n{added.read_text(encoding='utf-8')}{END}")
    copy = folder / f"{path.stem}_rules.v"
    if not (copy.exists() and copy.read_text(encoding="utf-8") == text):
        copy.write_text(text, encoding="utf-8")
    return copy
