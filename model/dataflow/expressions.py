# SPDX-License-Identifier: Apache-2.0
"""Expressions over nodes: sums, powers of two, selections and comparisons.

A term is a node, a constant or an expression of terms; its value is a number with ``frac`` fraction bits, or a mask.
Python's operators build expressions: ``cc - ss``, ``(d1 <= 0) | (d2 <= 0)``.  A term can be read in three ways:

* ``words(values)``: value in units of 2^-frac.  ``values`` maps node names to integers, which give the RTL's words, or
  to real numbers, which are never rounded.
* ``formula(domain)``: SMT-LIB over the reals.  ``domain``, of :mod:`tb.formal.lean_proofs`, supplies the names of nodes
  and the formulas of comparisons; it may raise :class:`FreeError`.
* ``text(level)``: right side of an equation, in parentheses if its binding strength is below the context's ``level``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from .nodes import Node

Values = Mapping[str, Any]  # node name -> array over targets

CHOICE, ANY, ALL, COMPARED, ADDED, SCALED, ATOM = range(7)
"""Binding strength of the operators in a text, weakest first."""

EXACT = (0.0, 0.0)
HALF_UP = (-0.5, 0.5)
FLOOR = (-1.0, 0.0)
JAM = (-1.0, 1.0)
"""Error range (low, high) of each rounding rule, in ulps of the result.  JAM sets the last bit if any dropped bit is
set, so no length becomes 0."""


class FreeError(Exception):
    """Comparison that needs more of a rounded word than its sign: proofs have no formula for it."""


def round_shift(words, shift: int):
    """Return words / 2^shift, rounded half up."""
    return (words + (1 << (shift - 1))) >> shift if shift else words


def wrap(words, width: int):
    """Return the low ``width`` bits as a signed word."""
    words = np.asarray(words)
    if words.dtype == np.int64:
        return words << 64 - width >> 64 - width
    half = 1 << (width - 1)
    return ((words + half) & (2 * half - 1)) - half


def integral(words) -> bool:
    """Return whether words are integers of up to 64 bits."""
    return np.asarray(words).dtype.kind == "i"


def magnitude(words):
    """Return the magnitudes of words; a negative integer c gives its one's complement, |c| - 1."""
    return np.where(words < 0, ~words, words) if integral(words) else np.abs(words)


def number(value: float | Fraction) -> str:
    """Return the exact number as SMT-LIB text."""
    exact = Fraction(value)
    size = f"{abs(exact.numerator)}.0"
    if exact.denominator > 1:
        size = f"(/ {size} {exact.denominator}.0)"
    return size if exact >= 0 else f"(- {size})"


class Term:
    """Node, constant or expression, with Python's operators."""

    frac: int = 0
    leaves: tuple[Node, ...] = ()  # nodes of the term, in the order in which the term reads them

    words: Callable[[Values], Any]
    formula: Callable[[Any], str]
    text: Callable[..., str]

    def __add__(self, other) -> Sum:
        return Sum(*_signed(self), *_signed(as_term(other)))

    def __radd__(self, other) -> Sum:
        return as_term(other) + self

    def __sub__(self, other) -> Sum:
        return Sum(*_signed(self), *((-sign, term) for sign, term in _signed(as_term(other))))

    def __rsub__(self, other) -> Sum:
        return as_term(other) - self

    def __neg__(self) -> Sum:
        return Sum((-1, self))

    def __rmul__(self, factor: int) -> Scaled:
        return Scaled(self, _power(factor))

    def __truediv__(self, divisor: int) -> Scaled:
        return Scaled(self, -_power(divisor))

    def __abs__(self) -> Function:
        """Return the magnitude; for a negative word, the one's complement, which is one ulp less."""
        return Function(magnitude, "|{}|", self, formula="(ite (< {0} 0.0) (- {0}) {0})")

    def __lt__(self, other) -> Compared:
        return Compared("<", self, as_term(other))

    def __le__(self, other) -> Compared:
        return Compared("<=", self, as_term(other))

    def __ge__(self, other) -> Compared:
        return Compared("<=", as_term(other), self)

    def __or__(self, other: Term) -> Logic:
        return Logic("or", ANY, self, other)

    def __and__(self, other: Term) -> Logic:
        return Logic("and", ALL, self, other)

    def __invert__(self) -> Function:
        return Function(np.logical_not, "not {}", self, formula="(not {})", level=COMPARED)


def as_term(value) -> Term:
    """Return a term unchanged, and a number as a constant."""
    return value if isinstance(value, Term) else Constant(value)


def zero(term: Term) -> Compared:
    """Return the comparison ``term = 0``."""
    return Compared("=", term, Constant(0))


def _power(factor: int) -> int:
    """Return the base-2 logarithm of a factor.  Raises ValueError if the factor is not a power of two."""
    if factor < 1 or factor & factor - 1:
        raise ValueError(f"{factor} is not a power of two")
    return factor.bit_length() - 1


