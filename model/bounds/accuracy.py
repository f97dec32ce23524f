# SPDX-License-Identifier: Apache-2.0
"""Proved accuracy of the lean datapath: |wrist - p| <= (a |p| + b d2) 2^-(W-2) for every target in reach.

docs/generated/accuracy.md is the proof.  This module computes its constants a and b from the errors that the operations
of the dataflow state, and from the rows of the root's table.  Numbers are intervals, rounded outwards by mpmath.

    python -m model.bounds.accuracy [DATAPATH WIDTH]      print the limits, or the constants of a core
"""

import itertools
import sys
from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from functools import cache, reduce
from operator import mul
from typing import NamedTuple

import mpmath
from mpmath.libmp import to_rational

from ..dataflow.angles import Interval, iv
from ..dataflow.expressions import EXACT
from ..dataflow.fixed import dataflow
from ..dataflow.formats import WIDTHS
from ..dataflow.lean_operations import Choice, Even, ShiftDown, ShiftUp
from ..dataflow.mul3 import Mul3
from ..dataflow.nodes import Dataflow, Node
from ..dataflow.quadratic import (
    INVERSE_ROOT,
    PRECISION,
    SINE_FRACS,
    Form,
    HalfAngle,
    Rsqrt,
    half_sincos_error,
    rounding,
    row_error,
)


def stated(ulps: str) -> dict[int, Fraction]:
    """Return word length -> limit."""
    return {width: Fraction(text) for width, text in zip(WIDTHS, ulps.split(), strict=False)}


STATED = {
    "lean": stated(
        "3.884 4.354 4.549 4.327 4.33 4.337 4.35 4.377 4.43 4.5 4.549 4.949 5.762 8.109 12.803 22.19 40.966"
    ),
    "lean25": stated(
        "3.884 4.353 4.547 4.324 4.325 4.326 4.328 4.332 4.341 4.359 4.395 4.644 5.17 6.925 10.436 17.457 31.498"
    ),
    "lean16": stated("3.876 4.336 4.513 4.371 4.418 4.474 4.498 4.77 5.225"),
}
"""Datapath -> word length -> proved limit of hand error / reach, in units of 2^-(W-2)."""

CELLS = 8
"""Number of parts of a mantissa's range [1/4, 1), each with its largest errors."""

SIDES = 32
"""Number of parts of the range of g, the tangent of half an angle."""


def interval(low, high=None) -> Interval:
    """Return the interval between exact numbers, or of one."""
    return iv.mpf(low if high is None else [low, high])


ZERO, ONE = interval(0), interval(1)


def hull(intervals: Iterable[Interval]) -> Interval:
    """Return the smallest interval that contains all ``intervals``."""
    parts = list(intervals)
    return iv.mpf([min(part.a for part in parts), max(part.b for part in parts)])


def largest(intervals: Iterable[Interval]) -> Interval:
    """Return the largest magnitude in ``intervals``."""
    return abs(hull(intervals)).b


def norm(*sizes: Interval) -> Interval:
    """Return the length of a vector."""
    return iv.sqrt(sum(abs(size) ** 2 for size in sizes))


# ---- roots, by rows of the table -------------------------------------------------------------------------------------


class Cell(NamedTuple):
    """Mantissas V, real numbers, in a part of [1/4, 1): sqrt V, the error of ``ik_rsqrt``'s word y relative to
    1/(2 sqrt V), and the error of the product 2 y m relative to sqrt V, where m is V's word."""

    root: Interval
    inverse: Interval
    product: Interval


