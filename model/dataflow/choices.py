# SPDX-License-Identifier: Apache-2.0
"""Selections, sign changes and sums of the lean dataflow and the whole arm, for which the folded program has special
steps.

The quaternion h(c, s) turns by the angle whose cosine is c and whose sine is s.  It is not normalized: (1 + c, s)/2, or
(s, 1 - c)/2 where c < 0.  The larger of its two parts, (1 + |c|)/2, is also its squared length.
"""

from fractions import Fraction
from functools import partial
from typing import Any

from .expressions import ANY, CHOICE, Floor, Function, Logic, Operation, Select, Sum, Term, Unary, number
from .nodes import Node


class Choice(Unary):
    """Expression for which the lowering's ``method``, with the node and ``given``, adds special folded steps."""

    def __init__(self, expression: Term, method: str, *given: Any, operands: tuple = ()) -> None:
        super().__init__(expression)
        self.operands, self.method, self._given = operands or self.operands, method, given

    def lower(self, to, node):
        getattr(to, self.method)(node, *self._given)


class Free(Choice):
    """Choice that saturates or wraps by design, so proofs have no formula for it."""

    free = True


def _at_most(term: Term) -> Function:
    """Return a term that the node limits to the largest word of its format; only ``text`` shows the limit."""
    return Function(lambda words: words, "min({}, most)", term, formula="{}", level=CHOICE + 1)


def limited(raw: Term) -> Choice:
    """Return a word limited to the format of its node."""
    return Choice(_at_most(raw), "limit", raw)


def mantissa(value: Term, low: Term) -> Choice:
    """Return a word, times 4 where the mask ``low`` is set, limited to the format of its node."""
    return Choice(_at_most(Select(low, 4 * value, value)), "mantissa", value, low)


def signed(value: Term, negative: Term) -> Choice:
    """Return a result, negated where the mask is set."""
    return Choice(Select(negative, -value, value), "result", value, negative)


def elbow(value: Term, sign: int, clamp: Term, closed: Term, ends: tuple[int, int]) -> Choice:
    """Return a word times ``sign``; for a clamped target, ``ends[0]`` if the arm is closed, else ``ends[1]``."""
    part = Select(clamp, Select(closed, *ends), value if sign > 0 else -value)
    return Choice(part, "elbow", value, sign)


# -- half angles -----------------------------------------------------------------------------------------------------


def _half_length(c: Term) -> Floor:
    return Floor((1 + abs(c)) / 2, c.frac)


def _halved(s: Term, none: Term | None = None) -> Term:
    half = Floor(s / 2, s.frac)
    return Select(none, 0, half) if none else half


def half_length(c: Term, unit: Term | None = None) -> Choice:
    """Return the squared length (1 + |c|)/2; 1 where the mask ``unit`` is set."""
    length = Select(unit, 1, _half_length(c)) if unit else _half_length(c)
    return Choice(length, "half_length", c, unit)


def half_part(c: Term, s: Term, large: Term, length: Term | None = None, none: Term | None = None) -> Choice:
    """Return a part of h: the squared length where ``large`` holds, else half the sine, or 0 where ``none`` is set.

    Without the node ``length`` the part computes the squared length itself.
    """
    part = Select(large, length or _half_length(c), _halved(s, none))
    return Choice(part, "half_part", c, s, large, none)


def half_sum(length: Term, s: Term, none: Term, sign: int) -> Choice:
    """Return the squared length plus or minus half the sine, or without the sine where the mask ``none`` is set."""
    total = Sum((1, length), (sign, _halved(s, none)))
    return Choice(total, "half_sum", length, s, sign)


def add_sub(whole: Term, part: Term, add: Term) -> Choice:
    """Return ``whole`` minus ``part``; their sum where the mask ``add`` is set."""
    total = Select(add, whole + part, whole - part)
    return Choice(total, "add_sub", whole, part, add)


# -- the whole arm ---------------------------------------------------------------------------------------------------


class WrappedSum(Sum):
    """a + b without the bits above the format."""

    def __init__(self, a: Term, b: Term) -> None:
        super().__init__((1, a), (1, b))

    def facts(self, node, domain):
        total = self.formula(domain)
        end, turn = (number(2 * side * -node.format.low * node.format.ulp) for side in (Fraction(1, 2), 1))
        wrapped = f"(ite (< {total} (- {end})) (+ {total} {turn}) {total})"
        return [f"(= {node.name} (ite (<= {end} {total}) (- {total} {turn}) {wrapped}))"]

    def lower(self, to, node):
        to.plus(node, *self.parts)


def replaced(word: Term, mask: Term, constant: int) -> Choice:
    """Return a word, or the constant 0 or 1 where the mask is set."""
    return Choice(Select(mask, constant, word), "replaced", word, mask, constant)


def wrist(point: Term, off: Term) -> Free:
    """Return a coordinate of the wrist, saturated: ``point`` of the hand minus the tool's offset, 2 ``off``."""
    return Free(point - 2 * off, "wrist", point, off)


def rounded_sum(a: Term, b: Term, sign: int) -> Choice:
    """Return a result of the whole arm: -a + b or -a - b, where a and b are products."""
    return Choice(Sum((sign, b), (-1, a)), "rounded_sum", a, b, sign, operands=(a, b))


def joint(s: Term, d: Term, sign: int, turned: tuple[Term, ...]) -> Free:
    """Return s + d or s - d, two angles, plus half a turn where an odd number of the masks ``turned`` is set."""
    total = Sum((1, s), (sign, d), (1, Select(Logic("xor", ANY, *turned), -1, 0)))
    return Free(total, "joint", s, d, sign, turned)


def twice(half: Term, negated: Term) -> Free:
    """Return twice an angle, negated where the mask is set."""
    term = 2 * half
    return Free(Select(negated, -term, term), "twice", half, negated)


def outside(angle, low: int, high: int, width: int):
    """Return a mask of the angles, words with one turn = 2^width, that lie outside the arc from ``low`` to ``high``."""
    turn = (1 << width) - 1
    return (angle - low & turn) > (high - low & turn)


class Outside(Function):
    """Mask of angles outside the arc from ``low`` to ``high``."""

    def __init__(self, angle: Node, low: int, high: int) -> None:
        mask = partial(outside, low=low, high=high, width=angle.format.width)
        super().__init__(mask, "{} outside its limits", angle, frac=0)

    def mask_registers(self, to, node):
        return {node.name}  # set after the joint's angle


class OutsideFormat(Operation):
    """Mask of wrists that have a coordinate outside the format of its node."""

    free = True

    def __init__(self, *wrists) -> None:
        super().__init__(*(operand for node in wrists for operand in node.operands))
        self.wrists = wrists

    def words(self, values):
        out = False
        for node in self.wrists:
            word = node.rounded(node.op.words(values))
            out = out | (word > node.format.high) | (word < node.format.low)
        return out

    def text(self, level=0):
        return f"{', '.join(node.name for node in self.wrists)} outside the format"

    def mask_registers(self, to, node):
        return to.wrist_registers()
