# SPDX-License-Identifier: Apache-2.0
"""Accuracy figures of the tables, the arithmetic modules and the datapaths: one group per module or datapath and
length.

    python -m model.bounds.tests.figures

writes figures.json in this folder from the current code. A worse figure is a regression, or a change that must be
explained where it is made: model and RTL agree on a wrong table as well as on a right one.

Units: fraction of the reach for a hand, radians for an angle, ulps of the result for an arithmetic module.

* ``proved``: the largest error permitted by the proof, for the actual table; rounded up at the fourth digit.
* ``max``, ``rms``, ``median``: of measured errors, always for the same arguments or targets.
* ``node rms``: of the error added by rounding an inner word.
* ``products``: of the lean datapath, the worst of them.
* ``inner``: the hand of the lean datapath before results are rounded, which masks inner errors at most word lengths.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np

from model.bounds import cordic as cordic_proof
from model.dataflow import cores, fixed, trig
from model.dataflow.reals import Real
from model.io.flags import UNREACHABLE, expected_flags
from model.io.scoring import singular_distance
from model.io.stimuli import REGIONS, random_reachable, region, unreachable
from model.io.words import RESULT_FIELDS, from_words, result_values
from model.reference.equations import solve_clamped
from model.reference.kinematics import angle_between, forward
from model.reference.lean_equations import solve_lean

FILE = Path(__file__).with_name("figures.json")
Figures = dict[str, float]

WIDE, SMALL = 18, 16
"""Bits of a tile: with the second the tables are small."""

ROOTS = [(f, WIDE) for f in range(19, 32)] + [(f, SMALL) for f in range(19, 30)]
SINES = ROOTS
PI = np.longdouble("3.14159265358979323846264338")


def measured(**errors: np.ndarray) -> Figures:
    """Return the maximum and the root mean square of each error."""
    found = {}
    for name, error in errors.items():
        found[f"{name} max"] = float(np.abs(error).max())
        found[f"{name} rms"] = float(np.sqrt(np.mean(np.square(error, dtype=np.float64))))
    return found


# -- arithmetic modules ------------------------------------------------------------------------------------------------


def around(first: int, last: int, points: int, seed: int) -> np.ndarray:
    """Return words in [``first``, ``last``): 60000 random ones, the others around ``points`` equidistant points."""
    anywhere = np.random.default_rng(seed).integers(first, last, 60000)
    near = (np.arange(points + 1)[:, None] * ((last - first) // points) + first + np.arange(-8, 8)).ravel()
    return np.concatenate([anywhere, near[(near >= first) & (near < last)]])


def reciprocal_root(frac: int, tile: int) -> Figures:
    """Return the figures of ``rsqrt``.  The mean is measured at the middle of the interval truncated to a mantissa, the
    largest error at its ends."""
    m = around(1 << frac + 1, 1 << frac + 3, 3072, frac)
    y = cores.rsqrt(m, frac, tile)
    low, middle, high = (
        (y - np.longdouble(2) ** frac / 2 / np.sqrt((m + part) / np.longdouble(2) ** (frac + 3))).astype(np.float64)
        for part in (np.longdouble(0), np.longdouble(0.5), np.longdouble(1))
    )
    found = measured(error=middle) | {"error max": float(max(np.abs(low).max(), np.abs(high).max()))}
    return {"proved": cores.rsqrt_error_bound(frac, tile)} | found


def sine_and_cosine(frac: int, tile: int) -> Figures:
    width = 32 if frac > 24 and tile == WIDE else 24
    phi = around(-(1 << width - 1), 1 << width - 1, 4096, frac)
    half = phi.astype(np.longdouble) * PI / 2**width
    pairs = zip(trig.half_sincos(phi, width, frac, tile), (np.sin(half), np.cos(half)), strict=True)
    errors = [(word - exact * np.longdouble(2) ** frac).astype(np.float64) for word, exact in pairs]
    return {"proved": trig.error_bound(frac, tile)} | measured(error=np.stack(errors))


def cordic(width: int) -> Figures:
    phi = around(-(1 << width - 1), 1 << width - 1, 512, width)
    half = np.pi * phi / 2**width
    pairs = zip(fixed.cordic(phi, width), (np.sin(half), np.cos(half)), strict=True)
    errors = np.stack([word - exact * 2.0 ** (width - 2) for word, exact in pairs])
    return {"proved": cordic_proof.sincos_bound(width)} | measured(error=errors)


# -- datapaths ---------------------------------------------------------------------------------------------------------


@cache
def everywhere(width: int) -> np.ndarray:
    """Return targets of every kind, most near singularities of the paper's equations; the last are out of reach."""
    return np.concatenate([*(region(name, 1000, width, 12) for name in REGIONS), unreachable(2000, width, 12)])


@cache
def regular(width: int) -> np.ndarray:
    """Return targets at least 0.2 rad from every singular pose."""
    words = random_reachable(20000, width, 12)
    return words[singular_distance(from_words(words, 0, width, "random")) > 0.2]


@cache
def poses(targets: Callable[[int], np.ndarray], width: int, lean: bool):
    """Return the targets, a mask of the reachable ones, and their poses in double precision."""
    words = targets(width)
    asked = from_words(words, 0, width, "words")
    pose = solve_clamped(asked.x, asked.y, asked.z, asked.phi, asked.d1, asked.d2)
    exact = np.column_stack([pose[name] for name in RESULT_FIELDS])
    reached = expected_flags(words, width) & UNREACHABLE == 0
    if lean:  # exact next to singular poses as well
        near = solve_lean(asked.x, asked.y, asked.z, asked.phi, asked.d1, asked.d2)
        exact[reached] = np.column_stack([near[name] for name in RESULT_FIELDS])[reached]
    return asked, reached, exact


