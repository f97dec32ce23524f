# SPDX-License-Identifier: Apache-2.0
"""Proved accuracy of the whole arm: limits of the error of the hand's point and orientation at the seven joint angles.

docs/generated/accuracy.md is the proof.  This module computes its constants from the errors that the operations of the
dataflow state, from the CORDIC's errors (:func:`head`), and from the lean datapath's constants.

    python -m model.bounds.arm_accuracy DATAPATH WIDTH      print the constants of a core
"""

import itertools
import sys
from fractions import Fraction
from functools import cache
from typing import NamedTuple

from ..dataflow.angles import GUARD, Interval, arc, head, iv, upper
from ..dataflow.arm import PRODUCTS
from ..dataflow.fixed import dataflow
from ..dataflow.nodes import Dataflow
from .accuracy import ZERO, accuracy, interval, largest, norm, sizes, stated, ulps, units

STATED = {
    "orientation": stated(
        "18.65 17.1 19 17.53 21.94 21.51 23.41 21.6 23.15 22.95 23.9 23.18 24.68 24.57 28.26 28.65 35.53"
    ),
    "point": stated(
        "19.55 18.05 19.95 18.48 22.89 22.46 24.36 22.55 24.1 23.91 24.86 24.17 25.7 25.74 29.74 31.07 46.29"
    ),
}
"""Error -> word length -> its proved limit for the datapath ``arm``, in units of 2^-(W-2): of the hand's orientation
(rad), and of its point for d1 + d2 + |tool| = 1."""


def ball(width: int, least: Interval) -> dict[str, Interval]:
    """Return the limit of the angle (rad) between a quaternion of words, at least ``least`` long, and the rotation by
    the words of its three angles; and the parts of the limit, in the cell of the largest sum."""
    word, half, root = interval(4) / 2**width, iv.pi / 2**width, iv.sqrt(interval(2))
    lsb = word / 2**GUARD
    worst = {"ball": ZERO}
    shares = [1 / root, *(interval(2) ** -k for k in range(1, width))]
    # Ranges of the shorter of (w, k) and (i, j), relative to the quaternion
    for high, low in itertools.pairwise(shares):
        longer, shorter = least * iv.sqrt(1 - high**2), interval((least * low).a)
        one, other = head(width, upper(root * word, shorter)), head(width, interval(longer.a))
        left = head(width, upper(word, shorter)).left  # a vector of one word is on an axis: its angle is exact
        slip = other.along * lsb / least
        along = other.along * iv.sqrt(1 - low**2)
        moved = norm(along, one.across, other.across) * lsb / (least * (1 - root * slip))
        cosine, between = iv.cos(upper(left, other.left)), (high + slip) / (longer / least - slip)
        unequal = (1 / iv.sqrt(cosine) - iv.sqrt(cosine)) / 2
        if (between**2 * cosine).b < 1:
            unequal = (1 / cosine - 1) * between / (1 + cosine * between**2)
        last = head(width, interval((other.gain * least * (1 - root * slip) * cosine).a))
        b = unequal + last.lost + last.rest + half / 2
        share = (high + slip) / (1 - root * slip)
        more = upper(ZERO, one.rest**2 - other.rest**2)
        sd = iv.sqrt(other.rest**2 + share * (share + b) * more) + half
        chord = norm(b, sd)
        size = 2 * (moved + 2 * arc(chord / 2))
        parts = {"ball": size, "ball rounding": 2 * moved, "ball b": 2 * b, "ball s, d": 2 * sd}
        worst = max(worst, parts, key=lambda parts: parts["ball"].b)
    return worst


def frame(flow: Dataflow, elbow: Interval) -> tuple[Interval, Interval]:
    """Return the lengths of Qw's error, of its products and of its rounding, for the largest length of Qe."""
    n, turned, moved = flow.nodes, [], []
    for c, row in PRODUCTS.items():
        errors = [(ulps(n[f"g_{a}{b}"]), sign == "-") for a, b, sign in map(tuple, row.split())]
        turned.append(largest([sum(-error if minus else error for error, minus in errors)]))
        one, two = (ulps(product) for product in n[f"qw_{c}"].operands)
        moved.append(largest([one + two, one - two]))
    return norm(*turned) * elbow + norm(*moved), sizes(flow, *(f"qw_{c}" for c in PRODUCTS))


class ArmAccuracy(NamedTuple):
    """Constants of the theorem in units of 2^-(W-2): limits of the errors of the ``orientation`` (rad) and of the
    ``point`` for d1 + d2 + |tool| = 1, of which ``wrist`` does not scale with it; their parts by name."""

    orientation: Fraction
    point: Fraction
    wrist: Fraction
    parts: dict[str, Fraction]


@cache
def arm_accuracy(width: int, datapath: str = "arm") -> ArmAccuracy:
    """Return the constants of the theorem for a whole arm at a word length."""
    flow, core = dataflow(datapath, width), accuracy(width, datapath.replace("arm", "lean"))
    unit, half = interval(4) / 2**width, iv.pi / 2**width
    k, turn, moved, factors, rests, skew = (
        interval(core.parts[name].numerator) / core.parts[name].denominator * unit
        for name in ("K", "w", "rounded", "Qe factors", "Qe rests", "Qe skew")
    )
    factors, rests = factors / 2, rests / 2
    shoulder, elbow = iv.sqrt(1 - k) - moved, 1 - factors - rests  # least lengths of Qs and Qe
    first = ball(width, shoulder)
    bend = head(width, interval(elbow.a))
    products, rounding = frame(flow, 1 + factors + rests)
    whole = shoulder * elbow * (1 - interval(2) ** -8)
    last = ball(width, whole - products - rounding)
    parts = {f"{name}, {q}": size for q, of in (("Qs", first), ("Qw", last)) for name, size in of.items()}
    parts["elbow"] = 2 * (bend.lost + bend.rest) + half
    parts["Qw"] = 2 * arc((products + rounding) / whole)
    parts["a, arm"] = turn + 2 * arc(moved / iv.sqrt(1 - k))
    parts["b, arm"] = 2 * (skew + arc(rests / (1 - factors)))
    nodes = flow.nodes
    rows = ("ik", "wj"), ("jk", "wi"), ("ii", "jj")
    parts["tool"] = 2 * norm(*(sum(largest([ulps(nodes[f"h_{product}"])]) for product in row) for row in rows))
    offsets = (2 * largest([ulps(nodes[f"off_{axis}"])]) + largest([ulps(nodes[axis])]) for axis in "xyz")
    wrist, both = norm(*offsets), parts["ball, Qs"] + parts["elbow"]
    end = parts["ball, Qw"] + parts["Qw"]
    point = wrist + both + upper(parts["a, arm"] + parts["b, arm"], end + parts["tool"])
    orientation, point, wrist = (units(limit, width) for limit in (both + end, point, wrist))
    return ArmAccuracy(orientation, point, wrist, {name: units(part, width) for name, part in parts.items()})


def main(datapath: str, width: str) -> None:
    """Print the constants of a whole arm at a word length."""
    result = arm_accuracy(int(width), datapath)
    for name, part in (*result.parts.items(), *zip(result._fields[:3], result[:3], strict=True)):
        print(f"{name:<20}{float(part):8.3f}")


if __name__ == "__main__":
    main(*sys.argv[1:])
