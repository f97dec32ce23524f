# SPDX-License-Identifier: Apache-2.0
"""The tolerances that scores, the soak and the list of hardest targets judge by: hand error / reach, norm error.

A prediction (:mod:`model.bounds.predict`) explains an error and is never a tolerance. For the paper's equations near
their singular poses, where their error grows without bound, the table has none: there bits,
flags and norms are judged, and the accuracy only if the user asks for one (``BAR=``).
"""

from __future__ import annotations

import numpy as np

from ..dataflow.datapaths import CONFIGURATIONS
from .predict import hand_bar

LEAN = {
    16: 2.05e-4, 17: 1.06e-4, 18: 5e-5, 19: 2.67e-5, 20: 1.33e-5, 21: 6.67e-6, 22: 3.33e-6, 23: 1.66e-6, 24: 1e-6,
    25: 4.17e-7, 26: 2.08e-7, 27: 1.25e-7, 28: 5.4e-8, 29: 3.12e-8, 30: 2e-8, 31: 2e-8, 32: 2e-8,
}  # fmt: skip
"""Word length -> largest hand error / reach of the lean datapath, in any pose that was not sought for its error
(:func:`sought`).  3.3 ulps of a result for 18 bits, 3.4 for 16, 3.5 up to 26 and 3.6 for 28, but 4.2 for 24, 27 and 29;
then more, up to 21.5 for 32, whose inner words have three bits more than the results where the others have seven, and
whose roots have one.  Short searches (`soak --worst 300`) find up to 3.2 ulps from 17 to 26 bits, 3.3 at 28, 3.9
at 29, and 1.91e-8 and 1.47e-8 at 30 and 31."""

ROUNDED_ULPS = 2 + 2**0.5
"""Hand error / reach of results rounded to the nearest word, in ulps, where Qs is a quarter turn about an axis of the
frame, the forearm has all of the reach and all roundings go one way.  No bits inside the core make it less, and the
tolerance of 18 bits is 3.28 of them."""

REGULAR = 1e-4
"""Of the paper's equations where all targets are regular: the paper group's 1/16 mm on an arm of 0.6 m."""

REGULAR_DISTANCE = 0.2
"""How far from every singular pose a regular target keeps (rad)."""

REGULAR_WIDTH = 32
"""Word length at which a regular trajectory has this fixed tolerance."""

LEAN_NORMS = {
    16: (2.1, 1.46), 17: (2.21, 1.5), 18: (2.43, 1.6), 19: (2.21, 1.5), 20: (2.21, 1.5), 21: (2.21, 1.5),
    22: (2.21, 1.5), 23: (2.21, 1.5), 24: (2.21, 1.5), 25: (2.21, 1.5), 26: (2.21, 1.5), 27: (2.43, 1.6),
    28: (2.87, 1.78), 29: (3.75, 2.16), 30: (5.5, 2.91), 31: (9.0, 4.41), 32: (16.0, 7.41),
}  # fmt: skip
"""Word length -> ulps of a result that abs(norm^2 - 1) of Qs and of Qe may have in the lean datapath.  Half an ulp in
every word changes norm^2 by the sum of their magnitudes, which is 2 at most (Qs), sqrt(2) (Qe); the rest is of the
roots, whose places are 2^-8 ulps at 16 bits, half an ulp at 32.  Searches find 2.1 at 18 bits, 15.4 at 32."""

PAPER_NORM = 16.0
"""The same of the paper's datapath, of either quaternion: at most 9.4 was seen."""


def lean(width: int) -> float:
    """Largest hand error / reach of the lean datapath at a word length."""
    return LEAN[width]


def sought(width: int) -> float:
    """Largest hand error / reach of the lean datapath in a target that was sought for its error: the tolerance, or
    what rounding results can do where that is more."""
    return max(lean(width), ROUNDED_ULPS * 2.0 ** (2 - width))


def hand(width: int, datapath: str, *, regular: bool = False) -> float | None:
    """Largest hand error / reach of any target; None where the table has nothing.

    ``regular``: all targets keep :data:`REGULAR_DISTANCE`, which a file or trajectory may say of itself.
    """
    if CONFIGURATIONS[datapath].equations == "lean":
        return lean(width)
    return REGULAR if regular and width == REGULAR_WIDTH else None


def yardstick(words: np.ndarray, width: int, datapath: str) -> np.ndarray:
    """What hand errors of input words (N, 6) are ranked by, (N,): the tolerance, or where there is none what the
    roundings explain. Nothing fails by it."""
    most = hand(width, datapath)
    return hand_bar(words, width, datapath) if most is None else np.full(len(words), most)


def norm(width: int, datapath: str) -> float:
    """Largest abs(norm^2 - 1) of a quaternion."""
    lean = CONFIGURATIONS[datapath].equations == "lean"
    ulps = max(LEAN_NORMS[width]) if lean else PAPER_NORM
    return ulps * 2.0 ** (2 - width)
