# SPDX-License-Identifier: Apache-2.0
"""``ik_sincos`` and ``ik_trig`` against ``math.sin`` and ``math.cos`` within a derived or proved bound, and against the
model bit by bit.
"""

import math
import random

import numpy as np

from model.dataflow import fixed
from model.dataflow.cores import TILE
from model.dataflow.nodes import Latency, inner_frac
from model.dataflow.trig import FRACS, error_bound, form_of, half_sincos, trig_clocks
from tb.units.unit import Tests, checks, corners, runs, signed

QUARTER = math.sqrt(0.5)


def bench(
    W: int, frac: int, model, bound: float, latency: int, angles: dict[int, tuple[float, float]], more: float, *streams
) -> Tests:
    """Return the tests. ``bound`` is in LSBs of 2^-``frac``; ``angles`` maps phi to sin and cos of phi/2, which the
    model must match within ``bound + more``.
    """
    words = signed(W)

    def true(vectors, got):
        """Check that results are within the bound of the true values."""
        errors = {
            phi: max(abs(sin - math.ldexp(math.sin(half), frac)), abs(cos - math.ldexp(math.cos(half), frac)))
            for (phi,), (sin, cos) in zip(vectors, got, strict=True)
            for half in [math.pi * phi / 2**W]
        }
        at = max(errors, key=errors.get)
        assert errors[at] <= bound, f"W={W}, phi={at}: error {errors[at]:.3f} last places, bound {bound:.3f}"

    def named_angles():
        """Each named angle between others."""
        for phi, values in angles.items():
            got = [int(word) for (word,) in model([phi])]
            errors = [abs(word - math.ldexp(value, frac)) for word, value in zip(got, values, strict=True)]
            assert max(errors) <= bound + more, f"model: {got} for phi={phi}"
            yield from (5, phi, words[0] // 3, phi, 5)

    def near_corners():
        """Angles near the corners, in random order."""
        angles = [phi + e for phi in corners(words) for e in range(-20, 21) if phi + e in words]
        return random.sample(angles, len(angles))

    return checks(
        {"phi": words},
        {"sin_h": signed(frac + 2), "cos_h": signed(frac + 2)},
        model,
        named_angles,
        near_corners,
        *streams,
        latency=latency,
        latencies=[(0, words[0]), (words[-1], -(1 << W - 2))],
        also=true,
    )


def sincos_bench(W: int) -> Tests:
    def model(phi):
        return fixed.cordic(np.array(phi, dtype=np.int64), W)

    angles = {
        0: (0.0, 1.0),
        1: (0.0, 1.0),
        -1: (0.0, 1.0),
        -(1 << W - 1): (-1.0, 0.0),
        (1 << W - 1) - 1: (1.0, 0.0),
        1 << W - 2: (QUARTER, QUARTER),
        -(1 << W - 2): (-QUARTER, QUARTER),
        -round(2**W / 3): (-math.sqrt(0.75), 0.5),
    }
    # phi itself is off by less than one LSB, an arc of pi/4 LSBs
    return bench(W, W - 2, model, fixed.sincos_bound(W), Latency(W)["sincos"], angles, math.pi / 4)


def trig_bench(W: int, F: int, TILE: int = TILE) -> Tests:
    rows = form_of(F, TILE).rows
    step = (1 << W - 1) // rows  # angle of a segment
    least, largest = -(1 << W - 1), (1 << W - 1) - 1
    small = math.pi / 2**W

    def model(phi):
        return half_sincos(np.array(phi, dtype=np.int64), W, F, TILE)

    # sin and cos of phi/2 where they are known exactly or as a root
    angles = {
        0: (0.0, 1.0),
        1: (small, 1.0),
        -1: (-small, 1.0),
        least: (-1.0, 0.0),
        largest: (1.0, small),
        least + 1: (-1.0, small),
        1 << W - 2: (QUARTER, QUARTER),
        -(1 << W - 2): (-QUARTER, QUARTER),
    }

    def segments():
        """Ends and middles of many segments, for both signs."""
        places = (-1, 0, 1, step // 2 - 1, step // 2)
        angles = [k * step + e for k in range(-rows, rows + 1, 3) for e in places if k * step + e in signed(W)]
        return random.sample(angles, len(angles))

    def from_segment_to_segment():
        """Last word of the first segment, first word of the next one, and the last segment."""
        return [v for phi in (step - 1, step, largest - step // 2) for v in (5, phi, least // 3, phi, 5)]

    # 1 stands for cos(pi/2^W) = 1 - (pi/2^W)^2/2.
    more = math.ldexp(math.pi**2, F - 2 * W - 1)
    bound, clocks = error_bound(F, TILE), trig_clocks(F, TILE)
    return bench(W, F, model, bound, clocks, angles, more, segments, from_segment_to_segment)


def trig(w: int, **tile: int) -> dict[str, int]:
    """Return the parameters; F depends on W as in the datapath."""
    return {"W": w, "F": min(inner_frac(w), FRACS[-1])} | tile


test_ik_sincos = runs("ik_sincos", sincos_bench, {"W": 32}, more=[{"W": 16}, {"W": 27}])
test_ik_trig = runs(
    "ik_trig",
    trig_bench,
    trig(18),
    trig(32),
    trig(24, TILE=16),
    more=[*map(trig, (16, 19, 24, 27)), trig(18, TILE=16)],
)
