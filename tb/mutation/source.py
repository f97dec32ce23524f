# SPDX-License-Identifier: Apache-2.0
"""The code of a Verilog file as mutations see it: comments, checks of parameters and lint's `unused` are blanks."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cached_property

# In this order: a quote in a comment opens no string.  An attribute, but not @(*) or a product in parentheses.
HIDDEN = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|^\s*`[^\n]*|\(\*(?!\)).*?\*\)', re.S | re.M)
NOT_LOGIC = re.compile(r"\bwire unused\w* =[^;]*;|\blocalparam LEGAL\b[^;]*;", re.S)
STOP = re.compile(r"\bu_stop \(\);")

TOKEN = re.compile(
    r"\d*'s?[bdohBDOH][\da-fA-F_xXzZ?]+|\d+|\$?\w+|<<<|>>>|===|!==|<<|>>|<=|>=|==|!=|&&|\|\||\*\*|\+:|-:|[^\s\w]"
)
KEYWORDS = frozenset(
    "always assign begin case casez default else end endcase endfunction endgenerate endmodule for function generate "
    "genvar if initial inout input integer localparam module negedge or output parameter posedge reg signed while "
    "wire".split()
)
OPENS, CLOSES = "([{", ")]}"


@dataclass(frozen=True)
class Token:
    """A word of the code and where it stands."""

    text: str
    start: int

    @property
    def end(self) -> int:
        return self.start + len(self.text)


def _blank(text: str, start: int, end: int) -> str:
    return text[:start] + re.sub(r"[^\n]", " ", text[start:end]) + text[end:]


def _before(text: str, close: int) -> int:
    """The place of the parenthesis that the one at `close` ends."""
    depth = 0
    for place in range(close, -1, -1):
        depth += (text[place] == ")") - (text[place] == "(")
        if depth == 0:
            return place
    raise ValueError("a parenthesis is not opened")


def masked(text: str) -> str:
    """The text, as long and with as many lines, with blanks for what is not to be changed."""
    for pattern in (HIDDEN, NOT_LOGIC):
        for found in list(pattern.finditer(text)):
            text = _blank(text, *found.span())
    for found in list(STOP.finditer(text)):  # if (...) begin : g_illegal <message> u_stop ();
        begin = text.rfind("begin", 0, found.start())
        condition = text.rfind(")", 0, begin)
        text = _blank(text, _before(text, condition), found.end())
    return text


class Code:
    """Tokens of a file, and what the operators ask of them.  ``at`` and ``other`` are numbers of tokens."""

    def __init__(self, text: str):
        self.text, self.masked = text, masked(text)
        self.tokens = [Token(m[0], m.start()) for m in TOKEN.finditer(self.masked)]

    @cached_property
    def other(self) -> dict[int, int]:
        """Of each bracket, the one that goes with it."""
        stack, pairs = [], {}
        for at, token in enumerate(self.tokens):
            if token.text in OPENS:
                stack.append(at)
            elif token.text in CLOSES and stack:
                pairs[at] = stack.pop()
                pairs[pairs[at]] = at
        return pairs

    def word(self, at: int) -> str:
        return self.tokens[at].text if 0 <= at < len(self.tokens) else ""

    def is_operand(self, at: int) -> bool:
        """Whether a value ends with this token: what follows it is a binary operator."""
        text = self.word(at)
        return text in (")", "]", "}") or (bool(re.match(r"[\w'$]", text)) and text not in KEYWORDS)

    def is_word(self, at: int) -> bool:
        """Whether a name is declared with more than a bit, as far as that is said beside it or in its declaration."""
        if self.word(at) in ("]", "}"):
            return ":" in self.cut(self.other[at], at + 1) if self.word(at) == "]" else True
        return bool(re.search(rf"\]\s*(?:\w+,\s*)*{re.escape(self.word(at))}\b", self.masked))

    def binary(self, *texts: str):
        """Tokens that stand between two values."""
        return [at for at, token in enumerate(self.tokens) if token.text in texts and self.is_operand(at - 1)]

    @cached_property
    def assignments(self) -> list[int]:
        """The `<=` of nonblocking assignments: the name before it begins a statement."""
        found = []
        for at, token in enumerate(self.tokens):
            if token.text != "<=":
                continue
            first = at - 1
            while self.word(first) == "]":
                first = self.other[first] - 1
            if self.word(first) == "}":
                first = self.other[first]
            before = self.word(first - 1)
            if before in (";", "begin", "else", ":", "end") or (before == ")" and self._heads(first - 1)):
                found.append(at)
        return found

    def _heads(self, close: int) -> bool:
        """Whether the parentheses that end here are those of an if, a for or an @."""
        return self.word(self.other[close] - 1) in ("if", "for", "@")

    @cached_property
    def relations(self) -> list[int]:
        """Comparisons by size."""
        nonblocking = set(self.assignments)
        return [at for at in self.binary("<", "<=", ">", ">=") if at not in nonblocking]

    def upto(self, at: int, *ends: str) -> int:
        """The first token from `at` on that is one of these, outside of brackets, or closes those around it."""
        while at < len(self.tokens):
            text = self.word(at)
            if text in ends or text in CLOSES:
                return at
            at = self.other[at] + 1 if text in OPENS and at in self.other else at + 1
        return at

    def span(self, first: int, end: int) -> tuple[int, int]:
        """Where the tokens from `first` to before `end` stand in the text."""
        return self.tokens[first].start, self.tokens[end - 1].end

    def cut(self, first: int, end: int) -> str:
        start, stop = self.span(first, end)
        return self.text[start:stop]

    @cached_property
    def brackets(self) -> list[tuple[int, int, bool]]:
        """[...]: its tokens, and whether it declares a word instead of choosing from one."""
        found = []
        for at, token in enumerate(self.tokens):
            if token.text == "[" and at in self.other:
                before = self.word(at - 1)
                found.append((at, self.other[at], before in KEYWORDS))
        return found

    @cached_property
    def connections(self) -> list[tuple[str, int, int]]:
        """.name(value): the name, and the parentheses of the value."""
        return [
            (self.word(at + 1), at + 2, self.other[at + 2])
            for at, token in enumerate(self.tokens)
            if token.text == "." and self.word(at + 2) == "(" and at + 2 in self.other
        ]

    def has_parameters(self, at: int) -> bool:
        """Whether a connection stands in #( ): it sets a parameter."""
        depth = at
        while depth >= 0:
            text = self.word(depth)
            if text in CLOSES and depth in self.other:
                depth = self.other[depth] - 1
                continue
            if text == "(":
                return self.word(depth - 1) == "#"
            depth -= 1
        return False