def _row(form: Form, frac: int, row: int, cut: bool) -> Cell:
    """Return the cell that is a row of the table.  ``cut``: the word of a mantissa may be truncated."""
    with mpmath.workprec(PRECISION):
        left, width = INVERSE_ROOT.segment(form, row)
        ends = row_error(INVERSE_ROOT, form, row, rises=False)
    ulp = mpmath.ldexp(1, -frac)
    added = interval(rounding(form, frac)) / (1 << form.sum_frac)
    error = interval(*ends) + added + interval(-ulp, 0)  # y - 1/(2 sqrt m)
    error += interval(-1, 1) * mpmath.ldexp(1, 40 - PRECISION)  # covers the error of the row errors
    root = iv.sqrt(interval(left, left + width))
    lost = interval(0, ulp / 8 if cut else 0)  # V - m
    share = lost / left  # 1 - m/V is at most its end
    fall = share / (4 * root.a)  # 1/(2 sqrt m) - 1/(2 sqrt V)
    truncated = hull([ZERO, -share / 2 - share**2 / 2])  # sqrt(m/V) - 1
    return Cell(root, 2 * root * (error + fall), truncated + 2 * root * error * (1 - share))


@cache
def cells(frac: int, tile: int, cut: bool) -> tuple[Cell, ...]:
    """Return the cells of a mantissa whose root has ``frac`` fraction bits: groups of rows of equal number."""
    form = INVERSE_ROOT.form(frac, tile)
    rows = [_row(form, frac, row, cut) for row in range(form.rows)]
    size = form.rows // CELLS
    groups = [rows[n : n + size] for n in range(0, form.rows, size)]
    return tuple(Cell(*map(hull, zip(*group, strict=True))) for group in groups)


def combinations(flow: Dataflow, node: Node, given: str = "") -> list[dict[str, Cell]]:
    """Return all combinations of cells of the mantissas on which a node depends, except node ``given``'s."""

    def mantissas(node: Node) -> list[Node]:
        if isinstance(node.op, Even):
            return [node]
        return [m for operand in node.operands for m in mantissas(operand)] if node.name != given else []

    roots = {m.name: cells(m.frac - 3, flow.tile, m.op.width > m.format.width) for m in mantissas(node)}  # type: ignore[attr-defined]
    return [dict(zip(roots, parts, strict=True)) for parts in itertools.product(*roots.values())]


# ---- words -----------------------------------------------------------------------------------------------------------


class Word(NamedTuple):
    """Bound of a node's word: the exact value times ``factor``, plus ``rest``.  ``value``: range of the exact value,
    where it is known to be positive."""

    factor: Interval
    rest: Interval = None
    value: Interval = None


def ulps(node: Node) -> Interval:
    """Return the range of the rounding error that the node's operation states."""
    return interval(*node.error) * node.format.ulp


class Words:
    """Bounds of words for mantissas in the cells ``places``, by name.  The word of node ``given`` counts as exact."""

    def __init__(self, places: Mapping[str, Cell], given: str = "") -> None:
        self.places, self.given = places, given

    def __call__(self, node: Node) -> Word:
        op = node.op
        if node.name == self.given:
            return Word(ONE)
        if isinstance(op, Rsqrt):
            cell = self.places[op.m.name]
            return Word(1 + cell.inverse, None, 1 / (2 * cell.root))
        if isinstance(op, Mul3):
            return self._product(node, op)
        if isinstance(op, ShiftDown) and (word := self(op.value)).rest is None:
            return Word(word.factor, ulps(node))
        if isinstance(op, ShiftUp) and op.value.decision:  # of an exact word
            return Word(ONE, ulps(node) if node.error != EXACT else None)
        if isinstance(op, Choice) and node.limited:
            # The limit takes at most an ulp from the exact value, as the raw word's rounding may.
            (raw,) = op.operands
            if raw.error[0] * raw.format.ulp <= -node.format.ulp:
                return self(raw)
        raise TypeError(f"{node.name}: no bound of its word")

    def _product(self, node: Node, op: Mul3) -> Word:
        a, b = op.parts
        if isinstance(b.op, Even):  # 2 m / (2 sqrt m)
            cell = self.places[b.name]
            return Word(1 + cell.product + ulps(node) / cell.root, None, cell.root)
        one, two, scale, rest = self(a), self(b), 2**op.scale, ulps(node)
        for word, other in ((one, two), (two, one)):
            if word.rest is not None:
                if other.rest is not None or other.value is None:
                    raise TypeError(f"{node.name}: no bound of a product with the rest of a word")
                rest += scale * word.rest * other.factor * other.value
        factor = one.factor * two.factor
        if one.value is None or two.value is None:
            return Word(factor, rest)
        value = scale * one.value * two.value
        return Word(factor + rest / value, None, value)


