# SPDX-License-Identifier: Apache-2.0
"""Regression list of the hardest targets found so far: ``tb/core/worst_targets.csv``.

``python -m scripts.soak --keep`` writes it; tb/core/test_every_node.py runs it. A reachable target is hard if its hand
error is large compared with its tolerance (paper: predicted error), or if its quaternions are far from unit length. A
row holds the datapath, the word length, the input words, the bit-true model's hand error / reach, and where the target
was found. In the row of a hand pose the last word is the branch, and the error is relative to the tolerance.
"""

import csv
import io
import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from model.bounds import tolerances
from model.dataflow.datapaths import MODELS
from model.dataflow.formats import WIDTHS
from model.io.files import number
from model.io.flags import UNREACHABLE, expected_flags
from model.io.scoring import hand_errors
from model.io.words import ARM_FIELDS, FIELDS, TargetError, from_words, result_values
from tb.sim.env import ROOT
from tb.sim.job import answer

LIST = ROOT / "tb" / "core" / "worst_targets.csv"
COLUMNS = ("datapath", "width", *FIELDS, *ARM_FIELDS[len(FIELDS) :], "branch", "hand_error", "found")
"""Columns of the list. The columns from tool to branch are empty for wrist targets."""

KEPT = 10  # targets kept for each measure of hardness, per datapath and word length


@dataclass(frozen=True)
class Row:
    """One line of the list."""

    datapath: str
    width: int
    words: tuple[int, ...]
    hand_error: float
    found: str


def errors(
    words: np.ndarray, results: np.ndarray, width: int, flags: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Return hand error / reach (N,), nan out of reach, and the larger abs(norm^2 - 1) (N,) of the quaternions.

    The whole arm needs ``flags``; the larger of :func:`tolerances.pose_errors` then replaces hand error / reach.
    """
    arm = words.shape[1] > len(FIELDS)
    quaternions = result_values(results[:, 7:13] if arm else results, width)
    if arm:
        hand = np.maximum(*tolerances.pose_errors(words, results, flags, width))
    else:
        reachable = expected_flags(words, width) & UNREACHABLE == 0
        hand = np.full(len(words), np.nan)
        hand[reachable] = hand_errors(quaternions[reachable], from_words(words[reachable], 0, width, "reachable"))
    return hand, np.maximum(*(np.abs((q**2).sum(axis=1) - 1) for q in (quaternions[:, :4], quaternions[:, 4:])))


def named(count: int) -> tuple[str, ...]:
    """Return the names of ``count`` input words: of a wrist target, or of a pose and its branch."""
    return (*ARM_FIELDS, "branch") if count > len(FIELDS) else FIELDS


def array(rows: Iterable[Row]) -> np.ndarray:
    """Return the input words of rows: wrist targets (N, 6), or poses with their branch (N, 12)."""
    words = [row.words for row in rows]
    return np.array(words, dtype=np.int64).reshape(len(words), -1 if words else len(FIELDS))


def groups(rows: Iterable[Row]) -> dict[tuple[str, int], list[Row]]:
    """Group rows by (datapath, width), in the order of these."""
    grouped: dict[tuple[str, int], list[Row]] = {}
    for row in rows:
        grouped.setdefault((row.datapath, row.width), []).append(row)
    return dict(sorted(grouped.items()))


def read(path: Path) -> list[Row]:
    """Read the rows of a list file. Raises OSError, and TargetError for wrong contents."""
    rows, line = [], 1
    try:
        with open(path, encoding="utf-8", newline="") as stream:
            for line, cells in enumerate(csv.reader(stream, strict=True), 1):
                if line > 1:
                    rows.append(_row(cells))
                elif tuple(cells) != COLUMNS:
                    raise ValueError(f"the header has to be {','.join(COLUMNS)}")
    except (csv.Error, ValueError) as error:
        raise TargetError(f"{path}: not a CSV file of targets: row {line}: {error}") from None
    return rows


def _row(cells: list[str]) -> Row:
    if len(cells) != len(COLUMNS):
        raise ValueError(f"{len(cells)} columns instead of {len(COLUMNS)}")
    datapath, *_, error, found = cells
    if datapath not in MODELS:
        raise ValueError(f"unknown datapath {datapath!r}")
    names = COLUMNS[1:-2] if MODELS[datapath].side else COLUMNS[1 : 2 + len(FIELDS)]
    for name, cell in zip(names, cells[1:], strict=False):
        if not re.fullmatch(r"-?\d+", cell):
            raise ValueError(f"column {name}: {cell!r} is not a whole number")
    width, *words = map(int, cells[1 : 1 + len(names)])
    if width not in WIDTHS:
        raise ValueError(f"unknown width {width}")
    if not all(-(1 << (width - 1)) <= word < 1 << (width - 1) for word in words):
        raise ValueError(f"a word does not fit {width} bits")
    return Row(datapath, width, tuple(words), number(error), found)


def text(rows: Iterable[Row]) -> str:
    """Return the contents of the list file for these rows."""
    out = io.StringIO()
    write = csv.writer(out, lineterminator="\n").writerow
    write(COLUMNS)
    for row in rows:
        words = [*row.words, *[""] * (len(COLUMNS) - 4 - len(row.words))]
        write((row.datapath, row.width, *words, _written(row.hand_error), row.found))
    return out.getvalue()


def _written(error: float) -> str:
    return f"{error:.6e}"


def merge(rows: Iterable[Row]) -> list[Row]:
    """Return the hardest rows of each datapath and word length: ``KEPT`` by hand error / tolerance, then ``KEPT``
    others by norm error. The order of ``rows`` has no effect. Hand errors are recomputed."""
    kept = []
    for (datapath, width), group in groups(rows).items():
        # Keep one row of a target found more than once: the first by `found`.
        once = {row.words: row for row in sorted(group, key=lambda row: (row.words, row.found), reverse=True)}
        unique = [once[words] for words in sorted(once)]
        words = array(unique)
        run = answer(words, width, datapath)
        hand, norm = errors(words, run.results, width, run.flags)
        # Row by row: the random endpoints that predicted_error tries depend on a target's index in the array.
        ratio = hand / np.concatenate([tolerances.scale(word[None], width, datapath) for word in words])
        reachable = np.flatnonzero(~np.isnan(hand))
        by_hand = reachable[np.argsort(-ratio[reachable], kind="stable")]
        by_norm = reachable[np.argsort(-norm[reachable], kind="stable")]
        chosen = by_hand[:KEPT].tolist()
        chosen += [n for n in by_norm.tolist() if n not in chosen][:KEPT]
        chosen.sort(key=lambda n: (-float(_written(hand[n])), unique[n].words))
        kept += [replace(unique[n], hand_error=float(hand[n])) for n in chosen]
    return kept
