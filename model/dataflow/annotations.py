# SPDX-License-Identifier: Apache-2.0
"""Annotations of a node beyond its computation, stated where the node is created.

Ranges of the paper datapath hold case by case: :mod:`model.bounds.ranges` runs the dataflow on parts of the input
words (:func:`cases`), each with geometric bounds on lengths; a node's range is their union:

* ``exact``: in reach, and the arms leave room for a shift: halving loses no bit of their words;
* ``long``: in reach, d1 + d2 >= 2: halving rounds odd lengths, so d1 + d2 is off by ulps (d1 - d2 stays exact);
* ``clamped``: everything else; computed as an arm d1 = d2 = 1/4 (see :func:`model.dataflow.paper.guard`).
"""

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

SQRT2, SQRT3 = math.sqrt(2), math.sqrt(3)


class RangeError(Exception):
    """Range or format that does not fit the node; the text names the node."""


@dataclass(frozen=True)
class Bound:
    """Exact arithmetic gives [low, high]; the word is within ``error`` of it and within [floor, ceiling], the
    operation's range on its operands' words."""

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
    """Part of the input domain: bounds of d1 and d2, of j in its unit, and of |p_w| and |b|."""

    name: str
    clamped: bool
    d_high: float  # of d1 and d2
    j: tuple[int, int]
    long: bool = False  # halving may round d1 and d2
    p: tuple[float, float] = (0.5, SQRT3)
    b: tuple[float, float] = (0.5, SQRT2)
    ulp: float = 0.0  # of d1 and d2
    elbow: float = 0.0  # an ulp of p_e
    tilt: float = 0.0  # sine of the angle between p_w and the plane of the words pi_swivel
    straight: float = 0.0  # distance of the words of p_e from a + t m of the words (model.dataflow.paper.off_length)
    square: float = 0.0  # distance of the words' |p_e|^2 from exact arithmetic

    def tilted(self, error: float) -> "Case":
        """Return the case with the words pi_swivel, which have an error of ``error``, taken as exact."""
        b = self.b[0] - error, self.b[1] + error
        return replace(self, b=b, tilt=error / b[0])

    @property
    def excess(self) -> float:
        """Increase of |k_e| by rounded lengths: the rounding of d1 + d2, times |d1 - d2|."""
        return 4 * self.ulp if self.long else 0.0

    @property
    def k_e(self) -> float:
        """|k_e| <= 2 d1 |p_w|, and <= s_j + (d1 + d2) |d_dif_j| where d1 and d2 are rounded."""
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

    @property
    def tmp1(self) -> tuple[float, float]:
        """(d1 sin a)^2 |PP^-|^2: |pi|^2 ((2 d1 |p_w|)^2 - k_e^2), where d1 and d2 are rounded."""
        most = (min(self.d_high, 0.5) * self.pp[1]) ** 2
        tilted = (self.pp[1] * self.p_e * self.tilt) ** 2
        if not self.long:
            return -tilted, most
        # from |k_e| <= 2 d1 |p_w| + excess, or from |k_e| alone
        near = 4 * self.d_high * self.p[1] * self.excess + self.excess**2
        # Where j >= 2, |d1 - d2| <= |p_a| + ulps leaves d1 >= 1/8.
        least = (self.p[0] / 4) ** 2 if self.j[0] >= 3 else 0.0
        return -(self.b[1] ** 2) * min(near, self.k_e**2 - least) - tilted, most

    @property
    def t_e(self) -> tuple[float, float]:
        """p_e (p_e - p_w): d1 d2 times a cosine."""
        if self.clamped:
            return 0.0, 0.75
        most = (self.p_e + self.elbow) ** 2 if self.long else 0.25 + (self.p_e * self.tilt) ** 2
        return -most, most

    @property
    def p_e_words(self) -> float:
        """Largest |p_e|, computed from the rounded words of p_e."""
        return math.sqrt(self.p_e**2 + self.square)


EDGES_P = (0.5, math.sqrt(0.5), 1.0, SQRT2, SQRT3)
EDGES_B = (0.5, math.sqrt(0.5), 1.0, SQRT2)
"""Boundaries of the lengths of the two mantissa vectors: within a part, numerators and divisors are correlated."""


def cases(width: int) -> list[Case]:
    """Return the parts of the input domain; together they contain every input word."""
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
    """Exact range of a node from geometry, [low, high], and the reason for it (``why``).

    ``below``: high is not reached, and the word is exact or truncated, never rounded up to it.
    """

    low: float
    high: float
    why: str
    below: bool = False


@dataclass(frozen=True)
class Rule:
    """Range of a paper-datapath node, case by case, and the reason (``why``): ``limit`` narrows the result of the
    operands' ranges, ``word`` is the range of the rounded word, ``error`` limits the result of the operands' errors."""

    why: str
    limit: Callable[[Case], Limits]
    word: Callable[[Case], Limits] = lambda case: ANYTHING
    error: Callable[[Case], float] = lambda case: math.inf


class Given(Rule):
    """Range of an exact word that its operands' ranges do not bound, a count or a word that wraps where it is unused:
    the part of its format permitted by ``limit``."""


@dataclass(frozen=True)
class Growth:
    """Error growth of an operation: the largest operand error times ``gains`` (default: 1), or the sum if ``added``;
    plus an ulp, unless the operation is ``exact``.  Masks and counts have no error and no gain."""

    gains: tuple[float, ...] = ()
    added: bool = False
    exact: bool = False

    def __call__(self, errors: Sequence[float], ulp: float) -> float:
        """Return the error of the result from the operands' errors."""
        grown = [gain * error for gain, error in zip(self.gains, errors, strict=True)] if self.gains else errors
        return (sum(grown) if self.added else max(grown)) + (0.0 if self.exact else ulp)


@dataclass(frozen=True)
class Limited:
    """Intended saturation at the end of the range, and the reason (``why``); ``clamped``: for clamped targets only."""

    why: str
    clamped: bool = False


COSINE = Rule("a sine or cosine", lambda c: (-1.0, 1.0))

SAME = Growth(exact=True)  # growth of a selection: the result is one of the operands

SUM = Growth(added=True, exact=True)


def upto(size: Callable[[Case], float]) -> Callable[[Case], Limits]:
    """Return the range [-size, size]."""
    return lambda c: (-size(c), size(c))


def used(limit: Callable[[Case], Limits]) -> Callable[[Case], Limits]:
    """Return the range ``limit``, but any value for clamped targets: there the word is unused and may wrap."""
    return lambda c: ANYTHING if c.clamped else limit(c)


def not_negative(c: Case) -> Limits:
    """Return the range of a word that rounding never makes negative."""
    return 0.0, math.inf


def leading(most: int) -> Given:
    """Return the range of a count of leading sign bits."""
    return Given("leading sign bits", lambda case: (0, most))
