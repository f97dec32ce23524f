# SPDX-License-Identifier: Apache-2.0
"""Proof by z3 that ik_rsqrt equals its model, register by register, for every mantissa.

The model is :func:`place` and :func:`polynomial` of :mod:`model.dataflow.quadratic`, called with z3 terms of
:data:`WIDE` bits, which never overflow. The RTL is represented by Yosys' formula of ik_rsqrt and its ik_quadratic,
unrolled for the latency, from an arbitrary state. The formula is cut at the register of each product. Separate
questions prove that the register holds the product of its factors, that the factors equal the model's, and that the
product fits. These questions read an arbitrary table word; a further check compares each table word with the model's.
"""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

from model.dataflow.formats import WIDTHS, root_frac
from model.dataflow.mul3 import TILE
from model.dataflow.quadratic import INVERSE_ROOT, Form, place, polynomial, rounding, table_rows
from tb.formal.smt import formula, word
from tb.formal.task import Question
from tb.formal.tools import Answer, Unrolled, ask, yosys
from tb.sim.env import ROOT
from tb.sim.seeded_bugs import Bug, copy_rtl

BUILD = ROOT / "build" / "formal_rsqrt"
WIDE = 96
FULL = 31  # fraction bits at W = 32

RSQRT = "rtl/lib/ik_rsqrt.v"
QUADRATIC = "rtl/lib/ik_quadratic.v"
TABLE = "rtl/include/ik_rsqrt_table.vh"

HELD = re.compile(r"\(= \(bvand \(select \(\|\S+\| state\) #b([01]+)\) #b1+\) #b([01]+)\)")
"""Pattern of a table word in Yosys' formula: address and initial value."""

MULTIPLIED = re.compile(r"^\(define-fun (\|\S+\|) \(\(state (\|\S+\|)\)\) (\(_ BitVec \d+\)) \(bvmul .*$", re.M)
"""Pattern of a product in Yosys' formula. Except in questions about products, an arbitrary word replaces it."""


def _operator(name: str) -> Callable[["Term", object], "Term"]:
    return lambda self, other: replace(self, text=f"({name} {self.text} {_text(other)})")


@dataclass(frozen=True)
class Term:
    """Model's integer, as a z3 bit vector. ``<`` always returns ``lower``; ``*`` returns the next product register."""

    text: str
    lower: bool = False
    products: tuple[list, list] | None = None  # registers of the products, and the factors multiplied so far

    __add__ = __radd__ = _operator("bvadd")
    __sub__ = _operator("bvsub")
    __and__ = _operator("bvand")
    __lshift__ = _operator("bvshl")
    __rshift__ = _operator("bvashr")

    def __neg__(self):
        return replace(self, text=f"(bvneg {self.text})")

    def __lt__(self, other):
        return self.lower

    def __mul__(self, other):
        registers, factors = self.products
        factors.append((self, other))
        return replace(self, text=registers[len(factors) - 1])


def _text(value) -> str:
    return value.text if isinstance(value, Term) else _number(int(value), WIDE)


def _number(value: int, width: int) -> str:
    return f"(_ bv{value % (1 << width)} {width})"


def model(form: Form, frac: int, row, m):
    """Return the model's row number, offset u in the row, and result before doubling, for a mantissa ``m`` >= 1/4, as
    numbers or terms. ``row`` holds c0 plus the rounding constant, c1 and, unless the form is linear, c2."""
    number, u = place(form, m, frac)
    y = polynomial(form, row, u, rises=False, bends_up=False)
    return number, u, y >> form.sum_frac - frac


class Product(NamedTuple):
    """Product of two Verilog words: its register in ``clock``, and its factors in the clock before."""

    name: str
    register: str
    factors: tuple[str, str]
    clock: int


