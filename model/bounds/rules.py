# SPDX-License-Identifier: Apache-2.0
"""What geometry knows of the paper's dataflow: the cases that the input words fall into, and a rule for each node whose
range exact arithmetic narrows.  :mod:`model.bounds.ranges` runs the dataflow on them.

The cases (:func:`cases`), of which a node's range is the union:

* ``exact``: in reach, and the arms leave room for a shift: their words lose nothing when they are halved;
* ``long``: in reach, d1 + d2 >= 2: halving rounds odd lengths, so d1 + d2 is off by ulps (d1 - d2 stays exact);
* ``clamped``: everything else; it takes the way of an arm d1 = d2 = 1/4 (see :func:`model.dataflow.nodes.guard`).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, replace

SQRT2, SQRT3 = math.sqrt(2), math.sqrt(3)

@dataclass(frozen=True)
class Case:
    """A part of the input domain: bounds of the arms and of j in their own unit, and of |p_w| and |b|."""

    name: str
    clamped: bool
    d_high: float  # either arm
    j: tuple[int, int]
    long: bool = False  # halving may round the arms
    p: tuple[float, float] = (0.5, SQRT3)
    b: tuple[float, float] = (0.5, SQRT2)
    ulp: float = 0.0  # of the arms
    tilt: float = 0.0  # sine of the angle between p_w and the plane of the words pi_swivel

    @property
    def excess(self) -> float:
        """What rounded arms add to |k_e|: the rounding of d1 + d2, times |d1 - d2|."""
        return 4 * self.ulp if self.long else 0.0

    @property
    def k_e(self) -> float:
        """|k_e| <= 2 d1 |p_w|, and <= s_j + (d1 + d2) |d_dif_j| where arms are rounded."""
        limit = 2 * self.d_high * self.p[1] + self.excess
        return min(limit, self.p[1] ** 2 * 2.0 ** -self.j[0] + 2) if self.long else limit

    @property
    def p_e(self) -> float:
        """|p_e| = max(d1, |k_e| / 2|p_w|), the latter over the cosine of the tilt."""
        return (self.d_high + self.excess / (2 * self.p[0])) / math.sqrt(1 - self.tilt**2)

    @property
    def pp(self) -> tuple[float, float]:
        """|PP^-| = 2 |p_w| |pi_swivel|."""
        return 2 * self.p[0] * self.b[0] * math.sqrt(1 - self.tilt**2), 2 * self.p[1] * self.b[1]


EDGES_P = (0.5, math.sqrt(0.5), 1.0, SQRT2, SQRT3)
EDGES_B = (0.5, math.sqrt(0.5), 1.0, SQRT2)
"""Where the lengths of the two mantissa vectors are cut: within a part, numerators and divisors keep step."""


def cases(width: int) -> list[Case]:
    """The parts of the input domain; together they hold every input word."""
    ulp = 2.0 ** (1 - width)
    last = 1 - 2 * ulp  # d1 + d2 <= 1 - ulp, d2 >= ulp
    whole = [
        Case("exact", False, last, (0, width - 1)),
        Case("long", False, 0.5, (0, width), True),
        Case("clamped", True, 0.25, (2, 2)),
    ]
    boxes = list(itertools.product(itertools.pairwise(EDGES_P), itertools.pairwise(EDGES_B)))
    return [replace(c, p=p, b=b, ulp=ulp) for c in whole for p, b in boxes]


# -- what geometry knows ---------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Rule:
    """What geometry says of some nodes in exact arithmetic: ``limit(case)`` gives (low, high)."""

    name: str
    why: str
    nodes: tuple[str, ...]
    limit: Callable[[Case], tuple[float, float]]


def _within(size: Callable[[Case], float]) -> Callable[[Case], tuple[float, float]]:
    return lambda c: (-size(c), size(c))


def _each(pattern: str, *letters: str) -> tuple[str, ...]:
    return tuple(pattern.format(a) for a in letters)


SAME_SIGN = ("rho_x", "rho_y", "uu_x", "uu_y")
"""Products of a component with itself in another unit."""

XYZ, IJK = ("x", "y", "z"), ("i", "j", "k")


def _tmp1(c: Case) -> tuple[float, float]:
    most = (min(c.d_high, 0.5) * c.pp[1]) ** 2
    if not c.long:
        return -((c.pp[1] * c.p_e * c.tilt) ** 2), most
    # tmp1 = |pi|^2 ((2 d1 |p_w|)^2 - k_e^2): by |k_e| <= 2 d1 |p_w| + excess, or by |k_e| alone
    near = 4 * c.d_high * c.p[1] * c.excess + c.excess**2
    # Where j >= 2, |d1 - d2| <= |p_a| + ulps leaves d1 >= 1/8.
    least = (c.p[0] / 4) ** 2 if c.j[0] >= 3 else 0.0
    return -(c.b[1] ** 2) * min(near, c.k_e**2 - least) - (c.pp[1] * c.p_e * c.tilt) ** 2, most


def _t_e(c: Case) -> tuple[float, float]:
    if c.clamped:
        return 0.0, 0.75
    most = (c.p_e + 2 * c.ulp) ** 2 if c.long else 0.25 + (c.p_e * c.tilt) ** 2
    return -most, most


RULES = (
    Rule(
        "unit mantissa",
        "a vector shifted until its largest component fills the word has that component in [1/2, 1], so its squared "
        "length is in [1/4, 3] (with two components: at most 2)",
        ("s",),
        lambda c: (c.p[0] ** 2, c.p[1] ** 2),
    ),
    Rule("unit mantissa", "the same of L_m", ("tmp2",), lambda c: (0.25, 3.0)),
    Rule(
        "unit mantissa, length",
        "the root of the squared length: |p_w| and |L_m| are in [1/2, sqrt 3]",
        ("l_sw",),
        lambda c: c.p,
    ),
    Rule("unit mantissa, length", "the same of L_m", ("l_m",), lambda c: (0.5, SQRT3)),
    Rule(
        "same direction",
        "p_w and b are the same target in two units, so each p_x b_x >= 0 and the sum is |p_xy| |b| <= 2",
        (*SAME_SIGN[:2], "rho"),
        lambda c: (0.0, min(2.0, c.p[1] * c.b[1])),
    ),
    Rule("cosine", "a sine or cosine", ("sin_h", "cos_h", "sin_phi", "cos_phi", "c3"), lambda c: (-1.0, 1.0)),
    Rule("cosine", "a squared cosine, doubled", ("cos2_sq",), lambda c: (0.0, 2.0)),
    Rule(
        "|pi_swivel| = |b|",
        "the two terms of (11) are orthogonal and of length |b| |sin phi| and |b| |cos phi|, and |b| <= sqrt 2",
        _each("pi_swivel_{}", *XYZ),
        _within(lambda c: c.b[1]),
    ),
    Rule(
        "|pi_swivel| = |b|",
        "before the division by |L_sw| <= sqrt 3",
        _each("pi_num_{}", *XYZ),
        _within(lambda c: c.p[1] * c.b[1]),
    ),
    Rule(
        "|pi_swivel| = |b|",
        "squared, with |b| in [1/2, sqrt 2]",
        ("pi_sq",),
        lambda c: (c.b[0] ** 2, c.b[1] ** 2),
    ),
    Rule("|pi_swivel| = |b|", "its root", ("pi_abs",), lambda c: c.b),
    Rule("|pi_swivel| = |b|", "its inverse", ("pi_inv",), lambda c: (1 / c.b[1], 1 / c.b[0])),
    Rule(
        "arms' unit",
        "d1 + d2 is shifted to [1/2, 1); halving never makes 1 of it, since the largest length, all ones, is rounded "
        "down",
        ("d_sum",),
        lambda c: (0.5, 0.5) if c.clamped else (0.5 - c.ulp, 1 - c.ulp),
    ),
    Rule("arms' unit", "d1 d2 <= ((d1 + d2) / 2)^2", ("d_12",), lambda c: (0.0, 0.25)),
    Rule(
        "not too near",
        "|d1 - d2| <= |p|, in the target's unit <= |p_w| <= sqrt 3",
        ("d_dif_j",),
        lambda c: (0.0, 0.0) if c.clamped else (-c.p[1], c.p[1]),
    ),
    Rule(
        "target's unit",
        "2^j |p_a|^2 = |p_w| |p_a|, with |p_a| <= d1 + d2 <= 1",
        ("s_j",),
        lambda c: (0.0, min(c.p[1] ** 2 * 2.0 ** -c.j[0], c.p[1])),
    ),
    Rule(
        "triangle",
        "|p_w^2 + d1^2 - d2^2| = 2 d1 |p_w| |cos a| <= 2 d1 |p_w| by the law of cosines",
        ("k_e",),
        _within(lambda c: c.k_e),
    ),
    Rule("triangle", "times |pi_swivel| <= sqrt 2", _each("pp_{}", *IJK), _within(lambda c: c.k_e * c.b[1])),
    Rule("triangle", "(k_e |pi_swivel|)^2", ("pp_sq",), lambda c: (0.0, (c.b[1] * c.k_e) ** 2)),
    Rule(
        "Cauchy-Schwarz",
        "2 p_w x pi_swivel is no longer than 2 |p_w| |pi_swivel| <= 2 sqrt 6",
        _each("pp_{}_m", *"123"),
        _within(lambda c: c.pp[1]),
    ),
    Rule(
        "orthogonal",
        "p_w lies in the swivel plane, so |PP^-| = 2 |p_w| |pi_swivel| exactly; its square is in [1/4, 24]",
        ("inf_pp",),
        lambda c: (c.pp[0] ** 2, c.pp[1] ** 2),
    ),
    Rule("orthogonal", "d1^2 |PP^-|^2", ("pp_pm",), lambda c: (0.0, (c.d_high * c.pp[1]) ** 2)),
    Rule(
        "d1 sin a <= min(d1, d2)",
        "tmp1 = (d1 sin a)^2 |PP^-|^2, and the triangle's height over p_w is no longer than the shorter arm <= 1/2",
        ("tmp1",),
        _tmp1,
    ),
    Rule("d1 sin a <= min(d1, d2)", "its root", ("tmp_sqr",), lambda c: (0.0, math.sqrt(_tmp1(c)[1]))),
    Rule(
        "|p_e| <= d1",
        "the numerators of (13) are the components of p_e times |PP^-|^2",
        (*_each("e_{}_pp", *XYZ), *_each("e_{}_num", *XYZ)),
        _within(lambda c: c.p_e * c.pp[1] ** 2),
    ),
    Rule(
        "|p_e| <= d1",
        "the elbow is d1 away from the shoulder (with rounded arms at most |k_e| / 2|p_w|)",
        _each("e_{}_quo", *XYZ),
        _within(lambda c: c.p_e),
    ),
    Rule(
        "law of cosines",
        "|p_e (p_e - p_w)| = d1 d2 |cos| <= 1/4; rounded arms that do not reach lie on one line; clamped ones do not "
        "count",
        ("t_e",),
        _t_e,
    ),
    Rule("unit vectors", "components of a vector of length 1", _each("q12_{}", *IJK), _within(lambda c: 1.0)),
    Rule("unit vectors", "(q_k^2 + q_j^2) - q_i^2, and the three make 1", ("r_x",), _within(lambda c: 1.0)),
    Rule("unit vectors", "|(q_j, q_k)| |pi_swivel| <= sqrt 2", ("g",), _within(lambda c: c.b[1])),
    Rule("unit vectors", "|(q_j, q_k)| |side| <= sqrt 3", ("sg",), _within(lambda c: SQRT3)),
    Rule(
        "2 a b <= a^2 + b^2",
        "2 |q_i| |(q_j, q_k)| <= 1, so the product is no longer than the vector: |pi_swivel| <= sqrt 2",
        ("c3_g",),
        _within(lambda c: c.b[1]),
    ),
    Rule("2 a b <= a^2 + b^2", "the same with |side| <= sqrt 3", ("sg_g",), _within(lambda c: SQRT3)),
    Rule("unit vectors", "pi_swivel times a unit vector", ("c3_num",), _within(lambda c: c.b[1])),
    Rule("unit vectors", "the side vector times a unit vector", ("sign",), _within(lambda c: SQRT3)),
    Rule("unit vectors", "q_i c + q_j s, with c^2 + s^2 = 1", _each("qs_{}", "i", "j"), _within(lambda c: 1.0)),
    Rule("same direction", "u and p_e as well", SAME_SIGN[2:], lambda c: (0.0, SQRT3 / 2 if c.clamped else c.p_e)),
    Rule(
        "mantissa of p_e",
        "|u| |p_xy| <= sqrt 2 |p_e|",
        ("uu",),
        lambda c: (0.0, SQRT2 * (SQRT3 / 2 if c.clamped else c.p_e)),
    ),
)
"""Every piece of geometry that narrows a range; the page of word lengths prints them."""

BY_DESIGN = {
    "c4_quo": "d1 d2 may be an ulp; the quotient saturates, and (14) limits it to [-1, 1]",
    "t_e": "only of clamped targets, whose c4 is set from outside",
    "h": "of an arm that is all upper arm, d1 + |p_ez| may be rounded to 2, and is limited to the largest word",
}
"""Nodes that saturate on purpose: their range is their format."""
