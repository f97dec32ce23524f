# SPDX-License-Identifier: Apache-2.0
"""Test ``ik_sum2``, ``ik_sum3``, ``ik_wide``, ``ik_half`` and ``ik_pick`` against Python integers."""

import itertools

from model.dataflow.formats import GUARD, Latency
from tb.units.unit import BIT, Case, Tests, checks, halves, rounded, runs, sets_of, signed, some, unsigned, wrapped


def sums(IW: int, SH: int, OW: int, SUB_B: int = 0, SUB_C: int | None = None, SAT: int = 1, **delays: int) -> Tests:
    """Check the exact sum, rounded half up; it is saturated if SAT is 1. SUB_B or SUB_C subtracts the last operand."""
    IN, Q = signed(IW), signed(OW)
    operands, sub = 2 if SUB_C is None else 3, SUB_B or SUB_C

    def total(*vector):
        *first, last = vector
        return sum(first) + (-last if sub else last)

    def reference(*vector):
        q = rounded(total(*vector), SH)
        return min(max(q, Q[0]), Q[-1]), int(q not in Q)

    def fits(*vector):
        """Accept all vectors; with SAT = 0 only sums in q's range, as the datapath's formats guarantee."""
        return SAT or reference(*vector)[1] == 0

    def operands_of(wanted):
        """Return operands whose result is ``wanted``. If there are none, an operand is out of range."""
        rest, chosen = wanted, []
        for k in range(operands - 1, -1, -1):
            # as large as this operand may be, but not larger than needed
            chosen.append(min(max(rest // (k + 1), IN[0]), IN[-1]))
            rest -= chosen[-1]
        chosen[-1] = (chosen[-1] + rest) * (-1 if sub else 1)
        return tuple(chosen)

    # top: the least sum that overflows upwards; low: the least sum that does not overflow
    half = 1 << SH - 1 if SH else 0
    top, low = (Q[-1] << SH) + (half or 1), (Q[0] << SH) - half
    cases = [(0, 0, 0), (top - 1, Q[-1], 0), (low, Q[0], 0)]
    cases += [(top, Q[-1], 1), (low - 1, Q[0], 1)] if SAT else []
    cases += [(half, 1, 0), (-half, 0, 0), (half - 1, 0, 0), (-half - 1, -1, 0), (-3 * half, -1, 0)] if SH else []
    return checks(
        {port: IN for port in "abc"[:operands]},
        {"q": Q, "ovf": BIT},
        reference,
        latency=Latency(32)[f"sum{operands}"],
        delays=delays,
        corners=[(operands_of(wanted), (q, ovf)) for wanted, q, ovf in cases],
        good=(1 << SH,) + (0,) * (operands - 1),
        fits=fits,
    )


def wide(W: int, SUB: int, **delays: int) -> Tests:
    """Check the sum or difference modulo 2^W."""
    words = signed(W)

    def extreme_halves():
        """Return all pairs of words with extreme halves, for every carry across the middle."""
        return itertools.product(halves(W), halves(W))

    def small_results():
        """Return pairs with a result near 0 or +-2^(W/2), because comparisons use the sign of q."""
        near = [s * (1 << W // 2) * k + e for s in (-1, 1) for k in (0, 1) for e in (-1, 0, 1)]
        drawn = [a for (a,) in some(100, words)]
        return [(a, wrapped((a if SUB else -a) + little, words)) for a in drawn for little in near]

    def reference(a, b):
        return wrapped(a - b if SUB else a + b, words)

    inputs = {"a": words, "b": words}
    timing = {"latency": Latency(32)["wide"], "delays": delays}
    return checks(inputs, {"q": words}, reference, extreme_halves, small_results, **timing)


def half(W: int, MINUS: int) -> Tests:
    """Check (1 +- c) / 2, clamped to [0, 1]. Since q has one fraction bit more than c, its word is 1 +- c's."""
    one = 1 << W - 2

    def around_one():
        return [s * one + e for s in (-1, 1) for e in range(-20, 21)]

    def reference(c):
        return min(max(one - c if MINUS else one + c, 0), 2 * one)

    return checks({"c": signed(W)}, {"q": unsigned(W)}, reference, around_one, latency=Latency(32)["mux"])


def pick(W: int) -> Tests:
    """Check that q is a, b or -b, modulo 2^W."""
    words = signed(W)

    def reference(a, b, use_b, minus):
        return wrapped(-b if minus else b, words) if use_b else a

    inputs = {"a": words, "b": words, "use_b": BIT, "minus": BIT}
    return checks(inputs, {"q": words}, reference, latency=Latency(32)["mux"])


def few(last: str) -> list[dict[str, int]]:
    return sets_of(f"IW SH OW SUB_{last}", (4, 1, 3, 1), (32 + GUARD, GUARD, 32, 0))


def more(last: str) -> list[dict[str, int]]:
    names = f"IW SH OW SUB_{last}"
    return [
        # q holds any sum; nothing to round
        *sets_of(names, (4, 1, 3, 0), (4, 2, 2, 1), (4, 0, 8, 1), (32 + GUARD, 0, 32 + GUARD, 1)),
        *sets_of(names, (4, 1, 3, 0), (32 + GUARD, GUARD, 32, 1), SAT=0),
    ]


delayed = sets_of("IW SH OW SUB_B", (4, 1, 3, 1), DA=2, DB=1) + sets_of("IW SH OW SUB_B", (4, 1, 3, 1), DB=3)
CASES = (
    Case("ik_sum2", sums, few("B") + delayed, more("B")),
    Case("ik_sum3", sums, few("C"), more("C")),
    Case(
        "ik_wide",
        wide,
        sets_of("W SUB", (6, 1), (66, 0), (66, 1)) + sets_of("W SUB", (6, 1), DA=1, DB=3),
        sets_of("W SUB", (4, 0), (4, 1), (6, 0), (34, 1), (38, 0)),
    ),
    Case("ik_half", half, sets_of("W MINUS", (8, 0), (32, 1)), sets_of("W MINUS", (8, 1), (32, 0))),
    Case("ik_pick", pick, [{"W": 32}], [{"W": 4}]),
)
test_sums, vectors = runs(CASES)
