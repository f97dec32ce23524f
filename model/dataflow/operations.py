# SPDX-License-Identifier: Apache-2.0
"""Operations of the dataflows on words: helpers of both datapaths, and the lean datapath's operations by name.

Each function acts on integer words: int64 arrays, or object arrays of Python integers where a word exceeds 64 bits.  On
:class:`Unrounded` words it computes the real value, because shifts then keep all bits and :func:`round_shift`,
:func:`saturate` and :func:`wrap` have no effect.
"""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

TILE = 18
"""Default tile: bits of the longer operand of the multipliers into which products are split."""


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


# ---- product of three tiles ------------------------------------------------------------------------------------------


def cuts(a_width: int, b_width: int, tile: int = TILE) -> tuple[int, int]:
    """Return the bits below the cut of either operand of :func:`mul3`: ``tile`` bits of a lie above it, and
    at most 18 bits of b."""
    return max(a_width - tile, 0), max(b_width - min(tile, 18), 0)


def unseen(a_width: int, b_width: int, tile: int = TILE) -> tuple[int, int]:
    """Return the number of low bits of either operand beyond two signed tiles, which :func:`mul3` ignores."""
    return max(a_width - 2 * tile + 1, 0), max(b_width - 2 * min(tile, 18) + 1, 0)


def mul3(a, b, shift: int, a_width: int, b_width: int, tile: int = TILE):
    """Compute ``ik_mul3``: a b / 2^shift from three tiles, rounded half up; the tile of the low parts is only
    estimated.

    Each tile is truncated two bits below the result's ulp; the rounding constant enters as a carry into each of the two
    sums.  Where the LSB of the highest tile lies above these two bits, the product of the two highest bits of both low
    parts fills the gap.  Errors: :func:`mul3_error`.
    """
    a_unseen, b_unseen = unseen(a_width, b_width, tile)
    a, b, shift = a >> a_unseen, b >> b_unseen, shift - a_unseen - b_unseen
    a_bits, b_bits = cuts(a_width - a_unseen, b_width - b_unseen, tile)
    a_hi, a_lo = a >> a_bits, a & ((1 << a_bits) - 1)
    b_hi, b_lo = b >> b_bits, b & ((1 << b_bits) - 1)
    drop = shift - 2
    mid = (a_hi * b_lo >> drop - a_bits) + (a_lo * b_hi >> drop - b_bits) + 1
    up = a_bits + b_bits - drop
    if up > 0:
        guess = (4 * a_lo >> a_bits) * (4 * b_lo >> b_bits)
        outer = (a_hi * b_hi << up) + (guess << up >> 4)
    else:
        outer = a_hi * b_hi >> -up
    return outer + mid + 1 >> 2


def mul3_error(shift: int, a_width: int, b_width: int, tile: int = TILE) -> tuple[float, float]:
    """Return the least and greatest error of :func:`mul3`, in ulps of the result.

    The omitted tile is nonnegative and less than 2^(cuts - shift) ulps, of which the estimate leaves 7/16; each mixed
    tile loses less than a quarter.  All other truncated bits lie below the words of the sum and belong to the rounding,
    which is half up.  Ignored bits contribute at most one of their places times the other word.
    """
    out = unseen(a_width, b_width, tile)
    aside = sum(2.0 ** (bits + other - 1 - shift) for bits, other in zip(out, (b_width, a_width), strict=True) if bits)
    low = cuts(a_width - out[0], b_width - out[1], tile)
    up = sum(low) - shift + sum(out) + 2
    left_out = 2.0 ** (up - 2) * (7 / 16 if up > 0 else 1) if all(low) else 0.0
    return -left_out - 1 - aside, 0.5 + aside


# ---- normalization by an even shift ----------------------------------------------------------------------------------


def bit_length(words):
    """Return the bits of unsigned words of up to 64 bits, 0 for 0."""
    high = words >> np.uint64(32)
    # frexp of an integer below 2^53 is exact: its exponent is the number of bits.
    _, bits = np.frexp(np.where(high, high, words).astype(np.float64))
    return bits + 32 * (high > 0)


def even(value, width: int, mantissa_bits: int):
    """Compute ``ik_even``: (k, m), leading zero pairs of a word and floor(value 4^k / 2^(width-mantissa_bits)).

    As a fraction, m lies in [1/4, 1); 0 gives k = width/2 - 1 and m = 0.  ``width`` is even, and at most 64.
    """
    value = np.asarray(value).astype(np.uint64)
    k = (width - np.maximum(bit_length(value), 1)).astype(np.int64) // 2
    right = width - mantissa_bits - 2 * k
    down, up = (np.maximum(n, 0).astype(np.uint64) for n in (right, -right))
    return k, ((value >> down) << up).astype(np.int64)


# ---- the lean datapath, by name --------------------------------------------------------------------------------------

# A node fixes the parameters after the words: partial(limit, top=7).  The fold datapath and the proofs have a method of
# the same name for each operation.


def operation(words: Callable) -> tuple[str, dict[str, Any]]:
    """Return the name of a node's operation, and its parameters."""
    return (words.func.__name__, words.keywords) if isinstance(words, partial) else (words.__name__, {})


def plus(a, b):
    return a + b


def minus(a, b):
    return a - b


def times(a, b):
    return a * b


def square(a):
    return times(a, a)


