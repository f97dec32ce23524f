# SPDX-License-Identifier: Apache-2.0
"""The generated pages: their templates, their tables and their pictures."""

from __future__ import annotations

import functools
import io
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined

TEMPLATES = Environment(
    loader=FileSystemLoader(Path(__file__).parent / "templates"),
    undefined=StrictUndefined,
    trim_blocks=True,
    lstrip_blocks=True,
    keep_trailing_newline=True,
)


def row(cells: Iterable[Any]) -> str:
    """A row of a table."""
    return f"| {' | '.join(map(str, cells))} |"


def table(head: Sequence[Any], rows: Iterable[Iterable[Any]], left: int = 1) -> str:
    """A table, its first ``left`` columns to the left and the others, figures, to the right."""
    line = ["---"] * left + ["--:"] * (len(head) - left)
    return "\n".join(map(row, (head, line, *rows)))


def error(value: float | None) -> str:
    """An error in a table, which None is where nothing was measured."""
    return "-" if value is None else f"{value:.1e}"


TEMPLATES.filters |= {"row": row, "error": error}
TEMPLATES.globals |= {"table": table}


def render(name: str, **values: Any) -> str:
    """The page of ``templates/<name>.md.j2``, or of a name with another suffix; a missing value is an error."""
    return TEMPLATES.get_template(f"{name}.j2" if "." in name else f"{name}.md.j2").render(values)


def svg(paint: Callable) -> Callable[..., bytes]:
    """Of ``paint(pyplot, ...)``, which returns a figure: the same that returns an SVG, of the same bytes every time."""

    @functools.wraps(paint)
    def painted(*arguments: Any) -> bytes:
        import matplotlib

        matplotlib.use("Agg")
        import matplotlib.pyplot as plt

        style = {"svg.hashsalt": "cga-ik", "svg.fonttype": "path", "font.family": "DejaVu Sans", "font.size": 10}
        with matplotlib.rc_context(style):
            figure, out = paint(plt, *arguments), io.BytesIO()
            figure.savefig(out, format="svg", metadata={"Date": None, "Creator": None})
            plt.close(figure)
        return out.getvalue()

    return painted
