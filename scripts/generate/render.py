# SPDX-License-Identifier: Apache-2.0
"""Templates and table formatting for the generated pages."""

import itertools
import re
import subprocess
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from tb.sim.env import ROOT

TEMPLATES = Environment(
    loader=FileSystemLoader(Path(__file__).parent / "templates"),
    undefined=StrictUndefined,
    trim_blocks=True,
    lstrip_blocks=True,
    keep_trailing_newline=True,
)


def row(cells: Iterable[Any]) -> str:
    return f"| {' | '.join(map(str, cells))} |"


def table(head: Sequence[Any], rows: Iterable[Iterable[Any]], left: int = 1) -> str:
    """Return a Markdown table; the first ``left`` columns are left-aligned, the others right-aligned."""
    line = ["---"] * left + ["--:"] * (len(head) - left)
    return "\n".join(map(row, (head, line, *rows)))


def read_table(page: Path, heading: str) -> list[list[str]]:
    """Return the rows of the page's table whose first heading is ``heading``; [] if there is no such table. Backquotes
    around a cell are removed."""
    lines = page.read_text(encoding="utf-8").splitlines() if page.exists() else []
    start = next((i for i, line in enumerate(lines) if line.startswith(f"| {heading} |")), len(lines))
    rows = itertools.takewhile(lambda line: line.startswith("|"), lines[start + 2 :])
    cells = ([cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]] for line in rows)
    return [[re.sub(r"^`([^`]*)`$", r"\1", cell) for cell in row] for row in cells]


def form(value: Any, pattern: str = "{}") -> str:
    """Format a value; a missing one (None or empty) becomes a dash."""
    return "-" if value in (None, "") else pattern.format(value)


def error(value: float | None, digits: int = 1) -> str:
    """Format an error; None, for an error that was not measured, becomes a dash."""
    return form(value, f"{{:.{digits}e}}")


def update(texts: Mapping[Path, str]) -> None:
    """Write each text (path -> text) that differs from the file in the checkout."""
    for path, text in texts.items():
        if not path.exists() or path.read_text("utf-8") != text:
            path.write_text(text, "utf-8")
            print(f"wrote {path.relative_to(ROOT)}")


def commit() -> str:
    """Return the checkout's short commit hash, followed by + if rtl has uncommitted changes."""

    def git(*words):
        return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=False).stdout.strip()

    return git("rev-parse", "--short", "HEAD") + ("+" if git("status", "--porcelain", "rtl") else "")


TEMPLATES.filters |= {"row": row, "form": form, "error": error}
TEMPLATES.globals |= {"table": table}


def render(name: str, **values: Any) -> str:
    """Render ``templates/<name>.md.j2``, or ``<name>.j2`` if the name has a suffix; a missing value is an error."""
    return TEMPLATES.get_template(f"{name}.j2" if "." in name else f"{name}.md.j2").render(values)
