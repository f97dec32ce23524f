# SPDX-License-Identifier: Apache-2.0
"""Test primitives of the bit-true model against fractions and unlimited integers, which model and RTL do not use."""

import math
from fractions import Fraction
from itertools import product

import numpy as np
from hypothesis import example, given
from hypothesis import strategies as st

from model.dataflow.expressions import Sum
from model.dataflow.formats import Format
from model.dataflow.mul3 import TILE, cuts, mul3, mul3_error, unseen
from model.dataflow.nodes import Dataflow, Input, Node
from model.dataflow.paper_operations import Mul, Total, floor_div, floor_root

ROOT_LIMIT = 1 << 63  # upper bound of floor_root's arguments; none in the datapath reaches 2^62


def signed(width: int):
    return st.integers(-(1 << width - 1), (1 << width - 1) - 1)


def half_up(value: Fraction) -> int:
    return math.floor(value + Fraction(1, 2))


W = 16  # word length of these nodes; no operation depends on it
ENDS = [-(1 << W - 1), -1, 0, 1, (1 << W - 1) - 1]


FLOW = Dataflow(W)


def inputs(columns, *formats: Format) -> tuple[list[Node], dict[str, np.ndarray]]:
    """Return input nodes, and their words by name."""
    nodes = [Node(name, "", "", Input(), fmt, None, 0, FLOW) for name, fmt in zip("abc", formats, strict=False)]
    return nodes, {node.name: np.array(words, dtype=np.int64) for node, words in zip(nodes, columns, strict=True)}


def check(operation, fmt: Format, values: dict[str, np.ndarray], exact: list[Fraction]) -> None:
    """Assert that a node's words are the exact values, rounded half up and saturated, and check its overflow mask."""
    node = Node("q", "", "", operation, fmt, operation.latency, 0, FLOW)
    words = [half_up(value * 2**fmt.frac) for value in exact]
    assert node.evaluate(values).tolist() == [min(max(word, fmt.low), fmt.high) for word in words]
    assert operation.overflow(node, values).tolist() == [not fmt.low <= word <= fmt.high for word in words]


@given(st.lists(st.tuples(signed(W), signed(W)), min_size=1), st.integers(-1, 3), st.booleans(), st.integers(0, 1))
@example(list(product(ENDS, repeat=2)), 0, True, 0)
@example(list(product(ENDS, repeat=2)), -1, True, 1)
def test_product_is_rounded_and_saturated(pairs, integer_bits, narrow, scale):
    (a, b), values = inputs(zip(*pairs, strict=True), FLOW.word(1), FLOW.word(0))
    fmt = FLOW.word(integer_bits) if narrow else FLOW.wide(integer_bits)
    place = 2 ** (a.format.frac + b.format.frac - scale)
    check(Mul(a, b, scale), fmt, values, [Fraction(p * q, place) for p, q in pairs])


@given(
    st.lists(st.tuples(*[signed(W)] * 3), min_size=1), st.integers(0, 3), *[st.sampled_from((-1, 1))] * 2, st.booleans()
)
@example(list(product(ENDS, repeat=3)), 0, -1, -1, True)
@example(list(product(ENDS, repeat=3)), 2, 1, -1, True)
def test_sum_is_rounded_and_saturated(triples, integer_bits, b_sign, c_sign, three):
    nodes, values = inputs(zip(*triples, strict=True), *[FLOW.word(0)] * 3)
    terms = list(zip((1, b_sign, c_sign), nodes, strict=True))[: 2 + three]
    exact = [Fraction(i + b_sign * j + three * c_sign * k, 1 << W - 1) for i, j, k in triples]
    check(Total(Sum(*terms)), FLOW.word(integer_bits), values, exact)


NEAR_QUOTIENTS = st.tuples(st.integers(1, (1 << 31) - 1), signed(32), st.integers(-1, 1)).map(
    lambda drawn: ((drawn[0] * drawn[1] >> 22) + drawn[2], drawn[0])
)
"""(n, d) with n 2^22 / d close to an integer, so that floating point would give a wrong floor."""


@given(st.one_of(st.tuples(signed(40), signed(32)), NEAR_QUOTIENTS))
@example((0, 0))
@example((-1, 0))
@example((1, -1))
@example((-(1 << 39), -(1 << 31)))
@example((-(1 << 39), 1))
@example(((1 << 39) - 1, 1))
@example((-1, (1 << 31) - 1))
def test_floor_div_is_the_floor_of_a_fraction(operands):
    """Check the saturated floor; where d <= 0, the sign of n decides."""
    (n, d), fmt = operands, Format(32, 30, "")
    q = math.floor(Fraction(n << 22, d)) if d > 0 else fmt.low - 1 if n < 0 else fmt.high + 1
    expected = min(max(q, fmt.low), fmt.high)
    assert [int(v[0]) for v in floor_div(np.array([n]), np.array([d]), 22, fmt)] == [expected, q != expected]


NEAR_SQUARES = st.tuples(st.integers(1, math.isqrt(ROOT_LIMIT)), st.integers(-1, 1)).map(
    lambda drawn: (drawn[0] ** 2 + drawn[1], 0)
)
"""(n, shift) with n at most 1 from a square, which may have more bits than the mantissa of a double."""


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


@st.composite
def factors(draw):
    """Draw two factors, a shift, the factors' widths and a tile; the mixed products reach down to the sum's LSB."""
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
    a, b, shift, *widths = case  # widths and tile
    least, greatest = mul3_error(shift, *widths)
    assert Fraction(least) < mul3(a, b, shift, *widths) - Fraction(a * b, 1 << shift) <= Fraction(greatest)


@given(factors())
@example((1, 4, 3, 5, 5, TILE))
@example((-1, 4, 3, 5, 5, TILE))
@example((-3, 4, 3, 5, 5, TILE))
@example((-(1 << 32), (1 << 32) - (1 << 15), 31, 33, 33, TILE))
def test_mul3_without_low_parts_rounds_half_up(case):
    a, b, shift, *widths = case
    a, b = (word >> bits << bits for word, bits in zip((a, b), cuts(*widths), strict=True))
    assert mul3(a, b, shift, *widths) == math.floor(Fraction(a * b, 1 << shift) + Fraction(1, 2))
