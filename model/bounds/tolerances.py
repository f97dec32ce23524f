# SPDX-License-Identifier: Apache-2.0
"""Tolerances of the hand error / reach, of the errors of hand poses, and of the norms of quaternions.

Scores, the soak and the list of worst targets use them.  A prediction (:mod:`model.bounds.predict`) explains an error
and is never a tolerance.  The paper's equations have no tolerance near their singular poses, because the error there
grows without bound: bits, flags and norms are checked at these poses, accuracy only on request (``TOLERANCE=``).
"""

import numpy as np

from ..dataflow.datapaths import MODELS
from ..dataflow.formats import WIDTHS
from ..io.flags import BAD_HAND, SATURATED, SINGULAR, UNREACHABLE
from ..reference.joints import reached
from ..reference.kinematics import angle_between
from .accuracy import STATED
from .predict import predicted_error

LEAN_ERRORS = """
    2.05e-4 1.06e-4 6.95e-5 2.67e-5 1.33e-5 6.67e-6 3.33e-6 1.66e-6 1e-6 4.17e-7 2.08e-7 1.25e-7 8.6e-8 6.05e-8
    4.78e-8 4.14e-8 2e-8
"""
LEAN = dict(zip(WIDTHS, map(float, LEAN_ERRORS.split()), strict=True))
"""Word length -> largest permitted hand error / reach of the lean datapath. Targets from a search for large errors have
their own tolerance, :func:`sought`. At 18 and 28 to 31 bits the tolerance is the proved limit; searches there (`soak
--worst 200`) find 5.07e-5, 5.27e-8, 3.42e-8, 2.43e-8 and 2.08e-8. In ulps of a result, it is 3.4 at 16 bits, 4.2 at 24
and 27, 21.5 at 32, else 3.5; searches (`--worst 300`) find up to 3.2 at 17 to 26 bits, and 1.91e-8 at 32. At 32 bits an
inner word has only three fraction bits more than a result (seven more at 17 to 28 bits), and a root one more."""

REGULAR = 1e-4
"""Tolerance of the paper's equations if all targets are regular: the paper's 1/16 mm, on an arm of 0.6 m."""

REGULAR_DISTANCE = 0.2  # minimum distance of a regular target from every singular pose (rad)
REGULAR_WIDTH = 32  # the word length for which REGULAR holds

LEAN_NORMS = dict.fromkeys(WIDTHS, (2.21, 1.5)) | {16: (2.1, 1.46), 18: (2.43, 1.6), 27: (2.43, 1.6)}
LEAN_NORMS |= {28: (2.87, 1.78), 29: (3.75, 2.16), 30: (5.5, 2.91), 31: (9.0, 4.41), 32: (16.0, 7.41)}
"""Word length -> largest permitted abs(norm^2 - 1) of Qs and of Qe in the lean datapath, in ulps of a result. Rounding
the components by half an ulp changes norm^2 by up to the sum of their magnitudes, in ulps: 2 (Qs) or sqrt(2) (Qe). The
remainder is caused by the roots, whose ulp is 2^-8 ulps of a result at 16 bits and half an ulp at 32. Searches find 2.1
at 18 bits and 15.4 at 32."""

PAPER_NORM = 16.0
"""Largest permitted abs(norm^2 - 1) of Qs and Qe in the paper datapath, in ulps; the largest observed is 9.4."""

ARM_ULPS = 12.5, 19.5
"""Largest permitted errors of the hand that the joint angles give, in ulps of a result: of its point, relative to reach
plus tool (from 28 bits on, the proved limit replaces it), and of its orientation (rad). They are 4.3e-8 and 1.8e-8 at
W = 32, 3e-6 and 4.6e-6 at W = 24, 1.9e-4 and 3e-4 at W = 18. Searches find 1.50e-8 and 1.52e-8 at W = 32."""

WRIST_ULPS = 3**0.5 * 0.9
"""Further error of the hand's point, in ulps of a length, from rounding each wrist coordinate to a word and half the
tool's offset to an inner word, which has three more bits at W = 32. Searches find 1.4 there, for tiny lengths."""


