# SPDX-License-Identifier: Apache-2.0
"""LaTeX blocks and table cells of the derivations' pages, and the function that writes a page."""

from __future__ import annotations

import sys
from pathlib import Path

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


def write_page(page: Path, text: str, wrong: list[str], proved: str) -> int:
    """Write a page; if a statement does not hold, print those that do not, write nothing and return 1."""
    if wrong:
        print(*wrong, f"{page.name} not written", sep="\n", file=sys.stderr)
        return 1
    page.write_text(text, encoding="utf-8")
    print(f"wrote {page.name}: {proved}")
    return 0
