# SPDX-License-Identifier: Apache-2.0
"""Compare accuracy figures of tables, arithmetic modules and datapaths with figures.json, and check that tolerances are
not too wide.

    python -m model.bounds.tests.test_figures

writes figures.json in this folder from the current code.  A worse figure is a regression, or a change that must be
explained in its commit; a much better figure shows that the file is outdated.  Model and RTL share tables and formats:
they remain equal if a table gets worse, and only this test detects it.

Units: fraction of the reach for a hand, radians for an angle, ulps of the result for an arithmetic module.

* ``proved``: the largest error that the proof permits for the actual table, rounded up to four digits.
* ``max``, ``rms``, ``median``: of measured errors, always for the same arguments or targets.
* ``NODE rms``: root mean square of the error that rounding adds at the node NODE.
* ``products proved``: the largest error of the lean datapath's products, each the sum of three tile products.
* ``inner``: hand error of the lean datapath before its results are rounded; that rounding mostly hides inner errors.
"""

import json
import math
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path

import numpy as np
import pytest

from model.bounds import tolerances
from model.bounds.predict import Real
from model.dataflow import fixed, quadratic
from model.dataflow.formats import WIDTHS
from model.dataflow.tests.test_datapaths import Run, ulp
from model.io.flags import UNREACHABLE, expected_flags
from model.io.scoring import singular_distance
from model.io.stimuli import REGIONS, random_reachable, region, unreachable
from model.io.words import from_words
from model.reference.equations import solve_clamped
from model.reference.lean_equations import solve_lean

FILE = Path(__file__).with_name("figures.json")
Figures = dict[str, float]

WIDE, SMALL = 18, 16
"""Bits of a multiplier tile; SMALL selects small tables."""

TABLES = [(f, WIDE) for f in (19, 22, 23, 24, 31)] + [(f, SMALL) for f in (19, 28, 29)]
"""(fraction bits, tile): the fewest and the most fraction bits for which each form of a table is used."""

PI = np.longdouble("3.14159265358979323846264338")

WORSE = {"proved": 1.0, "max": 1.1, "rms": 1.02, "median": 1.02}
"""Largest permitted ratio of a figure to the recorded figure.  The targets are always the same. One bit fewer in one of
many words increases an rms by a few percent; a maximum depends on a single target and varies more."""

BETTER = {"proved": 0.98, "max": 0.0, "rms": 0.9, "median": 0.9}
"""Smallest permitted ratio; none for a maximum, which depends on a single target."""


def measured(**errors: np.ndarray) -> Figures:
    """Return the maximum and the root mean square of each error."""
    found = {}
    for name, error in errors.items():
        found[f"{name} max"] = float(np.abs(error).max())
        found[f"{name} rms"] = float(np.sqrt(np.mean(np.square(error, dtype=np.float64))))
    return found


