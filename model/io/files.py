# SPDX-License-Identifier: Apache-2.0
"""Target files (CSV with a header, in the user's units), and atomic writing of any file.

A `TargetError` is one line that names file, row, column and value.
"""

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

from ..reference.kinematics import fixed_axes
from .words import DEFAULT_D1, DEFAULT_D2, FIELDS, LENGTH_TOLERANCE, TargetError, Targets, cell_error

REQUIRED = ("x", "y", "z")
QUATERNION = ("qw", "qx", "qy", "qz")
EULER = ("roll", "pitch", "yaw")  # rad, about the fixed axes x, y, z in turn, as in URDF files
OF_HANDS = (*QUATERNION, *EULER, "tool", "branch")  # columns of hand poses; the last two are optional

Place = Callable[[Path], Path]  # path -> temporary path to write to

# Other forms that float() accepts (underscores, non-ASCII digits) are errors in a target file.
_NUMBER = re.compile(r"[+-]?(([0-9]+\.?[0-9]*|\.[0-9]+)(e[+-]?[0-9]+)?|nan|inf|infinity)", re.IGNORECASE)


def read_csv(
    path: str | os.PathLike[str], *, d1: float | None = None, d2: float | None = None, phi: float | None = math.pi
) -> Targets:
    """Read targets from a CSV file with a header.

    docs/targets.md describes the file. d1, d2 and phi (rad) replace columns that the file lacks; a length of None means
    that of the default arm, and a phi of None means nan. Rows in messages are line numbers. Raises TargetError for a
    bad file and for a bad d1, d2 or phi.
    """
    path = os.fspath(path)
    asked = {column: value for column, value in (("phi", phi), ("d1", d1), ("d2", d2)) if value is not None}
    for column, value in asked.items():
        if reason := _value_reason(column, value):
            raise TargetError(f"default of {column}: '{value!r}' {reason}")
    defaults = {"phi": math.nan, "d1": DEFAULT_D1, "d2": DEFAULT_D2} | asked

    rows, separator = _read_rows(path)
    if not rows:
        raise TargetError(f"{path}: the file is empty; its first line must be a header such as {','.join(FIELDS)}")
    header_row, header = rows[0]
    columns = _check_header(path, header_row, header)
    if len(rows) == 1:
        raise TargetError(f"{path}: row {header_row}: a header but no targets below it")

    values = {column: np.full(len(rows) - 1, default) for column, default in defaults.items()}
    of_hands = [name for name in OF_HANDS if name in columns] if {*columns} & {*QUATERNION, *EULER} else []
    values |= {column: np.empty(len(rows) - 1) for column in columns if column in (*FIELDS, *of_hands)}
    others: dict[str, list[str]] = {column: [] for column in columns if column not in values}
    for n, (row, cells) in enumerate(rows[1:]):
        count, needed = len(cells), len(columns)
        if count != needed:
            column, cell = (str(needed + 1), cells[needed]) if count > needed else (columns[count], "")
            reason = "is one too many" if count > needed else "is missing"
            reason += f": the header has {needed} columns, this row has {count}"
            raise cell_error(path, row, column, cell, reason)
        for column, cell in zip(columns, cells, strict=True):
            if column in others:
                others[column].append(cell)
            else:
                values[column][n] = _parse(path, row, column, cell, separator)
    default_arm = tuple(name for name in ("d1", "d2") if name not in (*asked, *columns))
    lines = np.array([row for row, _ in rows[1:]])
    arm = next((np.array(cells) for name, cells in others.items() if name.lower() == "arm"), None)
    others |= {column: [repr(v) for v in values[column].tolist()] for column in of_hands}
    hands = _hands(path, lines, {column: values.pop(column) for column in of_hands})
    name = Path(path).stem
    return Targets(name, path=path, rows=lines, default_arm=default_arm, others=others, arm=arm, **hands, **values)


