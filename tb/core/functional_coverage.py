# SPDX-License-Identifier: Apache-2.0
"""Functional coverage at the ports of ``ik_axis``: flag x datapath x singular region x stall pattern; at those of
``ik_arm``: kind of pose x datapath x stall pattern.

:class:`tb.core.pipeline.Pipeline` samples each result that leaves, and writes the samples once a test has checked them.
"""

import functools
import itertools
import uuid
from collections import Counter
from collections.abc import Sequence
from math import isqrt

import numpy as np

from model.dataflow.datapaths import ARM
from model.io.flags import ARM_FLAGS, CORE_FLAGS, expected_flags, names
from model.io.stimuli import hands, mixed
from model.io.words import BRANCHES, FIELDS
from tb.sim import coverage
from tb.sim.coverage import Point
from tb.sim.job import answer

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


LATE = "after a reset that dropped poses"
POSES = [f"{name}={bit}" for name in (*ARM_FLAGS, *BRANCHES) for bit in (0, 1)]
POSES += [f"{joint} near {angle}" for joint in ("th2", "th6") for angle in ("0", "pi")]
POSES += [f"tool {length}" for length in ("least", "0", "greatest")]
"""Kinds of poses of the whole arm; an angle is near another one within 1/256 of a turn."""


def pose_bin(kind: str, datapath: str, stall: str) -> Point:
    """Return the point of a bin of ``ik_arm``: kind of pose, datapath, stall pattern."""
    return Point("ik_arm", 0, 0, "cross", " x ".join((kind, datapath, stall)))


BINS += [pose_bin(*of) for of in itertools.product(POSES, ("arm", "fold_arm"), STALLS)]
BINS += [pose_bin(LATE, datapath, "any") for datapath in ("arm", "fold_arm")]


def pose_kinds(pose: Sequence[int], results: Sequence[int], flags: int, width: int) -> list[str]:
    """Return the kinds of a pose, words with its branch, given its results and flags."""
    bits = {name: flags & flag != 0 for name, flag in ARM_FLAGS.items()}
    bits |= {name: pose[-1] >> k & 1 for k, name in enumerate(BRANCHES)}
    found = [f"{name}={int(bit)}" for name, bit in bits.items()]
    half, words = 1 << width - 1, dict(zip(ARM.results, results, strict=True))
    for joint in ("th2", "th6"):
        size = min(abs(words[joint]), half) << 7
        found += [f"{joint} near 0"] * (size <= half) + [f"{joint} near pi"] * (size >= 127 * half)
    lengths = {-half: "least", 0: "0", half - 1: "greatest"}
    tool = pose[ARM.inputs.index("tool")]
    return found + [f"tool {lengths[length]}" for length in {tool} & lengths.keys()]


def regions(target: Sequence[int]) -> list[str]:
    """Return the regions of a target: near the z axis or the shoulder, stretched or beyond, closed or too near."""
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


@functools.cache
def pose_of_kind(width: int) -> dict[str, tuple[int, ...]]:
    """Return a pose of each kind, a few poses for all of them."""
    poses = hands(mixed(4000, width, 8), width, 8)
    run = answer(poses, width, "arm")
    rows = zip(poses.tolist(), run.results.tolist(), run.flags.tolist(), strict=True)
    found: dict[str, tuple[int, ...]] = {}
    for pose, results, flags in rows:
        for kind in pose_kinds(pose, results, flags, width):
            found.setdefault(kind, tuple(pose))
    return found


def every_pose(width: int, datapath: str = "", stall: str = "") -> np.ndarray:
    """Return poses of all kinds, (N, 12); given datapath and stall pattern, those whose bin has no sample."""
    wanted = [
        pose for kind, pose in pose_of_kind(width).items() if not datapath or not HITS[pose_bin(kind, datapath, stall)]
    ]
    return np.array(list(dict.fromkeys(wanted))).reshape(-1, len(ARM.inputs) + 1)


HITS: Counter[Point] = Counter()  # samples of this simulation


def sample(flags: int, datapath: str, target: Sequence[int], gap: bool, held: bool) -> None:
    """Sample a result; ``gap``: its target followed idle clocks, ``held``: the result had to wait."""
    for flag, region in itertools.product(names(flags).split("+"), regions(target)):
        HITS[bin_of(flag, datapath, region, STALLS[gap + 2 * held])] += 1


def sample_pose(kinds: Sequence[str], datapath: str, gap: bool, held: bool, late: bool) -> None:
    """Sample a result of ``ik_arm``; ``late``: the first one after a reset that dropped poses."""
    HITS.update(pose_bin(kind, datapath, STALLS[gap + 2 * held]) for kind in kinds)
    HITS[pose_bin(LATE, datapath, "any")] += late


def keep() -> None:
    """Write everything sampled so far."""
    if folder := coverage.folder():
        coverage.write(folder / FILE, HITS)
