# SPDX-License-Identifier: Apache-2.0
"""Test shifts, counts of leading zeros, doubled angles, steps and limits of joints against their definitions. Test
``ik_sincos``, ``ik_trig``, ``ik_rsqrt`` and ``ik_vector`` against their models, and the first three models
against the true values."""

import itertools
import random
from functools import partial

import numpy as np

from model.dataflow import angles
from model.dataflow.expressions import round_shift
from model.dataflow.formats import Latency, inner_frac
from model.dataflow.lean_operations import even
from model.dataflow.mul3 import TILE
from model.dataflow.paper_operations import cordic, sincos_bound
from model.dataflow.quadratic import INVERSE_ROOT, SINE, SINE_FRACS, half_sincos, half_sincos_error, rsqrt, rsqrt_places
from tb.units.unit import BIT, Case, Tests, checks, corners, pairs, runs, sets_of, shuffled, signed, unsigned, wrapped

COUNTS = unsigned(6)


def every_count(words: range) -> list[tuple[int, int]]:
    return [(d, count) for d in corners(words) for count in COUNTS]


def shift(W: int, RIGHT: int, PRODUCT: int = 0, **delays: int) -> Tests:
    """Check d 2^count modulo 2^W or, if RIGHT, the floor of d / 2^count, also for counts larger than W."""
    words = signed(W)

    def reference(d, count):
        return d // 2**count if RIGHT else wrapped(d * 2**count, words)

    inputs, timing = {"d": words, "count": COUNTS}, {"latency": Latency(32)["shift"], "delays": delays}
    return checks(inputs, {"q": words}, reference, partial(every_count, words), **timing)


