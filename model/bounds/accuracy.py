# SPDX-License-Identifier: Apache-2.0
"""Proved accuracy: limits of the wrist error (lean) and of the hand's errors (whole arm) at every word length.

docs/generated/accuracy.md is the proof.  This module computes the constants of the proof from the stated errors of the
dataflow's operations, from the rows of the root's table, and from the CORDIC's errors
(:func:`..dataflow.angles.head`).  Numbers are intervals, rounded outwards by mpmath.

    python -m model.bounds.accuracy [DATAPATH WIDTH]      print all limits, or the constants of a core
"""

import itertools
import math
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from functools import cache, reduce
from operator import mul
from typing import NamedTuple

from mpmath.libmp import to_rational

from ..dataflow.angles import GUARD, Interval, arc, head, iv, upper
from ..dataflow.arm import PRODUCTS
from ..dataflow.expressions import EXACT
from ..dataflow.fixed import dataflow
from ..dataflow.formats import WIDTHS
from ..dataflow.lean_operations import Choice, Even, ShiftDown, ShiftUp
from ..dataflow.mul3 import Mul3
from ..dataflow.nodes import Dataflow, Node
from ..dataflow.quadratic import INVERSE_ROOT, PRECISION, SINE_FRACS, Rsqrt, half_sincos_error, rounding, row_error

LIMITS = """
lean wrist 3.884 4.354 4.549 4.327 4.33 4.337 4.35 4.377 4.43 4.5 4.549 4.949 5.762 8.109 12.803 22.19 40.966
lean25 wrist 3.884 4.353 4.547 4.324 4.325 4.326 4.328 4.332 4.341 4.359 4.395 4.644 5.17 6.925 10.436 17.457 31.498
lean16 wrist 3.876 4.336 4.513 4.371 4.418 4.474 4.498 4.77 5.225
arm orientation 18.65 17.1 19 17.53 21.94 21.51 23.41 21.6 23.15 22.95 23.9 23.18 24.68 24.57 28.26 28.65 35.53
arm point 19.55 18.05 19.95 18.48 22.89 22.46 24.36 22.55 24.1 23.91 24.86 24.17 25.7 25.74 29.74 31.07 46.29
"""
STATED = {
    (path, name): dict(zip(WIDTHS, map(Fraction, row), strict=False))
    for path, name, *row in map(str.split, LIMITS.strip().splitlines())
}
"""Datapath and constant -> word length -> proved limit in units of 2^-(W-2).  wrist: error / (d1 + d2); orientation:
angle (rad); point: error for d1 + d2 + |tool| = 1."""

CELLS = 8
"""Number of parts of a mantissa's range [1/4, 1), each with its largest errors."""

SIDES = 32
"""Number of parts of the range of g, the tangent of half an angle."""

ZERO, ONE = iv.mpf(0), iv.mpf(1)


def hull(intervals: Iterable[Interval]) -> Interval:
    """Return the smallest interval that contains all ``intervals``."""
    parts = list(intervals)
    return iv.mpf([min(part.a for part in parts), max(part.b for part in parts)])


def norm(*sizes: Interval) -> Interval:
    """Return the largest length of a vector of intervals."""
    return iv.sqrt(sum(abs(size) ** 2 for size in sizes)).b


def ulps(node: Node) -> Interval:
    """Return the range of the rounding error that the node's operation states."""
    return iv.mpf(node.error) * node.format.ulp


# ---- words -----------------------------------------------------------------------------------------------------------


class Cell(NamedTuple):
    """Intervals for one part of [1/4, 1), the range of a mantissa V.  ``root``: sqrt V; ``inverse``: error of
    ``ik_rsqrt``'s word y relative to 1/(2 sqrt V); ``product``: error of 2 y m relative to sqrt V, m being V's word."""

    root: Interval
    inverse: Interval
    product: Interval


@cache
def cells(frac: int, tile: int, cut: bool) -> list[Cell]:
    """Return the cells of a mantissa whose root has ``frac`` fraction bits; each cell covers equally many table rows.
    ``cut``: the mantissa's word may be truncated."""
    form, ulp, rows = INVERSE_ROOT.form(frac, tile), 2.0**-frac, []
    for row in range(form.rows):
        left, width = map(iv.mpf, INVERSE_ROOT.segment(form, row))
        error = iv.mpf(row_error(INVERSE_ROOT, form, row, rises=False)) + iv.mpf([-ulp, 0])  # y - 1/(2 sqrt m)
        error += iv.mpf(rounding(form, frac)) / 2**form.sum_frac
        error += iv.mpf([-1, 1]) * 2.0 ** (40 - PRECISION)  # covers the error of the row errors
        root = iv.sqrt(hull([left, left + width]))
        share = iv.mpf([0, ulp / 8 if cut else 0]) / left  # 1 - m/V is at most its end
        fall = share / (4 * root.a)  # 1/(2 sqrt m) - 1/(2 sqrt V)
        truncated = hull([ZERO, -share / 2 - share**2 / 2])  # sqrt(m/V) - 1
        rows.append((root, 2 * root * (error + fall), truncated + 2 * root * error * (1 - share)))
    size = form.rows // CELLS
    groups = (rows[n : n + size] for n in range(0, form.rows, size))
    return [Cell(*map(hull, zip(*group, strict=True))) for group in groups]


