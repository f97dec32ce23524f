# SPDX-License-Identifier: Apache-2.0
"""Primitives of the bit-true model against independent arithmetic: APyTypes, Python integers, ``math``.

Model and RTL could share an error; the references used here share nothing with either.
"""

import math
from fractions import Fraction

import numpy as np
from apytypes import APyFixed, APyFixedArray, OverflowMode, QuantizationMode
from hypothesis import example, given
from hypothesis import strategies as st

from model.dataflow.fixed import Bits, floor_div, floor_root, round_shift
from model.dataflow.nodes import Format
from model.dataflow.operations import TILE, cuts, mul3, mul3_error, unseen

ROOT_LIMIT = 1 << 63
"""Upper bound of floor_root's arguments; none in the datapath reaches 2^62."""


def signed(width: int):
    return st.integers(-(1 << width - 1), (1 << width - 1) - 1)


def to_signed(value: APyFixed) -> int:
    half = 1 << value.bits - 1
    return (value.to_bits() + half) % (2 * half) - half


# ---- rounding --------------------------------------------------------------------------------------------------------


@given(signed(64), st.integers(0, 40))
@example(1, 1)  # ties, on either side of 0
@example(-1, 1)
@example(3, 1)
@example(-3, 1)
@example(-(1 << 63), 40)
def test_round_shift_is_apytypes_round_half_up(value, shift):
    word = APyFixed(value % (1 << 64), int_bits=64 - shift, frac_bits=shift)
    rounded = word.cast(int_bits=66, frac_bits=0, quantization=QuantizationMode.RND)
    assert round_shift(value, shift) == to_signed(rounded)


# ---- products and sums of the dataflow -------------------------------------------------------------------------------

W = 16  # word length of these nodes; no operation depends on it


def node(bits: Bits, name: str, words, fmt: Format):
    return bits.make(name, "input", (), fmt, None, np.array(words, dtype=np.int64))


def apy(words, fmt: Format) -> APyFixedArray:
    mask = (1 << fmt.width) - 1
    return APyFixedArray([w & mask for w in words], int_bits=fmt.width - fmt.frac, frac_bits=fmt.frac)


def narrowed(value: APyFixedArray, fmt: Format) -> tuple[list[int], list[bool]]:
    """Return the value rounded and saturated to ``fmt`` by APyTypes; and a mask of saturated elements."""
    cast = {"int_bits": fmt.width - fmt.frac, "frac_bits": fmt.frac, "quantization": QuantizationMode.RND}
    words = value.cast(**cast, overflow=OverflowMode.SAT)
    wide = value.cast(**{**cast, "int_bits": value.int_bits + 2 + fmt.width})
    half, wide_half = 1 << words.bits - 1, 1 << wide.bits - 1
    saturated = [(int(v) + half) % (2 * half) - half for v in words.to_bits()]
    exact = [(int(v) + wide_half) % (2 * wide_half) - wide_half for v in wide.to_bits()]
    return saturated, [s != e for s, e in zip(saturated, exact, strict=True)]


PAIRS = st.lists(st.tuples(signed(W), signed(W)), min_size=1, max_size=20)
TRIPLES = st.lists(st.tuples(signed(W), signed(W), signed(W)), min_size=1, max_size=20)
ENDS = [-(1 << W - 1), -1, 0, 1, (1 << W - 1) - 1]


@given(PAIRS, st.integers(-1, 3), st.booleans(), st.integers(0, 1))
@example([(a, b) for a in ENDS for b in ENDS], 0, True, 0)
@example([(a, b) for a in ENDS for b in ENDS], -1, True, 1)
def test_product_is_apytypes_product(pairs, integer_bits, narrow, scale):
    a, b = zip(*pairs, strict=True)
    bits = Bits(W)
    fmt = bits.word(integer_bits) if narrow else bits.wide(integer_bits)
    result = bits.mul("q", node(bits, "a", a, bits.word(1)), node(bits, "b", b, bits.word(0)), fmt, scale=scale)
    # times 2^scale: the same bits with the point moved
    left = Format(W, bits.word(1).frac - scale, "")
    words, saturated = narrowed(apy(a, left) * apy(b, bits.word(0)), fmt)
    assert result.value.tolist() == words
    assert bits.overflow["q"].tolist() == saturated


