# SPDX-License-Identifier: Apache-2.0
"""The flag bits that stand above the tag in `m_axis_tuser`, and the exact rule for each.

A flagged result is still a defined value: a clamped pose, or a pose by convention.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from model.targets.words import FIELDS

TOO_FAR = 1 << 0
TOO_NEAR = 1 << 1
ON_AXIS = 1 << 2
AT_SHOULDER = 1 << 3
BAD_LENGTH = 1 << 4
SATURATED = 1 << 5

FLAG_BITS = 8
"""Width of the flag field; the bits without a name are 0."""

UNREACHABLE = TOO_FAR | TOO_NEAR | BAD_LENGTH
"""Flags of a target whose pose is clamped: the hand cannot be at the target."""


class Flag(NamedTuple):
    """One flag: its name, its value as a bit mask, and what it says in one line."""

    name: str
    bit: int
    meaning: str


FLAGS = (
    Flag("too_far", TOO_FAR, "|p| > d1+d2: straight arm toward the target"),
    Flag("too_near", TOO_NEAR, "|p| < |d1-d2|: folded arm toward the target"),
    Flag("on_axis", ON_AXIS, "target on the z axis: azimuth 0 is taken"),
    Flag("at_shoulder", AT_SHOULDER, "target at the shoulder: it has no direction"),
    Flag("bad_length", BAD_LENGTH, "d1 or d2 is not positive"),
    Flag("saturated", SATURATED, "an internal value did not fit; never for a reachable target"),
)


def names(flags: int) -> str:
    """The names of the set flags, joined by '+'; '-' when none is set. A bit without a name is 'bitN'."""
    known = {flag.bit: flag.name for flag in FLAGS}
    bits = [1 << n for n in range(FLAG_BITS) if flags >> n & 1]
    return "+".join(known.get(bit, f"bit{bit.bit_length() - 1}") for bit in bits) or "-"


def expected_flags(words: np.ndarray, width: int) -> np.ndarray:
    """The flags that the core owes for input words (N, 6) of `width` bits; (N,) int64.

    Exact: Python integers, since squares of 32-bit words do not fit 64 bits once three are added.
    `SATURATED` is never owed. Raises ValueError for a word that does not fit `width` bits, which the core
    could not be asked.
    """
    words = np.asarray(words, dtype=np.int64)
    half = 2 ** (width - 1)
    if ((words < -half) | (words >= half)).any():
        raise ValueError(f"a word does not fit {width} bits")
    flags = np.zeros(len(words), dtype=np.int64)
    for n, row in enumerate(words.tolist()):
        target = dict(zip(FIELDS, row, strict=True))
        flags[n] = _flags(**target)
    return flags


def _flags(x: int, y: int, z: int, phi: int, d1: int, d2: int) -> int:
    del phi  # a swivel angle is never out of range: it wraps
    flags = 0
    if x == 0 and y == 0:
        flags |= ON_AXIS
        if z == 0:
            flags |= AT_SHOULDER
    if d1 <= 0 or d2 <= 0:
        return flags | BAD_LENGTH
    squared = x * x + y * y + z * z
    if squared > (d1 + d2) ** 2:
        flags |= TOO_FAR
    if squared < (d1 - d2) ** 2:
        flags |= TOO_NEAR
    return flags
