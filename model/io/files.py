# SPDX-License-Identifier: Apache-2.0
"""Target files: CSV with a header, in the user's units; and atomic writing of any file.

Every error in a file is a `TargetError`, whose text is one line that names file, row, column and value.
"""

from __future__ import annotations

import codecs
import contextlib
import csv
import io
import math
import os
import re
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from .words import DEFAULT_D1, DEFAULT_D2, FIELDS, TargetError, Targets, cell_error

REQUIRED = ("x", "y", "z")
SEPARATORS = (",", ";", "\t")

Place = Callable[[Path], Path]
"""Function that returns where to write a file for now."""

# Other forms that float() accepts (underscores, non-ASCII digits) are errors in a target file.
_NUMBER = re.compile(r"[+-]?(([0-9]+\.?[0-9]*|\.[0-9]+)(e[+-]?[0-9]+)?|nan|inf|infinity)", re.IGNORECASE)


def read_csv(
    path: str | os.PathLike[str], *, d1: float | None = None, d2: float | None = None, phi: float = math.pi
) -> Targets:
    """Read targets from a CSV file with a header.

    Columns x, y, z are required; phi (rad), d1 and d2 are optional and default to the arguments (None: the default arm;
    pi: the elbow below). Columns may be in any order, with names in either case; other columns are kept for the results
    file, and a column arm names the arm of each row. Cells are separated by commas, semicolons (then a comma may also
    be the decimal point) or tabs, whichever the header uses. A byte order mark, CRLF, blank lines and lines that begin
    with # are accepted. Row numbers in messages are line numbers, as in an editor.

    Raises TargetError for any error in the file or in a value.
    """
    path = os.fspath(path)
    defaults = {"phi": phi, "d1": DEFAULT_D1 if d1 is None else d1, "d2": DEFAULT_D2 if d2 is None else d2}
    for column, default in defaults.items():
        reason = _value_reason(column, default)
        if reason:
            raise TargetError(f"default of {column}: '{default!r}' {reason}")

    rows, separator = _read_rows(path)
    if not rows:
        raise TargetError(f"{path}: the file is empty; its first line must be a header such as {','.join(FIELDS)}")
    header_row, header = rows[0]
    columns = _check_header(path, header_row, header)
    if len(rows) == 1:
        raise TargetError(f"{path}: row {header_row}: a header but no targets below it")

    values = {column: np.full(len(rows) - 1, default) for column, default in defaults.items()}
    values |= {column: np.empty(len(rows) - 1) for column in columns if column in FIELDS}
    others: dict[str, list[str]] = {column: [] for column in columns if column not in FIELDS}
    for n, (row, cells) in enumerate(rows[1:]):
        if len(cells) != len(columns):
            raise _length_error(path, row, cells, columns)
        for column, cell in zip(columns, cells, strict=True):
            if column in others:
                others[column].append(cell)
            else:
                values[column][n] = _parse(path, row, column, cell, separator)
    default_arm = tuple(name for name, given in (("d1", d1), ("d2", d2)) if given is None and name not in columns)
    lines = np.array([row for row, _ in rows[1:]])
    arm = next((np.array(cells) for name, cells in others.items() if name.lower() == "arm"), None)
    name = Path(path).stem
    return Targets(name, path=path, rows=lines, default_arm=default_arm, others=others, arm=arm, **values)