# ---- rotations -------------------------------------------------------------------------------------------------------


class Turn(NamedTuple):
    """Error of a rotation by words of a half angle: the matrix is 1 + ``stretch`` times a rotation whose angle is off
    by at most ``angle`` (rad).  The word of the squared length is from ``least`` to 1 + ``above``."""

    stretch: Interval
    angle: Interval
    above: Interval
    least: Interval = interval(0.5)


STRAIGHT = Turn(ZERO, ZERO, ZERO, ONE)
"""Rotation by 0 or 180 degrees: the bend of a clamped target."""

Pairs = Sequence[tuple[Interval, Interval]]


def turned(shared: Pairs, single: Pairs) -> Turn:
    """Return the error of a rotation.  Its parts are L, 2 L = 1 + |C| (1 + r) + c, and s, 2 s = S (1 + r) (1 + o) + e,
    where C is its exact cosine and S its exact sine.

    ``shared`` lists pairs (r, c), ``single`` pairs (o, e); each pair of one list may occur with each of the other.
    """
    r, c, o, e = (hull(part) for pairs in (shared, single) for part in zip(*pairs, strict=True))
    wrong = largest([r]) + largest([c])  # at most |C| where C's word has the wrong sign
    ends = [*(interval(n) / SIDES for n in range(SIDES + 1)), iv.sqrt((1 + wrong) / (1 - wrong)).b]
    stretches, angles = [], []
    for low, high in itertools.pairwise(ends):
        g = hull([low, high])
        sine = hull(2 * end / (1 + end**2) for end in (low, high)) if high.b <= 1 else interval(0, 1)
        along = hull(r * (1 + g**2) / 2 + c * (1 - g**2) / 2 for r, c in shared)
        along += hull((1 + r) * o * sine * g + e * g for o, e in single)
        across = hull((r - c) * g for r, c in shared) + hull((1 + r) * o * sine + e for o, e in single)
        angles.append(largest([across]))
        stretches.append(along + angles[-1] ** 2 * interval(0, 0.5))
    lost = wrong + largest([r]) + 2 * largest([o]) + largest([e])
    return Turn(hull(stretches), largest(angles) / (1 - lost), hull([ZERO, r + c]).b / 2)


def turn(flow: Dataflow, cosine: str, sine: str, common: str, mirrored: bool = False) -> Turn:
    """Return the error of the rotation by half the angle of two nodes, whose words have the factor of the node
    ``common``.  ``mirrored``: the sine may be negative."""
    c, s, of = (flow.nodes[name] for name in (cosine, sine, common))
    ulp, some = c.format.ulp, dict[str, Cell]()
    shared, single = [], []
    for places in combinations(flow, c):
        words, some = Words(places), some | places
        factor, rest = words(of).factor, words(c).rest
        shared += [(factor - 1, rest - interval(0, 1) * ulp), (factor - 1, -rest - interval(1, 2) * ulp)]  # C >= 0, < 0
        if words(c).factor != factor:
            raise ValueError(f"{cosine} does not have the factor of {common}")
    for places in combinations(flow, s, common):
        word, some = Words(places, common)(s), some | places
        error = word.rest - interval(0, 1) * ulp
        single += [(word.factor - 1, error), (word.factor - 1, -error if mirrored else error)]
    if Words(some)(s).factor != word.factor * factor:
        raise ValueError(f"{sine} does not have the factor of {common}")
    return turned(shared, single)