def combinations(node: Node, given: str = "") -> Iterator[dict[str, Cell]]:
    """Yield all combinations of cells for the mantissas on which a node depends.  Operands of ``given`` are ignored."""

    def mantissas(node: Node) -> list[Node]:
        if isinstance(node.op, Even):
            return [node]
        return [m for operand in node.operands for m in mantissas(operand)] if node.name != given else []

    found = {m.name: (m.frac - 3, m.flow.tile, m.op.width > m.format.width) for m in mantissas(node)}  # type: ignore
    parts = {name: cells(*of) for name, of in found.items()}
    return (dict(zip(parts, at, strict=True)) for at in itertools.product(*parts.values()))


class Word(NamedTuple):
    """Bound of a node's word: the word is the exact value times ``factor``, plus ``rest``.  ``value``: range of the
    exact value; None if the exact value is not known to be positive."""

    factor: Interval
    rest: Interval = None
    value: Interval = None


def bound(node: Node, at: Mapping[str, Cell], given: str = "") -> Word:
    """Return the bound of a node's word.  ``at``: mantissa name -> its cell.  The word of the node ``given`` counts as
    exact.  Raises TypeError for an operation without a rule."""
    op = node.op
    if node.name == given:
        return Word(ONE)
    if isinstance(op, Rsqrt):
        cell = at[op.m.name]
        return Word(1 + cell.inverse, None, 1 / (2 * cell.root))
    if isinstance(op, Mul3) and isinstance(op.parts[1].op, Even):  # 2 m / (2 sqrt m)
        cell = at[op.parts[1].name]
        return Word(1 + cell.product + ulps(node) / cell.root, None, cell.root)
    if isinstance(op, Mul3):
        one, two = (bound(part, at, given) for part in op.parts)
        return _product(node, one, two, iv.mpf(2) ** op.scale)
    if isinstance(op, ShiftDown) and (word := bound(op.value, at, given)).rest is None:
        return Word(word.factor, ulps(node))
    if isinstance(op, ShiftUp) and op.value.decision:  # of an exact word
        return Word(ONE, None if node.error == EXACT else ulps(node))
    if isinstance(op, Choice) and node.limited:
        # The limit takes at most an ulp from the exact value, as the raw word's rounding may where its factor is 1.
        (raw,) = op.operands
        word = bound(raw, at, given)
        if raw.error[0] * raw.format.ulp <= -node.format.ulp and word.factor.a <= 1:
            return word
    raise TypeError(f"{node.name}: no bound of its word")


def _product(node: Node, one: Word, two: Word, scale: Interval) -> Word:
    rest, factor = ulps(node), one.factor * two.factor
    for word, other in ((one, two), (two, one)):
        if word.rest is not None:
            if other.rest is not None or other.value is None:
                raise TypeError(f"{node.name}: no bound of a product with the rest of a word")
            rest += scale * word.rest * other.factor * other.value
    if one.value is None or two.value is None:
        return Word(factor, rest)
    value = scale * one.value * two.value
    return Word(factor + rest / value, None, value)


# ---- rotations -------------------------------------------------------------------------------------------------------


class Turn(NamedTuple):
    """Error of a rotation defined by the words of a half angle.  Their matrix, divided by the squared length's word, is
    (1 + ``stretch``) times a rotation off by at most ``angle`` (rad).  That word is in [``least``, 1 + ``above``]."""

    stretch: Interval
    angle: Interval
    above: Interval
    least: Interval = iv.mpf(0.5)


STRAIGHT = Turn(ZERO, ZERO, ZERO, ONE)
"""Rotation by 0 or 180 degrees: the bend of a clamped target."""

Pairs = Sequence[tuple[Interval, Interval]]


