# SPDX-License-Identifier: Apache-2.0
"""Annotations of nodes: ranges, error growth, intended saturation.  They are stated where the node is created.

:func:`cases` divides the inputs of the paper datapath into parts, with geometric bounds on lengths in each part.
:mod:`model.bounds.ranges` runs the dataflow on every part; a node's range is the union of the results.  Three cases:

* ``exact``: the target is in reach, and d1 + d2 < 2: scaling loses no bit of d1 and d2.
* ``long``: the target is in reach, and d1 + d2 >= 2: scaling rounds odd lengths, so d1 + d2 is off by ulps.
* ``clamped``: any other target, computed with d1 = d2 = 1/4 (see :func:`model.dataflow.paper.guard`).
"""

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

SQRT2, SQRT3 = math.sqrt(2), math.sqrt(3)


class RangeError(Exception):
    """Range or format that does not fit the node; the message names the node."""


@dataclass(frozen=True)
class Bound:
    """Bounds of a node.  Its value in exact arithmetic lies in [low, high].  Its word differs from this value by at
    most ``error``, and lies in [floor, ceiling], the range of the operation on its operands' words."""

    low: float
    high: float
    error: float = 0.0
    floor: float = -math.inf
    ceiling: float = math.inf

    @property
    def word(self) -> tuple[float, float]:
        """Range of the word's value."""
        return max(self.low - self.error, self.floor), min(self.high + self.error, self.ceiling)

    @property
    def size(self) -> float:
        """Largest magnitude in exact arithmetic."""
        return max(abs(self.low), abs(self.high))


@dataclass(frozen=True)
class Case:
    """Part of the input domain: bounds of d1 and d2, of the exponent j in p_w = 2^j p_a, and of |p_w| and |b|."""

    name: str
    clamped: bool
    d_high: float  # upper bound of d1 and d2
    j: tuple[int, int]
    long: bool = False  # scaling may round d1 and d2
    p: tuple[float, float] = (0.5, SQRT3)
    b: tuple[float, float] = (0.5, SQRT2)
    ulp: float = 0.0  # ulp of d1 and d2
    elbow: float = 0.0  # ulp of p_e
    tilt: float = 0.0  # sine of the angle between p_w and the plane that the words pi_swivel define
    straight: float = 0.0  # error of the vector p_e relative to a + t m (:func:`off_length`)
    square: float = 0.0  # error of |p_e|^2 computed from the words p_e

    def tilted(self, error: float) -> "Case":
        """Return the case in which the words pi_swivel, whose error is at most ``error``, count as exact."""
        b = self.b[0] - error, self.b[1] + error
        return replace(self, b=b, tilt=error / b[0])

    @property
    def excess(self) -> float:
        """Largest increase of |k_e| due to rounded lengths: the rounding error of d1 + d2, times |d1 - d2|."""
        return 4 * self.ulp if self.long else 0.0

    @property
    def k_e(self) -> float:
        """Upper bound of |k_e|: 2 d1 |p_w|; where d1 and d2 are rounded, also s_j + (d1 + d2) |d_dif_j|."""
        limit = 2 * self.d_high * self.p[1] + self.excess
        return min(limit, self.p[1] ** 2 * 2.0 ** -self.j[0] + 2) if self.long else limit

    @property
    def p_e(self) -> float:
        """Upper bound of |p_e| = max(d1, |k_e| / (2 |p_w|)), divided by the cosine of the tilt."""
        return (self.d_high + self.excess / (2 * self.p[0])) / math.sqrt(1 - self.tilt**2)

    @property
    def pp(self) -> tuple[float, float]:
        """Range of |PP^-| = 2 |p_w| |pi_swivel|; the tilt reduces the lower end."""
        return 2 * self.p[0] * self.b[0] * math.sqrt(1 - self.tilt**2), 2 * self.p[1] * self.b[1]

    @property
    def tmp1(self) -> tuple[float, float]:
        """Range of (d1 sin a)^2 |PP^-|^2; where d1 and d2 are rounded, of |pi_swivel|^2 ((2 d1 |p_w|)^2 - k_e^2)."""
        most = (min(self.d_high, 0.5) * self.pp[1]) ** 2
        tilted = (self.pp[1] * self.p_e * self.tilt) ** 2
        if not self.long:
            return -tilted, most
        # from |k_e| <= 2 d1 |p_w| + excess, or from |k_e| alone
        near = 4 * self.d_high * self.p[1] * self.excess + self.excess**2
        return -(self.b[1] ** 2) * min(near, self.k_e**2) - tilted, most

    @property
    def t_e(self) -> tuple[float, float]:
        """Range of p_e (p_e - p_w), which is d1 d2 times a cosine."""
        if self.clamped:
            return 0.0, 0.75
        most = (self.p_e + self.elbow) ** 2 if self.long else 0.25 + (self.p_e * self.tilt) ** 2
        return -most, most

    @property
    def forearm(self) -> float:
        """Upper bound of |p_e - p_w|, which is d2 unless rounded lengths do not reach the target."""
        return math.sqrt((self.p_e + self.elbow) ** 2 + self.square) + 2 * self.ulp

    @property
    def p_e_words(self) -> float:
        """Upper bound of |p_e| computed from the rounded words p_e."""
        return math.sqrt(self.p_e**2 + self.square)


