# SPDX-License-Identifier: Apache-2.0
"""Comparison of generated pages with fresh ones."""

import re


def table(text, heading):
    """Return the rows of the table whose first column is headed `heading`."""
    lines = text.splitlines()
    start = next(i for i, line in enumerate(lines) if line.startswith(f"| {heading} |"))
    rows = []
    for line in lines[start + 2 :]:
        if not line.startswith("|"):
            break
        rows.append([cell.strip().strip("`") for cell in re.split(r"(?<!\\)\|", line)[1:-1]])
    return rows


NUMBER = re.compile(r"-?\b\d+\.?\d*(?:e[-+]?\d+)?\b")
SAME_FIGURE = 0.06
"""Tolerance: sines of another processor may differ in the last place and change the rounding of a two-digit figure."""


def differing(text: str, fresh: str) -> list[str]:
    """Return the lines of a page that differ from a fresh page; figures are compared to two digits."""
    old, new = text.splitlines(), fresh.splitlines()
    wrong = [] if len(old) == len(new) else [f"the page has {len(old)} lines, just made {len(new)}"]
    for a, b in zip(old, new, strict=False):
        pairs = zip(NUMBER.findall(a), NUMBER.findall(b), strict=False)
        close = all(abs(float(u) - float(v)) <= SAME_FIGURE * max(abs(float(u)), abs(float(v))) for u, v in pairs)
        if NUMBER.sub("0", a) != NUMBER.sub("0", b) or not close:
            wrong.append(f"the page has: {a}\n   just made: {b}")
    return wrong