def turned(shared: Pairs, single: Pairs) -> Turn:
    """Return the error of a rotation with the exact cosine C and sine S.  The words of its half angle are L and s, with
    2 L = 1 + |C| (1 + r) + c and 2 s = S (1 + r) (1 + o) + e.

    ``shared`` lists the pairs (r, c), ``single`` the pairs (o, e); each (r, c) may occur with each (o, e).
    """
    r, c, o, e = (hull(part) for pairs in (shared, single) for part in zip(*pairs, strict=True))
    wrong = abs(r).b + abs(c).b  # at most |C| where C's word has the wrong sign
    ends = [*(iv.mpf(n) / SIDES for n in range(SIDES + 1)), iv.sqrt((1 + wrong) / (1 - wrong)).b]
    stretches, angles = [], []
    for low, high in itertools.pairwise(ends):
        g = hull([low, high])
        sine = hull(2 * end / (1 + end**2) for end in (low, high)) if high.b <= 1 else iv.mpf([0, 1])
        along = hull(r * (1 + g**2) / 2 + c * (1 - g**2) / 2 for r, c in shared)
        along += hull((1 + r) * o * sine * g + e * g for o, e in single)
        across = hull((r - c) * g for r, c in shared) + hull((1 + r) * o * sine + e for o, e in single)
        angles.append(abs(across).b)
        stretches.append(along + angles[-1] ** 2 * iv.mpf([0, 0.5]))
    lost = wrong + abs(r).b + 2 * abs(o).b + abs(e).b
    return Turn(hull(stretches), upper(*angles) / (1 - lost), hull([ZERO, r + c]).b / 2)


def turn(flow: Dataflow, cosine: str, sine: str, common: str, mirrored: bool = False) -> Turn:
    """Return the error of a rotation whose half angle is computed from the nodes ``cosine`` and ``sine``.  The bounds
    of both must contain the ``factor`` of the bound of ``common``.  ``mirrored``: the sine may be negative."""
    c, s, of = (flow.nodes[name] for name in (cosine, sine, common))
    one, two = (iv.mpf([n, n + 1]) * c.format.ulp for n in (0, 1))
    shared, single = [], []
    for at in combinations(c):
        factor, word = bound(of, at).factor, bound(c, at)
        shared += [(factor - 1, word.rest - one), (factor - 1, -word.rest - two)]  # C >= 0, C < 0
        if word.factor != factor:
            raise ValueError(f"{cosine} does not have the factor of {common}")
    for other in combinations(s, common):
        word = bound(s, other, common)
        error = word.rest - one
        single += [(word.factor - 1, error), (word.factor - 1, -error if mirrored else error)]
        if bound(s, at | other).factor != word.factor * factor:
            raise ValueError(f"{sine} does not have the factor of {common}")
    return turned(shared, single)


# ---- the wrist -------------------------------------------------------------------------------------------------------


def lengths(flow: Dataflow, turns: Sequence[Turn]) -> tuple[Interval, Interval]:
    """Return relative errors of the squared lengths of (cos phi/2, sin phi/2) and of Qs, the latter due to inv_q."""
    az_tilt_sq, length_sq, m_q, sine = (flow.nodes[name] for name in ("az_tilt_sq", "length_sq", "m_q", "sin_h"))
    frac = min(sine.frac, SINE_FRACS[-1])
    table = norm(*[iv.mpf(half_sincos_error(frac, flow.tile)) * (1 + 2.0**-50) / 2**frac] * 2)
    if m_q.frac < length_sq.frac:
        raise ValueError("m_q: the squared length is truncated")
    whole = 4 * ulps(az_tilt_sq) + 8 * ulps(length_sq)  # relative to lengths of 1/4 and 1/8 or more
    # A length of 1 or more becomes the largest mantissa.
    limited = (1 - iv.mpf(m_q.format.ulp)) / reduce(mul, (1 + turn.above for turn in turns)) - 1
    inverse = 1 + hull(cell.inverse for cell in cells(m_q.frac - 3, flow.tile, False))
    return hull([-2 * table, 2 * table + table**2]), inverse**2 / (1 + hull([whole, limited])) - 1


def products(flow: Dataflow) -> dict[str, Interval]:
    """Return a dict: group of products, or the rounding of results -> length of the error that it causes in Qs."""

    def at(names: str) -> list[Interval]:
        return [ulps(flow.nodes[name]) for name in names.split()]

    cc, ss, sc, cs = at("cc ss sc cs")
    last = []
    for names in ("wi_c i_dif w_sum", "kj_c j_dif k_sum"):
        whole, dif, plus = at(names)
        last += [hull([whole - dif, whole + dif]), whole - plus]
    return {
        "first products": upper(norm(cc - ss, sc + cs), norm(cc + ss, sc - cs)),
        "tilt products": norm(*at("w_0 i_0 j_0 k_0")),
        "bend products": norm(*last),
        "inv_q products": norm(*at("w_q i_q j_q k_q")),
        "Qs rounding": norm(*at("qs_w qs_i qs_j qs_k")),
    }


