# SPDX-License-Identifier: Apache-2.0
"""Selections, sign changes and sums of the lean dataflow and the whole arm; the folded program has steps for them.

The quaternion h(c, s) is along half the angle with cosine c and sine s, but not normalized: (1 + c, s)/2, or
(s, 1 - c)/2 where c < 0.  The larger of its parts, (1 + |c|)/2, is its squared length.
"""

from fractions import Fraction

from .expressions import SCALED, Constant, Floor, Operation, Scaled, Select, Sum, Term, Xor, number


class Defined(Operation):
    """An operation that an expression defines."""

    def __init__(self, expression: Term) -> None:
        super().__init__(*expression.leaves)
        self.expression, self.frac = expression, expression.frac

    def words(self, values):
        return self.expression.words(values)

    def real(self, values):
        return self.expression.real(values)

    def formula(self, domain):
        return self.expression.formula(domain)

    def text(self, level=0):
        return self.expression.text(level)


class Product(Operation):
    """Exact product."""

    def __init__(self, a: Term, b: Term) -> None:
        super().__init__(a, b)
        self.frac = a.frac + b.frac

    def words(self, values):
        a, b = (part.words(values) for part in self.parts)
        return a * b

    def real(self, values):
        a, b = (part.real(values) for part in self.parts)
        return a * b

    def formula(self, domain):
        return f"(* {' '.join(part.formula(domain) for part in self.parts)})"

    def text(self, level=0):
        a, b = (part.text(SCALED) for part in self.parts)
        return f"{a}^2" if a == b else f"{a} * {b}"

    def lower(self, to, node):
        to.exact_product(node, *self.parts)


def square(a: Term) -> Product:
    """Return a^2, exactly."""
    return Product(a, a)


class WrappedSum(Defined):
    """a + b without the bits above the format."""

    def __init__(self, a: Term, b: Term) -> None:
        super().__init__(a + b)

    def facts(self, node, domain):
        total = self.formula(domain)
        end, turn = (number(2 * side * -node.format.low * node.format.ulp) for side in (Fraction(1, 2), 1))
        wrapped = f"(ite (< {total} (- {end})) (+ {total} {turn}) {total})"
        return [f"(= {node.name} (ite (<= {end} {total}) (- {total} {turn}) {wrapped}))"]

    def lower(self, to, node):
        to.wrapped_sum(node, *self.operands)


class AtMost(Defined):
    """A word, at most the largest of the node's format, which real values do not reach."""

    def __init__(self, raw: Term) -> None:
        super().__init__(raw)

    def text(self, level=0):
        return f"min({self.expression.text()}, most)"

    def lower(self, to, node):
        to.limit(node, self.expression)


class Mantissa(Defined):
    """A word times 4 where the mask is set, at most the largest of the node's format."""

    def __init__(self, value: Term, low: Term) -> None:
        super().__init__(Select(low, 4 * value, value))
        self.value, self.low = value, low

    def text(self, level=0):
        return f"min({self.expression.text()}, most)"

    def lower(self, to, node):
        to.mantissa(node, self.value, self.low)


class Signed(Defined):
    """A word times a power of two, negated where the mask is set."""

    def __init__(self, value: Term, negative: Term, power: int = 0) -> None:
        term = Scaled(value, power) if power else value
        super().__init__(Select(negative, -term, term))
        self.value, self.negative, self.power = value, negative, power

    def lower(self, to, node):
        to.result(node, self.value, self.negative)


class Elbow(Defined):
    """A word times a sign; 1, 0 or -1 where the elbow is clamped: ``closed`` or ``straight``."""

    def __init__(self, value: Term, clamp: Term, fold: Term, sign: int, closed: int, straight: int) -> None:
        super().__init__(Select(clamp, Select(fold, closed, straight), value if sign > 0 else -value))
        self.value, self.sign = value, sign

    def lower(self, to, node):
        to.elbow(node, self.value, self.sign)


# -- half angles -----------------------------------------------------------------------------------------------------


def half_length(c: Term) -> Floor:
    """Return (1 + |c|)/2."""
    return Floor((1 + abs(c)) / 2, c.frac)


def halved(s: Term) -> Floor:
    """Return half a sine."""
    return Floor(s / 2, s.frac)


class HalfLength(Defined):
    """Squared length (1 + |c|)/2; 1 where the mask is set."""

    def __init__(self, c: Term, unit: Term | None = None) -> None:
        super().__init__(Select(unit, 1, half_length(c)) if unit else half_length(c))
        self.c, self.unit = c, unit

    def lower(self, to, node):
        to.half_length(node, self.c, self.unit)


class HalfPart(Defined):
    """Part of h: the squared length where ``large`` holds, else half the sine, or 0 where ``none`` is set.

    Without ``length`` the part does not wait for the squared length.
    """

    def __init__(self, c: Term, s: Term, large: Term, length: Term | None = None, none: Term | None = None) -> None:
        small: Term = Select(none, 0, halved(s)) if none else halved(s)
        super().__init__(Select(large, length or half_length(c), small))
        self.c, self.s, self.large, self.none = c, s, large, none

    def lower(self, to, node):
        to.half_part(node, self.c, self.s, self.large, self.none)


