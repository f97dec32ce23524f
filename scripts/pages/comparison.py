# SPDX-License-Identifier: Apache-2.0
"""The paper's and the lean datapath on the same targets: what is measured of them, its page and its picture."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np

from model.bounds import tolerances
from model.dataflow import fixed
from model.dataflow.datapaths import CONFIGURATIONS, DATAPATHS
from model.dataflow.nodes import WIDTHS
from model.io.stimuli import REGIONS, SINGULAR, at_distance, region
from model.io.words import RESULT_FIELDS, from_words, result_values
from model.reference.kinematics import angle_between, forward
from model.reference.lean_equations import solve_lean
from scripts.pages import counts
from scripts.pages.render import error, render, svg
from tb.sim.env import GENERATED

PAGE = GENERATED / "compare.md"
PLOT = GENERATED / "compare.svg"

WIDTH = 32
BATCH = 100
"""Targets of a trajectory."""

LATENCY_WIDTHS = (16, 18, 24, 27, 32)
DISTANCES = tuple(10.0 ** (-k / 2) for k in range(2, 21))
AT_DISTANCE = 400
"""Targets at each distance from each singular target."""

ANGLE = 1e-7
"""Largest error of a joint's angle (rad) that the lean datapath of 32 bits is to stay below."""

COLOURS = {"paper": "#c2410c", "lean": "#1d4ed8"}
PATHS = tuple(COLOURS)
SAME_BITS = {"fold": "lean"}
"""Machines that compute the bits of another: their clocks are their own."""
MACHINES = (*PATHS, *SAME_BITS)
ANGLES = ("shoulder", "elbow")

BEYOND = "most unequal arms"
"""The region that the table of both datapaths leaves out: arms more unequal than 1:20."""

# -- measuring -------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Errors:
    """Of some targets (N,): the hand against the target / reach, the angles of the joints against double precision
    (rad), and abs(norm^2 - 1) of the longer of both quaternions."""

    hand: np.ndarray
    shoulder: np.ndarray
    elbow: np.ndarray
    norm: np.ndarray

    @classmethod
    def of(cls, words: np.ndarray, width: int, datapath: str) -> Errors:
        """What a datapath makes of reachable targets."""
        values = result_values(fixed.run(words, width, datapath).results, width)
        asked = from_words(words, 0, width, "words")
        pose = solve_lean(asked.x, asked.y, asked.z, asked.phi, asked.d1, asked.d2)
        pose = np.column_stack([pose[name] for name in RESULT_FIELDS])
        qs, qe = values[:, :4], values[:, 4:]
        wrist = forward(qs, qe, asked.d1, asked.d2)[1]
        rest = np.zeros_like(qe)
        return cls(
            np.linalg.norm(wrist - asked.position, axis=1) / asked.reach,
            angle_between(qs, pose[:, :4]),
            angle_between(np.hstack([qe, rest]), np.hstack([pose[:, 4:], rest])),
            np.maximum(*(np.abs((q**2).sum(axis=1) - 1) for q in (qs, qe))),
        )

    @property
    def angle(self) -> float:
        """The largest error of a joint's angle."""
        return max(self.shoulder.max(), self.elbow.max())

    @classmethod
    def together(cls, parts: list[Errors]) -> Errors:
        """Those of all targets of several."""
        return cls(*(np.concatenate([getattr(p, name) for p in parts]) for name in cls.__dataclass_fields__))


def operations(datapath: str) -> Counter:
    """How many operations of each kind of table 4 the dataflow makes; not what is inside of one."""
    found = sum(counts.operations(DATAPATHS[datapath].flow).values(), Counter())
    return Counter({
        "multiplications": found["mul"] + found["mul3"] + found["square"] + found["product"],
        "of them exact squares and products of the flags": found["exact"],
        "additions": found["additions"],
        "square roots": found["root"],
        "reciprocal square roots": found["rsqrt"],
        "divisions": found["div"],
    })  # fmt: skip


@dataclass
class Measured:
    """Everything that the page and the picture show.

    ``same``: datapath -> region -> errors, W = 32; ``lean``: width -> region -> errors; ``near``: datapath -> singular
    target -> errors at each of ``DISTANCES``; ``clocks``: machine -> width -> latency, where it is built.
    """

    same: dict[str, dict[str, Errors]]
    lean: dict[int, dict[str, Errors]]
    near: dict[str, dict[str, list[Errors]]]
    clocks: dict[str, dict[int, int]]

    @classmethod
    def now(cls, targets: int, seed: int) -> Measured:
        """Measures."""
        lean = {
            width: {name: Errors.of(region(name, targets, width, seed), width, "lean") for name in REGIONS}
            for width in WIDTHS
        }
        paper = {name: Errors.of(region(name, targets, WIDTH, seed), WIDTH, "paper") for name in REGIONS}
        words = {
            kind: [at_distance(kind, d, AT_DISTANCE, WIDTH, seed) for d in DISTANCES] for kind in SINGULAR
        }
        near = {
            path: {kind: [Errors.of(w, WIDTH, path) for w in rows] for kind, rows in words.items()}
            for path in PATHS
        }
        clocks = {
            path: {w: fixed.latency(path, w) for w in LATENCY_WIDTHS if w in CONFIGURATIONS[path].widths}
            for path in MACHINES
        }
        return cls({"paper": paper, "lean": lean[WIDTH]}, lean, near, clocks)


# -- the page --------------------------------------------------------------------------------------------------------


def _three(values: np.ndarray) -> tuple[str, str, str]:
    return error(np.median(values)), error(np.quantile(values, 0.999)), error(values.max())


