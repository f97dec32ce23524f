# SPDX-License-Identifier: Apache-2.0
"""LaTeX blocks and table cells of the derivation pages, and the page writer."""

from __future__ import annotations

import sys
from pathlib import Path

TERMS = 5
"""Terms of a sum in a line."""


def aligned(equations: list[tuple[str, str]]) -> str:
    """Format equations as a block aligned at the equals signs; long sums are split into several lines."""
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
    """Split a sum into signed terms outside all brackets; products stay whole."""
    terms, depth, start = [], 0, 0
    for n, letter in enumerate(right):
        depth += letter in "{(["
        depth -= letter in "})]"
        if depth == 0 and letter in "+-" and n and right[n - 1] == " " and right[n + 1] == " ":
            terms.append(right[start:n])
            start = n
    return [*terms, right[start:]]


def cell(formula: str) -> str:
    """Replace the character that would end a table cell."""
    return formula.replace("|", r"\vert ")


def write_page(page: Path, text: str, wrong: list[str], proved: str) -> int:
    """Write a page; if statements do not hold, print them instead and return 1."""
    if wrong:
        print(*wrong, f"{page.name} not written", sep="\n", file=sys.stderr)
        return 1
    page.write_text(text, encoding="utf-8")
    print(f"wrote {page.name}: {proved}")
    return 0
