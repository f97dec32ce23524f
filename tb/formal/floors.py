# SPDX-License-Identifier: Apache-2.0
"""Proof by z3 over the integers that divider and root return the floor, given the properties in ik_div_digit.vh and
ik_root_digit.vh.

Those files prove one linear relation per row with bit vectors: P + R, or S + R, equals the operand's bits so far,
modulo a power of two. The questions here add the products P = Q d and S = Q^2; after the last row, Q is the floor. Row
equations are read from the .vh (:func:`integer`), so changing one changes the question. Widths appear only in the
integers D = 2^(DW-1), X = 2^XW >= 2 D and B = 2^ROWS, at least 8 for roots, so a proof holds at all widths.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import partial

from tb.formal.arithmetic import Question, integers
from tb.formal.unrolled import ask
from tb.sim.env import ROOT
from tb.sim.seeded_bugs import Bug

DIV = "tb/formal/ik_div_digit.vh"
ROOT_DIGIT = "tb/formal/ik_root_digit.vh"

LEVELS = (("||",), ("==",), (">=", "<=", "<"), ("<<",), ("+", "-"), ("*",))
"""Operators of an expression, lowest precedence first."""

TOKEN = re.compile(r"\s*(\{[^{}]*\{[^{}]*\}\}|\{[^{}]*\}|1'b[01]|\w+(?:\[[^\]]*\])?|\|\||==|>=|<=|<<<?|[-+*?:()<~])")


class FormulaError(LookupError):
    """An expression of a .vh file without an equivalent over the integers."""


class _Reader:
    """Parser of a Verilog expression into an SMT term over integers, ignoring overflow; ``names`` maps identifiers."""

    def __init__(self, text: str, names: dict[str, str]) -> None:
        self.text, self.names, self.left = text, names, []
        place = 0
        while text[place:].strip():
            found = TOKEN.match(text, place)
            if not found:
                raise FormulaError(f"cannot parse {text!r} from {text[place:]!r} on")
            self.left.append(found[1])
            place = found.end()

    def _next(self, *wanted: str) -> str:
        return self.left.pop(0) if self.left and self.left[0] in wanted else ""

    def choice(self) -> str:
        condition = self.level(0)
        if not self._next("?"):
            return condition
        yes = self.choice()
        if not self._next(":"):
            raise FormulaError(self.text)
        return f"(ite {condition} {yes} {self.choice()})"

    def level(self, depth: int) -> str:
        if depth == len(LEVELS):
            return self.primary()
        term = self.level(depth + 1)
        while sign := self._next(*LEVELS[depth], *(["<<<"] if "<<" in LEVELS[depth] else [])):
            other = self.level(depth + 1)
            if sign.startswith("<<"):  # by a number, or by ROWS, which maps to 2^ROWS
                term = f"(* {term} {1 << int(other) if other.isdigit() else other})"
            else:
                term = f"({ {'||': 'or', '==': '='}.get(sign, sign) } {term} {other})"
        return term

    def primary(self) -> str:
        if self._next("("):
            term = self.choice()
            if not self._next(")"):
                raise FormulaError(self.text)
            return term
        if self._next("~"):
            return f"(- (- 1) {self.primary()})"
        if self._next("-"):
            return f"(- {self.primary()})"
        if not self.left:
            raise FormulaError(self.text)
        word = self.left.pop(0)
        if word in self.names:
            return self.names[word]
        if word.isdigit() or word.startswith("1'b"):
            return word[-1] if "'" in word else word
        if re.fullmatch(r"\{\(\w+ - 1\) \{1'b0\}\}|\{\w+\{1'b0\}\}|\{\w+ \{1'b0\}\}", word):
            return "0"
        if found := re.fullmatch(r"\{(\w+)\[\w+-2:0\], (\w+)\}", word):  # a bit appended
            return f"(+ (* 2 {self.names[found[1]]}) {self.names[found[2]]})"
        raise FormulaError(f"no integer for {word!r} in {self.text!r}")


def integer(text: str, names: dict[str, str]) -> str:
    """Return the expression as an SMT term over integers."""
    reader = _Reader(text, names)
    term = reader.choice()
    if reader.left:
        raise FormulaError(f"cannot parse {text!r} from {reader.left[0]!r} on")
    return term


def _one(text: str, pattern: str) -> str:
    """Return the group of a pattern's only match."""
    found = re.findall(pattern, text)
    if len(found) != 1:
        raise FormulaError(f"not exactly one match of {pattern!r}")
    return found[0]


