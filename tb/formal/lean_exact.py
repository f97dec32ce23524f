# SPDX-License-Identifier: Apache-2.0
"""The lean dataflow and the whole arm around it in exact arithmetic, as formulas over the reals.

:class:`Exact` runs the dataflow itself; a node becomes a real number with the equation of its operation, a count e the
number 2^e, so that a shift is a product. Decisions are taken on rounded words: if a decision depends on signs and
masks only, its truth table becomes a formula over the sign of each word, which is free unless the word is exact; any
other decision is free. A proof therefore holds for any outcome of rounding. After ``Domain.words``, later nodes use
``n_w``, the word of node n: within n's error of n's exact value.

The questions are in :mod:`tb.formal.lean_proofs`.
"""

import itertools
import re
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction

import numpy as np

from model.bounds.ranges import LeanRanges, on_grid
from model.dataflow.angles import gain
from model.dataflow.annotations import Facts, Within
from model.dataflow.arm import arm
from model.dataflow.datapaths import MODELS
from model.dataflow.nodes import Domain, Format, Node
from model.dataflow.operations import operation
from model.io.words import ARMS

LONG = (1 << 60) - 1
"""Largest magnitude with which a decision is sampled: one that depends on magnitude does not depend on signs only."""


WORDS = {"and", "or", "not", "ite", "true", "false"}  # reserved words of SMT-LIB


VALUES = {
    "plus": "(+ {} {})",
    "minus": "(- {} {})",
    "times": "(* {} {})",
    "square": "(* {0} {0})",
    "limit": "{}",
    "mantissa": "(ite {1} (* 4.0 {0}) {0})",
    "turned": "(ite {2} (+ {0} {1}) (- {0} {1}))",
    "result": "(ite {1} (- {0}) {0})",
}
"""Operation -> its value, from its operands."""


def number(value: float | Fraction) -> str:
    """Return a number in SMT-LIB, exactly."""
    exact = Fraction(value)
    size = (
        f"(/ {abs(exact.numerator)}.0 {exact.denominator}.0)" if exact.denominator > 1 else f"{abs(exact.numerator)}.0"
    )
    return size if exact >= 0 else f"(- {size})"


def between(low: float, term: str, high: float, below: bool = False) -> str:
    """Return low <= term <= high, or < high."""
    return f"(and (<= {number(low)} {term}) ({'<' if below else '<='} {term} {number(high)}))"


def real_formula(facts: list[str], goal: str, bits: Callable[[str], bool] = lambda name: False) -> str:
    """Return the formula "the facts hold and the goal does not"; names are declared real, or Boolean where ``bits``."""
    names = sorted({n for text in (goal, *facts) for n in re.findall(r"[a-z]\w*", text)} - WORDS)
    lines = [f"(declare-const {name} {'Bool' if bits(name) else 'Real'})" for name in names]
    return "\n".join([*lines, *(f"(assert {fact})" for fact in facts), f"(assert (not {goal}))"])


class UnknownOperationError(Exception):
    """The dataflow has an operation without an equation over the reals; the text names the node."""


