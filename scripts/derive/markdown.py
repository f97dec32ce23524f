# SPDX-License-Identifier: Apache-2.0
"""What both derivations share of their pages: LaTeX blocks and cells, templates, and the command that writes a page."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined


def aligned(equations: list[tuple[str, str]]) -> list[str]:
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
    return ["$$", r"\begin{aligned}", *(f"{line} \\\\" for line in lines[:-1]), lines[-1], r"\end{aligned}", "$$"]


TERMS = 5


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


def render(template: str, **values) -> str:
    """A page from its template beside this file."""
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent), undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True,
        keep_trailing_newline=True, autoescape=False,
    )  # fmt: skip
    environment.globals |= {"cell": cell, "aligned": lambda equations: "\n".join(aligned(equations))}
    return environment.get_template(template).render(**values)


def command(
    arguments: list[str] | None, prog: str, about: str, page: Path, root: Path, text: str, wrong: list[str], said: str
) -> int:
    """Writes the page, or with --check compares it; status 1 if it is stale or a statement does not hold."""
    parser = argparse.ArgumentParser(prog=f"python -m {prog}", description=about)
    parser.add_argument("--check", action="store_true", help="compare the page, write nothing")
    check = parser.parse_args(arguments).check
    for line in wrong:
        print(line, file=sys.stderr)
    name = page.relative_to(root)
    if check:
        stale = not page.exists() or page.read_text(encoding="utf-8") != text
        if stale:
            print(f"{name} is out of date: run `make derive`", file=sys.stderr)
        return int(stale or bool(wrong))
    if wrong:
        print(f"{name} not written", file=sys.stderr)
        return 1
    page.write_text(text, encoding="utf-8")
    print(f"wrote {name}: {said}")
    return 0