def arm(words: np.ndarray, width: int) -> tuple[np.ndarray, float]:
    """Return the largest permitted errors of hand poses (N, 11): point error (N,) in ulps, orientation error in rad."""
    reach = words[:, 4] + words[:, 5] + np.abs(words[:, 6])
    point, orientation = ARM_ULPS if width < 28 else (float(STATED["arm", "point"][width]), ARM_ULPS[1])
    return point * 2.0 ** (2 - width) * reach + WRIST_ULPS, orientation * 2.0 ** (2 - width)


def pose_errors(words: np.ndarray, results: np.ndarray, flags: np.ndarray, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the errors (N,) of the hand's point and orientation, divided by their tolerances, for hand poses (N, 11).
    They are nan where the wrist is out of reach or saturated, where |Qh| differs from 1 by more than rounding explains,
    and where two angles are split at a singular pose."""
    th, tool = results[:, :7].T * (2 * np.pi / (1 << width)), words[:, 6:7] * (0.0, 0.0, 1.0)
    point, hand = reached(th, words[:, 4], words[:, 5], tool)
    permitted = arm(words, width)
    unit = np.abs(np.linalg.norm(words[:, 7:11], axis=1) - (1 << width - 2)) <= 2
    unknown = np.where((flags & (UNREACHABLE | SATURATED | BAD_HAND | SINGULAR) == 0) & unit, 0.0, np.nan)
    off = np.linalg.norm(point - words[:, :3], axis=1) / permitted[0]
    return off + unknown, angle_between(hand, words[:, 7:11]) / permitted[1] + unknown


ROUNDED_POSE_ULPS = 3**0.5 / 2 + 3 / 2, 2.0
"""Further errors, in ulps, of a hand pose in the user's units: (1) of its point, from rounding three coordinates, d1,
d2 and tool to words; (2) of its orientation, from rounding the quaternion's four components."""


def pose(words: np.ndarray, width: int, across: np.ndarray) -> tuple[np.ndarray, float]:
    """Return the tolerances of :func:`arm`, increased by errors from rounding poses in the user's units to ``words``.

    ``across`` (N,): length, in ulps, of the tool's component perpendicular to the hand's z axis.
    """
    point, orientation = arm(words, width)
    orientation += ROUNDED_POSE_ULPS[1] * 2.0 ** (2 - width)
    return point + ROUNDED_POSE_ULPS[0] + orientation * across, orientation


def sought(width: int) -> float:
    """Return the largest permitted hand error / reach of the lean datapath for targets from a search for large errors:
    the larger of the proved limit (:mod:`.accuracy`) and :data:`LEAN`, which may be the proved limit, rounded up."""
    return max(LEAN[width], float(STATED["lean", "wrist"][width]) * 2.0 ** (2 - width))


def hand(width: int, datapath: str, *, regular: bool = False) -> float | None:
    """Return the largest permitted hand error / reach; None if there is no tolerance. For the whole arm, return 1, the
    bound of :func:`pose_errors`. ``regular``: all targets are at least :data:`REGULAR_DISTANCE` from singular poses."""
    if MODELS[datapath].side:
        return 1.0
    if MODELS[datapath].equations == "lean":
        return LEAN[width]
    return REGULAR if regular and width == REGULAR_WIDTH else None


def scale(words: np.ndarray, width: int, datapath: str) -> np.ndarray:
    """Return divisors (N,) by which to rank hand errors of input words (N, 6): the tolerance, or the predicted error if
    there is no tolerance. They only set the order; they do not decide whether a target passes."""
    most = hand(width, datapath)
    return predicted_error(words, width, datapath) if most is None else np.full(len(words), most)


def norm(width: int, datapath: str) -> float:
    """Return the largest permitted abs(norm^2 - 1) of a quaternion."""
    ulps = max(LEAN_NORMS[width]) if MODELS[datapath].equations == "lean" else PAPER_NORM
    return ulps * 2.0 ** (2 - width)
