# SPDX-License-Identifier: Apache-2.0
"""Designs that `make fpga` measures, and their figures in docs/generated/fpga.json."""

import json
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from model.dataflow.datapaths import MODELS
from model.dataflow.formats import inner_frac
from scripts.fpga.runs import Run
from tb.sim.env import GENERATED
from tb.sim.sources import digest

FIGURES = GENERATED / "fpga.json"
PAGE = GENERATED / "fpga.md"


@dataclass(frozen=True)
class Design:
    """Top module with its parameters, and the families for which it is synthesized (``families``) or placed (``aims``).

    ``parameters`` excludes W. ``aims``: family -> clock (MHz) at which no further placement seed is tried; clocks
    vary by up to a fifth between seeds. If ``within`` is given, `ik_axis` is placed instead, with these parameters too.
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
        same = {"echo": "memory", "fold16": "fold", "fold_arm16": "fold_arm", "fold_choice": "choice"}
        same |= dict.fromkeys(ARM_PARTS, "arm")
        same |= dict.fromkeys(FOLDED_MEMORY, "memory") | {f"{ASIC}_{name}": ASIC for name, _ in STANDARD_CELLS}
        return same.get(self.datapath, self.datapath)

    def run(self, family: str, kind: str = "synth") -> Run:
        """Return the design's run of a kind (synth, tree or place; see `Run`) for a family."""
        values = {"W": self.width, **self.parameters}
        aim = self.aims.get(family) if kind == "place" else None
        if kind == "place" and self.within is not None:
            return Run(kind, family, "ik_axis", values | self.within, aim)
        return Run(kind, family, self.top, values, aim, echo=self.datapath == "echo")


FAMILIES = ("xc2vp", "xc7", "xcup", "ecp5")
TILED = {name: {k: v for k, v in one.parameters.items() if k != "CHOOSE"} for name, one in MODELS.items()}
"""Datapath -> its parameters, without CHOOSE."""
FOLD, FOLD16 = TILED["fold"], TILED["fold16"]
MEMORY = ("xc2vp", "xc7", "ecp5")
SMALL = ("ecp5-12k", "xc7", "gowin")
ARM_PARTS = {"arm_hand": "ik_lean_hand", "arm_frame": "ik_lean_frame", "arm_joints": "ik_lean_joints"}
"""Modules around the lean datapath in `ik_arm`, placed alone: `ik_arm` has too many multipliers for the ECP5-85k."""
FOLDED_MEMORY = ("fold_memory", "fold_arm_memory")
ASIC, STANDARD_CELLS = "asic", (("fold16", 18), ("fold", 24), ("fold_arm", 24), ("lean", 18))
"""Group of the designs for standard cells, measured by `make asic`; their datapaths and word lengths."""


DESIGNS = (
    Design("lean", 18, "ik_lean", FAMILIES, {"ecp5": 190}, within={}),
    *(Design("lean", width, "ik_lean", FAMILIES, {"ecp5": 170}, within={}) for width in (24, 32)),
    Design("lean25", 18, "ik_lean", ("xc7", "xcup"), {}, {"TILE": 25}),
    *(Design("arm", width, "ik_arm", FAMILIES, {}, {"DATAPATH": 1}) for width in (18, 24, 32)),
    *(
        Design(name, w, top, ("ecp5",), {"ecp5": aim}, {} if top == "ik_lean_joints" else {"N": inner_frac(w) + 2})
        for w, aim in ((18, 170), (24, 150), (32, 150))
        for name, top in ARM_PARTS.items()
    ),
    Design("paper", 32, "ik_paper", FAMILIES, {}, {"DIGIT": 1}),
    Design("paper", 18, "ik_paper", ("ecp5",), {"ecp5": 150}, {"DIGIT": 1}, within={"DATAPATH": 0}),
    Design("echo", 32, "ik_axi", MEMORY, {"ecp5": 145}),
    *(Design("memory", width, "ik_axi", MEMORY, {"ecp5": 130}) for width in (18, 32)),
    *(
        Design(name, 24, "ik_axi", SMALL[:2], {"ecp5-12k": 85}, FOLD | {"ARM": arm})
        for arm, name in enumerate(FOLDED_MEMORY)
    ),
    *(Design("fold16", width, "ik_axis", ("up5k",), {"up5k": 33}, FOLD16) for width in (18, 24)),
    *(Design("fold", width, "ik_axis", SMALL, {"ecp5-12k": 100}, FOLD) for width in (24, 32)),
    Design("fold_arm16", 24, "ik_arm", ("up5k",), {"up5k": 28}, FOLD16),
    *(Design("fold_arm", w, "ik_arm", ("ecp5-12k",), {"ecp5-12k": mhz}, FOLD) for w, mhz in ((24, 90), (32, 85))),
    *(Design(f"{ASIC}_{name}", w, MODELS[name].top, ("osu018",), {}, TILED[name]) for name, w in STANDARD_CELLS),
    *(Design("choice", width, "ik_choose", ("xc2vp", "ecp5"), {"ecp5": 180}) for width in (24, 32)),
    *(Design("fold_choice", width, "ik_fold_choose", ("xc2vp", "ecp5-12k"), {"ecp5-12k": 100}) for width in (24, 32)),
)
"""Default designs. choice and fold_choice are the logic that CHOOSE = 1 adds. lean25 shows the gain of larger tiles.
paper has dividers and roots built from logic. ``ik_axi`` has the lean datapath in memory, a folded core for wrists in
fold_memory and for the whole arm in fold_arm_memory, and a stand-in for the datapath in echo."""

