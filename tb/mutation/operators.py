# SPDX-License-Identifier: Apache-2.0
"""Mutation operators: small changes of Verilog, each a mistake that somebody could make.

An operator is a function of a file's :class:`~tb.mutation.source.Code` that gives its edits: start, end, new text.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

from tb.mutation.source import Code

Edit = tuple[int, int, str]
OPERATORS: dict[str, Callable[[Code], Iterator[Edit]]] = {}
DELAY = re.compile(r"N|D[A-Z]")
"""Parameters that are clocks."""

SELDOM = frozenset({"signed_dropped", "signed_added", "width_plus_one", "repetition_plus_one", "slice_top_plus_one"})
"""What mostly changes nothing but a bit that nobody reads; these are tried a quarter as often as the others."""


def _named(name: str):
    def add(function):
        OPERATORS[name] = function
        return function

    return add


def _swaps(name: str, old: str, new: str) -> None:
    """An operator that puts `new` in the place of the binary `old`."""

    def edits(code: Code) -> Iterator[Edit]:
        at = code.relations if old in ("<", "<=", ">", ">=") else code.binary(old)
        yield from ((*code.span(k, k + 1), new) for k in at if code.word(k) == old)

    OPERATORS[name] = edits


for _name, _old, _new in [
    ("add_to_sub", "+", "-"), ("sub_to_add", "-", "+"), ("mul_to_add", "*", "+"),
    ("less_to_at_most", "<", "<="), ("at_most_to_less", "<=", "<"), ("more_to_at_least", ">", ">="),
    ("at_least_to_more", ">=", ">"), ("less_to_not_less", "<", ">="), ("at_most_to_more", "<=", ">"),
    ("more_to_at_most", ">", "<="), ("at_least_to_less", ">=", "<"), ("equal_to_unequal", "==", "!="),
    ("unequal_to_equal", "!=", "=="), ("and_to_or", "&&", "||"), ("or_to_and", "||", "&&"),
    ("bits_and_to_or", "&", "|"), ("bits_or_to_and", "|", "&"), ("xor_to_or", "^", "|"), ("xor_to_and", "^", "&"),
    ("left_to_right", "<<", ">>"), ("right_to_left", ">>", "<<"), ("arithmetic_to_logic", ">>>", ">>"),
    ("arithmetic_to_left", ">>>", "<<<"), ("left_to_arithmetic", "<<<", ">>>"),
]:  # fmt: skip
    _swaps(_name, _old, _new)


@_named("invert_dropped")
def _(code: Code) -> Iterator[Edit]:
    for at, token in enumerate(code.tokens):
        if token.text in "~!" and not code.is_operand(at - 1):
            yield *code.span(at, at + 1), ""


@_named("condition_inverted")
def _(code: Code) -> Iterator[Edit]:
    for first, last in _conditions(code):
        yield *code.span(first, last + 1), f"(!{code.cut(first, last + 1)})"


@_named("always_true")
def _(code: Code) -> Iterator[Edit]:
    for first, last in _conditions(code):
        yield *code.span(first, last + 1), "(1'b1)"


@_named("never_true")
def _(code: Code) -> Iterator[Edit]:
    for first, last in _conditions(code):
        yield *code.span(first, last + 1), "(1'b0)"


def _conditions(code: Code) -> Iterator[tuple[int, int]]:
    """The parentheses of each if."""
    for at, token in enumerate(code.tokens):
        if token.text == "if" and code.word(at + 1) == "(":
            yield at + 1, code.other[at + 1]


@_named("number_plus_one")
def _(code: Code) -> Iterator[Edit]:
    yield from _numbers(code, 1)


@_named("number_minus_one")
def _(code: Code) -> Iterator[Edit]:
    yield from _numbers(code, -1)


def _numbers(code: Code, by: int) -> Iterator[Edit]:
    for at, token in enumerate(code.tokens):
        if token.text.isdigit() and (by > 0 or int(token.text) > 0):
            yield *code.span(at, at + 1), str(int(token.text) + by)


@_named("literal_changed")
def _(code: Code) -> Iterator[Edit]:
    """A bit of a sized literal."""
    for at, token in enumerate(code.tokens):
        found = re.fullmatch(r"(\d+)'([bdh])([\da-fA-F]+)", token.text)
        if not found:
            continue
        width, base = int(found[1]), {"b": 2, "d": 10, "h": 16}[found[2]]
        for bit in {0, width - 1}:
            value = int(found[3], base) ^ (1 << bit)
            yield *code.span(at, at + 1), f"{width}'{found[2]}{format(value, {2: 'b', 10: 'd', 16: 'x'}[base])}"


def _moved(by: str, declared: bool, part: int) -> Callable[[Code], Iterator[Edit]]:
    """An end of a range by one: part 0 the one before the colon, 1 the one behind it; or the only one."""

    def edits(code: Code) -> Iterator[Edit]:
        for first, last, declares in code.brackets:
            if declares != declared:
                continue
            colon = code.upto(first + 1, ":", "+:", "-:")
            if part == 2:
                ends = (first + 1, last) if colon == last else None
            elif colon == last:
                ends = None
            else:
                ends = (first + 1, colon) if part == 0 else (colon + 1, last)
            if ends and ends[0] < ends[1]:
                start, end = code.span(*ends)
                yield start, end, f"({code.text[start:end]}){by}1"

    return edits


for _by, _word in (("+", "plus"), ("-", "minus")):
    OPERATORS[f"width_{_word}_one"] = _moved(_by, True, 0)
    OPERATORS[f"index_{_word}_one"] = _moved(_by, False, 2)
    OPERATORS[f"slice_top_{_word}_one"] = _moved(_by, False, 0)
    OPERATORS[f"slice_end_{_word}_one"] = _moved(_by, False, 1)


def _set(by: str, clocks: bool) -> Callable[[Code], Iterator[Edit]]:
    """A parameter of an instance by one: its clocks, or another one."""

    def edits(code: Code) -> Iterator[Edit]:
        for name, first, last in code.connections:
            if last > first + 1 and bool(DELAY.fullmatch(name)) == clocks and code.has_parameters(first - 2):
                start, end = code.span(first + 1, last)
                yield start, end, f"({code.text[start:end]}){by}1"

    return edits


for _by, _word in (("+", "plus"), ("-", "minus")):
    OPERATORS[f"parameter_{_word}_one"] = _set(_by, False)
    OPERATORS[f"delay_{_word}_one"] = _set(_by, True)


@_named("signed_dropped")
def _(code: Code) -> Iterator[Edit]:
    for at, token in enumerate(code.tokens):
        if token.text == "signed":
            yield *code.span(at, at + 1), ""
        if token.text == "$signed":
            yield *code.span(at, at + 1), "$unsigned"


@_named("signed_added")
def _(code: Code) -> Iterator[Edit]:
    for at, token in enumerate(code.tokens):
        if token.text in ("wire", "reg") and code.word(at + 1) == "[":
            yield *code.span(at, at + 1), f"{token.text} signed"
        if token.text == "$unsigned":
            yield *code.span(at, at + 1), "$signed"


def _values(code: Code) -> Iterator[tuple[int, int, tuple[int, ...]]]:
    """What is assigned to registers and wires, and the bits of it that may be stuck."""
    starts = list(code.assignments)
    for at, token in enumerate(code.tokens):
        if token.text == "=" and re.fullmatch(r"[\w\]}]+", code.word(at - 1)):
            first = max(k for k in range(at) if code.word(k) in (";", "begin", "else", ")", "end") or k == 0)
            if code.word(first + 1) in ("assign", "wire"):
                starts.append(at)
    for at in starts:
        end = code.upto(at + 1, ";", ",")
        if end > at + 1:
            yield at + 1, end, (0, 1) if code.is_word(at - 1) else (0,)


def _stuck(value: str) -> Callable[[Code], Iterator[Edit]]:
    def edits(code: Code) -> Iterator[Edit]:
        for first, end, bits in _values(code):
            for bit in bits:
                yield *code.span(first, end), f"(({code.cut(first, end)}) {value.format(bit)})"

    return edits


OPERATORS["stuck_at_0"] = _stuck("& ~(1 << {})")
OPERATORS["stuck_at_1"] = _stuck("| (1 << {})")


def _choices(code: Code) -> Iterator[tuple[int, int, int]]:
    """condition ? one : other: tokens of the question mark, the colon and the end."""
    for at, token in enumerate(code.tokens):
        if token.text == "?":
            colon = _past(code, at + 1)
            if code.word(colon) == ":":
                yield at, colon, _past(code, colon + 1)


def _past(code: Code, first: int) -> int:
    """The end of a value that may hold choices of its own."""
    end = code.upto(first, ";", ",", ":", "?")
    while code.word(end) == "?":
        end = _past(code, end + 1)  # its colon
        end = code.upto(end + 1, ";", ",", ":", "?")
    return end


@_named("choice_swapped")
def _(code: Code) -> Iterator[Edit]:
    for at, colon, end in _choices(code):
        one, other = code.cut(at + 1, colon), code.cut(colon + 1, end)
        yield *code.span(at + 1, end), f"({other}) : ({one})"


@_named("choice_always_first")
def _(code: Code) -> Iterator[Edit]:
    for at, colon, end in _choices(code):
        yield *code.span(colon + 1, end), f"({code.cut(at + 1, colon)})"


@_named("choice_always_second")
def _(code: Code) -> Iterator[Edit]:
    for at, colon, end in _choices(code):
        yield *code.span(at + 1, colon), f"({code.cut(colon + 1, end)})"


@_named("reset_never")
def _(code: Code) -> Iterator[Edit]:
    for first, last in _conditions(code):
        if code.cut(first + 1, last) == "rst":
            yield *code.span(first + 1, last), "1'b0"


@_named("reset_of_one_removed")
def _(code: Code) -> Iterator[Edit]:
    """A register that the reset leaves as it is."""
    for first, last in _conditions(code):
        if code.cut(first + 1, last) == "rst":
            end = next((k for k in range(last, len(code.tokens)) if code.word(k) in ("end", "else")), last)
            for at in code.assignments:
                if last < at < end:
                    yield _without(code, at)


@_named("assignment_removed")
def _(code: Code) -> Iterator[Edit]:
    for at in code.assignments:
        yield _without(code, at)


def _without(code: Code, at: int) -> Edit:
    """The register keeps its value."""
    first = at - 1
    while code.word(first) == "]":
        first = code.other[first] - 1
    if code.word(first) == "}":
        first = code.other[first]
    return *code.span(at + 1, code.upto(at + 1, ";")), code.cut(first, at)


def _shifted(by: str) -> Callable[[Code], Iterator[Edit]]:
    def edits(code: Code) -> Iterator[Edit]:
        for at in code.binary("<<", ">>", "<<<", ">>>"):
            yield code.tokens[at].end, code.tokens[at].end, f" {by}1 + "

    return edits


OPERATORS["shift_plus_one"] = _shifted("")
OPERATORS["shift_minus_one"] = _shifted("-")


def _parts(code: Code) -> Iterator[list[tuple[int, int]]]:
    """The elements of each {..., ...}."""
    for at, token in enumerate(code.tokens):
        if token.text == "{" and at in code.other:
            parts, first = [], at + 1
            while first < code.other[at]:
                end = code.upto(first, ",")
                parts.append((first, end))
                first = end + 1
            if len(parts) > 1:
                yield parts


@_named("concatenation_swapped")
def _(code: Code) -> Iterator[Edit]:
    for parts in _parts(code):
        for one, other in zip(parts, parts[1:], strict=False):
            yield *code.span(one[0], other[1]), f"{code.cut(*other)}, {code.cut(*one)}"


def _repeated(by: str) -> Callable[[Code], Iterator[Edit]]:
    def edits(code: Code) -> Iterator[Edit]:
        for at, token in enumerate(code.tokens):
            if token.text == "{" and at in code.other:
                inner = code.upto(at + 1, "{", ",")
                if code.word(inner) == "{" and inner > at + 1:
                    start, end = code.span(at + 1, inner)
                    yield start, end, f"({code.text[start:end]}){by}1"

    return edits


OPERATORS["repetition_plus_one"] = _repeated("+")
OPERATORS["repetition_minus_one"] = _repeated("-")


@_named("ports_swapped")
def _(code: Code) -> Iterator[Edit]:
    """Two ports of an instance next to each other get each other's words."""
    given = [c for c in code.connections if c[2] > c[1] + 1]
    for (one, a, a_end), (other, b, b_end) in zip(given, given[1:], strict=False):
        if b == a_end + 4 and "clk" not in (one, other):
            between = code.text[code.tokens[a_end].start : code.tokens[b].end]
            yield *code.span(a + 1, b_end), code.cut(b + 1, b_end) + between + code.cut(a + 1, a_end)


@_named("falling_edge")
def _(code: Code) -> Iterator[Edit]:
    for at, token in enumerate(code.tokens):
        if token.text == "posedge":
            yield *code.span(at, at + 1), "negedge"


@_named("case_swapped")
def _(code: Code) -> Iterator[Edit]:
    """The labels of two cases that follow each other."""
    labels = [
        at
        for at in range(1, len(code.tokens))
        if re.fullmatch(r"[A-Z]\w*|\d+'\w+", code.word(at)) and code.word(at + 1) == ":"
        and code.word(at - 1) in (";", ")", "end")
    ]  # fmt: skip
    for one, other in zip(labels, labels[1:], strict=False):
        start, end = code.span(one, other + 1)
        between = code.text[code.tokens[one].end : code.tokens[other].start]
        yield start, end, code.word(other) + between + code.word(one)


def edits(text: str) -> dict[str, list[Edit]]:
    """All edits of a file's text by operator, those that change nothing left out."""
    code = Code(text)
    found = {}
    for name, operator in OPERATORS.items():
        wanted = [edit for edit in dict.fromkeys(operator(code)) if text[edit[0] : edit[1]] != edit[2]]
        if wanted:
            found[name] = wanted
    return found