def _signed(term: Term) -> tuple[tuple[int, Term], ...]:
    return term.terms if type(term) is Sum else ((1, term),)


def _aligned(values: Values, *terms: Term) -> list:
    """Return the words of the terms, all aligned to the longest fraction."""
    frac = max(term.frac for term in terms)
    return [term.words(values) * (1 << frac - term.frac) if term.frac < frac else term.words(values) for term in terms]


class Operation(Term):
    """Operation of a dataflow on the terms ``parts``.

    As a term, it has ``words``, ``formula`` and ``text``; the last two are by default the patterns ``smt`` and
    ``pattern``, in which braces stand for the parts.  The methods with the argument ``node`` also use the rounding and
    the format of that node, which the operation computes.
    """

    smt, pattern = "", ""
    level, inner = ATOM, CHOICE  # binding strength of the text, and of the context of the parts in it
    kind = "choose"
    latency: str | None = "mux"  # key of :class:`.formats.Latency`
    adds_rounding = False  # True: :meth:`growth` leaves out the rounding of this operation
    rounds: tuple[float, float] | None = None  # error range in ulps, if the operation rounds by a rule of its own
    free = False  # True: proofs have no formula for it
    method = ""  # name of the lowering's method for the operation; if empty, :meth:`lower` must be defined
    given: tuple[Any, ...] = ()  # arguments of the method, by default the parts
    parts: tuple[Any, ...]  # terms; some operations take nodes

    def __init__(self, *parts: Term) -> None:
        self.parts = parts
        self.operands = self.leaves = tuple(dict.fromkeys(node for part in parts for node in part.leaves))

    def formula(self, domain):
        return self.smt.format(*(part.formula(domain) for part in self.parts))

    def text(self, level=0):
        text = self.pattern.format(*(part.text(self.inner) for part in self.parts))
        return f"({text})" if level > self.level else text

    def error(self, node) -> tuple[float, float]:
        """Return the range (low, high) of the rounding error that the operation adds, in ulps of the node."""
        return self.rounds or node.rounding

    def result(self, node, values):
        """Return the node's words."""
        return node.narrowed(node.rounded(self.words(values)))

    def real_result(self, node, values):
        """Return the node's unrounded value in ulps, computed from real numbers."""
        return self.words(values) * 2.0 ** (node.frac - self.frac)

    def growth(self, node, bounds) -> float:
        """Return the largest error of the node's word.  ``bounds``: operand -> :class:`model.bounds.ranges.Bound`."""
        return node.grows([bounds[operand.name].error for operand in self.operands if operand.frac], node.format.ulp)

    def facts(self, node, domain) -> list[str]:
        """Return the SMT-LIB formulas that the node's value satisfies."""
        return [] if self.free else [f"(= {node.name} {self.formula(domain)})"]

    def lower(self, to, node) -> None:
        """Add the node's steps to the folded program: call the method ``self.method`` of the Lowering ``to``."""
        if not self.method:
            raise NotImplementedError(f"{node.name}: the folded program has no {type(self).__name__}")
        getattr(to, self.method)(node, *(self.given or self.parts))

    def mask_registers(self, to, node) -> set[str]:
        """Return the names of the folded datapath's registers on which the mask ``node`` depends."""
        return set().union(*(to.operand_registers(node, operand) for operand in self.operands))


class Constant(Term):
    """Exact number whose denominator is a power of two."""

    def __init__(self, value: float | Fraction) -> None:
        self.value = Fraction(value)
        self.frac = self.value.denominator.bit_length() - 1

    def words(self, values):
        return self.value.numerator

    def formula(self, domain):
        return number(self.value)

    def text(self, level=0):
        return f"{self.value.numerator} / 2^{self.frac}" if self.frac > 3 else str(self.value)


class Sum(Operation):
    """Sum of signed terms."""

    level, method = ADDED, "sum"

    def __init__(self, *terms: tuple[int, Term]) -> None:
        super().__init__(*(term for _, term in terms))
        self.terms, self.given = terms, (terms,)
        self.frac = max(term.frac for term in self.parts)

    def words(self, values):
        return sum(sign * word for (sign, _), word in zip(self.terms, _aligned(values, *self.parts), strict=True))

    def formula(self, domain):
        signs = tuple(sign for sign, _ in self.terms)
        texts = [term.formula(domain) for term in self.parts]
        if len(texts) < 3 and signs[0] > 0 or signs == (-1,):
            return f"({'+' if signs[-1] > 0 else '-'} {' '.join(texts)})"
        return f"(+ {' '.join(f'(* {number(s)} {t})' for s, t in zip(signs, texts, strict=True))})"

    def text(self, level=0):
        terms = [(s, t) for s, t in self.terms if not (isinstance(t, Constant) and t.value == 0)]
        first, *others = ((sign, term.text(ADDED + (sign < 0))) for sign, term in terms)
        signed = "".join(f" {'+' if sign > 0 else '-'} {text}" for sign, text in others)
        text = f"{'-' if first[0] < 0 else ''}{first[1]}{signed}"
        return f"({text})" if level > ADDED else text


