# SPDX-License-Identifier: Apache-2.0
"""Tables of the generated pages, read back: for tests, and for what checks that a page is fresh."""


def table(text, heading):
    """Rows of the table whose first column is called `heading`."""
    lines = text.splitlines()
    start = next(i for i, line in enumerate(lines) if line.startswith(f"| {heading} |"))
    rows = []
    for line in lines[start + 2 :]:
        if not line.startswith("|"):
            break
        rows.append([cell.strip().strip("`") for cell in line.strip("|").split("|")])
    return rows
