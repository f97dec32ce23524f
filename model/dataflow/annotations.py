# SPDX-License-Identifier: Apache-2.0
"""Annotations of a node beyond its computation: :class:`Facts`, stated where the node is created."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from .interval_cases import Case

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
    """Range of a paper-datapath node, case by case: ``limit`` narrows the result of the operands' ranges, ``word`` is
    the range of the rounded word, ``error`` limits the result of the operands' errors."""

    name: str
    why: str
    limit: Callable[[Case], Limits]
    word: Callable[[Case], Limits] = lambda case: ANYTHING
    error: Callable[[Case], float] = lambda case: math.inf


@dataclass(frozen=True)
class Given:
    """Range of an exact word that its operands' ranges do not bound, a count or a word that wraps where it is unused:
    the part of its format permitted by ``limit``."""

    why: str
    limit: Callable[[Case], Limits]


@dataclass(frozen=True)
class Growth:
    """Error growth of an operation: the largest operand error times ``gains`` (default: 1), or the sum if ``added``;
    plus an ulp, unless the operation is ``exact``."""

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


@dataclass(frozen=True)
class Facts:
    """Annotations of a node beyond its computation: its range with the reason, its error growth, its saturation."""

    within: Within | Rule | Given | None = None
    grows: Growth = Growth()
    limited: Limited | None = None


COSINE = Rule("cosine", "a sine or cosine", lambda c: (-1.0, 1.0))

SAME = Growth(exact=True)
"""Growth of a selection: the result is one of the operands."""

SUM = Growth(added=True, exact=True)


def upto(size: Callable[[Case], float]) -> Callable[[Case], Limits]:
    """Return limits of at most ``size`` in magnitude."""
    return lambda c: (-size(c), size(c))


def used(limit: Callable[[Case], Limits]) -> Callable[[Case], Limits]:
    """Return ``limit`` for a word that is unused, and may wrap, for clamped targets."""
    return lambda c: ANYTHING if c.clamped else limit(c)


def not_negative(c: Case) -> Limits:
    """Return the limits of a word that rounding does not make negative."""
    return 0.0, math.inf


def leading(most: int) -> Given:
    """Return the range of a count of leading sign bits."""
    return Given("leading sign bits", lambda case: (0, most))
