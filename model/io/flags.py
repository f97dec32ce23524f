# SPDX-License-Identifier: Apache-2.0
"""Flag bits above the tag in `m_axis_tuser`, and the exact rule for each."""

from enum import IntFlag

import numpy as np


class Flag(IntFlag):
    """Flag of a result; `meaning` is one line for the user."""

    meaning: str

    def __new__(cls, bit: int, meaning: str = "") -> "Flag":
        flag = int.__new__(cls, bit)
        flag._value_, flag.meaning = bit, meaning
        return flag

    TOO_FAR = 1, "|p| > d1+d2, lengths positive: straight arm toward the target"
    TOO_NEAR = 2, "|p| < |d1-d2|, lengths positive: closed elbow, wrist toward the target"
    ON_AXIS = 4, "target on the z axis: azimuth 0 is taken"
    AT_SHOULDER = 8, "target at the shoulder: direction +z is taken"
    BAD_LENGTH = 16, "d1 or d2 is not positive: straight arm"
    SATURATED = 32, "the wrist of a hand pose is clamped to the number range; always 0 for a wrist target"
    BAD_HAND = 256, "hand pose: length of the quaternion outside [1 - 2^-8, 1 + 2^-8): no rotation, no tool"


TOO_FAR, TOO_NEAR, ON_AXIS, AT_SHOULDER, BAD_LENGTH, SATURATED, BAD_HAND = map(int, Flag)

UNREACHABLE = TOO_FAR | TOO_NEAR | BAD_LENGTH
"""Flags of a target that the hand cannot reach; its pose is clamped."""

FLAG_BITS, ARM_FLAG_BITS = 8, 16  # widths of the flag field of the core and the whole arm; unnamed bits are 0
OVER_BIT = 9  # bit of over_1: joint 1 is outside its limits

FLAGS = {name.lower(): flag for name, flag in Flag.__members__.items() if flag < 1 << FLAG_BITS}
CORE_FLAGS = {name: flag for name, flag in FLAGS.items() if flag != SATURATED}
ARM_FLAGS = {**FLAGS, "bad_hand": BAD_HAND, **{f"over_{k}": BAD_HAND << k for k in range(1, 8)}}
"""Result flags by the name of their node: bits 0 to 7 (FLAGS), of the core (CORE_FLAGS), of the arm (ARM_FLAGS)."""

CHOICE_FLAG_BITS, SINGULAR = 41, 1 << 40
CHOICE_FLAGS = {**FLAGS, "bad_hand": BAD_HAND, **{f"out_{k}": BAD_HAND << k for k in range(1, 8)}}
CHOICE_FLAGS |= {"choice_shoulder": 1 << 16, "choice_elbow": 1 << 17, "choice_wrist": 1 << 18, "least": 1 << 19}
CHOICE_FLAGS |= {f"feasible_{branch}": 1 << 32 + branch for branch in range(8)} | {"singular": SINGULAR}
"""Result flags if the core chooses the branch. Above them come the chosen branch, the largest step (bits 19 to 30;
bit 31: no branch is within the limits), a bit for each branch within the limits, and `singular`."""


def names(flags: int) -> str:
    """Return the names of the set flags, joined by '+'; '-' when none is set. An unnamed bit is 'bitN'."""
    known = {int(flag): name for name, flag in ARM_FLAGS.items()}
    return "+".join(known.get(1 << n, f"bit{n}") for n in range(ARM_FLAG_BITS) if flags >> n & 1) or "-"


def expected_flags(words: np.ndarray, width: int) -> np.ndarray:
    """Return the exact flags (N,) of input words (N, 6).  Raises ValueError for a word that does not fit ``width``."""
    words = np.asarray(words, dtype=np.int64)
    if (words != words << 64 - width >> 64 - width).any():
        raise ValueError(f"a word does not fit {width} bits")
    x, y, z, _, d1, d2 = words.T  # any swivel angle is valid: it wraps
    # Exact: three squares of 32-bit words, and the squared sum of two positive words, fit unsigned 64 bits.
    squared = sum((v * v).astype(np.uint64) for v in (x, y, z))
    furthest, nearest = ((np.abs(v).astype(np.uint64)) ** 2 for v in (d1 + d2, d1 - d2))
    return combine(x, y, z, d1, d2, squared > furthest, squared < nearest)


def combine(x, y, z, d1, d2, beyond, inside) -> np.ndarray:
    """Return the flags (N,), int64, of targets. Masks: ``beyond``, |p| > d1 + d2; ``inside``, |p| < |d1 - d2|."""
    on_axis = (x == 0) & (y == 0)
    bad = (d1 <= 0) | (d2 <= 0)
    return (
        np.where(on_axis, ON_AXIS, 0)
        | np.where(on_axis & (z == 0), AT_SHOULDER, 0)
        | np.where(bad, BAD_LENGTH, 0)
        | np.where(~bad & beyond, TOO_FAR, 0)
        | np.where(~bad & inside, TOO_NEAR, 0)
    )