class Product(Operation):
    """Exact product a * b * 2^scale."""

    smt, method = "(* {} {})", "exact_product"

    def __init__(self, a: Term, b: Term, scale: int = 0) -> None:
        super().__init__(a, b)
        self.scale, self.frac = scale, a.frac + b.frac - scale

    def words(self, values):
        a, b = (part.words(values) for part in self.parts)
        return a * b

    def text(self, level=0):
        a, b = (part.text(SCALED) for part in self.parts)
        return f"{2**self.scale} * " * (self.scale > 0) + (f"{a}^2" if a == b else f"{a} * {b}")


def square(a: Term) -> Product:
    return Product(a, a)


class Unary(Operation):
    """Operation on one term.  By default the operation's value is the term's value."""

    smt = "{}"
    term: Any  # some operations take a node

    def __init__(self, term: Term) -> None:
        super().__init__(term)
        self.term, self.frac = term, term.frac

    def words(self, values):
        return self.term.words(values)

    def text(self, level=0):
        return self.term.text(level)


class Scaled(Unary):
    """Term times 2^power."""

    level = inner = SCALED
    text = Operation.text

    def __init__(self, term: Term, power: int) -> None:
        super().__init__(term)
        self.frac = term.frac - power
        factor = 2 ** abs(power)
        self.smt = f"(* {number(factor)} {{}})" if power > 0 else f"(/ {{}} {number(factor)})"
        self.pattern = f"{factor} * {{}}" if power > 0 else f"{{}} / {factor}"


class Floor(Unary):
    """Term truncated to ``frac`` fraction bits."""

    def __init__(self, term: Term, frac: int) -> None:
        super().__init__(term)
        self.frac, self.drop = frac, term.frac - frac

    def words(self, values):
        words = self.term.words(values)
        return words >> self.drop if integral(words) else words / (1 << self.drop)


class Function(Operation):
    """Any function of the words of ``parts``.

    * ``pattern``: text with braces for the parts; ``level``: binding strength of the parts' context in the text
    * ``formula``: formula with braces for the parts; without it, proofs have no formula for the operation
    * ``frac``: number of fraction bits, by default the largest number that a part has
    """

    def __init__(
        self, function: Callable, pattern: str, *parts: Term, frac: int | None = None, formula: str = "", level: int = 0
    ) -> None:
        super().__init__(*parts)
        self.function, self.pattern, self.inner, self.smt, self.free = function, pattern, level, formula, not formula
        self.frac = max(part.frac for part in parts) if frac is None else frac

    def words(self, values):
        return self.function(*(part.words(values) for part in self.parts))


class Select(Operation):
    """Selection: ``yes`` where the mask is set, else ``no``."""

    smt = "(ite {2} {0} {1})"

    def __init__(self, mask: Term, yes, no) -> None:
        self.mask, self.yes, self.no = mask, as_term(yes), as_term(no)
        super().__init__(self.yes, self.no, self.mask)
        self.frac = max(self.yes.frac, self.no.frac)

    def words(self, values):
        return np.where(self.mask.words(values), *_aligned(values, self.yes, self.no))

    def text(self, level=0):
        text = f"{self.mask.text(COMPARED)} ? {self.yes.text(CHOICE + 1)} : {self.no.text()}"
        return f"({text})" if level > CHOICE else text


# -- decisions -------------------------------------------------------------------------------------------------------


class Compared(Operation):
    """Relation of two terms: ``<``, ``<=`` or ``=``."""

    level, inner = COMPARED, ADDED
    RELATIONS: Mapping[str, Callable] = {"<": np.less, "<=": np.less_equal, "=": np.equal}

    def __init__(self, relation: str, left: Term, right: Term) -> None:
        super().__init__(left, right)
        self.relation = relation
        swapped = isinstance(left, Constant)  # a >= 0 is stored as 0 <= a
        self.pattern = f"{{1}} {relation.replace('<', '>')} {{0}}" if swapped else f"{{0}} {relation} {{1}}"

    def words(self, values):
        return np.asarray(self.RELATIONS[self.relation](*_aligned(values, *self.parts))).astype(bool)

    def formula(self, domain):
        return domain.compared(self)


class Logic(Operation):
    """Masks joined by ``or``, ``and`` or ``xor``."""

    def __init__(self, word: str, level: int, *masks: Term) -> None:
        super().__init__(*masks)
        self.word, self.level, self.inner = word, level, level
        self.smt, self.pattern = f"({word}{' {}' * len(masks)})", f" {word} ".join(["{}"] * len(masks))

    def words(self, values):
        return getattr(np, f"logical_{self.word}").reduce([part.words(values) for part in self.parts])