def shoulder(flow: Dataflow, *turns: Turn) -> dict[str, Interval]:
    """Return, by name, the constants for a unit vector rotated by Qs.  ``turns``: errors of azimuth, tilt and bend."""
    phi, last = lengths(flow, turns)
    stretch = reduce(mul, (1 + turn.stretch for turn in turns)) * (1 + phi) * (1 + last)
    k, w = abs(stretch - 1).b, norm(turns[0].angle, turns[1].angle) + turns[2].angle
    size, steps, length = iv.sqrt(1 + k), products(flow), iv.sqrt(1 + phi)
    for name, part in zip(steps, turns, strict=False):
        length = length * iv.sqrt((1 + part.stretch) * part.least)
        steps[name] = size * steps[name] / length
    moved = sum(steps.values())
    parts = {"phi k": phi, "length k": last, "K": k, "w": w, **{name: 2 * step for name, step in steps.items()}}
    return parts | {"turned": norm(k, size * w), "rounded": moved, "spread": 2 * size * moved + moved**2}


def elbow(flow: Dataflow) -> dict[str, Interval]:
    """Return limits, by name.  ``Qe factors``: length of Qe's error due to its words' factors; ``Qe rests``: length of
    Qe's error due to its words' rests and to rounding; ``Qe skew``: angle by which unequal factors turn Qe."""
    shared = hull(bound(flow.nodes["inv_12"], at).factor for at in combinations(flow.nodes["inv_12"]))
    factors, rests = [], []
    for half in "wi":
        node = flow.nodes[f"elbow_{half}"]
        words = [bound(node, at, "inv_12") for at in combinations(node, "inv_12")]
        factors.append(hull(word.factor for word in words))
        rests.append(abs(hull(word.rest for word in words)).b + abs(ulps(flow.nodes[f"qe_{half}"])).b)
    ratio = factors[0] / factors[1]
    most = abs(hull(factor * shared - 1 for factor in factors)).b
    return {"Qe factors": most, "Qe rests": norm(*rests), "Qe skew": abs((ratio - 1) / iv.sqrt(ratio) / 2).b}


@cache
def core(flow: Dataflow) -> dict[str, Interval]:
    """Return the constants of the wrist's theorem, by name.  For d1 + d2 = 1, the wrist's error is at most ``wrist`` =
    ``a`` + ``b`` in reach, and at most ``c`` for a clamped target."""
    turns = {
        "azimuth": turn(flow, "u_y", "u_x", "inv_rho", mirrored=True),
        "tilt": turn(flow, "sin_el", "cos_el", "inv_s"),
        "bend": turn(flow, "cos_a", "sin_a", "inv_law"),
    }
    straight = shoulder(flow, turns["azimuth"], turns["tilt"], STRAIGHT)
    parts = {
        f"{name} {kind}": size for name, of in turns.items() for kind, size in (("k", of.stretch), ("w", of.angle))
    }
    parts |= shoulder(flow, *turns.values()) | elbow(flow)
    bent = parts["Qe factors"] + parts["Qe rests"]
    a = parts["turned"] + parts["spread"]
    b = (2 * bent + bent**2) * (1 + parts["K"] + parts["spread"])
    return parts | {"a": a, "b": b, "c": straight["turned"] + straight["spread"], "wrist": a + b}


# ---- the whole arm ---------------------------------------------------------------------------------------------------


def ball(width: int, least: Interval) -> Interval:
    """Return the limit of the angle (rad) between a quaternion's rotation and the rotation by the words of the three
    angles that are computed from it.  The quaternion consists of words; its length is at least ``least``."""
    word, half, root = iv.mpf(4) / 2**width, iv.pi / 2**width, iv.sqrt(iv.mpf(2))
    lsb = word / 2**GUARD
    worst = ZERO
    shares = [1 / root, *(iv.mpf(2) ** -k for k in range(1, width))]
    # Ranges of the shorter of (w, k) and (i, j), relative to the quaternion
    for high, low in itertools.pairwise(shares):
        longer, shorter = least * iv.sqrt(1 - high**2), iv.mpf((least * low).a)
        one, other = head(width, upper(root * word, shorter)), head(width, iv.mpf(longer.a))
        left = head(width, upper(word, shorter)).left  # a vector of one word is on an axis: its angle is exact
        slip = other.along * lsb / least
        along = other.along * iv.sqrt(1 - low**2)
        moved = norm(along, one.across, other.across) * lsb / (least * (1 - root * slip))
        cosine, between = iv.cos(upper(left, other.left)), (high + slip) / (longer / least - slip)
        unequal = (1 / iv.sqrt(cosine) - iv.sqrt(cosine)) / 2
        if (between**2 * cosine).b < 1:
            unequal = (1 / cosine - 1) * between / (1 + cosine * between**2)
        last = head(width, iv.mpf((other.gain * least * (1 - root * slip) * cosine).a))
        b = unequal + last.lost + last.rest + half / 2
        share = (high + slip) / (1 - root * slip)
        more = upper(ZERO, one.rest**2 - other.rest**2)
        chord = norm(b, iv.sqrt(other.rest**2 + share * (share + b) * more) + half)
        worst = upper(worst, 2 * (moved + 2 * arc(chord / 2)))
    return worst