class Exact(Domain):
    """The whole arm's dataflow at one word length."""

    def __init__(self, width: int) -> None:
        super().__init__(width)
        self.equations: dict[str, list[str]] = {}
        self.signs: dict[str, str] = {}  # word -> whether it is negative, if a decision depends on it
        self.errors = LeanRanges(width, datapath="arm").errors
        self._is("ulp", f"(= ulp {number(self.word(1).ulp)})")
        inputs = self.inputs(lambda name, fmt: None, (*MODELS["arm"].inputs, *MODELS["arm"].side))
        for name, node in inputs.items():
            fmt = node.format
            low = fmt.ulp if name in ARMS else fmt.low * fmt.ulp
            self._is(name, between(low, name, fmt.high * fmt.ulp))
        self.before: dict[str, Node] = {}  # nodes replaced by their words downstream
        arm(self, inputs)
        words = {node.name: node for node in map(self.nodes.__getitem__, self.before)}
        self.nodes |= self.before | words

    def words(self, *names):
        super().words(*names)
        for name in names:
            node, word, error = self.nodes[name], f"{name}_w", self.errors[name]
            low, high = node.format.low * node.format.ulp, node.format.high * node.format.ulp
            if self.equations[name]:
                within = node.facts.within
                low, high = on_grid((within.low - error, within.high + error), node.format)
            self._is(word, between(low, word, high))
            self.before[name], self.errors[word] = node, 0.0
            self.nodes[name] = replace(node, name=word, op="input", facts=Facts())

    def near(self, name: str) -> str:
        """Return the fact that a node's word is within its error of its exact value."""
        error = self.errors[name]
        return between(-error, f"(- {name}_w {name})", error) if error else f"(= {name}_w {name})"

    def _is(self, name: str, *formulas: str) -> None:
        self.equations[name] = list(formulas)

    def claim(self, name: str) -> str:
        """Return the claim about a node's exact value; for a count, that it is between 0 and 63."""
        within = self.nodes[name].facts.within
        if not isinstance(within, Within):
            raise LookupError(name)
        if not self.nodes[name].format.frac:  # an integer: above -1 and below 64
            return f"(and (< 0.5 {name}) (< {name} {number(2.0 ** (within.high + 1))}))"
        return between(within.low, name, within.high, within.below)

    def known(self, name: str) -> str:
        """Return the consequence of :meth:`claim`: a count above -1 is at least 0, as it is an integer."""
        if self.nodes[name].format.frac:
            return self.claim(name)
        return between(1.0, name, 2.0 ** self.nodes[name].facts.within.high)

    def places(self, name: str) -> str:
        """Return the fact that an exact word is 0, one ulp, or at least two."""
        if self.errors[name]:
            raise LookupError(f"{name} is rounded")
        ulp = self.nodes[name].format.ulp
        size = f"(ite (< {name} 0.0) (- {name}) {name})"
        return f"(or (= {name} 0.0) (= {size} {number(ulp)}) (<= {number(2 * ulp)} {size}))"

    def formula(self, facts: list[str], goal: str) -> str:
        """Return the formula "the facts hold and the goal does not", with its declarations."""
        return real_formula(
            facts, goal, lambda n: n.startswith("neg_") or (n in self.nodes and self.nodes[n].format.width == 1)
        )

    @property
    def claimed(self) -> list[str]:
        """The nodes for which the dataflow claims a range that they could exceed."""
        return [n for n, node in self.nodes.items() if isinstance(node.facts.within, Within) and self.equations[n]]

    def _sign(self, node: Node) -> str:
        """Return the sign of a node's word as a formula; an input or an exact node has the sign of its value."""
        if node.op == "input" or node.section == "guard":
            return f"(< {node.name} 0.0)"
        self.signs[node.name] = f"neg_{node.name}"
        return f"neg_{node.name}"

    def _decision(self, operands: tuple[Node, ...], decide: Callable) -> str:
        """Return a formula equivalent to ``decide``; empty if it depends on more than signs."""

        def words(node: Node) -> list[tuple[str, tuple[int, ...]]]:
            if node.format.width == 1:
                return [(f"(not {node.name})", (0,)), (node.name, (1,))]
            sign, most = self._sign(node), min(node.format.high, LONG)
            above, below = (1, 5, most // 3, most), (-1, -5, -most // 3, -most)
            if sign.startswith("neg_"):
                return [(sign, below), (f"(not {sign})", (0, *above))]
            return [(sign, below), (f"(= {node.name} 0.0)", (0,)), (f"(> {node.name} 0.0)", above)]

        parts = []
        for case in itertools.product(*map(words, operands)):
            found = {
                bool(np.atleast_1d(decide(*(np.array([v], dtype=np.int64) for v in values)))[0])
                for values in itertools.product(*(samples for _, samples in case))
            }
            if len(found) > 1:
                return ""
            if found == {True}:
                parts.append(f"(and true {' '.join(condition for condition, _ in case)})")
        return f"(or false {' '.join(parts)})"

    def apply(self, name: str, operands: tuple[Node, ...], fmt: Format, bits: Callable):
        kind, parameters = operation(bits)
        names, write = [node.name for node in operands], getattr(self, f"_{kind}", None)
        if fmt.width == 1 and not write:
            decision = self._decision(operands, _mask(bits))
            self._is(name, *([f"(= {name} {decision})"] if decision else []))
            return
        if kind not in VALUES and write is None:
            raise UnknownOperationError(f"{name}: {kind}")
        found = VALUES[kind].format(*names) if kind in VALUES else write(name, operands, fmt, *names, **parameters)
        self._is(name, *([f"(= {name} {found})"] if isinstance(found, str) else found))

    # Each other operation has a method that returns its value, or the equations of the node `name`.

    def _free(self, *_, **__):
        """Return no equation, for words that saturate or wrap by design and for decisions on them."""
        return []

    _target = _joint = _twice = _outside = _outside_format = _free

    def _off_one(self, name, operands, fmt, square, frac, places):
        low, high = (number((1 + sign * Fraction(1, 1 << places)) ** 2) for sign in (-1, 1))
        return f"(not (and (<= {low} {square}) (< {square} {high})))"

    def _plus_wrapped(self, name, operands, fmt, a, b, width):
        total, end, turn = f"(+ {a} {b})", number(2.0 ** (width - 1) * fmt.ulp), number(2.0**width * fmt.ulp)
        return f"(ite (<= {end} {total}) (- {total} {turn}) (ite (< {total} (- {end})) (+ {total} {turn}) {total}))"

    def _chosen(self, name, operands, fmt, word, mask, unit):
        return f"(ite {mask} {number(0 if unit is None else 2.0**unit * fmt.ulp)} {word})"

    def _half_row(self, name, operands, fmt, *terms, signs, half, width):
        return f"(+ {number(half * fmt.ulp)} {self._four(name, operands, fmt, *terms, signs=signs)})"

    def _four(self, name, operands, fmt, *terms, signs):
        return f"(+ {' '.join(f'(* {number(s)} {t})' for s, t in zip(signs, terms, strict=True))})"

    def _two(self, name, operands, fmt, a, b, sign, drop):
        return f"(- (* {number(sign)} {b}) {a})"

    def _count(self, name, operands, fmt, *counts, factors, constant=0):
        up = [n for n, f in zip(counts, factors, strict=True) for _ in range(max(f, 0))]
        down = [n for n, f in zip(counts, factors, strict=True) for _ in range(max(-f, 0))]
        total = " ".join([number(2.0**constant), *up])
        return [f"(= (* {' '.join([name, *down, '1.0'])}) (* {total} 1.0))", f"(< 0.0 {name})"]

    def _shift_up(self, name, operands, fmt, value, count, width, left=0, right=0):
        return f"(* {number(2.0 ** (left - right + operands[0].format.frac - fmt.frac))} {value} {count})"

    def _shift_down(self, name, operands, fmt, value, count, left=0):
        power = number(2.0 ** (left + operands[0].format.frac - fmt.frac))
        return [f"(= (* {name} {count}) (* {power} {value}))"]

    def _half_length(self, name, operands, fmt, cosine, unit="false", frac=0):
        return f"(ite {unit} 1.0 {_half(cosine)})"

    def _half_part(self, name, operands, fmt, length, cosine, sine, *masks, large, none=None, frac=0):
        large = self._decision((operands[1], *operands[3:]), _mask(large))
        none = self._decision(operands[3:], _mask(none)) if none else "false"
        if not large or not none:
            raise UnknownOperationError(f"{name}: its choice depends on more than signs and masks")
        return f"(ite {large} {_half(cosine) if frac else length} (ite {none} 0.0 (/ {sine} 2.0)))"

    def _part_sum(self, name, operands, fmt, length, sine, none, sign):
        return f"({'+' if sign > 0 else '-'} {length} (ite {none} 0.0 (/ {sine} 2.0)))"

    def _elbow(self, name, operands, fmt, value, clamp, fold, drop, sign, folded, straight, one):
        clamped = f"(ite {fold} {number(folded)} {number(straight)})"
        return f"(ite {clamp} {clamped} (* {number(sign)} {value}))"

    def product3(self, name: str, a: Node, b: Node, fmt: Format, scale: int):
        self._is(name, f"(= {name} (* {number(2.0**scale)} {a.name} {b.name}))")

    def even_mantissa(self, count: str, name: str, value: Node, width: int, fmt: Format):
        """Define value 4^e 2^(frac - width), in [1/4, 1); 0 and the largest e for a value of 0."""
        most = number(2.0 ** (width // 2 - 1))
        self._is(count, f"(and (<= 1.0 {count}) (<= {count} {most}))")
        scale = number(2.0 ** (value.format.frac - width))
        held = f"(=> (< 0.0 {value.name}) (and (<= 0.25 {name}) (< {name} 1.0)))"
        empty = f"(=> (= {value.name} 0.0) (and (= {name} 0.0) (= {count} {most})))"
        self._is(name, f"(= {name} (* {scale} {value.name} {count} {count}))", held, empty)
        return None, None

    def reciprocal_root(self, name: str, m: Node, fmt: Format, twice: Node | None):
        one = f"(ite {twice.name} 4.0 1.0)" if twice else "1.0"
        self._is(
            name, f"(ite (= {m.name} 0.0) (= {name} 1.0) (= (* 4.0 {m.name} {name} {name}) {one}))", f"(< 0.0 {name})"
        )

    def polar(self, names: tuple[str | None, str], x: Node, y: Node, sign: int):
        """Define the gained length; the angle is free."""
        length, angle = names
        gained = number(Fraction(gain(self.width)) ** 2)
        squares = f"(+ (* {x.name} {x.name}) (* {y.name} {y.name}))"
        if length:
            self._is(length, f"(<= 0.0 {length})", f"(= (* {length} {length}) (* {gained} {squares}))")
        self._is(angle)
        return None, None

    def half_sincos(self, names: tuple[str, str], phi: Node, fmt: Format):
        """Define sine and cosine of half an angle of at most half a turn in either direction."""
        sine, cosine = names
        for name in names:
            self._is(name, f"(= 1.0 (+ (* {sine} {sine}) (* {cosine} {cosine})))", f"(<= 0.0 {cosine})")
        return None, None


def _half(cosine: str) -> str:
    """Return (1 + |c|)/2."""
    return f"(/ (+ 1.0 (ite (< {cosine} 0.0) (- {cosine}) {cosine})) 2.0)"


def _mask(decide: Callable) -> Callable:
    """Return a decision on masks as Booleans."""
    return lambda *values: np.asarray(decide(*values)).astype(bool)
