# SPDX-License-Identifier: Apache-2.0
"""Targets for testbenches: (N, 6) signed input words of a width, the same ones for the same seed.

Columns are ``FIELDS`` of :mod:`model.targets`: x, y, z, phi, d1, d2.
"""

from __future__ import annotations

import numpy as np

from model.flags import UNREACHABLE, expected_flags
from model.targets import FIELDS


def random_reachable(count: int, width: int, seed: int) -> np.ndarray:
    """Targets without any flag: directions and swivel angles uniform, arms of all sizes.

    Every other target has arms that fill their words; the size of the others is spread evenly over the bits, so small
    arms, unequal arms and targets near the shoulder or near the end of the reach all come up.
    """
    random = np.random.default_rng((seed, width, 1))
    rows = np.zeros((0, len(FIELDS)), dtype=np.int64)
    while len(rows) < count:
        rows = np.concatenate([rows, _reachable(random, count + 16, width)])
    return rows[:count]


def _reachable(random, count: int, width: int) -> np.ndarray:
    one = 2.0 ** (width - 2)
    size = np.where(np.arange(count) % 2, 0.0, random.uniform(3 - width, 0, count))  # log2 of d1 + d2, or nearly
    total = np.exp2(size) * random.uniform(0.5, 1.9, count)
    share = random.uniform(0.03, 0.97, count)
    d1, d2 = total * share, total * (1 - share)
    distance = random.uniform(np.abs(d1 - d2), total)
    direction = random.normal(size=(count, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    lengths = np.column_stack([direction * distance[:, None], d1, d2]) * one
    words = np.rint(lengths).astype(np.int64)
    words = np.insert(words, 3, random.integers(-(1 << (width - 1)), 1 << (width - 1), count), axis=1)
    return words[expected_flags(words, width) == 0]


def unreachable(count: int, width: int, seed: int) -> np.ndarray:
    """Clamped targets, the kinds in turn: too far, too near (either arm the longer), at the shoulder, on the axis and
    out of reach, arms without a length."""
    random = np.random.default_rng((seed, width, 2))
    top = (1 << (width - 1)) - 1
    rows = np.zeros((count, len(FIELDS)), dtype=np.int64)
    for k, row in enumerate(rows):
        size = int(random.integers(2, width - 1))  # bits of the target
        row[:3] = random.integers(-(1 << size), 1 << size, 3)
        row[3] = random.integers(-top - 1, top + 1)
        row[4:] = random.integers(1, 1 << int(random.integers(1, width - 1)), 2)
        kind = k % 7
        if kind == 0:  # too far
            row[:3] |= 1 << (width - 3)
            row[4:] = random.integers(1, 1 << (width - 5), 2)
        elif kind in (1, 2):  # too near
            row[:3] >>= 4
            row[3 + kind], row[6 - kind] = top - int(random.integers(0, 1 << (width - 3))), 1 << (width - 5)
        elif kind == 3:
            row[:3] = 0
        elif kind == 4:  # out of reach on the axis, on either side
            row[:3] = 0, 0, (1 << (width - 2)) * (1 if k % 2 else -1)
            row[4:] >>= 3
        elif kind == 5:
            row[4 + int(random.integers(2))] = 0
        else:
            row[4 + int(random.integers(2))] *= -1
    np.clip(rows, -top - 1, top, out=rows)
    stray = (expected_flags(rows, width) & UNREACHABLE == 0) & rows[:, :3].any(axis=1)
    rows[stray, 4] = 0
    return rows


def corners(width: int) -> dict[str, tuple[int, ...]]:
    """Named targets at the edges of formats, reach and equations."""
    low, top = -(1 << (width - 1)), (1 << (width - 1)) - 1
    k = 1 << (width - 6)  # exact multiples: 3-4-5 and 1-2-2-3
    half_turn, quarter = low, 1 << (width - 2)
    place = (3 * k, 2 * k, k)  # somewhere in reach of (3k, 2k)
    arm = (3 * k, 2 * k)
    return {
        # words
        "zero": (0, 0, 0, 0, 0, 0),
        "all lowest": (low, low, low, low, low, low),
        "all highest": (top, top, top, top, top, top),
        "x = -2, longest arm": (low, 0, 0, 0, top, top),
        "y = -2, longest arm": (0, low, 0, quarter, top, top),
        "z = -2, longest arm": (0, 0, low, 0, top, top),
        "cube corner, longest arm": (low, low, low, 12345, top, top),
        "opposite corner, longest arm": (top, top, top, half_turn, top, top),
        "1 lsb, longest arm": (1, 0, 0, 0, top, top),
        "-1 lsb each, longest arm": (-1, -1, -1, quarter, top, top),
        "arms of 1 lsb": (1, 0, 0, 0, 1, 1),
        "arms of 1 lsb, -1 lsb each": (-1, -1, -1, 1, 1, 1),
        "arms of 1 lsb, stretched": (0, 2, 0, 0, 1, 1),
        "arms of 1 lsb, far": (top, 1, low, 0, 1, 1),
        "forearm of 1 lsb": (0, top, 0, quarter, top, 1),
        "forearm of 1 lsb, down": (0, 1, 2 - top, quarter, top - 2, 1),  # d1 + |p_ez| is rounded to 2
        "odd long arms, 2 lsb apart": (1, 0, 2, top, quarter + 3 * k + 1, quarter + 3 * k - 1),
        "odd long arms, 1 lsb apart": (-1, 0, -1, low, quarter + 3 * k, quarter + 3 * k - 1),
        "upper arm of 1 lsb": (top, 0, 0, quarter, 1, top),
        "arms of 2^n exactly": (k, k, k, 0, 2 * k, 2 * k),
        # reach
        "exactly full stretch": (3 * k, 4 * k, 0, quarter, 2 * k, 3 * k),
        "exactly full stretch, off the planes": (-k, 2 * k, -2 * k, 777, 2 * k, k),
        "full stretch, 1 lsb less": (3 * k, 4 * k, 0, quarter, 2 * k, 3 * k + 1),
        "full stretch, 1 lsb more": (3 * k, 4 * k, 0, quarter, 2 * k, 3 * k - 1),
        "exactly folded, upper arm longer": (3 * k, 0, -4 * k, 999, 7 * k, 2 * k),
        "exactly folded, forearm longer": (3 * k, 0, -4 * k, 999, 2 * k, 7 * k),
        "folded, 1 lsb less": (3 * k, 0, -4 * k, 999, 7 * k - 1, 2 * k),
        "folded, 1 lsb more": (3 * k, 0, -4 * k, 999, 7 * k + 1, 2 * k),
        "at the shoulder, equal arms": (0, 0, 0, 5, 3 * k, 3 * k),
        "at the shoulder, unequal arms": (0, 0, 0, 5, 3 * k, 2 * k),
        # the z axis
        "target on +z": (0, 0, 4 * k, 0, *arm),
        "target on -z": (0, 0, -4 * k, 0, *arm),
        "target on +z, swivel": (0, 0, 4 * k, quarter + 3, *arm),
        "target 1 lsb off +z": (0, -1, 4 * k, quarter, *arm),
        "target 1 lsb off -z": (1, 0, -4 * k, -quarter, *arm),
        "exactly full stretch on +z": (0, 0, 5 * k, 0, *arm),
        "exactly full stretch on -z": (0, 0, -5 * k, 0, *arm),
        "too far on +z": (0, 0, 6 * k, 0, *arm),
        "too far on -z": (0, 0, -6 * k, 0, *arm),
        "exactly folded on +z": (0, 0, k, 0, *arm),
        "exactly folded on -z": (0, 0, -k, half_turn, *arm),
        "too near on +z": (0, 0, k >> 1, 0, *arm),
        "too near on -z, forearm longer": (0, 0, -(k >> 1), 0, *arm[::-1]),
        # an upper arm of 5k along the axis, a forearm (3k, 0, +-4k) or (4k, 0, -+3k)
        "elbow on +z, forearm up": (3 * k, 0, 9 * k, 0, 5 * k, 5 * k),
        "elbow on +z, forearm down": (0, 3 * k, k, 0, 5 * k, 5 * k),
        "elbow on -z, forearm up": (-3 * k, 0, -k, half_turn, 5 * k, 5 * k),
        "elbow on -z, forearm down": (3 * k, 0, -9 * k, half_turn, 5 * k, 5 * k),
        # the swivel angle
        "phi = 0": (*place, 0, *arm),
        "phi = half a turn": (*place, half_turn, *arm),
        "phi = half a turn - 1 lsb": (*place, top, *arm),
        "phi = 1 lsb": (*place, 1, *arm),
        "phi = -1 lsb": (*place, -1, *arm),
        "phi = a quarter turn": (*place, quarter, *arm),
        "phi = minus a quarter turn": (*place, -quarter, *arm),
        # lengths
        "d1 = 0": (*place, 77, 0, 2 * k),
        "d2 = 0": (*place, 77, 3 * k, 0),
        "d1 = -1 lsb": (*place, 77, -1, 2 * k),
        "d2 = -2": (*place, 77, 3 * k, low),
        "d1 = d2 = -2": (*place, 77, low, low),
        "d1 = -d2": (*place, 77, -2 * k, 2 * k),
    }


def extremes(count: int, width: int, seed: int) -> np.ndarray:
    """Words that are each lowest, highest, around 0 or anything: most of them targets that make no sense."""
    random = np.random.default_rng((seed, width, 3))
    low, top = -(1 << (width - 1)), (1 << (width - 1)) - 1
    edge = random.choice([low, low + 1, -1, 0, 1, top - 1, top], (count, len(FIELDS)))
    anything = random.integers(low, top + 1, (count, len(FIELDS)))
    return np.where(random.random((count, len(FIELDS))) < 0.6, edge, anything)


def mixed(count: int, width: int, seed: int) -> np.ndarray:
    """All of the above, shuffled: every corner, the rest half reachable, a quarter clamped, a quarter extreme.

    With a ``count`` below that of the corners, some of the corners.
    """
    random = np.random.default_rng((seed, width, 4))
    rows = np.array(list(corners(width).values()), dtype=np.int64)
    rest = max(0, count - len(rows))
    rows = np.concatenate(
        [
            random.permutation(rows)[:count],
            random_reachable(rest - 2 * (rest // 4), width, seed),
            unreachable(rest // 4, width, seed),
            extremes(rest // 4, width, seed),
        ]
    )
    return random.permutation(rows)