def half_angle(flow: Dataflow) -> Interval:
    """Return the error of the squared length of (cos, sin) of phi/2."""
    sine, cosine = (flow.nodes[name] for name in flow.half_angle)
    frac = min(sine.frac, SINE_FRACS[-1])
    if not all(isinstance(node.op, HalfAngle) for node in (sine, cosine)):
        raise TypeError("the half angle is not from the table")
    one = interval(half_sincos_error(frac, flow.tile)) * (1 + 2.0**-50) / (1 << frac)
    both = 2 * norm(one, one)
    return hull([-both, both + 2 * one**2])


def normalization(flow: Dataflow, turns: Iterable[Turn]) -> Interval:
    """Return the error that the squared length's products and the last root add to the squared length of Qs."""
    az_tilt_sq, length_sq, m_q = (flow.nodes[name] for name in ("az_tilt_sq", "length_sq", "m_q"))
    if m_q.frac < length_sq.frac:
        raise ValueError("m_q: the squared length is truncated")
    whole = 4 * ulps(az_tilt_sq) + 8 * ulps(length_sq)  # relative to lengths of 1/4 and 1/8 or more
    # A length of 1 or more becomes the largest mantissa.
    limited = (1 - interval(m_q.format.ulp)) / reduce(mul, (1 + turn.above for turn in turns)) - 1
    inverse = 1 + hull(cell.inverse for cell in cells(m_q.frac - 3, flow.tile, False))
    return inverse**2 / (1 + hull([whole, limited])) - 1


# ---- the theorem -----------------------------------------------------------------------------------------------------


def sizes(flow: Dataflow, *names: str) -> Interval:
    """Return the largest length of the vector of the nodes' rounding errors."""
    return norm(*(largest([ulps(flow.nodes[name])]) for name in names))


def corners(flow: Dataflow, *names: str) -> Iterable[tuple[Interval, ...]]:
    """Return all combinations of the least and greatest rounding errors of nodes."""
    errors = (ulps(flow.nodes[name]) for name in names)
    return itertools.product(*((error.a, error.b) for error in errors))


def products(flow: Dataflow) -> tuple[Interval, Interval, Interval]:
    """Return the lengths of the errors of Qs from the products of azimuth and phi, of these with the tilt, and of these
    with the bend.  A length is convex in the errors, so it is largest in a corner."""
    first = largest(
        norm(*part)
        for cc, ss, sc, cs in corners(flow, "cc", "ss", "sc", "cs")
        for part in ((cc - ss, sc + cs), (cc + ss, sc - cs))
    )
    pairs = (
        largest(
            norm(part, whole - plus)
            for whole, dif, plus in corners(flow, f"{one}{two}_c", f"{two}_dif", f"{one}_sum")
            for part in (whole - dif, whole + dif)
        )
        for one, two in ("wi", "kj")
    )
    return first, sizes(flow, "w_0", "i_0", "j_0", "k_0"), norm(*pairs)


def elbow(flow: Dataflow) -> tuple[Interval, Interval, Interval]:
    """Return two parts of the length of Qe's error, of the factors of its words, and of their rests and rounding; and
    the largest angle by which unequal factors turn Qe."""
    inverse, factors, rests = flow.nodes["inv_12"], [], []
    shared = hull(Words(places)(inverse).factor for places in combinations(flow, inverse))
    for half in "wi":
        node = flow.nodes[f"elbow_{half}"]
        words = [Words(places, "inv_12")(node) for places in combinations(flow, node, "inv_12")]
        factors.append(hull(word.factor for word in words))
        rests.append(largest(word.rest for word in words) + largest([ulps(flow.nodes[f"qe_{half}"])]))
    ratio = factors[0] / factors[1]
    return largest(factor * shared - 1 for factor in factors), norm(*rests), largest([(ratio - 1) / iv.sqrt(ratio) / 2])


class Accuracy(NamedTuple):
    """Constants of the theorem in units of 2^-(W-2): ``a``, ``b``, for a clamped target ``c``, and by name those from
    which they come."""

    a: Fraction
    b: Fraction
    c: Fraction
    parts: dict[str, Fraction]

    @property
    def both(self) -> Fraction:
        """Limit of the hand error divided by d1 + d2: a + b."""
        return self.a + self.b