def _asked(name: str, says: str, names: str, facts: list[str], claim: str) -> Question:
    text = {met: integers(names, facts, met) for met in (claim, "false")}
    return Question(name, says, partial(ask, text[claim]), partial(ask, text["false"]))


BIT = "(<= 0 bit 1)"
WORDS = ["(< 0 D)", "(<= (* 2 D) X)", "(< 0 B)"]


def _divider(text: str) -> Iterator[Question]:
    names = {"P": "P", "Q": "Q", "bit_q": "q", "dv": "d", "R": "R", "sign": "sign", "ROWS": "B"}
    names["bit_q"] = "(= q 1)"
    p_next = integer(_one(text, r"wire \[XW-1:0\] P_next = (.*);"), names)
    q_next = integer(_one(text, r"wire \[ROWS-1:0\] Q_next = (.*);"), {**names, "bit_q": "q"})
    flag = {"over_q": "false", "P_q": "P", "R": "R"}
    held, come = _one(text, r"\.identity\(over_q \|\| (P_q \+ R) == (M_q >> \(ROWS - 1 - k\))\)")
    if come != "M_q >> (ROWS - 1 - k)":
        raise FormulaError(come)
    total = integer(held, flag)
    below = _one(text, r"\.in_range\(\(over_q \|\| \((.*?) && r_plus").replace("g_row[k].divisor_q", "d")
    least = integer(below, {"R": "R", "d": "d"})
    magnitude = integer(
        _one(text, r"f_M_1 <= (n\[NW-1\] \? .*);").replace("n[NW-1]", "minus"), {"minus": "(< N 0)", "f_N": "N"}
    )
    over = integer(
        _one(text, r"wire f_over_1 = f_d_1\[DW-1\] \|\| (.*);"), {"f_M_wide": "M", "f_d_wide": "d", "ROWS": "B"}
    )
    out = integer(
        _one(text, r"f_over_rows, (f_sign_rows \? .*)\};"), {"f_sign_rows": "(< N 0)", "f_magnitude": "magnitude"}
    )
    names = "P Q R d q bit M X D B R2 P2 Q2 M2 t"
    row = [*WORDS, "(<= 0 q 1)", BIT, "(<= 0 R)", least, "(< d D)", "(<= 0 M)", "(<= 0 Q)"]
    row += ["(= P (* Q d))", f"(= {total} M)"]
    behind = ["(<= 0 R2)", "(< R2 d)", f"(= P2 {p_next})", f"(= Q2 {q_next})", "(= M2 (+ (* 2 M) bit))"]
    modulo = "(= (+ P2 R2) (+ M2 (* t X)))"
    yield _asked(
        "divider: bits",
        "M >> k is M >> (k + 1), doubled, and a bit",
        "M c m n",
        ["(< 0 c)", "(<= 0 M)", "(<= 0 (- M (* c m)) (- c 1))", "(<= 0 (- M (* 2 c n)) (- (* 2 c) 1))"],
        "(<= 0 (- m (* 2 n)) 1)",
    )
    yield _asked(
        "divider: first",
        "before the first row P = Q d, and P + R is what is above the rows' bits",
        "Q d R M",
        ["(= Q 0)", "(= R M)"],
        "(= (+ (* Q d) R) M)",
    )
    says = "P = Q d before a row: P = Q d behind it"
    yield _asked("divider: product", says, names, [*row, *behind], "(= P2 (* Q2 d))")
    yield _asked(
        "divider: row",
        "P + R is M's bits so far modulo the words' length, therefore without it",
        names,
        [*row, *behind, modulo],
        "(= t 0)",
    )
    last = [*WORDS, "(<= 0 R)", least, "(= (+ (* Q d) R) M)"]
    yield _asked("divider: last", "Q = floor(M / d)", "Q d R M X D B", last, "(<= 0 (- M (* Q d)) (- d 1))")
    about = "N Q d R M X D B magnitude q"
    fits = [f"(= M {magnitude})", *last, f"(not {over})", "(= magnitude Q)", f"(= q {out})"]
    says = "q = floor(N / d), for a negative N as well"
    yield _asked("divider: sign", says, about, fits, "(<= 0 (- N (* q d)) (- d 1))")
    yield _asked(
        "divider: fits",
        "without overflow the quotient is a word of ROWS bits and a sign",
        about,
        [*fits, "(<= 0 Q)"],
        "(and (<= (- B) q) (< q B))",
    )
    yield _asked(
        "divider: overflow",
        "with it and d > 0, floor(N / d) is none",
        "N d M B f",
        ["(< 0 d)", "(< 0 B)", f"(= M {magnitude})", over, "(<= 0 (- N (* f d)) (- d 1))"],
        "(or (<= B f) (< f (- B)))",
    )


