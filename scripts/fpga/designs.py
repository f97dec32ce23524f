# SPDX-License-Identifier: Apache-2.0
"""Designs that `make fpga` measures, and their figures in docs/generated/fpga.json."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from model.dataflow.datapaths import MODELS
from scripts.fpga.runs import Run
from tb.sim.env import GENERATED
from tb.sim.sources import digest

FIGURES = GENERATED / "fpga.json"
PAGE = GENERATED / "fpga.md"


@dataclass(frozen=True)
class Design:
    """Top module with parameters, and the families for which it is synthesized or placed.

    parameters: all but W. aims: family -> MHz at which no further placement seed is tried; clocks vary by up to a fifth
    between seeds. within: parameters of `ik_axis`, if it is placed instead of the top.
    """

    datapath: str
    width: int
    top: str
    families: tuple[str, ...]
    aims: dict[str, float] = field(default_factory=dict)
    parameters: dict[str, int] = field(default_factory=dict)
    within: dict[str, int] | None = None

    @property
    def name(self) -> str:
        return f"{self.datapath}-{self.width}"

    @property
    def group(self) -> str:
        """Value of --datapath that selects the design."""
        return {"echo": "memory", "fold16": "fold", "fold_arm16": "fold_arm"}.get(self.datapath, self.datapath)

    def run(self, family: str, kind: str = "synth") -> Run:
        """Return a run of the top, or of `ik_axis` around it."""
        values = {"W": self.width, **self.parameters}
        aim = self.aims.get(family) if kind == "place" else None
        if kind == "place" and self.within is not None:
            return Run(kind, family, "ik_axis", values | self.within, aim)
        return Run(kind, family, self.top, values, aim, echo=self.datapath == "echo")


FAMILIES = ("xc2vp", "xc7", "xcup", "ecp5")
FOLD, FOLD16 = ({key: MODELS[name].parameters[key] for key in ("DATAPATH", "TILE")} for name in ("fold", "fold16"))
MEMORY = ("xc2vp", "xc7", "ecp5")
SMALL = ("ecp5-12k", "xc7", "gowin")

DESIGNS = (
    Design("lean", 18, "ik_lean", FAMILIES, {"ecp5": 190}, within={}),
    *(Design("lean", width, "ik_lean", FAMILIES, {"ecp5": 170}, within={}) for width in (24, 32)),
    Design("lean25", 18, "ik_lean", ("xc7", "xcup"), {}, {"TILE": 25}),
    Design("paper", 32, "ik_paper", FAMILIES, {}, {"DIGIT": 1}),
    Design("paper", 18, "ik_paper", ("ecp5",), {"ecp5": 150}, {"DIGIT": 1}, within={"DATAPATH": 0}),
    Design("echo", 32, "ik_axi", MEMORY, {"ecp5": 145}),
    *(Design("memory", width, "ik_axi", MEMORY, {"ecp5": 130}) for width in (18, 32)),
    *(Design("fold16", width, "ik_axis", ("up5k",), {"up5k": 33}, FOLD16) for width in (18, 24)),
    *(Design("fold", width, "ik_axis", SMALL, {"ecp5-12k": 100}, FOLD) for width in (24, 32)),
    Design("fold_arm16", 24, "ik_arm", ("up5k",), {"up5k": 28}, FOLD16),
    Design("fold_arm", 24, "ik_arm", ("ecp5-12k",), {"ecp5-12k": 90}, FOLD),
    Design("fold_arm", 32, "ik_arm", ("ecp5-12k",), {"ecp5-12k": 85}, FOLD),
)
"""Default designs. lean25: only the gain of larger tiles is measured. paper: dividers and roots built from logic.
memory: ``ik_axi`` with the lean datapath. echo: ``ik_axi`` with a stand-in for the datapath."""

GROUPS = list(dict.fromkeys(design.group for design in DESIGNS))

CHIPS = {
    "up5k": ("iCE40 UP5K", "logic cells"),
    "ecp5-12k": ("ECP5-12k, speed grade 6", "LUT4"),
    "xc7": ("xc7", "LUT6"),
    "gowin": ("Gowin GW2A", "LUT4"),
}
"""Chips of the folded datapath, with their unit of logic."""


def find(datapath: str, width: int) -> Design | None:
    """Return the design of a datapath at any word length."""
    known = [one for one in DESIGNS if one.datapath == datapath]
    return next((replace(one, width=width) for one in sorted(known, key=lambda one: one.width != width)), None)


def select(groups: Sequence[str], widths: Sequence[int]) -> list[Design]:
    """Return the default designs, or the designs of groups and word lengths."""
    designs = [one for one in DESIGNS if one.group in (groups or [one.group])]
    if widths:
        names = dict.fromkeys(one.datapath for one in designs)
        designs = [find(name, width) for name in names for width in sorted(widths)]
    limited = {name: one.widths for name, one in MODELS.items()}
    return [one for one in designs if one.width in limited.get(one.datapath, [one.width])]


def measured(data: dict, *datapaths: str) -> list[Design]:
    """Return the measured designs of datapaths, by default of all."""
    names = (name.split("-") for name in data["designs"])
    return [find(datapath, int(width)) for datapath, width in names if datapath in (datapaths or [datapath])]


def load() -> dict:
    return json.loads(FIGURES.read_text())


def run_of(data: dict, run: Run) -> dict:
    """Return the figures of a run, empty if it was not measured."""
    return data["runs"].get(run.title, {})


def clock(data: dict, datapath: str, width: int) -> float | None:
    """Return the clock of a placed design (MHz), None unless it was placed."""
    design = find(datapath, width)
    return next(filter(None, (run_of(data, design.run(family, "place")).get("mhz") for family in design.aims)), None)


def size(data: dict, datapath: str, width: int) -> tuple[dict | None, str]:
    """Return the cells of a design with LUT4, None if not measured, and the family, such as up5k."""
    design = find(datapath, width)
    family = next((one for one in ("xc2vp", "up5k", "ecp5-12k") if design and one in design.families), "")
    return (run_of(data, design.run(family)).get("cells") if family else None), family


def code(design: Design) -> str:
    return digest({path for kind in ("synth", "place") for path in design.run("", kind).files()})


def recorded() -> dict[str, str]:
    """Return a dict: design, such as lean-32 -> digest of the code behind the checked-in figures."""
    return {f"RTL of {name}": design["rtl"] for name, design in load()["designs"].items()}


def present() -> dict[str, str]:
    """Return a dict: design -> digest of the present code."""
    return {f"RTL of {design.name}": code(design) for design in measured(load())}