def count(*counts, factors: tuple[int, ...], constant: int = 0):
    """Return a shift count of six bits: other counts times ``factors``, and a constant."""
    first, *others = (f * e for f, e in zip(factors, counts, strict=True))
    total = sum(others, first)
    return (total + constant if constant else total) & 63


def shift_down(v, count, *, left: int = 0):
    """Return v 2^(left - count), truncated."""
    return v << left >> count


def shift_up(v, count, *, width: int, left: int = 0, right: int = 0):
    """Return the low ``width`` bits of v 2^(left + count - right), truncated."""
    if isinstance(v, Unrounded):
        return v << left + count - right
    up = left + count - right
    shifted = v << np.maximum(up, 0)
    return wrap(shifted >> np.maximum(-up, 0) if right else shifted, width).astype(np.int64)


def limit(v, *, top: int):
    """Return the smaller of a word and ``top``, which real values do not reach."""
    return saturate(v, top)


def result(q, negative, *, drop: int):
    """Return a word, negated where the mask is set, rounded."""
    return round_shift(np.where(negative, -1, 1) * q, drop)


def elbow(v, clamp, fold, *, drop: int, sign: int, folded: int, straight: int, one: int):
    """Return a word times ``sign``, rounded; ``folded`` or ``straight`` times ``one`` where the elbow is clamped."""
    return np.where(clamp, np.where(fold, folded, straight) * one, round_shift(sign * v, drop))


def mantissa(t, low, *, up: int, top: int):
    """Return a word shifted left by ``up`` bits, and by two more where the mask is set, but at most ``top``."""
    return saturate(t << np.where(low, up + 2, up), top)


# h(c, s) is the quaternion of the rotation with cosine c and sine s, not normalized: (1 + c, s)/2, or (s, 1 - c)/2
# where c < 0.  The larger of its parts, (1 + |c|)/2, is its squared length.


def half_length(c, unit=False, *, frac: int):
    """Return (1 + |c|)/2 of words of ``frac`` fraction bits; 1 where the mask is set."""
    return np.where(unit, 1 << frac, ((1 << frac) + magnitude(c)) >> 1)


def half_part(g, c, s, *masks, large: Callable, none: Callable | None = None, frac: int = 0):
    """Return a part of h: the squared length g where ``large`` of the cosine and masks holds, else half the sine, or 0
    where ``none`` of the masks holds.  With ``frac`` the part has a length of its own and does not wait for g."""
    g = half_length(c, frac=frac) if frac else g
    small = np.where(none(*masks), 0, s >> 1) if none else s >> 1
    return np.where(large(c, *masks), g, small)


def part_sum(g, s, none, *, sign: int):
    """Return the squared length plus ``sign`` times half the sine, or plus 0 where the mask is set."""
    return g + sign * np.where(none, 0, s >> 1)


def turned(whole, part, swap):
    """Return the first operand minus the second; their sum where the mask is set."""
    return np.where(swap, whole + part, whole - part)


# ---- the whole arm, by name ------------------------------------------------------------------------------------------


def off_one(square, *, frac: int, places: int):
    """Return whether the root of a word is below 1 - 2^-places, or not below 1 + 2^-places."""
    one = 1 << frac
    even, odd = one + (one >> 2 * places), one >> places - 1
    return (square < even - odd) | (square >= even + odd)


def plus_wrapped(a, b, *, width: int):
    """Return the low ``width`` bits, at most 64, of a + b."""
    return a + b << 64 - width >> 64 - width


def chosen(word, mask, *, unit: int | None):
    """Return a word; where the mask is set, 0, or 2^unit."""
    return np.where(mask, 0 if unit is None else 1 << unit, word)


def half_row(a, b, *, signs: tuple[int, int], half: int, width: int):
    """Return the sum of two words with signs and a constant, in ``width`` bits."""
    return wrap(signs[0] * a + signs[1] * b + half, width)


def difference(point, off, *, up: int, drop: int):
    """Return point 2^up - off, rounded."""
    return round_shift((point << up) - off, drop)


def target(point, off, *, top: int, **shifts: int):
    """Return :func:`difference`, saturated."""
    return saturate(difference(point, off, **shifts), top, -top - 1)


def outside_format(*words, top: int, **shifts: int):
    """Return whether one of three differences, words in pairs, saturates."""
    found = [difference(*words[k : k + 2], **shifts) for k in (0, 2, 4)]
    return np.any([(v > top) | (v < -top - 1) for v in found], axis=0)


def four(*words, signs: tuple[int, ...]):
    """Return the sum of words with signs."""
    return sum(sign * word for sign, word in zip(signs, words, strict=True))


def two(a, b, *, sign: int, drop: int):
    """Return sign b - a, rounded."""
    return round_shift(sign * b - a, drop)


def joint(s, d, *turned, sign: int, drop: int, width: int):
    """Return s + sign d, rounded; half a turn more where one of the masks is set, but not both."""
    half = np.bitwise_xor.reduce(np.asarray(turned, dtype=np.int64)) << width - 1
    return wrap(round_shift(s + sign * d, drop) + half, width)


def twice(half, negated, *, drop: int, width: int):
    """Return 2 half, rounded; -2 half where the mask is set."""
    return wrap(round_shift(np.where(negated, -2, 2) * half, drop), width)


def outside(angle, *, low: int, high: int, width: int):
    """Return whether an angle is not on the arc from low to high."""
    turn = (1 << width) - 1
    return (angle - low & turn) > (high - low & turn)
