# SPDX-License-Identifier: Apache-2.0
"""What the dataflows say of a node besides how it is computed: :class:`Facts`, stated where the node is made."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from .interval_cases import Case

Limits = tuple[float, float]
ANYTHING = -math.inf, math.inf


@dataclass(frozen=True)
class Within:
    """What geometry says of a node in exact arithmetic: it lies in [low, high], and ``why``.

    ``below``: high is not reached, and the word is exact or cut off, never rounded up to it.
    """

    low: float
    high: float
    why: str
    below: bool = False


@dataclass(frozen=True)
class Rule:
    """The same of a node of the paper's datapath, case by case: ``limit`` narrows what the
    operands' ranges give, ``word`` the range of the word as it is rounded, ``error`` what the operands' errors give."""

    name: str
    why: str
    limit: Callable[[Case], Limits]
    word: Callable[[Case], Limits] = lambda case: ANYTHING
    error: Callable[[Case], float] = lambda case: math.inf


@dataclass(frozen=True)
class Given:
    """The range of an exact word whose operands' ranges say nothing of it, a count or what wraps where it is not used:
    the part of its format that ``limit`` leaves."""

    why: str
    limit: Callable[[Case], Limits]


@dataclass(frozen=True)
class Growth:
    """How errors come out of an operation: the largest of the operands' times ``gains`` (default: 1), or all of them
    ``added``; and an ulp, unless the operation is ``exact``."""

    gains: tuple[float, ...] = ()
    added: bool = False
    exact: bool = False

    def __call__(self, errors: Sequence[float], ulp: float) -> float:
        """The error of the result from those of the operands."""
        grown = [gain * error for gain, error in zip(self.gains, errors, strict=True)] if self.gains else errors
        return (sum(grown) if self.added else max(grown)) + (0.0 if self.exact else ulp)


@dataclass(frozen=True)
class Limited:
    """On purpose the end of its range stands for what is beyond it: ``why``; ``clamped``: of clamped targets only."""

    why: str
    clamped: bool = False


@dataclass(frozen=True)
class Facts:
    """What the dataflow says of a node besides how it is computed: its range and the reason for it, how errors come out
    of it, whether it is limited.  ``exact`` is for what a section computes itself, without an operator module: what the
    node holds after its latency, a Verilog expression of the section's own signals, of any length."""

    within: Within | Rule | Given | None = None
    grows: Growth = Growth()
    limited: Limited | None = None
    exact: str = ""


COSINE = Rule("cosine", "a sine or cosine", lambda c: (-1.0, 1.0))

SAME = Growth(exact=True)
"""What comes out is one of the operands."""

SUM = Growth(added=True, exact=True)


def upto(size: Callable[[Case], float]) -> Callable[[Case], Limits]:
    """No longer than that."""
    return lambda c: (-size(c), size(c))


def used(limit: Callable[[Case], Limits]) -> Callable[[Case], Limits]:
    """Of a word that is not used, and may wrap, of a clamped target."""
    return lambda c: ANYTHING if c.clamped else limit(c)


def not_negative(c: Case) -> Limits:
    """Of a word that rounding does not make negative."""
    return 0.0, math.inf


def leading(most: int) -> Given:
    """The range of a count of leading sign bits."""
    return Given("leading sign bits", lambda case: (0, most))