class HalfSum(Defined):
    """Squared length plus or minus half the sine, or plus 0 where the mask is set."""

    def __init__(self, length: Term, s: Term, none: Term, sign: int) -> None:
        super().__init__(Sum((1, length), (sign, Select(none, 0, halved(s)))))
        self.length, self.s, self.sign = length, s, sign

    def lower(self, to, node):
        to.half_sum(node, self.length, self.s, self.sign)


class AddSub(Defined):
    """The first term minus the second; their sum where the mask is set."""

    def __init__(self, whole: Term, part: Term, add: Term) -> None:
        super().__init__(Select(add, whole + part, whole - part))
        self.whole, self.part, self.add = whole, part, add

    def lower(self, to, node):
        to.add_sub(node, self.whole, self.part, self.add)


# -- the whole arm ---------------------------------------------------------------------------------------------------


class Replaced(Defined):
    """A word; where the mask is set, a constant, 0 or 1."""

    def __init__(self, word: Term, mask: Term, constant: int) -> None:
        super().__init__(Select(mask, constant, word))
        self.word, self.mask, self.constant = word, mask, constant

    def lower(self, to, node):
        to.replaced(node, self.word, self.mask, self.constant)


class Free(Defined):
    """An expression whose words saturate or wrap by design: no formula states it."""

    def facts(self, node, domain):
        return []


class Wrist(Free):
    """Coordinate of the wrist: of the hand's point, less twice half the tool's offset; saturated."""

    def __init__(self, point: Term, off: Term) -> None:
        super().__init__(point - 2 * off)
        self.point, self.off = point, off

    def lower(self, to, node):
        to.wrist(node, self.point, self.off)


class RoundedSum(Defined):
    """Sum of two products that becomes a result: -a, plus or minus b."""

    def __init__(self, a: Term, b: Term, sign: int) -> None:
        super().__init__(Sum((sign, b), (-1, a)))
        self.operands = self.leaves = (a, b)
        self.a, self.b, self.sign = a, b, sign

    def formula(self, domain):
        return f"(- (* {number(self.sign)} {self.b.formula(domain)}) {self.a.formula(domain)})"

    def lower(self, to, node):
        to.rounded_sum(node, self.a, self.b, self.sign)


class Joint(Free):
    """Sum or difference of two angles, with half a turn more where an odd number of the masks is set."""

    def __init__(self, s: Term, d: Term, sign: int, turned: tuple[Term, ...]) -> None:
        half = Select(Xor(*turned), Constant(-1), 0)
        super().__init__(Sum((1, s), (sign, d), (1, half)))
        self.s, self.d, self.sign, self.turned = s, d, sign, turned

    def text(self, level=0):
        masks = " xor ".join(mask.text() for mask in self.turned)
        turn = f"half_turn * {masks if len(self.turned) == 1 else f'({masks})'}"
        return f"{self.s.text()} {'+' if self.sign > 0 else '-'} {self.d.text()} + {turn}"

    def lower(self, to, node):
        to.joint(node, self.s, self.d, self.sign, self.turned)


class Twice(Signed):
    """Twice an angle, negated where the mask is set."""

    def __init__(self, half: Term, negated: Term) -> None:
        super().__init__(half, negated, power=1)

    def facts(self, node, domain):
        return []

    def lower(self, to, node):
        to.twice(node, self.value, self.negative)


def outside(angle, low: int, high: int, width: int):
    """Return whether angles, words of a turn, are not on the arc from one word to another."""
    turn = (1 << width) - 1
    return (angle - low & turn) > (high - low & turn)


class Outside(Operation):
    """Whether an angle is not on the arc from one word to another."""

    def __init__(self, angle: Term, low: int, high: int) -> None:
        super().__init__(angle)
        self.low, self.high = low, high

    def words(self, values):
        angle = self.operands[0]
        return outside(angle.words(values), self.low, self.high, angle.format.width)

    def facts(self, node, domain):
        return []

    def text(self, level=0):
        return f"{self.operands[0].text()} outside its limits"

    def mask_registers(self, to, node):
        return {node.name}  # set after the joint's angle


class OutsideFormat(Operation):
    """Whether one of the wrist's coordinates does not fit the format of its node."""

    def __init__(self, *wrists) -> None:
        super().__init__(*(operand for node in wrists for operand in node.operands))
        self.wrists = wrists

    def words(self, values):
        out = False
        for node in self.wrists:
            word = node.rounded(node.op.words(values))
            out = out | (word > node.format.high) | (word < node.format.low)
        return out

    def facts(self, node, domain):
        return []

    def text(self, level=0):
        return f"{', '.join(node.name for node in self.wrists)} outside the format"

    def mask_registers(self, to, node):
        return to.wrist_registers()