def page(measured: Measured, targets: int, seed: int) -> str:
    """docs/generated/compare.md."""
    same, near = measured.same, measured.near
    return render(
        "compare",
        targets=targets,
        seed=seed,
        width=WIDTH,
        machines=list(MACHINES),
        widths=[f"W = {w}" for w in LATENCY_WIDTHS],
        beyond=BEYOND,
        regions=REGIONS,
        at_distance=AT_DISTANCE,
        farthest=DISTANCES[0],
        side_by_side=_side_by_side(measured),
        clocks=[(path, *(of.get(w, "-") for w in LATENCY_WIDTHS)) for path, of in measured.clocks.items()],
        hands=[(name, *(f for path in PATHS for f in _three(same[path][name].hand))) for name in REGIONS],
        angles=[
            (name, *(f for a in ANGLES for path in PATHS for f in _three(getattr(same[path][name], a))[1:]))
            for name in REGIONS
        ],
        singular=[f"{kind}, {path}" for kind in SINGULAR for path in PATHS],
        near={angle: list(_growth(near, angle)) for angle in ANGLES},
        worst={
            path: [max(near[path][kind][n].angle for kind in SINGULAR) for n in range(len(DISTANCES))] for path in PATHS
        },
        by_width=_by_width(measured),
        by_region=[(name, *(error(measured.lean[w][name].hand.max()) for w in LATENCY_WIDTHS)) for name in REGIONS],
    )


def batch_clocks(path: str, latency: int) -> int:
    """From the first of a batch of targets in to the last result out."""
    return latency + 1 + (BATCH - 1) * CONFIGURATIONS[path].period


def _side_by_side(measured: Measured):
    clocks = {path: measured.clocks[path][WIDTH] for path in MACHINES}
    yield "clocks from a target to the next", *(CONFIGURATIONS[path].period for path in MACHINES)
    yield "latency (clocks)", *clocks.values()
    yield f"clocks for {BATCH} targets", *(batch_clocks(*each) for each in clocks.items())
    computed = [SAME_BITS.get(path, path) for path in MACHINES]
    found = {path: operations(path) for path in PATHS}
    for kind in found[PATHS[0]]:
        yield kind, *(found[path][kind] for path in computed)
    anywhere = {path: parts["anywhere"] for path, parts in measured.same.items()}
    everywhere = {
        path: Errors.together([errors for name, errors in parts.items() if name != BEYOND])
        for path, parts in measured.same.items()
    }
    for what, source in (("anywhere", anywhere), ("all regions but one", everywhere)):
        for name, label in (("hand", "hand error"), ("shoulder", "shoulder angle"), ("elbow", "elbow angle")):
            three = [_three(getattr(source[path], name)) for path in computed]
            yield f"{label}, {what}: median, 99.9 %, largest", *(", ".join(t) for t in three)


def _growth(near: dict[str, dict[str, list[Errors]]], angle: str):
    """For every second distance the largest error at each singular target."""
    for n, distance in list(enumerate(DISTANCES))[::2]:
        worst = (getattr(near[path][kind][n], angle).max() for kind in SINGULAR for path in PATHS)
        yield f"1e{round(np.log10(distance))}", *map(error, worst)


def _by_width(measured: Measured):
    for width, regions in measured.lean.items():
        e = Errors.together(list(regions.values()))
        ulp = 2.0 ** (2 - width)
        yield (
            width, *_three(e.hand), f"{e.hand.max() / ulp:.1f}", f"{tolerances.lean(width):.3g}",
            error(e.shoulder.max()), error(e.elbow.max()), f"{e.norm.max() / ulp:.1f}",
        )  # fmt: skip


# -- the picture -----------------------------------------------------------------------------------------------------


@svg
def plot(plt, near: dict[str, dict[str, list[Errors]]]):
    """Errors against distance: a row an error, a column a singular target, a colour a datapath."""
    titles = {
        "the z axis": "angle to the z axis (rad)", "full stretch": "to full stretch / reach",
        "full fold": "to full fold / reach", "the shoulder": "to the shoulder / reach",
    }  # fmt: skip
    rows = {"shoulder": "shoulder angle (rad)", "elbow": "elbow angle (rad)", "hand": "hand error / reach"}
    hand = tolerances.lean(WIDTH)
    asked = f"asked of lean: {ANGLE:.0e} rad, {hand:.0e}"
    shape = len(rows), len(SINGULAR)
    figure, grid = plt.subplots(*shape, figsize=(13, 8.6), sharex=True, sharey="row", facecolor="white")
    for axes_row, (name, label) in zip(grid, rows.items(), strict=True):
        for axes, kind in zip(axes_row, SINGULAR, strict=True):
            for path, colour in COLOURS.items():
                values = [getattr(e, name) for e in near[path][kind]]
                axes.plot(DISTANCES, [v.max() for v in values], color=colour, label=f"{path}, largest")
                middle = [np.maximum(np.median(v), 1e-11) for v in values]
                axes.plot(DISTANCES, middle, color=colour, linestyle=":", label=f"{path}, median")
            most = hand if name == "hand" else ANGLE
            axes.axhline(most, color="#666", linestyle="--", linewidth=1, label=asked)
            axes.set(xscale="log", yscale="log")
            axes.grid(True, which="major", color="#ddd")
            axes.spines[["top", "right"]].set_visible(False)
        axes_row[0].set_ylabel(label)
    for axes, kind in zip(grid[-1], SINGULAR, strict=True):
        axes.set_xlabel(titles[kind])
    grid[0, 0].set_xlim(min(DISTANCES), max(DISTANCES))
    figure.suptitle(f"Errors toward singular targets, W = {WIDTH}")
    lines = grid[0, 0].get_legend_handles_labels()
    figure.legend(*lines, loc="upper center", bbox_to_anchor=(0.5, 0.965), ncols=5, frameon=False)
    figure.tight_layout(rect=(0, 0, 1, 0.96))
    return figure
