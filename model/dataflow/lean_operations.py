# SPDX-License-Identifier: Apache-2.0
"""Operations of the lean dataflow besides products and tables: normalization, shifts by counts, and choices.

Normalization is an even shift (``ik_even``).  In a formula, the name of a count n stands for 2^n, so that a shift is a
product.  The paper's dataflow also uses the shifts, and the whole arm's dataflow also uses the choices.

Choices are selections, sign changes and sums for which the folded program has special steps.  The quaternion h(c, s)
turns by the angle whose cosine is c and whose sine is s.  It is not normalized: it is (1 + c, s)/2, or (s, 1 - c)/2
where c < 0.  The larger of its two parts, (1 + |c|)/2, is also the squared length of h.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from .expressions import CHOICE, FLOOR, Floor, Function, Operation, Select, Sum, Term, Unary, magnitude, number, wrap

if TYPE_CHECKING:
    from .nodes import Node


def bit_length(words):
    """Return the number of significant bits of uint64 words; 0 for 0."""
    high = words >> np.uint64(32)
    # frexp of an integer below 2^53 is exact: its exponent is the number of bits.
    _, bits = np.frexp(np.where(high, high, words).astype(np.float64))
    return bits + 32 * (high > 0)


def room(words, width: int):
    """Return the left shift that ``width``-bit words allow without overflow; ``width - 1`` for 0 and -1."""
    return width - 1 - bit_length(magnitude(words).astype(np.uint64))


def even(value, width: int, mantissa_bits: int):
    """Return (k, m) as ``ik_even`` computes them: k, the number of leading zero pairs of a word, and the mantissa
    m = floor(value 4^k / 2^(width-mantissa_bits)).

    As a fraction, m lies in [1/4, 1).  The value 0 gives k = width/2 - 1 and m = 0.  ``width`` is even, at most 64.
    """
    value = np.asarray(value).astype(np.uint64)
    k = (width - np.maximum(bit_length(value), 1)).astype(np.int64) // 2
    right = width - mantissa_bits - 2 * k
    down, up = (np.maximum(n, 0).astype(np.uint64) for n in (right, -right))
    return k, ((value >> down) << up).astype(np.int64)


class Even(Operation):
    """Mantissa of the low ``width`` bits of a word, shifted left by pairs of bits until the first pair is not 0."""

    kind, latency, rounds = "even", "even", FLOOR
    count: Node
    mantissa: Node

    def __init__(self, value: Node, width: int) -> None:
        super().__init__(value)
        self.value, self.width = value, width

    def pair(self, node, values):
        """Return the words of the shift count and of the mantissa."""
        if self not in values:
            word = self.value.words(values)
            whole = word.dtype == np.int64 and self.width > 63
            values[self] = even(word if whole else word & (1 << self.width) - 1, self.width, node.format.width)
        return values[self]

    def result(self, node, values):
        return self.pair(node, values)[1]

    def real_result(self, node, values):
        up = 2 * self.count.words(values) - self.width + node.format.width
        return np.where(values.word(node.name) == 0, 0.0, self.value.words(values) * 2.0**up)

    def growth(self, node, bounds):
        return node.format.ulp

    def facts(self, node, domain):
        """Return the formulas of m = value * 4^e * 2^(frac - width), in [1/4, 1). For value = 0, m is 0 and e is
        largest."""
        m, value, count = node.name, self.value.formula(domain), self.count.name
        scale = number(2.0 ** (self.value.frac - self.width))
        most = number(2.0 ** (self.width // 2 - 1))
        return [
            f"(= {m} (* {scale} {value} {count} {count}))",
            f"(=> (< 0.0 {value}) (and (<= 0.25 {m}) (< {m} 1.0)))",
            f"(=> (= {value} 0.0) (and (= {m} 0.0) (= {count} {most})))",
        ]

    def text(self, level=0):
        return f"{self.value.text()} << 2 * {self.count.name}"

    def lower(self, to, node):
        to.even(node, self.value, self.count.name)


class EvenCount(Operation):
    """Number of pairs of bits by which :class:`Even` shifts."""

    kind, latency, pattern = "even", "even", "clz({}) / 2"

    def __init__(self, shifted: Even) -> None:
        super().__init__(shifted.value)
        self.shifted, self.most = shifted, shifted.width / 2 - 1  # the largest count

    def result(self, node, values):
        return self.shifted.pair(self.shifted.mantissa, values)[0]

    def facts(self, node, domain):
        return [f"(and (<= 1.0 {node.name}) (<= {node.name} {number(2.0**self.most)}))"]

    def lower(self, to, node):
        pass  # made by the mantissa's step


class Count(Operation):
    """Shift count of six bits: a constant plus other counts, each times a factor."""

    def __init__(self, *terms: tuple[int, Node], constant: int = 0) -> None:
        super().__init__(*(count for _, count in terms))
        self.terms, self.constant = terms, constant

    def words(self, values):
        return sum(factor * count.words(values) for factor, count in self.terms) + self.constant & 63

    def facts(self, node, domain):
        up = [count.name for factor, count in self.terms for _ in range(max(factor, 0))]
        down = [count.name for factor, count in self.terms for _ in range(max(-factor, 0))]
        total = " ".join([number(2.0**self.constant), *up])
        return [f"(= (* {' '.join([node.name, *down, '1.0'])}) (* {total} 1.0))", f"(< 0.0 {node.name})"]

    def text(self, level=0):
        first, *others = self.terms
        names = [f"{'' if first[0] == 1 else f'{first[0]} * '}{first[1].name}"]
        names += [f"{'+' if f > 0 else '-'} {f'{abs(f)} * ' * (abs(f) > 1)}{count.name}" for f, count in others]
        return " ".join(names) + f" + {self.constant}" * (self.constant > 0)

    def lower(self, to, node):
        to.counts[node.name] = self.constant, tuple((factor, count.name) for factor, count in self.terms)


class Shift(Operation):
    """Word v times 2^(power + sign * n), truncated.  n is a shift count; sign is 1 or -1."""

    sign: int

    def __init__(self, value: Node, count: Node, power: int = 0) -> None:
        super().__init__(value, count)
        self.value, self.count, self.power, self.frac = value, count, power, value.frac - power
        self.given = value, count.name, power
        self.smt, self.pattern = f"(* {number(2.0**power)} {{}} {{}})", f"{{}} * {_power(count, self.sign, power)}"

    def words(self, values):
        return self.value.words(values) * 2.0 ** (self.sign * self.count.words(values))


class ShiftUp(Shift):
    """Word v times 2^(power + n), truncated.  Bits above the format, set only for clamped targets, are dropped."""

    sign, method = 1, "shift_up"

    def result(self, node, values):
        up = node.frac - self.frac
        count, word = self.count.words(values), self.value.words(values)
        shifted = word << np.maximum(up + count, 0)
        if up < 0:
            shifted = shifted >> np.maximum(-up - count, 0)
        return wrap(shifted, node.format.width).astype(np.int64)


class ShiftDown(Shift):
    """Word v times 2^(power - n), truncated."""

    sign, method = -1, "shift_down"

    def result(self, node, values):
        return self.value.words(values) << node.frac - self.frac >> self.count.words(values)

    def facts(self, node, domain):
        return [f"(= (* {node.name} {self.count.name}) (* {number(2.0**self.power)} {self.value.formula(domain)}))"]


def _power(count: Node, sign: int, constant: int) -> str:
    """Return 2^(sign count + constant) as text."""
    if sign < 0 < constant:
        return f"2^({constant} - {count.name})"
    text = f"{'-' * (sign < 0)}{count.name}" + (f" {'+' if constant > 0 else '-'} {abs(constant)}" if constant else "")
    return f"2^{text}" if text.isidentifier() else f"2^({text})"


# -- choices -----------------------------------------------------------------------------------------------------------


class Choice(Unary):
    """Expression with special steps in the folded program: the lowering's ``method(node, *given)`` adds them.

    ``free``: True if the expression saturates or wraps by design, so that proofs have no formula for it.
    """

    def __init__(self, expression: Term, method: str, *given: Any, operands: tuple = (), free: bool = False) -> None:
        super().__init__(expression)
        self.operands, self.method, self.given, self.free = operands or self.operands, method, given, free


def _at_most(term: Term) -> Function:
    """Return ``term`` with a text that shows the limit: the largest word of the node's format."""
    return Function(lambda words: words, "min({}, most)", term, formula="{}", level=CHOICE + 1)