GROUPS = list(dict.fromkeys(design.group for design in DESIGNS))

CHIPS = {
    "up5k": ("iCE40 UP5K", "logic cells"),
    "ecp5-12k": ("ECP5-12k, speed grade 6", "LUT4"),
    "xc7": ("xc7", "LUT6"),
    "gowin": ("Gowin GW2A", "LUT4"),
}
"""Family in which the fold datapath is measured -> (chip, unit of logic)."""


def find(datapath: str, width: int) -> Design | None:
    """Return a datapath's default design, changed to word length `width`; None if there is no such design."""
    known = [one for one in DESIGNS if one.datapath == datapath]
    return next((replace(one, width=width) for one in sorted(known, key=lambda one: one.width != width)), None)


def select(groups: Sequence[str], widths: Sequence[int]) -> list[Design]:
    """Return the default designs of ``groups``; if empty, of all groups but ASIC. With ``widths``, return a design for
    each datapath of these designs at each of the ``widths`` that the datapath supports."""
    designs = [one for one in DESIGNS if one.group in (groups or {*GROUPS} - {ASIC})]
    if widths:
        names = dict.fromkeys(one.datapath for one in designs)
        designs = [find(name, width) for name in names for width in sorted(widths)]
    limited = {name: one.widths for name, one in MODELS.items()}
    return [one for one in designs if one.width in limited.get(one.datapath, [one.width])]


def measured(data: dict, *datapaths: str) -> list[Design]:
    """Return the designs in ``data`` with one of these datapaths; all designs if no datapath is given."""
    names = (name.split("-") for name in data["designs"])
    return [find(datapath, int(width)) for datapath, width in names if datapath in (datapaths or [datapath])]


def load() -> dict:
    return json.loads(FIGURES.read_text())


def run_of(data: dict, run: Run) -> dict:
    """Return the figures of a run in ``data``; an empty dict if the run was not measured."""
    return data["runs"].get(run.title, {})


def clock(data: dict, datapath: str, width: int) -> float | None:
    """Return the clock (MHz) of a design after placement; None if the design was not placed."""
    design = find(datapath, width)
    return next(filter(None, (run_of(data, design.run(family, "place")).get("mhz") for family in design.aims)), None)


def size(data: dict, datapath: str, width: int) -> tuple[dict | None, str]:
    """Return a design's cells (None: not measured) on a LUT4 family, and that family's name, such as up5k."""
    design = find(datapath, width)
    family = next((one for one in ("xc2vp", "up5k", "ecp5-12k") if design and one in design.families), "")
    return (run_of(data, design.run(family)).get("cells") if family else None), family


def code(design: Design) -> str:
    return digest({path for kind in ("synth", "place") for path in design.run("", kind).files()})


def recorded() -> dict[str, str]:
    """Return a dict: "RTL of lean-32" and so on -> digest of the code from which the checked-in figures were made."""
    return {f"RTL of {name}": design["rtl"] for name, design in load()["designs"].items()}


def present() -> dict[str, str]:
    """Return the same dict as :func:`recorded`, with digests of the present code."""
    return {f"RTL of {design.name}": code(design) for design in measured(load())}
