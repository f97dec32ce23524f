# SPDX-License-Identifier: Apache-2.0
"""The tolerances that scores, the soak and the list of hardest targets judge by: hand error / reach, norm error.

A prediction (:mod:`model.bounds.predict`) explains an error and is never a tolerance. For the paper's equations near
their singular poses, where their error grows without bound, and for their short words the table has none: there bits,
flags and norms are judged, and the accuracy only if the user asks for one (``BAR=``).
"""

from __future__ import annotations

import numpy as np

from ..dataflow.datapaths import CONFIGURATIONS
from .predict import hand_bar

LEAN = {32: 2e-8, 27: 1.25e-7, 24: 1e-6, 18: 5e-5, 16: 2.05e-4}
"""Word length -> largest hand error / reach of the lean datapath, in any pose that was not sought for its error
(:func:`sought`): 3.3 ulps of a result for 18 bits and 3.4 for 16; 4.2 for 24 and as many for 27; 21.5 for 32, whose
inner words have three bits more than the results where the others have seven, and whose roots have one."""

LEAN_ULPS = 4.2
"""The same at other lengths, in ulps of a result (that of 24 and 27 bits), but not below that of 32: from 29 bits on,
inner words do not grow any more.  In 40000 targets of every kind at each length, no error is above 2.9 ulps up to 30
bits and 3.9 at 31."""

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

NORM_ULPS = 16
"""Ulps that abs(norm^2 - 1) of a quaternion may have, of the coarsest of its factors: its words are rounded, and so are
the factors and the length that they come from."""


def lean(width: int) -> float:
    """Largest hand error / reach of the lean datapath at a word length."""
    return LEAN.get(width) or max(LEAN_ULPS * 2.0 ** (2 - width), LEAN[32])


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


FACTORS = ("qe_w", "qe_abs", "l_m", "q12_i", "q12_j", "q12_k", "q3_scalar", "q3_abs")
"""The quotients and roots that the paper's quaternions are made of: a shortened one has coarser places."""


def norm(width: int, datapath: str) -> float:
    """Largest abs(norm^2 - 1) of a quaternion."""
    cuts = CONFIGURATIONS[datapath].cuts
    return NORM_ULPS * 2.0 ** (2 - width + max(cuts.get(name, 0) for name in FACTORS))