def _read_rows(path: str) -> tuple[list[tuple[int, list[str]]], str]:
    """Return the rows that are not blank or comments, each with its first line number, and the cell separator."""
    try:
        data = Path(path).read_bytes()
    except FileNotFoundError:
        raise TargetError(f"{path}: no such file") from None
    except IsADirectoryError:
        raise TargetError(f"{path}: is a directory, not a file of targets") from None
    except OSError as exc:
        raise TargetError(f"{path}: cannot be read: {exc.strerror}") from None
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        raise TargetError(f"{path}: is UTF-16 text; save it as UTF-8")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as exc:
        row = data[: exc.start].count(b"\n") + 1
        raise TargetError(f"{path}: row {row}: not UTF-8 text (byte 0x{data[exc.start]:02x})") from None

    head = next((line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")), "")
    separator = max(SEPARATORS, key=head.count)
    rows: list[tuple[int, list[str]]] = []
    reader = csv.reader(io.StringIO(text, newline=""), strict=True, delimiter=separator)
    first_line = 1
    try:
        for cells in reader:
            if any(cell.strip() for cell in cells) and not cells[0].lstrip().startswith("#"):
                rows.append((first_line, cells))
            first_line = reader.line_num + 1
    except csv.Error as exc:
        raise TargetError(f"{path}: row {first_line}: not CSV: {exc}") from None
    return rows, separator


def _check_header(path: str, row: int, header: list[str]) -> list[str]:
    """Return the column names in the file's order, target columns in lower case. Raises TargetError for repeated, empty
    or missing ones."""
    columns = [cell.strip() for cell in header]
    columns = [column.lower() if column.lower() in FIELDS else column for column in columns]
    if not set(columns) & set(REQUIRED):
        reason = f"is not a header; expected {','.join(REQUIRED)} and optionally {','.join(FIELDS[3:])}"
        raise cell_error(path, row, columns[0] or "(no name)", ",".join(columns), reason)
    for n, column in enumerate(columns, 1):
        if columns.count(column) > 1 and column:
            raise cell_error(path, row, column, header[n - 1].strip(), "appears twice in the header")
    for column in REQUIRED:
        if column not in columns:
            raise TargetError(f"{path}: row {row}, column {column}: is missing; the header is {','.join(columns)!r}")
    return [column or f"column {n}" for n, column in enumerate(columns, 1)]


def _length_error(path: str, row: int, cells: list[str], columns: list[str]) -> TargetError:
    """Return the error for a row whose number of cells differs from the header's."""
    count = f"the header has {len(columns)} columns, this row has {len(cells)}"
    if len(cells) > len(columns):
        extra = len(columns)
        return cell_error(path, row, str(extra + 1), cells[extra], f"is one too many: {count}")
    missing = columns[len(cells)]
    return cell_error(path, row, missing, "", f"is missing: {count}")


def _parse(path: str, row: int, column: str, cell: str, separator: str) -> float:
    text = cell.strip()
    if separator == ";":
        text = text.replace(",", ".", 1)
    if not _NUMBER.fullmatch(text):
        raise cell_error(path, row, column, text, "is not a number" if text else "is empty")
    value = float(text)
    reason = _value_reason(column, value)
    if reason:
        raise cell_error(path, row, column, text, reason)
    return value


def number(text: str) -> float:
    """Return the finite number in a text. Raises ValueError, even for text that float() accepts, such as 1_0."""
    value = float(text) if _NUMBER.fullmatch(text) else math.nan
    if not math.isfinite(value):
        raise ValueError(f"{text!r} is not a finite number")
    return value


def _value_reason(column: str, value: float) -> str | None:
    """Return the reason why `value` is not allowed in `column`, or None."""
    if not math.isfinite(value):
        return "is not a finite number"
    if column in ("d1", "d2") and value <= 0:
        return "is not positive: an arm length must be greater than 0"
    return None


def format_csv(targets: Targets) -> str:
    """Return the text of a target file: a header with all six columns and one row per target, exact to the last bit."""
    lines = [",".join(FIELDS)]
    table = np.column_stack([getattr(targets, field) for field in FIELDS])
    lines += [",".join(map(repr, row)) for row in table.tolist()]
    return "\n".join(lines) + "\n"


@contextlib.contextmanager
def whole_files() -> Iterator[Place]:
    """Yield a function that returns a temporary path in the folder of a path; rename all temporary files at the end, or
    remove them after an error.

    After Ctrl-C or on a full disk the user finds all the old files, otherwise all the new ones. An OSError names the
    path, without a filename the one asked for last.
    """
    paths: dict[str, Path] = {}

    def temporary(path: Path) -> Path:
        hidden = path.absolute().with_name(f".{os.getpid()}.{path.name}")
        paths[str(hidden)] = path
        return hidden

    try:
        yield temporary
        for hidden, path in paths.items():
            if os.path.exists(hidden):
                os.replace(hidden, path)
    except OSError as error:
        hidden = str(error.filename) if error.filename or not paths else list(paths)[-1]
        if hidden in paths:
            error.filename = os.fspath(paths[hidden])
        raise
    finally:
        for hidden in paths:
            Path(hidden).unlink(missing_ok=True)


def write_atomically(path: Path, content: str | bytes) -> None:
    """Write a file in one step. Raises OSError, whose filename is `path`."""
    with whole_files() as temporary:
        temporary(path).write_bytes(content.encode() if isinstance(content, str) else content)