@given(TRIPLES, st.integers(-2, 3), st.booleans(), st.booleans(), st.booleans())
@example([(a, b, c) for a in ENDS for b in ENDS for c in ENDS], 0, True, True, True)
@example([(a, b, c) for a in ENDS for b in ENDS for c in ENDS], 2, False, True, True)
def test_sum_is_apytypes_sum(triples, integer_bits, minus_b, minus_c, three):
    bits = Bits(W)
    terms = [
        node(bits, name, words, bits.word(0)) for name, words in zip("abc", zip(*triples, strict=True), strict=True)
    ]
    a, b, c = (apy(t.value.tolist(), t.format) for t in terms)
    signs = [terms[0], -terms[1] if minus_b else terms[1], -terms[2] if minus_c else terms[2]]
    total = a - b if minus_b else a + b
    if three:
        total = total - c if minus_c else total + c
    fmt = bits.word(max(integer_bits, 0))  # a sum never gains fraction bits
    result = bits.sum("q", *signs[: 3 if three else 2], fmt=fmt)
    words, saturated = narrowed(total, fmt)
    assert result.value.tolist() == words
    assert bits.overflow["q"].tolist() == saturated


# ---- division --------------------------------------------------------------------------------------------------------


NEAR_QUOTIENTS = st.tuples(st.integers(1, (1 << 31) - 1), signed(32), st.integers(-1, 1)).map(
    lambda drawn: ((drawn[0] * drawn[1] >> 22) + drawn[2], drawn[0])
)
"""n 2^22 / d next to an integer, where a float would be wrong."""


@given(st.one_of(st.tuples(signed(40), signed(32)), NEAR_QUOTIENTS))
@example((0, 0))
@example((-1, 0))
@example((1, -1))
@example((-(1 << 39), -(1 << 31)))
@example((-(1 << 39), 1))
@example(((1 << 39) - 1, 1))
@example((-1, (1 << 31) - 1))
def test_floor_div_is_the_floor_of_a_fraction(operands):
    """The floor, saturated; by the sign of n where d <= 0."""
    (n, d), fmt = operands, Format(32, 30, "")
    q = math.floor(Fraction(n << 22, d)) if d > 0 else fmt.low - 1 if n < 0 else fmt.high + 1
    expected = min(max(q, fmt.low), fmt.high)
    assert [int(v[0]) for v in floor_div(np.array([n]), np.array([d]), 22, fmt)] == [expected, q != expected]


# ---- square root -----------------------------------------------------------------------------------------------------

NEAR_SQUARES = st.tuples(st.integers(1, math.isqrt(ROOT_LIMIT)), st.integers(-1, 1)).map(
    lambda drawn: (drawn[0] ** 2 + drawn[1], 0)
)
"""Next to a square with more digits than a float."""


@given(st.one_of(st.tuples(signed(33), st.integers(0, 29)), NEAR_SQUARES))
@example((0, 0))
@example((-1, 29))
@example((-(1 << 32), 29))
@example(((1 << 32) - 1, 29))
@example((math.isqrt(ROOT_LIMIT) ** 2 + 1, 0))
@example(((1 << 62) - 1, 0))
@example((((1 << 31) - 1) ** 2 - 1, 0))
def test_floor_root_is_isqrt(operands):
    n, shift = operands
    assert int(floor_root(np.array([n]), shift)[0]) == (math.isqrt(n << shift) if n > 0 else 0)


# ---- product of three tiles ------------------------------------------------------------------------------------------


@st.composite
def factors(draw):
    """Draw factors, their widths, and a shift that keeps both low parts below the two extra bits."""
    widths = draw(st.integers(3, 35)), draw(st.integers(3, 35))
    tile = draw(st.sampled_from([TILE, 25, 16, 5]))
    least = 2 + max(map(sum, zip(cuts(*widths, tile), reversed(unseen(*widths, tile)), strict=True)))
    shift = draw(st.integers(least, max(least, 36)))
    return *(draw(signed(width)) for width in widths), shift, *widths, tile


@given(factors())
@example((-1, -1, 31, 33, 35, TILE))
@example((-(1 << 32), -(1 << 32), 30, 33, 33, TILE))
@example(((1 << 33) - 1, -(1 << 34), 33, 34, 35, TILE))
@example(((1 << 32) - 1, (1 << 33) - 1, 31, 33, 34, TILE))
@example((-1, (1 << 21) - 1, 20, 22, 22, TILE))
@example((-(1 << 24), (1 << 24) - 1, 23, 25, 25, 25))
def test_mul3_is_within_its_error(case):
    """Its bits are compared with their definition in tb/units/test_products.py."""
    a, b, shift, *widths = case  # widths and tile
    least, greatest = mul3_error(shift, *widths)
    assert Fraction(least) < mul3(a, b, shift, *widths) - Fraction(a * b, 1 << shift) <= Fraction(greatest)
