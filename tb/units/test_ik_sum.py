# SPDX-License-Identifier: Apache-2.0
"""``ik_sum2`` and ``ik_sum3`` against APyTypes: exact sum, rounded half up, saturated if SAT is 1."""

from model.dataflow.nodes import GUARD, Latency
from tb.units.unit import BIT, Tests, checks, fixed_point, rounded, runs, sets_of, signed


def bench(IW: int, SH: int, OW: int, SUB_B: int = 0, SUB_C: int | None = None, SAT: int = 1, **delays: int) -> Tests:
    IN, Q = signed(IW), signed(OW)
    ports = "ab" if SUB_C is None else "abc"
    operands, sub = len(ports), SUB_B or SUB_C

    def reference(*columns):
        *first, last = (fixed_point(words, IW, SH) for words in columns)
        total = first[0] if operands == 2 else first[0] + first[1]
        return rounded(total - last if sub else total + last, OW)

    # First sum that overflows, lowest that does not; half an LSB.
    half = 1 << SH - 1 if SH else 0
    top, low = (Q[-1] << SH) + (half or 1), (Q[0] << SH) - half

    def fits(*vector):
        """Accept all vectors; with SAT = 0 only sums in q's range, as the datapath's formats guarantee."""
        *first, last = vector
        return SAT or low <= sum(first) + (-last if sub else last) < top

    def terms(total):
        """Return operands with this sum, the last negated if it is subtracted; out of range if there are none."""
        rest, chosen = total, []
        for k in range(operands - 1, -1, -1):
            # as large as this operand may be, but not larger than needed
            chosen.append(min(max(rest // (k + 1), IN[0]), IN[-1]))
            rest -= chosen[-1]
        chosen[-1] = (chosen[-1] + rest) * (-1 if sub else 1)
        return tuple(chosen)

    # sum before rounding, q and ovf
    sums = {
        "zero": (0, 0, 0),
        "largest": (top - 1, Q[-1], 0),
        "rounds_to_overflow": (top, Q[-1], 1),
        "least": (low, Q[0], 0),
        "below_least": (low - 1, Q[0], 1),
        "overflow": (operands * IN[-1] - 2, Q[-1], 1),
        "negative_overflow": (operands * IN[0] + 2, Q[0], 1),
    }
    ties = {
        "tie": (half, 1, 0),
        "negative_tie": (-half, 0, 0),
        "below_tie": (half - 1, 0, 0),
        "below_negative_tie": (-half - 1, -1, 0),
        "odd_tie": (3 * half, 2, 0),
        "odd_negative_tie": (-3 * half, -1, 0),
    }
    cases = {
        name: (terms(total), (q, ovf))
        for name, (total, q, ovf) in (sums | (ties if SH else {})).items()
        # only cases possible with these widths; where terms() found none, an operand is no word of its port
        if ovf == (not low <= total < top) and ovf <= SAT
    }

    def single(value):
        return (value,) + (0,) * (operands - 1)

    # q and ovf leave together; ovf can change only if q does not hold every sum.
    overflows = "overflow" in cases
    latencies = [(single(0), single(min(IN[-1], Q[-1] << SH)))]
    return checks(
        {port: IN for port in ports},
        {"q": Q, "ovf": BIT},
        reference,
        latency=Latency(32)[f"sum{operands}"],
        latencies=latencies + [(single(0), cases["overflow"][0])] if overflows else latencies,
        delays=delays,
        still=() if overflows else ("ovf",),
        corners=cases,
        good=single(1 << SH),
        fits=fits,
    )


def sets(last: str, *rows: tuple[int, ...], **others: int) -> list[dict[str, int]]:
    """Return parameter sets from rows of IW, SH, OW and whether the last operand is subtracted."""
    return [sets_of(f"IW SH OW SUB_{last}")(*row, **others) for row in rows]


def few(last: str) -> list[dict[str, int]]:
    return sets(last, (4, 1, 3, 1), (32 + GUARD, GUARD, 32, 0))


def more(last: str) -> list[dict[str, int]]:
    rows = [
        (4, 1, 3, 0),
        (4, 2, 2, 1),
        (4, 0, 8, 1),  # q holds any sum
        (32 + GUARD, 0, 32 + GUARD, 1),  # nothing to round
        (18 + GUARD, GUARD + 1, 18, 1),
    ]
    return sets(last, *rows) + sets(last, (4, 1, 3, 0), (32 + GUARD, GUARD, 32, 1), SAT=0)


delayed = sets("B", (4, 1, 3, 1), DA=2, DB=1) + sets("B", (4, 1, 3, 1), DB=3)
test_ik_sum2 = runs("ik_sum2", bench, *few("B"), *delayed, more=more("B"))
test_ik_sum3 = runs("ik_sum3", bench, *few("C"), more=more("C"))