def _hands(path: str, rows: np.ndarray, values: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return the fields of Targets that the columns :data:`OF_HANDS` define; {} if there are no such columns."""
    if not values:
        return {}
    euler = EULER[0] in values
    turns = [values[column] for column in (EULER if euler else QUATERNION)]
    q = fixed_axes(*turns) if euler else np.column_stack(turns)
    with np.errstate(over="ignore"):
        length = np.sqrt((q**2).sum(axis=1))
    branch = values.get("branch", np.zeros(len(q)))
    for wrong, column, reason in (
        (~(np.abs(length - 1) <= LENGTH_TOLERANCE), "qw", "is part of a quaternion of length {:.6g}, not 1"),
        (~np.isin(branch, range(8)), "branch", "is not a whole number from 0 to 7"),
    ):
        if wrong.any():
            n = int(wrong.argmax())
            raise cell_error(path, int(rows[n]), column, f"{values[column][n]:.12g}", reason.format(length[n]))
    tool = values.get("tool", np.zeros(len(q)))
    return {"hand": q / length[:, None], "tool": tool, "branch": branch.astype(np.int64)}


def _read_rows(path: str) -> tuple[list[tuple[int, list[str]]], str]:
    """Return the rows (first line number, cells) without blank rows and comments, and the cell separator."""
    try:
        data = Path(path).read_bytes()
    except OSError as exc:
        known = {FileNotFoundError: "no such file", IsADirectoryError: "is a directory, not a file of targets"}
        raise TargetError(f"{path}: {known.get(type(exc), f'cannot be read: {exc.strerror}')}") from None
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        raise TargetError(f"{path}: is UTF-16 text; save it as UTF-8")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as exc:
        row = data[: exc.start].count(b"\n") + 1
        raise TargetError(f"{path}: row {row}: not UTF-8 text (byte 0x{data[exc.start]:02x})") from None

    head = next((line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")), "")
    separator = max(",;\t", key=head.count)
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
    """Return the column names; those of targets and hands are in lower case.  Raises TargetError for a bad header."""
    columns = [cell.strip() for cell in header]
    of_hands = OF_HANDS if {column.lower() for column in columns} & {*QUATERNION, *EULER} else ()
    columns = [column.lower() if column.lower() in (*FIELDS, *of_hands) else column for column in columns]
    if not set(columns) & set(REQUIRED):
        reason = f"is not a header; expected {','.join(REQUIRED)} and optionally {','.join(FIELDS[3:])}"
        raise cell_error(path, row, columns[0] or "(no name)", ",".join(columns), reason)
    for n, column in enumerate(columns, 1):
        if columns.count(column) > 1 and column:
            raise cell_error(path, row, column, header[n - 1].strip(), "appears twice in the header")
    turns = [names for names in (QUATERNION, EULER) if set(names) & set(columns)] if of_hands else []
    if len(turns) > 1:
        raise cell_error(path, row, "roll", ",".join(columns), "has both a quaternion and roll, pitch, yaw")
    if missing := [column for column in sum(turns, REQUIRED) if column not in columns]:
        of = f"columns {', '.join(missing)}: are" if len(missing) > 1 else f"column {missing[0]}: is"
        raise TargetError(f"{path}: row {row}, {of} missing; the header is {','.join(columns)!r}")
    return [column or f"column {n}" for n, column in enumerate(columns, 1)]


def _parse(path: str, row: int, column: str, cell: str, separator: str) -> float:
    text = cell.strip()
    if separator == ";":
        text = text.replace(",", ".", 1)
    reason: str | None = "is not a number" if text else "is empty"
    if _NUMBER.fullmatch(text):
        reason = _value_reason(column, float(text))
    if reason:
        raise cell_error(path, row, column, text, reason)
    return float(text)


def number(text: str) -> float:
    """Convert a text to a finite number.  Raises ValueError, also for some forms that float() accepts, such as 1_0."""
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
    """Return the text of a target file, exact to the last bit."""
    cells = {field: [*map(repr, getattr(targets, field).tolist())] for field in FIELDS}
    cells |= {column: targets.others[column] for column in OF_HANDS if column in targets.others}
    return "\n".join([",".join(cells), *map(",".join, zip(*cells.values(), strict=True))]) + "\n"


@contextlib.contextmanager
def whole_files() -> Iterator[Place]:
    """Yield a function path -> temporary path in the same folder. At the end rename all temporary files to their paths;
    after an error in the block remove them, so that the old files remain.

    An OSError names the requested path, not the temporary one; if it names no file, it gets the last requested path.
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
    """Write a file atomically.  Raises OSError, whose filename is `path`."""
    with whole_files() as temporary:
        temporary(path).write_bytes(content.encode() if isinstance(content, str) else content)
