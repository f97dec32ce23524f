# SPDX-License-Identifier: Apache-2.0
"""Datapaths by name, with the properties needed to run, check or draw them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

from ..io.flags import ARM_FLAG_BITS, ARM_FLAGS, CHOICE_FLAG_BITS, CHOICE_FLAGS, CORE_FLAGS, FLAG_BITS
from ..io.words import ARM_FIELDS, ARM_RESULT_FIELDS, BRANCHES, CHOICE_FIELDS, FIELDS, REFERENCES, RESULT_FIELDS
from . import arm, choose, lean, paper
from .fold import program, shown
from .formats import WIDTHS
from .mul3 import TILE
from .nodes import Node


@dataclass(frozen=True)
class Datapath:
    """Dataflow and its Verilog.

    * ``number``: parameter ``DATAPATH`` of ``ik_axis``; ``top``: module that contains the datapath
    * ``flow(dataflow, target)``: builds the whole dataflow; ``sections``: section -> description
    * ``widths``: supported word lengths; ``tile``: bits of the longer operand of its multipliers
    * ``times(width)``: node -> clock in which it is valid; None if the datapath is the dataflow's pipeline
    * ``period``: clocks between targets at W = 24; ``behind``: clocks of the FIFO or choice behind the datapath
    * ``inputs``, ``results``: words of a target and of a result, lowest bits first; ``side``: target bits above the tag
    * ``flags``: node -> mask of its flag among a result's ``flag_bits`` flag bits, which are above the tag
    * ``core``: instance of the datapath ``lean`` within this datapath; empty if there is none
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
        """Verilog parameters of ``top`` that select the datapath."""
        tile = {"TILE": self.tile} if self.equations == "lean" else {}
        return {"DATAPATH": self.number} | tile | ({"CHOOSE": int(self.chooses)} if self.side else {})

    @property
    def chooses(self) -> bool:
        """True if the datapath chooses the branch of a hand pose."""
        return self.inputs[-1] == REFERENCES[-1]

    @property
    def rtl(self) -> str:
        """RTL module prefix."""
        return ("paper", "lean", "fold")[self.number]

    @property
    def entity(self) -> str:
        """Verilog module of the datapath, inside ``top``."""
        return f"ik_{self.rtl}_arm" if self.side else f"ik_{self.rtl}"

    def lap(self, width: int) -> int:
        """Return the clocks from one target to the next at word length ``width``."""
        return program.schedule(width, self.entity.removeprefix("ik_")).period if self.times else 1

    @property
    def error(self) -> str:
        """Name of the error measure."""
        return "hand error / tolerance" if self.side else "hand error / reach"

    @property
    def equations(self) -> str:
        """Set of equations that the datapath computes: ``lean`` or ``paper``."""
        return "paper" if self.flow is paper.paper else "lean"

    @property
    def folder(self) -> Path:
        """Folder of the datapath's Verilog, relative to the repository root."""
        return Path("rtl") / self.rtl

    def instance(self, node: Node) -> str:
        """Return the instance that holds a node's signal, levels joined by dots; empty for the datapath itself."""
        if node.section == "choose" or node.name in REFERENCES:
            return "g_choose.u_choose" if node.operands else "g_choose"
        inside = self.core and node.instance and node.section in lean.SECTIONS
        return f"{self.core}.{node.instance}" if inside else node.instance

    def module(self, section: str) -> str:
        """Return the Verilog module of a section."""
        if section == "choose":
            return "ik_choose"
        return f"ik_{section}" if self.rtl == "paper" else f"ik_{self.rtl}_{section}"


LEAN = Datapath("lean", 1, lean.lean, lean.SECTIONS, lean.WIDTHS)
PAPER = Datapath("paper", 0, paper.paper, paper.SECTIONS)


def folded(path: Datapath, name: str) -> Datapath:
    """Return the folded version of a datapath, a program for one multiplier."""
    path = replace(path, name=name, number=2, widths=range(20, 33, 2), behind=0, core="")
    return replace(path, times=partial(shown.times, name=name), period=program.schedule(24, name).period)


FOLD = folded(LEAN, "fold")
FOLD16 = replace(FOLD, name="fold16", tile=16, widths=range(18, 25, 2))

DATAPATHS = {"lean": LEAN, "paper": PAPER}  # dataflows by name
DEFAULT = "lean"  # default datapath

TILED = replace(LEAN, name="lean25", tile=25), replace(LEAN, name="lean16", tile=16, widths=range(16, 25))

CONFIGURATIONS = {path.name: path for path in (LEAN, PAPER, *TILED, FOLD, FOLD16)}
"""``DATAPATH=`` name -> datapath of the core: lean; paper; lean for multipliers of 25x18 or of 16x16 bits, the latter
with small tables; lean folded into a program for one multiplier, with tiles of 18x18 or of 16x16 bits."""

ARM = replace(LEAN, name="arm", flow=arm.arm, sections=arm.SECTIONS, widths=WIDTHS, inputs=ARM_FIELDS, side=BRANCHES)
ARM = replace(ARM, results=ARM_RESULT_FIELDS, flags=ARM_FLAGS, flag_bits=ARM_FLAG_BITS, top="ik_arm", core="u_lean")
FOLD_ARM = folded(ARM, "fold_arm")
FOLD_ARM16 = replace(FOLD_ARM, name="fold_arm16", tile=16, widths=FOLD16.widths)

ARM25, ARM16 = replace(ARM, name="arm25", tile=25), replace(ARM, name="arm16", tile=16, widths=TILED[1].widths)


def choosing(path: Datapath, name: str) -> Datapath:
    """Return the version of a whole-arm datapath that also chooses the branch of a hand pose."""
    path = replace(path, name=name, flow=choose.choose, sections=path.sections | choose.SECTION)
    path = replace(path, inputs=(*path.inputs, *REFERENCES), results=CHOICE_FIELDS)
    return replace(path, flags=CHOICE_FLAGS, flag_bits=CHOICE_FLAG_BITS)


CHOOSE = choosing(ARM, "choose")
FOLD_CHOOSE = replace(choosing(FOLD_ARM, "fold_choose"), behind=choose.FOLD_CLOCKS)

WHOLE = ARM, ARM25, ARM16, FOLD_ARM, FOLD_ARM16, CHOOSE, FOLD_CHOOSE
MODELS = {**CONFIGURATIONS, **{path.name: path for path in WHOLE}}
"""Name -> datapath, for all that the model computes: the configurations of the core, and the whole arm."""