def limited(raw: Term) -> Choice:
    """Return the word ``raw``, limited to the format of its node."""
    return Choice(_at_most(raw), "limit", raw)


def mantissa(value: Term, low: Term) -> Choice:
    """Return ``value``, times 4 where the mask ``low`` is set, limited to the format of its node."""
    return Choice(_at_most(Select(low, 4 * value, value)), "mantissa", value, low)


def signed(value: Term, negative: Term) -> Choice:
    """Return the result word ``value``, negated where the mask ``negative`` is set."""
    return Choice(Select(negative, -value, value), "result", value, negative)


def elbow(value: Term, sign: int, clamp: Term, closed: Term, ends: tuple[int, int]) -> Choice:
    """Return ``value`` times ``sign``; for a clamped target, ``ends[0]`` if the arm is closed, else ``ends[1]``."""
    return Choice(Select(clamp, Select(closed, *ends), value if sign > 0 else -value), "elbow", value, sign)


# -- half angles -----------------------------------------------------------------------------------------------------


def _half_length(c: Term) -> Floor:
    return Floor((1 + abs(c)) / 2, c.frac)


def _halved(s: Term, none: Term | None = None) -> Term:
    half = Floor(s / 2, s.frac)
    return Select(none, 0, half) if none else half


def half_length(c: Term, unit: Term | None = None) -> Choice:
    """Return the squared length (1 + |c|)/2 of h(c, s); 1 where the mask ``unit`` is set."""
    return Choice(Select(unit, 1, _half_length(c)) if unit else _half_length(c), "half_length", c, unit)


def half_part(c: Term, s: Term, large: Term, length: Term | None = None, none: Term | None = None) -> Choice:
    """Return a part of h: the squared length where ``large`` holds, else half the sine, or 0 where ``none`` is set.

    The squared length is the node ``length`` or, if that is None, computed from ``c``.
    """
    return Choice(Select(large, length or _half_length(c), _halved(s, none)), "half_part", c, s, large, none)


def half_sum(length: Term, s: Term, none: Term, sign: int) -> Choice:
    """Return ``length`` plus or minus (``sign``) half the sine, or ``length`` alone where the mask ``none`` is set."""
    return Choice(Sum((1, length), (sign, _halved(s, none))), "half_sum", length, s, sign)


def add_sub(whole: Term, part: Term, add: Term) -> Choice:
    """Return ``whole`` minus ``part``; their sum where the mask ``add`` is set."""
    return Choice(Select(add, whole + part, whole - part), "add_sub", whole, part, add)