def _root(text: str) -> Iterator[Question]:
    names = {"S": "S", "Q": "Q", "Q_wide": "Q", "bit_q": "(= q 1)"}
    s_next = integer(_one(text, r"wire \[MW-1:0\] S_next = (.*);"), names)
    q_next = integer(_one(text, r"wire \[ROWS-1:0\] Q_next = (.*);"), {**names, "bit_q": "q"})
    held = _one(text, r"\.identity\((S_q \+ R) == M_q >> \(2 \* \(ROWS - 1 - k\)\)\)")
    total = integer(held, {"S_q": "S", "R": "R"})
    doubled = _one(text, r"wire \[MW:0\] Q_twice = (\{Q_q, 1'b0\});")
    least = integer(_one(text, r"\.in_range\((.*?) && r_plus"), {"R": "R", "Q_twice": "(* 2 Q)" * bool(doubled)})
    names = "S Q R q pair M B R2 S2 Q2 M2 t"
    row = ["(<= 8 B)", "(<= 0 q 1)", "(<= 0 pair 3)", "(<= 0 R)", least, "(<= 0 Q)", "(< Q B)", "(<= 0 M)"]
    row += ["(= S (* Q Q))", f"(= {total} M)"]
    behind = ["(<= 0 R2)", "(<= R2 (* 2 Q2))", f"(= S2 {s_next})", f"(= Q2 {q_next})", "(= M2 (+ (* 4 M) pair))"]
    yield _asked(
        "root: pairs",
        "M >> 2 k is M >> 2 (k + 1), four times, and a pair of bits",
        "M c m n",
        ["(< 0 c)", "(<= 0 M)", "(<= 0 (- M (* c m)) (- c 1))", "(<= 0 (- M (* 4 c n)) (- (* 4 c) 1))"],
        "(<= 0 (- m (* 4 n)) 3)",
    )
    yield _asked("root: square", "S = Q^2 before a row: S = Q^2 behind it", names, [*row, *behind], "(= S2 (* Q2 Q2))")
    yield _asked(
        "root: row",
        "S + R is M's bits so far modulo the words' length, 2^(2 ROWS), therefore without it",
        names,
        [*row, *behind, "(= (+ S2 R2) (+ M2 (* t B B)))"],
        "(= t 0)",
    )
    yield _asked(
        "root: last",
        "Q = floor(sqrt(M))",
        "Q R M",
        ["(<= 0 R)", least, "(<= 0 Q)", "(= (+ (* Q Q) R) M)"],
        "(and (<= (* Q Q) M) (< M (* (+ Q 1) (+ Q 1))))",
    )
    yield _asked(
        "root: overflow",
        "where n 2^SH has more bits, its root has more than ROWS",
        "f v B",
        ["(<= 8 B)", "(<= (* B B) v)", "(<= 0 f)", "(< v (* (+ f 1) (+ f 1)))"],
        "(<= B f)",
    )


def floors(bug: Bug | None = None) -> Iterator[Question]:
    """Yield all questions, for the files unchanged or with a bug in one."""
    for file, questions in ((DIV, _divider), (ROOT_DIGIT, _root)):
        text = (ROOT / file).read_text()
        yield from questions(bug.seeded(text) if bug and bug.file == file else text)