class Stages:
    """Questions about one number of fraction bits and one tile size."""

    def __init__(self, frac: int, tile: int = TILE, bug: Bug | None = None) -> None:
        self.frac, self.tile, self.form = frac, tile, INVERSE_ROOT.form(frac, tile)
        self.bent = len(self.form.c_frac) > 2
        place = BUILD / ("bug" if bug else f"{frac}_{tile}")
        copy_rtl(place, bug)
        here = place.relative_to(ROOT)
        read = f"{here}/{RSQRT} {here}/{QUADRATIC} {here}/rtl/lib/ik_delay.v"
        lines = [f"read_verilog -formal -sv -I{here}/rtl/include {read}"]
        lines += [f"chparam -set F {frac} -set TILE {tile} ik_rsqrt", "hierarchy -check -top ik_rsqrt; proc; flatten"]
        lines += ["opt_clean; memory_collect; opt_clean; async2sync; dffunmap"]
        if wrong := yosys(place, "formula", [*lines, f"write_smt2 -wires {here}/formula.smt2"]):
            raise RuntimeError(wrong)
        text = (place / "formula.smt2").read_text()
        self.rom = {int(address, 2): int(held, 2) for address, held in HELD.findall(text)}
        text = HELD.sub("true", text)  # the table is arbitrary; `words` checks its contents
        self.whole, self.unrolled = Unrolled(text), Unrolled(MULTIPLIED.sub(r"(declare-fun \1 (\2) \3)", text))
        self.clocks = INVERSE_ROOT.clocks(frac, tile) + 1

    def at(self, name: str, clock: int, signed: bool = True) -> str:
        """Return a Verilog word in a clock, extended to the :data:`WIDE` bits of the model."""
        width = self.unrolled.widths[name]
        return f"((_ {'sign' if signed else 'zero'}_extend {WIDE - width}) {self.unrolled.at(name, clock)})"

    def field(self, low: int, width: int) -> str:
        """Return ``width`` bits of the table's word, from bit ``low`` upwards."""
        held = f"|{self.unrolled.top}_m:R0D rom@0|"
        return f"((_ zero_extend {WIDE - width}) ((_ extract {low + width - 1} {low}) {held}))"

    @property
    def fields(self) -> list[tuple[int, int]]:
        """Lowest bit and width of c0 (without its leading one), c1 and, unless linear, c2 in a word of the table."""
        widths = self.form.c_bits
        return [(sum(widths[i + 1 :]), width) for i, width in enumerate(widths)]

    @property
    def row(self) -> tuple[str, ...]:
        """Coefficients of a row: c0 (in the sum's scale, plus the rounding constant), c1 and, unless linear, c2."""
        spare = self.form.sum_frac - self.form.c_frac[0]
        lowest = rounding(self.form, self.frac) & (1 << spare) - 1
        c0, *others = (self.field(*field) for field in self.fields)
        one = 1 << self.form.c_bits[0]
        whole = f"(bvor (bvshl (bvor {c0} {_number(one, WIDE)}) {_number(spare, WIDE)}) {_number(lowest, WIDE)})"
        return whole, *others

    def words(self) -> Answer:
        """Check that every word of the table equals the model's, and that every slope fits and is not negative."""
        form, spare = self.form, self.form.sum_frac - self.form.c_frac[0]
        slope_bits = form.c_bits[1] + form.slope_frac - form.c_frac[1] + 1
        wrong = [] if len(self.rom) == form.rows else ["length"]
        for number, (c0, *others) in enumerate(table_rows(INVERSE_ROOT, form)):
            held = self.rom.get(number, 0)
            fields = [held >> low & (1 << width) - 1 for low, width in self.fields]
            whole = (fields[0] | 1 << form.c_bits[0]) << spare | rounding(form, self.frac) & (1 << spare) - 1
            if whole != (c0 << spare) + rounding(form, self.frac) or fields[1:] != list(others):
                wrong.append(number)
            slope = others[0] << form.slope_frac - form.c_frac[1]
            high = 1 << form.u_frac - form.index_bits - form.u_low - 1
            down = form.c_frac[-1] + form.u_frac - form.u_low - form.slope_frac
            bends = [others[1] * u >> down for u in (-high, high)] if self.bent else [0]
            if not all(0 <= slope - bend < 1 << slope_bits - 1 for bend in bends):
                wrong.append(number)
        return Answer("sat" if wrong else "unsat", 0.0)

    @property
    def products(self) -> list[Product]:
        """Products in the order in which the model computes them."""
        after = 7 if self.bent else 4
        products = [Product("hh", "hh_2", ("slope_hi_1", "u_hi_1"), after)]
        if self.bent:
            products.insert(0, Product("bend", "g_bend.bend", ("g_bend.c2_in", "g_bend.u_in"), 4))
        if self.form.tiles > 1:
            products.append(Product("hl", "g_tiles.hl_2", ("slope_hi_1", "g_tiles.u_lo_1"), after))
            products.append(Product("lh", "g_tiles.lh_2", ("g_tiles.slope_lo_1", "u_hi_1"), after))
        return products

    def questions(self) -> Iterator[Question]:
        label = "" if (self.frac, self.tile) == (FULL, TILE) else f", F={self.frac}, TILE={self.tile}"
        yield Question(f"table{label}", "all words are the model's", self.words)
        yield Question(f"products fit{label}", "in their registers", self._fit)
        for name, says, claim in self._claims():
            yield Question(f"{name}{label}", says, partial(self._cases, claim), partial(self._cases, None))

    def _fit(self) -> Answer:
        """Check that each product fits for any two factors that fit, if the first factor (c2 or slope part) is >= 0."""
        widths = self.unrolled.widths
        for product in self.products:
            a, b = (widths[f"u_quadratic.{name}"] for name in product.factors)
            facts = ["(<= 0 a)", word("a", a), word("b", b)]
            answer = ask(formula(facts, word("(* a b)", widths[f"u_quadratic.{product.register}"])))
            if answer.said != "unsat":
                return answer
        return answer

    def _run(self, lower: bool, below: bool):
        """Run the model on terms of the Verilog; return row number, u, result, and the factors of the products."""
        factors: list = []
        registers = [self.at(f"u_quadratic.{p.register}", p.clock) for p in self.products]
        text = self.at("m_next", 0, signed=False)
        if below:
            text = f"(bvor {text} {_number(1 << self.frac + 1, WIDE)})"
        c0, *others = (Term(text, lower, (registers, factors)) for text in self.row)
        form = replace(self.form, c_frac=(self.form.sum_frac, *self.form.c_frac[1:]))
        return (*model(form, self.frac, (c0, *others), Term(text, lower, (registers, factors))), factors)

    def _cases(self, claim) -> Answer:
        """Check a claim for mantissas below 1/4, in [1/4, 1/2) and above. If ``claim`` is None, check that none of
        these ranges is empty."""
        m, seconds = self.unrolled.at("m_next", 0), 0.0
        half, quarter = (_number(1 << self.frac + bits, self.frac + 3) for bits in (2, 1))
        for lower, below in ((True, True), (True, False), (False, False)):
            case = [f"(bvult {m} {half})" if lower else f"(bvuge {m} {half})"]
            case += [f"(bvult {m} {quarter})" if below else f"(bvuge {m} {quarter})"]
            terms = self._run(lower, below)
            text = claim(*terms) if claim else "false"
            steps = self.whole if "bvmul" in text else self.unrolled
            slope, bits = terms[-1][int(self.bent)][0].text, self.unrolled.widths["u_quadratic.slope_hi_1"] - 1
            # `words` checks that the high part of a slope fits and is not negative
            fits = f"(and (bvsle {_number(0, WIDE)} {slope}) (bvslt {slope} {_number(1 << bits, WIDE)}))"
            answer = steps.ask(self.clocks, [*case, fits], text)
            seconds += answer.seconds
            if answer.said != ("unsat" if claim else "sat"):
                break
        return Answer(answer.said, seconds)

    def _factors(self, number: int, product: Product, row, u, y, factors) -> str:
        """Return the claim that the factors in the clock before a product equal the model's."""
        words = (self.at(f"u_quadratic.{name}", product.clock - 1) for name in product.factors)
        equal = (f"(= {word} {_text(factor)})" for word, factor in zip(words, factors[number], strict=True))
        return f"(and {' '.join(equal)})"

    def _multiplied(self, product: Product, row, u, y, factors) -> str:
        """Return the claim that a register holds the product of its factors in the clock before."""
        at, widths = self.unrolled.at, self.unrolled.widths
        names, register = [f"u_quadratic.{name}" for name in product.factors], f"u_quadratic.{product.register}"
        terms = (f"((_ sign_extend {widths[register] - widths[name]}) {at(name, product.clock - 1)})" for name in names)
        return f"(= {at(register, product.clock)} (bvmul {' '.join(terms)}))"

    def _claims(self) -> Iterator[tuple[str, str, object]]:
        address = f"|{self.unrolled.top}_m:R0A rom@0|"
        longer = WIDE - self.form.index_bits
        says = "the table is read at the model's row"
        yield "address", says, lambda row, u, y, f: f"(= ((_ zero_extend {longer}) {address}) {_text(row)})"
        yield "u", "u_1 is the model's u", lambda row, u, y, f: f"(= {self.at('u_1', 2)} {u.text})"
        for number, product in enumerate(self.products):
            factors = partial(self._factors, number, product)
            yield f"{product.name}, factors", f"{' and '.join(product.factors)} are the model's factors", factors
            yield f"{product.name}, product", f"{product.register} is their product", partial(self._multiplied, product)
        y, twice = self.unrolled.at("y", self.clocks), self.unrolled.at("twice", 1)

        def result(row, u, result, f) -> str:
            return f"(= {y} ((_ extract {self.frac} 0) (ite {twice} {(result << 1).text} {result.text})))"

        yield "y", "the result is the model's, doubled where twice is 1", result


def forms() -> list[tuple[int, int]]:
    """Return pairs (fraction bits, tile size), for all word lengths with TILE, for those up to 24 also with 16."""
    full = {(root_frac(width), TILE) for width in WIDTHS}
    return sorted(full | {(root_frac(width), 16) for width in WIDTHS if width <= 24}, reverse=True)


def stages(bug: Bug | None = None) -> Iterator[Question]:
    """Yield all questions; if ``bug`` is given, seed it and yield only the questions at W = 32."""
    for frac, tile in [(FULL, TILE)] if bug else forms():
        yield from Stages(frac, tile, bug).questions()
