# SPDX-License-Identifier: Apache-2.0
"""Operations of the lean dataflow on words, integers or their real values."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .nodes import wrap


@dataclass(frozen=True)
class Addition:
    """The first operand plus ``sign`` times the second."""

    sign: int

    def __call__(self, a, b):
        return a + b if self.sign > 0 else a - b


@dataclass(frozen=True)
class Product:
    """The product of integers of any size; the square of a single operand."""

    operands: int

    def __call__(self, *factors):
        return factors[0].astype(object) * factors[-1]


plus, minus = Addition(1), Addition(-1)
times, square = Product(2), Product(1)


def half_up(words, drop: int):
    """Drop the last ``drop`` bits, rounding half up."""
    return (words + (1 << (drop - 1))) >> drop


@dataclass(frozen=True)
class Count:
    """Shift count of six bits: other counts times ``factors``, and a constant."""

    factors: tuple[int, ...]
    constant: int = 0

    def __call__(self, *counts):
        first, *others = (f * e for f, e in zip(self.factors, counts, strict=True))
        count = sum(others, first)
        return (count + self.constant if self.constant else count) & 63


@dataclass(frozen=True)
class Shift:
    """v 2^(power + sign count), truncated; for words (v 2^(left + sign count)) 2^-right, and its low ``width`` bits if
    ``width`` is given."""

    power: int
    sign: int
    left: int = 0
    right: int = 0
    width: int | None = None

    def __call__(self, v, count):
        if self.width is None:
            return (v << self.left) >> count + self.right if self.sign < 0 else v << self.left + count >> self.right
        return wrap(v.astype(object) << self.left + count >> self.right, self.width).astype(np.int64)

    def real(self, v, count):
        return v * 2.0 ** (self.power + self.sign * count)


@dataclass(frozen=True)
class Limit:
    """The smaller of a word and ``top``, which real values do not reach."""

    top: int

    def __call__(self, v):
        return np.minimum(v, self.top)

    def real(self, v):
        return v


@dataclass(frozen=True)
class Result:
    """Result: a word, negated where the mask is set, rounded."""

    drop: int

    def __call__(self, q, minus):
        return half_up(np.where(minus, -1, 1) * q, self.drop)

    def real(self, q, minus):
        return np.where(minus, -q, q)


@dataclass(frozen=True)
class Elbow:
    """Result: a word times ``sign``, rounded; ``folded`` or ``straight`` times ``one`` where the elbow is clamped."""

    drop: int
    sign: int
    folded: int
    straight: int
    one: int

    def __call__(self, v, clamp, fold):
        clamped = np.where(fold, self.folded, self.straight) * self.one
        return np.where(clamp, clamped, half_up(self.sign * v, self.drop))

    def real(self, v, clamp, fold):
        return np.where(clamp, np.where(fold, self.folded, self.straight), self.sign * v)


@dataclass(frozen=True)
class Mantissa:
    """A word shifted left by ``up`` bits, and by two more where the mask is set, but at most ``top``; as a real value,
    four times the word where the mask is set."""

    up: int
    top: int

    def __call__(self, t, low):
        return np.minimum(t << np.where(low, self.up + 2, self.up), self.top)

    def real(self, t, low):
        return np.where(low, 4 * t, t)


# h(c, s) is the quaternion of the rotation with cosine c and sine s, not normalized: (1 + c, s)/2, or (s, 1 - c)/2
# where c < 0.  The larger of its parts, (1 + |c|)/2, is its squared length.


@dataclass(frozen=True)
class HalfLength:
    """(1 + |c|)/2 of words of ``frac`` fraction bits; 1 where a mask is set."""

    frac: int

    def __call__(self, c, unit=False):
        return np.where(unit, 1 << self.frac, ((1 << self.frac) + magnitude(c)) >> 1)

    def real(self, c, unit=False):
        return np.where(unit, 1.0, (1 + abs(c)) / 2)


@dataclass(frozen=True)
class HalfPart:
    """Part of h: the squared length g where ``large`` of the cosine and masks holds, else half the sine, or 0 where
    ``none`` of the masks holds.  The part does not wait for g if it has its own ``length``."""

    large: Callable
    none: Callable | None = None
    length: HalfLength | None = None

    def __call__(self, g, c, s, *masks):
        g = self.length(c) if self.length else g
        small = np.where(self.none(*masks), 0, s >> 1) if self.none else s >> 1
        return np.where(self.large(c, *masks), g, small)

    def real(self, g, c, s, *masks):
        g = self.length.real(c) if self.length else g
        small = np.where(self.none(*masks), 0.0, s / 2) if self.none else s / 2
        return np.where(self.large(c, *masks), g, small)


@dataclass(frozen=True)
class PartSum:
    """The squared length plus ``sign`` times half the sine, or plus 0 where the mask is set."""

    sign: int

    def __call__(self, g, s, none):
        return g + self.sign * np.where(none, 0, s >> 1)

    def real(self, g, s, none):
        return g + self.sign * np.where(none, 0.0, s / 2)


@dataclass(frozen=True)
class Turned:
    """The first operand minus the second; their sum where the mask is set."""

    def __call__(self, whole, part, swap):
        return np.where(swap, whole + part, whole - part)


def magnitude(words):
    """Return |c| for c >= 0, and |c| - 1, the one's complement, for c < 0."""
    return np.where(words < 0, ~words, words)


def truth(mask):
    """Return a mask that ``~`` negates."""
    return np.asarray(mask).astype(bool)