def answers(targets: Callable[[int], np.ndarray], width: int, datapath: str) -> Figures:
    """Return the errors of hand, angles and norms of the targets' results."""
    lean = datapath.startswith("lean")
    asked, reached, exact = poses(targets, width, lean)
    run = fixed.run(targets(width), width, datapath)
    q = result_values(run.results, width)
    reach = np.maximum(np.abs(asked.d1) + np.abs(asked.d2), 2.0 ** (2 - width))
    aim = np.where(reached[:, None], asked.position, forward(exact[:, :4], exact[:, 4:], asked.d1, asked.d2)[1])

    def hand(q):
        return np.linalg.norm(forward(q[:, :4], q[:, 4:], asked.d1, asked.d2)[1] - aim, axis=1) / reach

    padded = [np.pad(v[:, 4:], ((0, 0), (0, 2))) for v in (q, exact)]
    angles = np.maximum(angle_between(q[:, :4], exact[:, :4]), angle_between(*padded))
    norms = np.stack([(q[:, :4] ** 2).sum(axis=1), (q[:, 4:] ** 2).sum(axis=1)]) - 1
    found = measured(norm=norms)
    if not reached.all():
        found["clamped max"] = float(hand(q)[~reached].max())
    if not lean:  # a few targets near singular poses dominate the maximum and the root mean square
        middle = np.median([hand(q)[reached], angles[reached]], axis=1).tolist()
        return found | dict(zip(("hand median", "angle median"), middle, strict=True))
    found |= measured(hand=hand(q)[reached], angle=angles[reached])
    nodes = (run.bits.nodes[name] for name in INNER)
    inner = np.column_stack([node.value * node.format.ulp for node in nodes]) * (1, 1, 1, 1, 1, -1)
    products = max(abs(e) for node in run.bits.nodes.values() if node.op == "mul3" for e in node.error)
    return found | measured(inner=hand(inner)[reached]) | {"products proved": products}


INNER = ("w_q", "i_q", "j_q", "k_q", "elbow_w", "elbow_i")
"""Nodes of the lean datapath that are rounded to results."""


class Local(Real):
    """Every node from the words of its operands, in double precision: ``off`` is the error of its own rounding."""

    def __init__(self, bits: fixed.Bits) -> None:
        self.off: dict[str, np.ndarray] = {}
        super().__init__(bits, {})

    def _moved(self, name, value, fmt):
        word = self.bits.nodes[name].value * fmt.ulp
        self.off[name] = np.asarray(word - value, np.float64)
        return word


NOISE = 1e-14
"""Noise of double precision, where most words are exact."""


def nodes(width: int, datapath: str) -> Figures:
    """Return the rms rounding error of every node, not in ulps, so that a shortened word is detected."""
    words = everywhere(width)
    reached = expected_flags(words, width) & UNREACHABLE == 0
    off = Local(fixed.run(words, width, datapath).bits).off
    rms = {f"{name} rms": float(np.sqrt(np.mean(error[reached] ** 2))) for name, error in off.items()}
    return {name: figure for name, figure in rms.items() if figure > NOISE}


# -- all of them -------------------------------------------------------------------------------------------------------


def groups() -> dict[str, Callable[[], Figures]]:
    """Return name -> function: a module or a datapath, its length, and its variant."""
    found: dict[str, Callable[[], Figures]] = {}
    for frac, tile in ROOTS:
        found[f"rsqrt-{frac}" + "-small" * (tile == SMALL)] = lambda f=frac, t=tile: reciprocal_root(f, t)
    for frac, tile in SINES:
        found[f"trig-{frac}" + "-small" * (tile == SMALL)] = lambda f=frac, t=tile: sine_and_cosine(f, t)
    for width in range(16, 33):
        found[f"cordic-{width}"] = lambda w=width: cordic(w)
    lean = [("lean", range(16, 33)), ("lean16", range(16, 25)), ("lean25", (18, 24, 32))]
    paper = [("paper", (18, 24, 32))]
    for datapath, widths in lean + paper:
        for width in widths:
            found[f"{datapath}-{width}"] = lambda d=datapath, w=width: answers(everywhere, w, d)
    for datapath, widths in paper:
        for width in widths:
            found[f"{datapath}-{width}-regular"] = lambda d=datapath, w=width: answers(regular, w, d)
    for datapath, width in (("lean", 18), ("lean", 24), ("lean", 32), ("lean16", 24), ("paper", 24)):
        found[f"{datapath}-{width}-nodes"] = lambda d=datapath, w=width: nodes(w, d)
    return found


def rounded(name: str, figure: float) -> float:
    """Round to four digits; proved figures are rounded up."""
    if not name.endswith("proved"):
        return float(f"{figure:.3e}")
    place = 10.0 ** (math.floor(math.log10(figure)) - 3)
    return float(f"{math.ceil(figure / place) * place:.4g}")


def main() -> None:
    lines = []
    for group, of in groups().items():
        figures = {name: rounded(name, figure) for name, figure in of().items()}
        lines.append(f"{json.dumps(group)}: {json.dumps(figures)}")
    FILE.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")


if __name__ == "__main__":
    main()
