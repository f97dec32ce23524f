# SPDX-License-Identifier: Apache-2.0
"""What both derivations share of their pages: LaTeX blocks and cells, and the command that writes a page."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

from scripts.console import Parser, exit_status

TERMS = 5
"""Of a sum, in a line."""


def aligned(equations: list[tuple[str, str]]) -> str:
    """A block of equations, aligned at the equals signs; long sums go over several lines."""
    lines = []
    for left, right in equations:
        terms = _terms(right)
        first, rest = terms[:TERMS], terms[TERMS:]
        lines.append(f"{left} &= {''.join(first)}")
        while rest:
            lines.append(rf"&\quad {''.join(rest[:TERMS])}")
            rest = rest[TERMS:]
    lines = [line.replace("  ", " ").rstrip() for line in lines]
    return "\n".join(["$$", r"\begin{aligned}", " \\\\\n".join(lines), r"\end{aligned}", "$$"])


def _terms(right: str) -> list[str]:
    """The terms of a sum with their signs, cut outside all brackets; products are left whole."""
    terms, depth, start = [], 0, 0
    for n, letter in enumerate(right):
        depth += letter in "{(["
        depth -= letter in "})]"
        if depth == 0 and letter in "+-" and n and right[n - 1] == " " and right[n + 1] == " ":
            terms.append(right[start:n])
            start = n
    return [*terms, right[start:]]


def cell(formula: str) -> str:
    """LaTeX without the character that ends a cell of a table."""
    return formula.replace("|", r"\vert ")


def write(command: str, about: str, page: Path, make: Callable[[], tuple[str, list[str], str]], arguments=None) -> int:
    """The command that writes a page; its status is 1, and nothing is written, if a statement does not hold.

    make: the page's text, the statements that do not hold, and a word on those that do.
    """

    def work() -> int:
        Parser(command, about, "the page is written", "a statement does not hold").parse_args(arguments)
        text, wrong, said = make()
        if wrong:
            print(*wrong, f"{page.name} not written", sep="\n", file=sys.stderr)
            return 1
        page.write_text(text, encoding="utf-8")
        print(f"wrote {page.name}: {said}")
        return 0

    return exit_status(command, work)
