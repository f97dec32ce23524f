# SPDX-License-Identifier: Apache-2.0
"""The datapaths by name: what everything that runs, checks or draws one of them needs to know of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from . import lean, paper
from .cores import TILE
from .fold import program, shown
from .nodes import WIDTHS


@dataclass(frozen=True)
class Datapath:
    """One dataflow and where its Verilog is.

    ``flow(domain, target)`` is the whole of it, ``after_guard(domain, phi)`` what follows the exact decisions.
    ``sections`` maps a section to what it is, ``widths`` are the word lengths that it can be built with,
    ``parameters`` those of ``ik_axis`` that choose it.
    ``tile``: bits of the longer operand of the multipliers that :func:`model.dataflow.cores.mul3` is cut for.
    ``times(width)``: node -> clock in which it is valid, of a machine without the clocks of the dataflow's pipeline;
    ``period``: clocks from a target to the next; ``behind``: clocks of the FIFO behind the datapath.
    """

    name: str
    flow: Callable
    after_guard: Callable
    sections: dict[str, str]
    parameters: dict[str, int]
    widths: range = WIDTHS
    tile: int = TILE
    times: Callable[[int], Mapping[str, int]] | None = None
    period: int = 1
    behind: int = 2

    @property
    def rtl(self) -> str:
        """What its Verilog is called by."""
        return ("paper", "lean", "fold")[self.parameters["DATAPATH"]]

    @property
    def equations(self) -> str:
        """Whose equations it computes: ``lean`` or ``paper``."""
        return "paper" if self.flow is paper.paper else "lean"

    @property
    def folder(self) -> Path:
        """Of its Verilog, from the root of the repository."""
        return Path("rtl") / self.rtl

    def module(self, section: str) -> str:
        """The Verilog module of a section."""
        return f"ik_{section}" if self.rtl == "paper" else f"ik_{self.rtl}_{section}"


DATAPATHS = {
    "lean": Datapath(
        "lean", lean.lean, lean.sections, lean.SECTIONS, {"DATAPATH": 1, "TILE": TILE}, lean.WIDTHS,
    ),  # fmt: skip
    "paper": Datapath("paper", paper.paper, paper.sections, paper.SECTIONS, {"DATAPATH": 0}),
}
"""The dataflows by name."""

DEFAULT = "lean"
"""What a user gets who does not choose."""

LEAN25 = replace(DATAPATHS["lean"], name="lean25", parameters={"DATAPATH": 1, "TILE": 25}, tile=25)

LEAN16 = replace(
    DATAPATHS["lean"], name="lean16", parameters={"DATAPATH": 1, "TILE": 16}, tile=16, widths=range(16, 25),
)  # fmt: skip

FOLD = replace(
    DATAPATHS["lean"], name="fold", parameters={"DATAPATH": 2, "TILE": TILE}, widths=range(20, 33, 2),
    times=shown.times, period=program.schedule().period, behind=0,
)  # fmt: skip

FOLD16 = replace(
    FOLD, name="fold16", parameters={"DATAPATH": 2, "TILE": 16}, tile=16, widths=range(18, 25, 2),
)  # fmt: skip

CONFIGURATIONS = DATAPATHS | {path.name: path for path in (LEAN25, LEAN16, FOLD, FOLD16)}
"""All that can be run, by the name of its ``DATAPATH=``: the dataflows, the lean one with products cut for
multipliers of 25x18 bits or of 16x16 bits, the latter with small tables, and the lean one as a program of one
multiplier, of 18x18 bits a tile or 16x16."""
