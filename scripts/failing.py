# SPDX-License-Identifier: Apache-2.0
"""What fails told on stderr, and the lists of hard or failing targets as files."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

from model.io.files import write_atomically
from model.io.words import FIELDS
from scripts.console import InputError, writing
from tb.core import hardest
from tb.core.random_targets import Core, Failure


def tell(failures: list[Failure], words: np.ndarray, where: Callable[[int], str]) -> list[int]:
    """Say on stderr what fails, with the words of each failure's first target; the rows of all of them in order."""
    for failure in failures:
        what, *more = failure.lines
        n = failure.rows[0] if failure.rows else None
        print(f"soak: {'somewhere' if n is None else where(n)}: {what}", file=sys.stderr)
        if n is not None:
            named = " ".join(f"{name}={word}" for name, word in zip(FIELDS, words[n].tolist(), strict=True))
            print(f"soak: its words: {named}", file=sys.stderr)
        for line in more:
            print(f"soak: {line}", file=sys.stderr)
    return list(dict.fromkeys(n for failure in failures for n in failure.rows))


def write_rows(path: Path, rows: list[hardest.Row]) -> None:
    with writing():
        write_atomically(path, hardest.text(rows))


def row_of(core: Core, words: np.ndarray, hand_error: float, found: str) -> hardest.Row:
    error = None if math.isnan(hand_error) else float(hand_error)
    words = tuple(map(int, words))
    return hardest.Row(core.datapath, core.width, words, error, found)


def read_rows(path: Path) -> list[hardest.Row]:
    try:
        return hardest.read(path)
    except ValueError as error:
        raise InputError(str(error)) from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None
