# SPDX-License-Identifier: Apache-2.0
"""Proof by z3 over the integers that divider and root return the floor, given the properties in ik_div_digit.vh and
ik_root_digit.vh.

Q has the result's bits so far, R is the remainder, d the divisor. These files define P and S and prove, on bit vectors,
that in each row P + R (divider) or S + R (root) equals the operand's bits so far, modulo a power of two. The questions
here prove P = Q d and S = Q^2 from the files' row equations, so Q is the floor after the last row. Widths appear
only in D = 2^(DW-1), X = 2^XW >= 2 D and B = 2^ROWS (at least 8 for roots), so the proof holds at all widths.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import partial

from tb.formal.smt import formula, smt
from tb.formal.task import Question
from tb.formal.tools import ask
from tb.sim.env import ROOT
from tb.sim.seeded_bugs import Bug

DIV = "tb/formal/ik_div_digit.vh"
ROOT_DIGIT = "tb/formal/ik_root_digit.vh"

PYTHON = {
    r"\{[^{}]*\{1'b0\}\}": "0",
    r"\{(\w+)\[\w+-2:0\], (\w+)\}": r"(2 * \1 + \2)",  # append a bit
    r"\{(\w+), 1'b0\}": r"(2 * \1)",
    r"1'b([01])": r"\1",
    r"\|\|": " or ",
    r"\?": " if ",  # c ? a : b gives c if a else b; :func:`integer` exchanges c and a
    r":": " else ",
}
"""Pattern in a Verilog expression -> Python. The operators used here have the same precedence in both languages."""


def integer(text: str, names: dict[str, str]) -> str:
    """Return a Verilog expression as an SMT term over integers, without overflow; ``names`` maps identifiers to terms.
    Raises SyntaxError for an unsupported expression, KeyError for an unknown identifier or comparison."""
    for verilog, replacement in PYTHON.items():
        text = re.sub(verilog, replacement, text)
    tree = ast.parse(text.strip(), mode="eval").body
    for choice in ast.walk(tree):
        if isinstance(choice, ast.IfExp):
            choice.test, choice.body = choice.body, choice.test
    return smt(tree, str, names.__getitem__)


def _read(text: str, pattern: str, names: dict[str, str]) -> str:
    """Find ``pattern`` in ``text`` and translate its group to an SMT term; ``names`` maps names of the text to SMT
    names. Raises LookupError unless the pattern matches exactly once."""
    expressions = re.findall(pattern, text)
    if len(expressions) != 1:
        raise LookupError(f"not exactly one {pattern!r}")
    return integer(expressions[0], names)


def _asked(name: str, says: str, facts: list[str], claim: str) -> Question:
    return Question(name, says, partial(ask, formula(facts, claim)), partial(ask, formula(facts, "false")))


BIT = "(<= 0 bit 1)"
WORDS = ["(< 0 D)", "(<= (* 2 D) X)", "(< 0 B)"]


def _divider(text: str) -> Iterator[Question]:
    read = partial(_read, text)
    p_next = read(r"wire \[XW-1:0\] P_next = (.*);", {"P": "P", "bit_q": "(= q 1)", "dv": "d"})
    q_next = read(r"wire \[ROWS-1:0\] Q_next = (.*);", {"Q": "Q", "bit_q": "q"})
    total = read(r"\.identity\(over_q \|\| (P_q \+ R) == M_q >> \(ROWS - 1 - k\)\)", {"P_q": "P", "R": "R"})
    least = read(r"\.in_range\(\(over_q \|\| \((.*?) && r_plus", {"R": "R", "g_row[k].divisor_q": "d"})
    magnitude = read(r"f_M_1 <= (n\[NW-1\] \? .*);", {"n[NW - 1]": "(< N 0)", "f_N": "N"})
    wide = {"f_M_wide": "M", "f_d_wide": "d", "ROWS": "B"}
    over = read(r"wire f_over_1 = f_d_1\[DW-1\] \|\| (.*);", wide)
    out = read(r"f_over_rows, (f_sign_rows \? .*)\};", {"f_sign_rows": "(< N 0)", "f_magnitude": "magnitude"})
    row = [*WORDS, "(<= 0 q 1)", BIT, "(<= 0 R)", least, "(< d D)", "(<= 0 M)", "(<= 0 Q)"]
    row += ["(= P (* Q d))", f"(= {total} M)"]
    behind = ["(<= 0 R2)", "(< R2 d)", f"(= P2 {p_next})", f"(= Q2 {q_next})", "(= M2 (+ (* 2 M) bit))"]
    modulo = "(= (+ P2 R2) (+ M2 (* t X)))"
    says = "M >> k is M >> (k + 1), doubled, and a bit"
    facts = ["(< 0 c)", "(<= 0 M)", "(<= 0 (- M (* c m)) (- c 1))", "(<= 0 (- M (* 2 c n)) (- (* 2 c) 1))"]
    yield _asked("divider: bits", says, facts, "(<= 0 (- m (* 2 n)) 1)")
    says = "before the first row P = Q d, and P + R is what is above the rows' bits"
    yield _asked("divider: first", says, ["(= Q 0)", "(= R M)"], "(= (+ (* Q d) R) M)")
    says = "P = Q d before a row: P = Q d behind it"
    yield _asked("divider: product", says, [*row, *behind], "(= P2 (* Q2 d))")
    says = "P + R is M's bits so far modulo the words' length, therefore without it"
    yield _asked("divider: row", says, [*row, *behind, modulo], "(= t 0)")
    last = [*WORDS, "(<= 0 R)", least, "(= (+ (* Q d) R) M)"]
    yield _asked("divider: last", "Q = floor(M / d)", last, "(<= 0 (- M (* Q d)) (- d 1))")
    fits = [f"(= M {magnitude})", *last, f"(not {over})", "(= magnitude Q)", f"(= q {out})"]
    says = "q = floor(N / d), for a negative N as well"
    yield _asked("divider: sign", says, fits, "(<= 0 (- N (* q d)) (- d 1))")
    says = "without overflow the quotient is a word of ROWS bits and a sign"
    yield _asked("divider: fits", says, [*fits, "(<= 0 Q)"], "(and (<= (- B) q) (< q B))")
    says = "with it and d > 0, floor(N / d) is none"
    facts = ["(< 0 d)", "(< 0 B)", f"(= M {magnitude})", over, "(<= 0 (- N (* f d)) (- d 1))"]
    yield _asked("divider: overflow", says, facts, "(or (<= B f) (< f (- B)))")


def _root(text: str) -> Iterator[Question]:
    read = partial(_read, text)
    s_next = read(r"wire \[MW-1:0\] S_next = (.*);", {"S": "S", "Q_wide": "Q", "bit_q": "(= q 1)"})
    q_next = read(r"wire \[ROWS-1:0\] Q_next = (.*);", {"Q": "Q", "bit_q": "q"})
    total = read(r"\.identity\((S_q \+ R) == M_q >> \(2 \* \(ROWS - 1 - k\)\)\)", {"S_q": "S", "R": "R"})
    twice = read(r"wire \[MW:0\] Q_twice = (\{Q_q, 1'b0\});", {"Q_q": "Q"})
    least = read(r"\.in_range\((.*?) && r_plus", {"R": "R", "Q_twice": twice})
    row = ["(<= 8 B)", "(<= 0 q 1)", "(<= 0 pair 3)", "(<= 0 R)", least, "(<= 0 Q)", "(< Q B)", "(<= 0 M)"]
    row += ["(= S (* Q Q))", f"(= {total} M)"]
    behind = ["(<= 0 R2)", "(<= R2 (* 2 Q2))", f"(= S2 {s_next})", f"(= Q2 {q_next})", "(= M2 (+ (* 4 M) pair))"]
    says = "M >> 2 k is M >> 2 (k + 1), four times, and a pair of bits"
    facts = ["(< 0 c)", "(<= 0 M)", "(<= 0 (- M (* c m)) (- c 1))", "(<= 0 (- M (* 4 c n)) (- (* 4 c) 1))"]
    yield _asked("root: pairs", says, facts, "(<= 0 (- m (* 4 n)) 3)")
    yield _asked("root: square", "S = Q^2 before a row: S = Q^2 behind it", [*row, *behind], "(= S2 (* Q2 Q2))")
    says = "S + R is M's bits so far modulo the words' length, 2^(2 ROWS), therefore without it"
    yield _asked("root: row", says, [*row, *behind, "(= (+ S2 R2) (+ M2 (* t B B)))"], "(= t 0)")
    says = "Q = floor(sqrt(M))"
    facts = ["(<= 0 R)", least, "(<= 0 Q)", "(= (+ (* Q Q) R) M)"]
    yield _asked("root: last", says, facts, "(and (<= (* Q Q) M) (< M (* (+ Q 1) (+ Q 1))))")
    says = "where n 2^SH has more bits, its root has more than ROWS"
    facts = ["(<= 8 B)", "(<= (* B B) v)", "(<= 0 f)", "(< v (* (+ f 1) (+ f 1)))"]
    yield _asked("root: overflow", says, facts, "(<= B f)")


def floors(bug: Bug | None = None) -> Iterator[Question]:
    """Yield all questions about both property files. If ``bug`` is given, seed it in its file."""
    for file, questions in ((DIV, _divider), (ROOT_DIGIT, _root)):
        text = (ROOT / file).read_text()
        yield from questions(bug.seeded(text) if bug and bug.file == file else text)
