# SPDX-License-Identifier: Apache-2.0
"""Functional coverage at the ports of ``ik_axis``: flag x datapath x singular region x stall pattern.

:class:`tb.core.pipeline.Pipeline` samples each result that leaves, and writes the samples once a test has checked them.
"""

import functools
import itertools
import uuid
from collections import Counter
from collections.abc import Sequence
from math import isqrt

import numpy as np

from model.io.flags import CORE_FLAGS, expected_flags, names
from model.io.stimuli import mixed
from model.io.words import FIELDS
from tb.sim import coverage
from tb.sim.coverage import Point

NEAR = 64  # a target is near a singular pose if it is within reach / NEAR of it
FILE = f"{uuid.uuid4().hex}.txt"  # counts of this simulation

REGIONS = ("regular", "axis", "shoulder", "stretched", "folded")
STALLS = ("none", "gap", "held", "gap and held")
"""Idle clocks before the target, a result that had to wait, or both."""

IMPOSSIBLE = {
    *itertools.product(("too_far", "too_near", "on_axis", "at_shoulder"), ("regular",)),
    ("too_far", "shoulder"),  # farther than d1 + d2 is not within a 64th of it
}
"""Flags that exclude a region."""


def bin_of(*values: str) -> Point:
    """Return the point of a bin: flag, datapath, region, stall pattern."""
    return Point("ik_axis", 0, 0, "cross", " x ".join(values))


BINS = [
    bin_of(flag, datapath, region, stall)
    for flag in ["-", *CORE_FLAGS]
    for datapath, region, stall in itertools.product(("lean", "paper", "fold"), REGIONS, STALLS)
    if (flag, region) not in IMPOSSIBLE
]


def regions(target: Sequence[int]) -> list[str]:
    """Return the regions of a target: z axis, shoulder, full stretch or beyond, full fold or inside."""
    x, y, z, _, d1, d2 = (int(word) for word in target)
    reach, nearest = abs(d1) + abs(d2), abs(abs(d1) - abs(d2))
    off, far = isqrt(x * x + y * y), isqrt(x * x + y * y + z * z)
    near = {
        "axis": NEAR * off <= far,
        "shoulder": NEAR * far <= reach,
        "stretched": NEAR * far >= (NEAR - 1) * reach,
        "folded": NEAR * (far - nearest) <= reach,
    }
    return [name for name, is_near in near.items() if is_near] or ["regular"]


@functools.cache
def kinds(width: int) -> dict[tuple[str, str], list[int]]:
    """Return a target for each flag, and none, in each region where it can occur."""
    k = 1 << width - 5
    found: dict[tuple[str, str], list[int]] = {}
    for target in [*mixed(4000, width, 8).tolist(), (k - 2, 0, 0, 9, k, 1), (k + 2, 0, 0, 9, k, 1)]:
        flags = names(int(expected_flags(np.array([target]), width)[0])).split("+")
        for kind in itertools.product(flags, regions(target)):
            found.setdefault(kind, target)
    return found


def every_kind(width: int, datapath: str = "", stall: str = "") -> np.ndarray:
    """Return the targets of :func:`kinds`, (N, 6); given datapath and stall pattern, those whose bin has no sample."""
    wanted = [
        tuple(target)
        for (flag, region), target in kinds(width).items()
        if not datapath or not HITS[bin_of(flag, datapath, region, stall)]
    ]
    return np.array(list(dict.fromkeys(wanted))).reshape(-1, len(FIELDS))


HITS: Counter[Point] = Counter()  # samples of this simulation


def sample(flags: int, datapath: str, target: Sequence[int], gap: bool, held: bool) -> None:
    """Sample a result; ``gap``: its target followed idle clocks, ``held``: the result had to wait."""
    for flag, region in itertools.product(names(flags).split("+"), regions(target)):
        HITS[bin_of(flag, datapath, region, STALLS[gap + 2 * held])] += 1


def keep() -> None:
    """Write everything sampled so far."""
    if folder := coverage.folder():
        coverage.write(folder / FILE, HITS)