def frame(flow: Dataflow, elbow: Interval) -> Interval:
    """Return the limit of the length of Qw's error.  ``elbow``: largest length of Qe."""
    turned, moved = [], []
    for c, row in PRODUCTS.items():
        turned.append(
            sum(ulps(flow.nodes[f"g_{a}{b}"]) * (-1 if sign == "-" else 1) for a, b, sign in map(tuple, row.split()))
        )
        one, two = (ulps(product) for product in flow.nodes[f"qw_{c}"].operands)
        moved.append(hull([one + two, one - two]))
    return norm(*turned) * elbow + norm(*moved) + norm(*(ulps(flow.nodes[f"qw_{c}"]) for c in PRODUCTS))


def arm(flow: Dataflow) -> dict[str, Interval]:
    """Return the constants of the whole arm's theorem, by name.  ``orientation``: limit of the orientation error (rad);
    ``point``: limit of the point error for d1 + d2 + |tool| = 1; its part ``coordinates`` is independent of lengths."""
    width, wrist = flow.width, core(dataflow("lean", flow.width))
    k, moved, factors, rests = (wrist[name] for name in ("K", "rounded", "Qe factors", "Qe rests"))
    qs, qe, half = iv.sqrt(1 - k) - moved, 1 - factors - rests, iv.pi / 2**width  # least lengths
    bend, off = head(width, iv.mpf(qe.a)), frame(flow, 1 + factors + rests)
    least = qs * qe * (1 - iv.mpf(2) ** -8)

    def largest(name: str) -> Interval:
        return abs(ulps(flow.nodes[name])).b

    columns = (("ik", "wj"), ("jk", "wi"), ("ii", "jj"))
    parts = {
        "ball, Qs": ball(width, qs),
        "elbow": 2 * (bend.lost + bend.rest) + half,
        "Qw": 2 * arc(off / least),
        "ball, Qw": ball(width, least - off),
        "a, arm": wrist["w"] + 2 * arc(moved / iv.sqrt(1 - k)),
        "b, arm": 2 * (wrist["Qe skew"] + arc(rests / (1 - factors))),
        "tool": 2 * norm(*(sum(largest(f"h_{product}") for product in column) for column in columns)),
        "coordinates": norm(*(2 * largest(f"off_{axis}") + largest(axis) for axis in "xyz")),
    }
    both, end = parts["ball, Qs"] + parts["elbow"], parts["ball, Qw"] + parts["Qw"]
    moved = upper(parts["a, arm"] + parts["b, arm"], end + parts["tool"])
    return parts | {"orientation": both + end, "point": parts["coordinates"] + both + moved}


@cache
def accuracy(width: int, datapath: str = "lean") -> dict[str, Fraction]:
    """Return the constants of a datapath's theorem (:func:`core` or :func:`arm`), by name, in units of 2^-(W-2)."""
    parts = (arm if datapath == "arm" else core)(dataflow(datapath, width))
    return {name: Fraction(*to_rational(abs(size).b._mpi_[1])) * (1 << width - 2) for name, size in parts.items()}


def main(datapath: str = "", width: str = "") -> None:
    """Print a datapath's constants at a word length; without arguments, all limits at every word length."""
    if datapath:
        for name, part in accuracy(int(width), datapath).items():
            print(f"{name:<16}{math.ceil(part * 1000) / 1000:8.3f} {math.ldexp(part, 2 - int(width)):.3e}")
        return
    for (datapath, name), limits in STATED.items():
        for w, limit in limits.items():
            most = float(accuracy(w, datapath)[name])
            print(f"{datapath:<7} W = {w}: {name} {most:.4f}, stated {float(limit)}, {math.ldexp(limit, 2 - w):.3e}")


if __name__ == "__main__":
    main(*sys.argv[1:])