def off_length(c: Case, nodes: Mapping[str, Any], bounds: Mapping[str, Bound]) -> Case:
    """Return the case with bounds of the errors of p_e (``straight``) and |p_e|^2 (``square``).

    The root t = tmp_sqr in (13) may lose half of its digits, and so may p_e.  But |p_e|^2 = |a|^2 + t^2 |m|^2 contains
    only t^2, which is precise; a is along p_w, and m = PP^- / |PP^-|^2 is perpendicular to p_w.
    """
    root, inf, worst = bounds["tmp_sqr"], bounds["inf_pp"], 0.0
    if min(inf.low, inf.word[0]) <= 0:
        return c  # the division then raises RangeError
    for axis, m in zip("xyz", "123", strict=True):
        if f"e_{axis}_pp" not in bounds:  # not yet evaluated: use the first axis's bound
            axis, m = "x", max("123", key=lambda k: bounds[f"pp_{k}_m"].error)
        along = bounds[f"e_{axis}_pp"].error + root.word[1] * bounds[f"pp_{m}_m"].error
        num = along + nodes[f"e_{axis}_pp"].format.ulp
        worst = max(worst, (num + c.p_e * 1.1 * inf.error) / inf.word[0] + c.elbow)
    straight = SQRT3 * worst
    square = bounds["tmp1"].error + 2 * root.word[1] * nodes["tmp_sqr"].format.ulp
    return replace(c, straight=straight, square=square / inf.low + 2 * straight * c.p_e * 1.1 + straight**2)


EDGES_P = (0.5, math.sqrt(0.5), 1.0, SQRT2, SQRT3)
EDGES_B = (0.5, math.sqrt(0.5), 1.0, SQRT2)
"""Boundaries that divide the ranges of |p_w| and |b| into parts; quotients have tighter bounds in a narrow part."""


def cases(width: int) -> list[Case]:
    """Return the parts of the input domain; together they contain every target."""
    ulp = 2.0 ** (1 - width)
    last = 1 - 2 * ulp  # d1 + d2 <= 1 - ulp, d2 >= ulp
    whole = [
        Case("exact", False, last, (0, width - 1)),
        Case("long", False, 0.5, (0, width), True),
        Case("clamped", True, 0.25, (2, 2)),
    ]
    boxes = list(itertools.product(itertools.pairwise(EDGES_P), itertools.pairwise(EDGES_B)))
    return [replace(c, p=p, b=b, ulp=ulp) for c in whole for p, b in boxes]


Limits = tuple[float, float]
ANYTHING = -math.inf, math.inf


@dataclass(frozen=True)
class Within:
    """Range [low, high] of a node in exact arithmetic, from geometry; ``why`` is the reason.

    ``below``: the value stays below ``high``, and so does its word, which is exact or truncated.
    """

    low: float
    high: float
    why: str
    below: bool = False


@dataclass(frozen=True)
class Rule:
    """Rule for one node of the paper datapath in each :class:`Case`.  ``limit`` narrows the range computed from the
    operands, and ``why`` is the reason.  ``word`` is the range of the rounded word.  ``error`` is an upper limit for
    the error computed from the operands."""

    why: str
    limit: Callable[[Case], Limits]
    word: Callable[[Case], Limits] = lambda case: ANYTHING
    error: Callable[[Case], float] = lambda case: math.inf


class Given(Rule):
    """Range of an exact word that its operands' ranges do not bound: a count, or a word that wraps where it is unused.
    ``limit`` is the permitted part of the word's format."""


@dataclass(frozen=True)
class Growth:
    """Error growth of an operation: the largest of the operands' errors, or their sum if ``added``.  Each error is
    multiplied by its gain (default 1).  Unless ``exact``, rounding adds an ulp.  Masks and counts have no error and no
    entry in ``gains``."""

    gains: tuple[float, ...] = ()
    added: bool = False
    exact: bool = False

    def __call__(self, errors: Sequence[float], ulp: float) -> float:
        """Return the error of the result from the operands' errors."""
        grown = [gain * error for gain, error in zip(self.gains, errors, strict=True)] if self.gains else errors
        return (sum(grown) if self.added else max(grown)) + (0.0 if self.exact else ulp)


@dataclass(frozen=True)
class Limited:
    """Intended saturation at the end of the format; ``why`` is the reason.  ``clamped``: only for clamped targets."""

    why: str
    clamped: bool = False


SAME = Growth(exact=True)  # growth of a selection: the result is one of the operands

SUM = Growth(added=True, exact=True)


def upto(size: Callable[[Case], float]) -> Callable[[Case], Limits]:
    """Return a function: case -> range [-size, size]."""
    return lambda c: (-size(c), size(c))


def used(limit: Callable[[Case], Limits]) -> Callable[[Case], Limits]:
    """Return the function ``limit``, but without a range for clamped targets: their word is unused and may wrap."""
    return lambda c: ANYTHING if c.clamped else limit(c)


def not_negative(c: Case) -> Limits:
    """Return the range of a word that rounding never makes negative."""
    return 0.0, math.inf


def leading(most: int) -> Given:
    """Return the range of a count of leading sign bits."""
    return Given("leading sign bits", lambda case: (0, most))