def around(first: int, last: int, points: int, seed: int) -> np.ndarray:
    """Return words in [``first``, ``last``): 60000 at random, and the words around ``points`` equidistant points."""
    anywhere = np.random.default_rng(seed).integers(first, last, 60000)
    near = (np.arange(points + 1)[:, None] * ((last - first) // points) + first + np.arange(-8, 8)).ravel()
    return np.concatenate([anywhere, near[(near >= first) & (near < last)]])


def reciprocal_root(frac: int, tile: int) -> Figures:
    """Return the figures of ``rsqrt``.  A mantissa stands for the interval of values truncated to it: the rms error is
    measured in the middle of the interval, the largest error at its ends."""
    m = around(1 << frac + 1, 1 << frac + 3, 3072, frac)
    y = quadratic.rsqrt(m, frac, tile)
    two, parts = np.longdouble(2), np.array([[0], [0.5], [1]], np.longdouble)
    low, middle, high = (y - two**frac / 2 / np.sqrt((m + parts) / two ** (frac + 3))).astype(np.float64)
    found = measured(error=middle) | {"error max": float(max(np.abs(low).max(), np.abs(high).max()))}
    proved = quadratic.rsqrt_error(frac, tile)
    assert proved < quadratic.rsqrt_places(frac, tile)
    return {"proved": proved} | found


def sine_and_cosine(frac: int, tile: int) -> Figures:
    width = 32 if frac > 24 and tile == WIDE else 24
    phi = around(-(1 << width - 1), 1 << width - 1, 4096, frac)
    half = phi.astype(np.longdouble) * PI / 2**width
    pairs = zip(quadratic.half_sincos(phi, width, frac, tile), (np.sin(half), np.cos(half)), strict=True)
    errors = [(word - exact * np.longdouble(2) ** frac).astype(np.float64) for word, exact in pairs]
    return {"proved": quadratic.half_sincos_error(frac, tile)} | measured(error=np.stack(errors))


@cache
def everywhere(width: int) -> np.ndarray:
    """Return targets of every kind, most near singularities of the paper's equations; 2000 are out of reach."""
    return np.concatenate([*(region(name, 1000, width, 12) for name in REGIONS), unreachable(2000, width, 12)])


@cache
def regular(width: int) -> np.ndarray:
    """Return targets at least 0.2 rad from every singular pose."""
    words = random_reachable(20000, width, 12)
    return words[singular_distance(from_words(words, 0, width, "random")) > 0.2]


def answers(targets: Callable[[int], np.ndarray], width: int, datapath: str) -> Figures:
    """Return the figures of a datapath for ``targets(width)``: errors of hand, angles and norms."""
    words, lean = targets(width), datapath.startswith("lean")
    clamped = expected_flags(words, width) & UNREACHABLE != 0
    runs = [Run(words[~clamped], width, datapath, solve_lean if lean else solve_clamped)]
    runs += [Run(words[clamped], width, datapath, solve_clamped)] if clamped.any() else []
    found = measured(norm=np.concatenate([norm for run in runs for norm in run.norms]) * ulp(width))
    if clamped.any():
        found["clamped max"] = float(runs[1].hand.max())
    run, angle = runs[0], np.maximum(runs[0].shoulder_angle, runs[0].elbow_angle)
    if not lean:  # a few targets near singular poses dominate the maximum and the root mean square
        return found | {"hand median": float(np.median(run.hand)), "angle median": float(np.median(angle))}
    nodes = run.answer.nodes
    final = [nodes[name] for name in ("w_q", "i_q", "j_q", "k_q", "elbow_w", "elbow_i")]  # to results
    inner = np.column_stack([node.value * node.format.ulp for node in final]) * (1, 1, 1, 1, 1, -1)
    products = max(abs(e) for node in nodes.values() if node.kind == "mul3" for e in node.error)
    return found | measured(hand=run.hand, angle=angle, inner=run.off(inner)[1]) | {"products proved": products}


class Local(Real):
    """Dataflow in double precision, each node computed from its operands' words."""

    def __getitem__(self, name: str):
        node = self.nodes[name]
        return np.asarray(node.value, np.float64) if node.frac else node.value


NOISE = 1e-14  # an rms error up to this is noise of double precision


def nodes(width: int, datapath: str) -> Figures:
    """Return each node's rms rounding error. It is not in ulps, because that would not reveal a shortened word."""
    words = everywhere(width)
    reached = expected_flags(words, width) & UNREACHABLE == 0
    real, figures = Local(fixed.run(words, width, datapath).nodes, {}), {}
    for name, node in real.nodes.items():
        if node.frac and (rms := np.sqrt(np.mean((real.word(name) - real.values[name])[reached] ** 2))) > NOISE:
            figures[f"{name} rms"] = float(rms)
    return figures


PATHS = {"lean": range(16, 33), "lean16": (16, 18, 24), "lean25": (18, 24, 32), "paper": (18, 24, 32)}

GROUPS: dict[str, Callable[[], Figures]] = {
    **{f"rsqrt-{f}" + "-small" * (tile == SMALL): partial(reciprocal_root, f, tile) for f, tile in TABLES},
    **{f"trig-{f}" + "-small" * (tile == SMALL): partial(sine_and_cosine, f, tile) for f, tile in TABLES},
    **{f"{path}-{w}": partial(answers, everywhere, w, path) for path, widths in PATHS.items() for w in widths},
    **{f"paper-{width}-regular": partial(answers, regular, width, "paper") for width in PATHS["paper"]},
    **{f"lean-{width}-nodes": partial(nodes, width, "lean") for width in (18, 24, 32)},
    **{f"{path}-24-nodes": partial(nodes, 24, path) for path in ("lean16", "paper")},
}
"""Module or datapath, word length and variant -> function that returns the figures."""

TOLERATED = {f"lean-{width}": tolerances.LEAN[width] for width in WIDTHS}
"""Group -> tolerance of its hand error."""


@pytest.mark.parametrize("name", GROUPS)
def test_figures(name):
    present, recorded = GROUPS[name](), json.loads(FILE.read_text(encoding="utf-8"))[name]
    assert list(present) == list(recorded), "other figures than in the file"
    for what, figure in present.items():
        ratio = figure / recorded[what]
        kind = what.split()[-1]
        message = f"{name}: {what} is {figure:.4g}, {ratio:.3f} times the {recorded[what]:.4g} recorded"
        assert BETTER[kind] <= ratio <= WORSE[kind], message
    assert present.get("error max", 0) <= present.get("proved", 0), "an error exceeds its proved bound"
    if name in TOLERATED:
        assert TOLERATED[name] / 8 < present["hand max"] <= TOLERATED[name]


def rounded(name: str, figure: float) -> float:
    """Return a figure rounded to four digits; a proved figure is rounded up."""
    if not name.endswith("proved"):
        return float(f"{figure:.3e}")
    place = 10.0 ** (math.floor(math.log10(figure)) - 3)
    return float(f"{math.ceil(figure / place) * place:.4g}")


if __name__ == "__main__":
    made = {group: {name: rounded(name, figure) for name, figure in of().items()} for group, of in GROUPS.items()}
    lines = [f"{json.dumps(group)}: {json.dumps(figures)}" for group, figures in made.items()]
    FILE.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")
