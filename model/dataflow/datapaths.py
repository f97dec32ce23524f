# SPDX-License-Identifier: Apache-2.0
"""Datapaths by name, with the properties needed to run, check or draw them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

from ..io.flags import ARM_FLAG_BITS, ARM_FLAGS, CORE_FLAGS, FLAG_BITS
from ..io.words import ARM_FIELDS, ARM_RESULT_FIELDS, BRANCHES, FIELDS, RESULT_FIELDS
from . import arm, lean, lean_turn, paper
from .fold import program, shown
from .formats import WIDTHS
from .mul3 import TILE
from .nodes import Node


@dataclass(frozen=True)
class Datapath:
    """A dataflow and the location of its Verilog.

    ``number`` is the parameter ``DATAPATH`` of ``ik_axis``, ``flow(dataflow, target)`` builds the whole dataflow.
    ``sections`` maps a section to its description, ``widths`` are the supported word lengths.
    ``tile``: bits of the longer operand of the multipliers for which :func:`model.dataflow.mul3.mul3` is cut.
    ``times(width)``: node -> clock in which it is valid, for a datapath without the dataflow's pipeline;
    ``period``: clocks from a target to the next, at W = 24; ``behind``: clocks of the FIFO behind the datapath.
    ``top`` is the module around it, ``inputs`` and ``results`` are the words of a target and of a result, lowest bits
    first; ``side``: bits of a target above its tag; ``flags``: node -> its bit among the ``flag_bits`` of a result
    above the tag; ``core`` is the instance in the datapath that holds the sections of the lean one, if there is one.
    """

    name: str
    number: int
    flow: Callable
    sections: dict[str, str]
    widths: range = WIDTHS
    tile: int = TILE
    times: Callable[[int], Mapping[str, int]] | None = None
    period: int = 1
    behind: int = 2
    top: str = "ik_axis"
    inputs: tuple[str, ...] = FIELDS
    side: tuple[str, ...] = ()
    results: tuple[str, ...] = RESULT_FIELDS
    flags: Mapping[str, int] = field(default_factory=lambda: CORE_FLAGS)
    flag_bits: int = FLAG_BITS
    core: str = ""

    @property
    def parameters(self) -> dict[str, int]:
        """Parameters of its top that select the datapath."""
        return {"DATAPATH": self.number} | ({"TILE": self.tile} if self.equations == "lean" else {})

    @property
    def rtl(self) -> str:
        """RTL module prefix."""
        return ("paper", "lean", "fold")[self.number]

    @property
    def entity(self) -> str:
        """Module of the datapath inside its top."""
        return f"ik_{self.rtl}_arm" if self.side else f"ik_{self.rtl}"

    def lap(self, width: int) -> int:
        """Return the clocks from a target to the next at a word length."""
        return program.schedule(width, self.entity.removeprefix("ik_")).period if self.times else 1

    @property
    def error(self) -> str:
        """Measure of a hand's error."""
        return "hand error / tolerance" if self.side else "hand error / reach"

    @property
    def equations(self) -> str:
        """Set of equations it computes: ``lean`` or ``paper``."""
        return "paper" if self.flow is paper.paper else "lean"

    @property
    def folder(self) -> Path:
        """Folder of its Verilog, relative to the repository root."""
        return Path("rtl") / self.rtl

    def instance(self, node: Node) -> str:
        """Return the instance in the datapath that holds a node's signal, levels joined by dots; none for an input."""
        inside = self.core and node.instance and node.section in lean.SECTIONS
        return f"{self.core}.{node.instance}" if inside else node.instance

    def module(self, section: str) -> str:
        """Return the Verilog module of a section."""
        return f"ik_{section}" if self.rtl == "paper" else f"ik_{self.rtl}_{section}"


LEAN = Datapath("lean", 1, lean_turn.lean, lean.SECTIONS, lean.WIDTHS)
PAPER = Datapath("paper", 0, paper.paper, paper.SECTIONS)


def folded(path: Datapath, name: str) -> Datapath:
    """Return a datapath as a program for one multiplier."""
    path = replace(path, name=name, number=2, widths=range(20, 33, 2), behind=0, core="")
    return replace(path, times=partial(shown.times, name=name), period=program.schedule(24, name).period)


FOLD = folded(LEAN, "fold")
FOLD16 = replace(FOLD, name="fold16", tile=16, widths=range(18, 25, 2))

DATAPATHS = {"lean": LEAN, "paper": PAPER}  # dataflows by name
DEFAULT = "lean"  # default datapath

TILED = replace(LEAN, name="lean25", tile=25), replace(LEAN, name="lean16", tile=16, widths=range(16, 25))

CONFIGURATIONS = {path.name: path for path in (LEAN, PAPER, *TILED, FOLD, FOLD16)}
"""Everything that can be run, by its ``DATAPATH=`` name: the dataflows, the lean one with products cut for multipliers
of 25x18 or 16x16 bits, the 16x16 ones with small tables, and the lean one as a program for a single multiplier, with
tiles of 18x18 or 16x16 bits."""

ARM = replace(LEAN, name="arm", flow=arm.arm, sections=arm.SECTIONS, widths=WIDTHS, inputs=ARM_FIELDS, side=BRANCHES)
ARM = replace(ARM, results=ARM_RESULT_FIELDS, flags=ARM_FLAGS, flag_bits=ARM_FLAG_BITS, top="ik_arm", core="u_lean")
FOLD_ARM = folded(ARM, "fold_arm")
FOLD_ARM16 = replace(FOLD_ARM, name="fold_arm16", tile=16, widths=FOLD16.widths)

ARM25, ARM16 = replace(ARM, name="arm25", tile=25), replace(ARM, name="arm16", tile=16, widths=TILED[1].widths)

MODELS = {**CONFIGURATIONS, **{path.name: path for path in (ARM, ARM25, ARM16, FOLD_ARM, FOLD_ARM16)}}
"""Everything that the model computes: the configurations, and the whole arm around the lean datapath, and folded."""
