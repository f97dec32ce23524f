# SPDX-License-Identifier: Apache-2.0
"""Operations of the dataflows on words: helpers of both datapaths, and the lean datapath's operations by name.

Each function acts on integer words.  On :class:`Unrounded` words it computes the real value, because shifts then keep
all bits and :func:`round_shift`, :func:`saturate` and :func:`wrap` have no effect.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np


class Unrounded(np.ndarray):
    """Real values in ulps of their format, on which an operation on words does not round."""

    def __array_function__(self, function, types, arguments, options):
        result = super().__array_function__(function, types, arguments, options)
        return result.view(Unrounded) if isinstance(result, np.ndarray) else result

    def __lshift__(self, places):
        return self * 2.0 ** np.asarray(places)

    def __rshift__(self, places):
        return self * 2.0 ** -np.asarray(places)

    def __invert__(self):
        return np.logical_not(self) if self.dtype == bool else -self


def round_shift(words, shift: int):
    """Return words / 2^shift, rounded half up."""
    if isinstance(words, Unrounded) or not shift:
        return words >> shift
    return (words + (1 << (shift - 1))) >> shift


def saturate(words, high: int, low: int | None = None):
    """Return words limited to ``high`` and, if given, ``low``."""
    if isinstance(words, Unrounded):
        return words
    return np.minimum(words, high) if low is None else np.clip(words, low, high)


def wrap(words, width: int):
    """Return the low ``width`` bits as a signed word: only words of a clamped target lose bits here."""
    if isinstance(words, Unrounded):
        return words
    half = 1 << (width - 1)
    return ((words + half) & (2 * half - 1)) - half


def room(words, width: int):
    """Return the left shift that ``width``-bit words allow without overflow; ``width - 1`` for 0 and -1."""
    # frexp of an integer below 2^53 is exact: its exponent is the number of bits.
    return width - 1 - np.frexp(magnitude(words).astype(np.float64))[1].astype(np.int64)


def magnitude(words):
    """Return |c| for c >= 0, and |c| - 1, the one's complement, for c < 0."""
    return np.where(words < 0, ~words, words)


def truth(mask):
    """Return a mask that ``~`` negates."""
    return np.asarray(mask).astype(bool)


# ---- the lean datapath -----------------------------------------------------------------------------------------------


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
    """v 2^(left + sign count - right), truncated; a shift to the left keeps the low ``width`` bits."""

    sign: int
    left: int = 0
    right: int = 0
    width: int = 0

    def __call__(self, v, count):
        if self.sign < 0:
            return v << self.left >> count + self.right
        long = v if isinstance(v, Unrounded) else v.astype(object)
        return wrap(long << self.left + count >> self.right, self.width).astype(v.dtype)

    def power(self, v: int, result: int) -> int:
        """Return n of the value v 2^(n + sign count), for the fraction bits of v and of the result."""
        return self.left - self.right + v - result


@dataclass(frozen=True)
class Limit:
    """The smaller of a word and ``top``, which real values do not reach."""

    top: int

    def __call__(self, v):
        return saturate(v, self.top)


@dataclass(frozen=True)
class Result:
    """Result: a word, negated where the mask is set, rounded."""

    drop: int

    def __call__(self, q, minus):
        return round_shift(np.where(minus, -1, 1) * q, self.drop)


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
        return np.where(clamp, clamped, round_shift(self.sign * v, self.drop))


@dataclass(frozen=True)
class Mantissa:
    """A word shifted left by ``up`` bits, and by two more where the mask is set, but at most ``top``."""

    up: int
    top: int

    def __call__(self, t, low):
        return saturate(t << np.where(low, self.up + 2, self.up), self.top)


# h(c, s) is the quaternion of the rotation with cosine c and sine s, not normalized: (1 + c, s)/2, or (s, 1 - c)/2
# where c < 0.  The larger of its parts, (1 + |c|)/2, is its squared length.


@dataclass(frozen=True)
class HalfLength:
    """(1 + |c|)/2 of words of ``frac`` fraction bits; 1 where a mask is set."""

    frac: int

    def __call__(self, c, unit=False):
        return np.where(unit, 1 << self.frac, ((1 << self.frac) + magnitude(c)) >> 1)


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


@dataclass(frozen=True)
class PartSum:
    """The squared length plus ``sign`` times half the sine, or plus 0 where the mask is set."""

    sign: int

    def __call__(self, g, s, none):
        return g + self.sign * np.where(none, 0, s >> 1)


@dataclass(frozen=True)
class Turned:
    """The first operand minus the second; their sum where the mask is set."""

    def __call__(self, whole, part, swap):
        return np.where(swap, whole + part, whole - part)
