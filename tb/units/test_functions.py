# SPDX-License-Identifier: Apache-2.0
"""Test ``ik_sincos``, ``ik_trig`` and ``ik_rsqrt`` against their models, and the models against the true values."""

import random
from functools import partial

import numpy as np

from model.dataflow.formats import Latency, inner_frac
from model.dataflow.mul3 import TILE
from model.dataflow.paper_operations import cordic, sincos_bound
from model.dataflow.quadratic import INVERSE_ROOT, SINE, SINE_FRACS, half_sincos, half_sincos_error, rsqrt, rsqrt_places
from tb.units.unit import BIT, Case, Tests, checks, runs, sets_of, shuffled, signed, unsigned


def half_angles(W: int, frac: int, model, bound: float, latency: int, *streams) -> Tests:
    """Return the tests of sin and cos of phi / 2. ``bound`` is the model's largest error in LSBs, 2^-``frac``."""

    def reference(phi):
        """Return the model's words; check that they differ from the true values by at most the bound."""
        half, results = np.pi * np.array(phi) / 2**W, model(np.array(phi))
        for function, result in zip((np.sin, np.cos), results, strict=True):
            error = np.abs(result - np.ldexp(function(half), frac)).max()
            assert error <= bound, f"the model's error is {error:.3f} last places, its bound {bound:.3f}"
        return results

    ports = {"sin_h": signed(frac + 2), "cos_h": signed(frac + 2)}
    return checks({"phi": signed(W)}, ports, reference, *streams, latency=latency, columns=True)


def sincos(W: int) -> Tests:
    return half_angles(W, W - 2, partial(cordic, width=W), sincos_bound(W), Latency(W)["sincos"])


def trig(W: int, F: int, TILE: int = TILE) -> Tests:
    rows = SINE.form(F, TILE).rows
    step = (1 << W - 1) // rows  # angle of a segment

    def segments():
        """Return angles at and next to the ends and middles of many segments, for both signs, in random order."""
        near = (-1, 0, 1, step // 2 - 1, step // 2)
        return shuffled(k * step + e for k in range(-rows, rows + 1, 3) for e in near if k * step + e in signed(W))

    model = partial(half_sincos, width=W, frac=F, tile=TILE)
    return half_angles(W, F, model, half_sincos_error(F, TILE), SINE.clocks(F, TILE), segments)


def reciprocal(F: int, TILE: int = TILE) -> Tests:
    MW = F + 3
    words, one = unsigned(MW), 1 << MW
    mantissas = words[one // 4 :]

    def reference(m, twice):
        """Return the model's words, doubled modulo the word length if ``twice``. Check that roots of mantissas m differ
        from 2^(F-1) / sqrt(V / 2^MW), for V from m to m + 1, by at most :func:`rsqrt_places` LSBs."""
        y = rsqrt(np.array(m), F, TILE).tolist()
        square = 100 << 2 * F + MW - 2
        off = round(10 * rsqrt_places(F, TILE))
        for v, root in zip(m, y, strict=True):
            near = (10 * root - off) ** 2 * (v + 1) <= square < (10 * root + off) ** 2 * v
            assert near or v not in mantissas, f"the model is not faithful: {v} -> {root}"
        return ([(root << double) % (2 << F) for root, double in zip(y, twice, strict=True)],)

    def segments():
        """Return words at and next to the ends and middles (u changes sign) of many segments, in random order."""
        segment = one >> 11
        near = (0, 1, segment // 4, segment // 2 - 1, segment // 2, segment // 2 + 1, segment - 2, segment - 1)
        return shuffled((start + place, 0) for start in range(0, one, 7 * segment) for place in near)

    def random_mantissas():
        return [(random.choice(mantissas), random.choice(BIT)) for _ in range(2000)]

    return checks(
        {"m_next": words, "twice": BIT},
        {"y": unsigned(F + 1)},
        reference,
        segments,
        random_mantissas,
        latency=INVERSE_ROOT.clocks(F, TILE),  # counted after the mantissa register, where `twice` enters
        columns=True,
        delays={"DM": 1},
        corners=[((one // 4, 0), 1 << F), ((one - 1, 0), 1 << F - 1), ((one - 1, 1), 1 << F), ((0, 0), 1 << F)],
        good=(one // 3, 0),
    )


def of_datapath(*widths: int, **tile: int) -> list[dict[str, int]]:
    """Return the parameters W and F of ``ik_trig``, as in the datapath of each width."""
    return sets_of("W F", *((w, min(inner_frac(w), SINE_FRACS[-1])) for w in widths), **tile)


CASES = (
    Case("ik_sincos", sincos, [{"W": 32}], [{"W": 16}, {"W": 27}]),
    Case("ik_trig", trig, of_datapath(18, 32), of_datapath(16, 19, 24, 27) + of_datapath(18, 24, TILE=16)),
    Case(
        "ik_rsqrt",
        reciprocal,
        [{"F": 31}],
        [*sets_of("F", (29,), (22,), TILE=16), *sets_of("F", (19,), (20,), (21,), (22,), (24,), (27,))],
    ),
)
test_functions, vectors = runs(CASES)