def shift3(IW: int, DROP: int, OW: int, **delays: int) -> Tests:
    """Check the low OW bits of the floor of d 2^count / 2^DROP, for any count."""
    words, Q, top = signed(IW), signed(OW), DROP + OW  # top: the bit above the result's MSB

    def single_bits():
        """Return (d, count): d is a bit that count shifts to or near an end of the result, or bit - 1, -bit, ~bit."""
        places = (0, DROP - 1, DROP, DROP + 1, top - 2, top - 1, top)
        bits = [(1 << place - count, count) for place in places for count in COUNTS if place >= count]
        return [(d, count) for bit, count in bits for d in (bit, bit - 1, -bit, -bit - 1) if d in words]

    def normalized_words():
        """Return short words of either sign, with counts that shift the highest bit to the place below q's sign bit or
        to a neighbouring place."""
        short = [random.getrandbits(random.randint(1, IW - 1)) for _ in range(500)]
        near = [(d, top - 1 - d.bit_length() + random.choice((-1, 0, 0, 1))) for d in short]
        return [(random.choice((d, ~d)), min(max(count, 0), COUNTS[-1])) for d, count in near]

    def reference(d, count):
        return wrapped(d * 2**count // 2**DROP, Q)

    inputs = {"d": words, "count": COUNTS}
    timing = {"latency": Latency(32)["shift3"], "delays": delays}
    return checks(inputs, {"q": Q}, reference, partial(every_count, words), single_bits, normalized_words, **timing)


def of_triangle(width: int) -> tuple[int, int, int]:
    """Return the parameters of ``ik_shift3`` in ``ik_lean_triangle``."""
    frac = inner_frac(width)
    return 2 * width + 2, 2 * width + width % 2 - frac, frac + 2


def evenly(VW: int, MW: int) -> Tests:
    """Check k, the largest integer for which v 4^k still fits VW bits, and m, the floor of v 4^k / 2^(VW-MW)."""
    V = unsigned(VW)

    def normalized(v):
        k = max(k for k in range(VW // 2) if v << 2 * k in V)
        return k, v << 2 * k + MW >> VW

    def reference(v):
        k, m = map(list, zip(*map(normalized, v), strict=True))
        of_model = even(np.array(v, dtype=object), VW, MW)
        assert [k, m] == [column.tolist() for column in of_model], "the model is not the definition"
        return k, m

    def powers_of_two():
        """Return each power of two and its neighbours, so that every count occurs."""
        return shuffled({(1 << n) + e for n in range(VW) for e in (-1, 0, 1)})

    quarter = 1 << MW - 2
    return checks(
        {"v": V},
        {"k": unsigned(6), "m": unsigned(MW)},
        reference,
        powers_of_two,
        columns=True,
        latency=Latency(32)["even"],
        corners=[(0, (VW // 2 - 1, 0)), (1, (VW // 2 - 1, quarter)), (4, (VW // 2 - 2, quarter))],
        good=V[-1] // 9,
    )


def zeros(W: int, N: int, norm: bool = False) -> Tests:
    """Check the largest left shift for which all words still fit and, with `norm`, the shifted words. If all words are
    0, `norm` expects one half in word 0."""
    words = signed(W)

    def pack(vector):
        return sum(word % (1 << W) << W * k for k, word in enumerate(vector))

    def reference(d):
        vector = [wrapped(d >> W * k, words) for k in range(N)]
        count = max(s for s in range(W) if all(w << s in words for w in vector)) if any(vector) else 0
        return (pack([w << count for w in vector]) or 1 << W - 2, count) if norm else count

    def extreme_words():
        return [pack(vector) for vector in itertools.product(corners(words), repeat=N)]

    def powers_of_two():
        """Return vectors with a single nonzero word: a power of two or a neighbour, of either sign."""
        near = sorted({s * (1 << k) + e for k in range(W) for s in (1, -1) for e in (-1, 0, 1)})
        return [pack([0] * k + [v]) for k in range(N) for v in near if v in words]

    def common_magnitude():
        """Return vectors of words with a common random magnitude, so that every count occurs."""
        small = [signed(random.randint(1, W)) for _ in range(1000)]
        return [pack([random.randrange(s.start, s.stop) for _ in range(N)]) for s in small]

    return checks(
        {"d": unsigned(N * W)},
        {"q": unsigned(N * W), "count": unsigned(6)} if norm else {"count": unsigned(6)},
        reference,
        extreme_words,
        powers_of_two,
        common_magnitude,
        latency=Latency(32)["norm" if norm else "lzc"],
    )


def norm(W: int, N: int) -> Tests:
    return zeros(W, N, norm=True)


def half_angles(W: int, frac: int, model, bound: float, latency: int, *streams) -> Tests:
    """Return the tests of sin and cos of phi / 2. ``bound`` is the model's largest error in LSBs of 2^-``frac``."""

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
        """Return the model's words, doubled modulo 2^(F+1) if ``twice``. Check that the word for a mantissa m differs
        from 2^(F-1) / sqrt(V / 2^MW), for V from m to m + 1, by at most :func:`rsqrt_places` LSBs."""
        y = rsqrt(np.array(m), F, TILE).tolist()
        square = 100 << 2 * F + MW - 2
        off = round(10 * rsqrt_places(F, TILE))
        for v, root in zip(m, y, strict=True):
            near = (10 * root - off) ** 2 * (v + 1) <= square < (10 * root + off) ** 2 * v
            assert near or v not in mantissas, f"the model is not faithful: {v} -> {root}"
        return ([(root << double) % (2 << F) for root, double in zip(y, twice, strict=True)],)

    def segments():
        """Return words at and next to the ends and middles of many segments, in random order; u is 0 at a middle."""
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
    """Return, for each width, ``ik_trig``'s parameters W and F for the lean datapath; all sets include ``tile``."""
    return sets_of("W F", *((w, min(inner_frac(w), SINE_FRACS[-1])) for w in widths), **tile)


def vector(W: int) -> Tests:
    """Check length and angle in separate tests, because their latencies differ."""
    inputs = {"x": signed(W + 4), "y": signed(W + 4)}

    def of_words():
        return [(x << angles.GUARD, y << angles.GUARD) for x, y in pairs(W)]

    def of_lengths():
        return [(abs(x) >> 1, abs(y) >> 1) for x, y in pairs(W + 4, 500)]

    def bench(port: str, outputs: range, which: int, latency: str, named: list) -> Tests:
        def model(x, y):
            return (angles.iterate(np.array(x), np.array(y), W)[which],)

        options = {"latency": Latency(W)[latency], "columns": True, "corners": named, "good": (9, 4)}
        tests = checks(inputs, {port: outputs}, model, of_words, of_lengths, **options)
        return {f"{name}_{port}": test for name, test in tests.items()}

    exact = [((x, 0), 0) for x in (0, 8, 1 << W)] + [((x, 0), -(1 << W + 3)) for x in (-8, -(1 << W))]
    lengths = bench("length", unsigned(W + 3), 0, "vector_x", [])
    return lengths | bench("angle", signed(W + 4), 1, "vector", exact)


def double(IW: int, OW: int) -> Tests:
    """Check that q is 2 a, or -2 a, rounded half up, modulo one turn."""
    q = unsigned(OW)
    return checks(
        {"a": unsigned(IW), "negate": BIT},
        {"q": q},
        lambda a, negate: wrapped(round_shift(-2 * a if negate else 2 * a, IW - OW), q),
        latency=1,
    )


def over(W: int, th: int, low: int, high: int) -> int:
    return int((th - low) % (1 << W) > (high - low) % (1 << W))


def limit(W: int) -> Tests:
    angle = unsigned(W)
    return checks({"th": angle, "low": angle, "high": angle}, {"over": BIT}, partial(over, W), latency=1)


def fold_limit(W: int) -> Tests:
    def of_joint(joint: int, th: int, limits: int) -> int:
        return over(W, th, *(limits >> W * n & (1 << W) - 1 for n in (2 * joint - 2, 2 * joint - 1)))

    def near():
        drawn = [(random.randint(1, 7), random.randint(-1, 1), random.getrandbits(14 * W)) for _ in range(2000)]
        return [(n, ((arcs >> W * (2 * n - 1 - arcs % 2)) + by) % (1 << W), arcs) for n, by, arcs in drawn]

    inputs = {"joint": unsigned(3), "th": unsigned(W), "limits": unsigned(14 * W)}
    return checks(inputs, {"over": BIT}, of_joint, near, latency=1, fits=lambda joint, *_: joint)


def step(W: int, STEP: int, NEGATED: int) -> Tests:
    """Check both steps. The next vector's limits decide if a joint is limited, as the RTL assumes static limits."""
    turn, angle, most = 1 << W, unsigned(W), (2 << STEP) - 1

    def size(at: int, ref_at: int, span: int, whole: bool) -> int:
        gap = at - ref_at
        if whole:
            gap = (gap + turn // 2) % turn - turn // 2
        return most if at > span else (~gap if gap < 0 else gap) >> W - STEP

    def reference(*columns):
        rows = list(zip(*columns, strict=True))
        for (th, ref, low, high), (*_, next_low, next_high) in zip(rows, [*rows[1:], rows[-1]], strict=True):
            whole, span = (next_high - next_low) % turn == turn - 1, (high - low) % turn
            other = -th if NEGATED else th + turn // 2
            yield [size((one - low) % turn, (ref - low) % turn, span, whole) for one in (th, other)]

    inputs = dict.fromkeys(("th", "ref_th", "low", "high"), angle)
    steps = dict.fromkeys(("step_0", "step_1"), unsigned(STEP + 1))
    return checks(inputs, steps, lambda *columns: zip(*reference(*columns), strict=True), latency=3, columns=True)


CASES = (
    Case(
        "ik_shift",
        shift,
        sets_of("W RIGHT", (19, 0), (32, 1)) + sets_of("W RIGHT", (33, 0), PRODUCT=1),
        [
            *sets_of("W RIGHT", (8, 0), (8, 1), (33, 0)),
            *sets_of("W RIGHT", (19, 0), PRODUCT=1, DC=2),
            *sets_of("W RIGHT", (8, 1), DD=3, DC=1),
        ],
    ),
    Case(
        "ik_shift3",
        shift3,
        sets_of("IW DROP OW", (7, 3, 4), of_triangle(32), of_triangle(17)),  # at 17 one bit longer than the word
        [
            # the word has bits above the result; in the second set it has fewer bits than the result
            *sets_of("IW DROP OW", (7, 2, 3), (5, 3, 6), (34, 24, 21), *map(of_triangle, (27, 18, 16))),
            *sets_of("IW DROP OW", (7, 3, 4), DD=2),
        ],
    ),
    Case(
        "ik_even",
        evenly,
        sets_of("VW MW", (32, 34), (64, 34)),
        sets_of("VW MW", (16, 22), (16, 5), (18, 24), (36, 24), (48, 30), (54, 33), (62, 50)),
    ),
    Case("ik_lzc", zeros, sets_of("W N", (5, 2), (32, 3)), sets_of("W N", (4, 3), (10, 1), (33, 1), (64, 2))),
    Case("ik_norm", norm, sets_of("W N", (5, 2), (32, 3)), sets_of("W N", (4, 3), (18, 3), (32, 2))),
    Case("ik_sincos", sincos, [{"W": 32}], [{"W": 16}, {"W": 27}]),
    Case("ik_trig", trig, of_datapath(18, 32), of_datapath(16, 19, 24, 27) + of_datapath(18, 24, TILE=16)),
    Case(
        "ik_rsqrt",
        reciprocal,
        [{"F": 31}],
        [*sets_of("F", (29,), (22,), TILE=16), *sets_of("F", (19,), (20,), (21,), (22,), (24,), (27,))],
    ),
    Case("ik_vector", vector, sets_of("W", (6,)), sets_of("W", (5,), (17,), (24,), (32,))),
    Case("ik_double", double, sets_of("IW OW", (8, 4), (36, 32))),
    Case("ik_limit", limit, sets_of("W", (4,), (32,))),
    Case(
        "ik_step",
        step,
        sets_of("W STEP NEGATED", (3, 3, 0), (3, 3, 1), (24, 12, 1)),
        sets_of("W STEP NEGATED", (32, 12, 0)),
    ),
    Case("ik_fold_limit", fold_limit, sets_of("W", (4,), (32,))),
)
test_functions, vectors = runs(CASES)
