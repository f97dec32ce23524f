# SPDX-License-Identifier: Apache-2.0
"""A second opinion on what the core answers: the C of table 6 in long double, which shares no code with the model.

`make soak AGAINST=c` asks it: the lean equations for every target without a flag, the paper's for those that keep
`REGULAR_DISTANCE` from every singular pose, next to which they lose digits, and whose arms are not too unequal.
"""

from __future__ import annotations

import ctypes
import tempfile
from functools import cache
from pathlib import Path

import numpy as np

from model.bounds.tolerances import REGULAR_DISTANCE
from model.io.flags import expected_flags
from model.io.scoring import singular_distance
from model.io.words import from_words
from scripts.paper.table6.compiled import SOURCE, library
from tb.core.opinion import Opinion

LONG = SOURCE.with_name("long.c")
EQUATIONS = ("lean", "paper")
PHI, D1, D2 = 3, 4, 5  # their places among the words

UNEQUAL = 2.0**-24
"""The paper's equations add the squares of the arms: of one that is so much shorter than the other, 16 bits are left
of the 64 of a long double."""


@cache
def compiled() -> ctypes.CDLL:
    """The C as a library. InputError where there is no compiler."""
    with tempfile.TemporaryDirectory(prefix="ik_") as folder:  # each process its own
        return ctypes.CDLL(str(library(LONG, Path(folder) / "long.so")))


def opinions(words: np.ndarray, width: int) -> list[Opinion]:
    """What the C answers to input words (N, 6), by either set of equations, and to which of them it is held."""
    scale = np.full(words.shape[1], np.longdouble(2) ** (2 - width))
    scale[PHI] = np.longdouble(2) ** (1 - width) * 4 * np.arctan(np.longdouble(1))
    given = [np.ascontiguousarray(column * factor) for column, factor in zip(words.T, scale, strict=True)]
    plain = expected_flags(words, width) == 0
    regular = plain.copy()
    regular[plain] = singular_distance(from_words(words[plain], 0, width, "soak")) >= REGULAR_DISTANCE
    shorter, longer = np.sort(words[:, [D1, D2]].astype(float)).T
    regular &= shorter >= UNEQUAL * longer
    found = []
    for name, rows in zip(EQUATIONS, (plain, regular), strict=True):
        answers = np.full(words.shape, np.nan)
        pointers = [ctypes.c_void_p(array.ctypes.data) for array in (*given, answers)]
        getattr(compiled(), f"{name}_poses")(ctypes.c_long(len(words)), *pointers)
        found.append(Opinion(f"C, long double, {name} equations", answers, rows))
    return found