def shoulder(flow: Dataflow, *turns: Turn) -> tuple[Interval, Interval, Interval, dict[str, Interval]]:
    """Return the errors of a unit vector rotated by Qs, for the errors of azimuth, tilt and bend: from exact products
    of words, and from their roundings; the squared length of Qs without the latter; and parts by name."""
    phi, last = half_angle(flow), normalization(flow, turns)
    stretch = reduce(mul, (1 + turn.stretch for turn in turns)) * (1 + phi) * (1 + last)
    angle = norm(turns[0].angle, turns[1].angle) + turns[2].angle
    size, off = iv.sqrt(stretch).b, largest([stretch - 1])
    turned = norm(off, size * angle)

    steps, length = [], iv.sqrt(1 + phi)
    for error, part in zip(products(flow), turns, strict=True):
        length = length * iv.sqrt((1 + part.stretch) * part.least)
        steps.append(size * error / length)
    steps += [sizes(flow, *(f"{kind}{unit}{end}" for unit in "wijk")) for kind, end in (("", "_q"), ("qs_", ""))]
    moved = sum(steps)
    names = "first products", "tilt products", "bend products", "inv_q products", "Qs rounding"
    parts = {name: 2 * step for name, step in zip(names, steps, strict=True)}
    parts |= {"phi k": phi, "length k": last, "K": off, "w": angle, "turned": turned, "rounded": moved}
    return turned, 2 * size * moved + moved**2, stretch, parts


def units(size: Interval, width: int) -> Fraction:
    """Return the largest magnitude of an interval in units of 2^-(W-2)."""
    return Fraction(*to_rational(abs(size).b._mpi_[1])) * (1 << width - 2)


@cache
def accuracy(width: int, datapath: str = "lean") -> Accuracy:
    """Return the constants of the theorem for a datapath at a word length."""
    flow = dataflow(datapath, width)
    azimuth = turn(flow, "u_y", "u_x", "inv_rho", mirrored=True)
    tilt, bend = turn(flow, "sin_el", "cos_el", "inv_s"), turn(flow, "cos_a", "sin_a", "inv_law")
    turned, spread, stretch, parts = shoulder(flow, azimuth, tilt, bend)
    factors, rests, skew = elbow(flow)
    bent = factors + rests
    limits = [
        turned + spread,
        (2 * bent + bent**2) * (stretch + spread),
        sum(shoulder(flow, azimuth, tilt, STRAIGHT)[:2]),
    ]
    for name, part in (("azimuth", azimuth), ("tilt", tilt), ("bend", bend)):
        parts |= {f"{name} k": part.stretch, f"{name} w": part.angle}
    inverses = (root.inverse for root in cells(flow.nodes["m_s"].frac - 3, flow.tile, True))
    parts |= {"Qe factors": 2 * factors, "Qe rests": 2 * rests, "Qe skew": skew, "inv": hull(inverses)}
    a, b, c = (units(limit, width) for limit in limits)
    return Accuracy(a, b, c, {name: units(part, width) for name, part in parts.items()})


def main(words: Sequence[str]) -> None:
    """Print the constants of a datapath at a word length, or all limits."""
    if words:
        result = accuracy(int(words[1]), words[0])
        rows = {**result.parts, "a": result.a, "b": result.b, "c": result.c, "a + b": result.both}
        for name, part in rows.items():
            print(f"{name:<16}{float(part):8.3f} {float(part) * 2.0 ** (2 - int(words[1])):.3e}")
        return
    for datapath, limits in STATED.items():
        for width, limit in limits.items():
            both, reach = float(accuracy(width, datapath).both), float(limit) * 2.0 ** (2 - width)
            print(f"{datapath:<7} W = {width}: {both:.4f}, stated {float(limit)}, {reach:.3e} of the reach")


if __name__ == "__main__":
    main(sys.argv[1:])
