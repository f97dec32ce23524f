# SPDX-License-Identifier: Apache-2.0
"""Functional coverage at the ports of ``ik_axis`` (flag x datapath x singular region x stall pattern) and of ``ik_arm``
(property of a pose or of its branch choice x datapath x stall pattern).

:class:`tb.core.pipeline.Monitor` samples each result; the bench writes the samples after it has checked the results.
"""

import functools
import itertools
import uuid
from collections import Counter
from collections.abc import Sequence
from math import isqrt

import numpy as np

from model.dataflow.datapaths import ARM, MODELS
from model.io.flags import ARM_FLAGS, CHOICE_FLAGS, CORE_FLAGS, names
from model.io.stimuli import hands, mixed
from model.io.words import BRANCHES, FIELDS
from tb.sim import coverage
from tb.sim.coverage import Point
from tb.sim.job import answer, usual_words

NEAR = 64  # largest offset from the z axis: distance from the shoulder / NEAR; from other singular poses: reach / NEAR
FILE = f"{uuid.uuid4().hex}.json"  # file for the counts of this simulation

REGIONS = ("regular", "axis", "shoulder", "stretched", "closed")
STALLS = ("none", "gap", "held", "gap and held")
"""Stall patterns. gap: the target followed idle clocks. held: its result had to wait."""

IMPOSSIBLE = {
    *itertools.product(("too_far", "too_near", "on_axis", "at_shoulder"), ("regular",)),
    ("too_far", "shoulder"),  # a target beyond d1 + d2 is not within (d1 + d2) / 64 of the shoulder
}
"""Pairs of a flag and a region that cannot occur together."""


Kind = tuple[str, ...]  # flag and region of a wrist target, or one property of a pose of the whole arm

LATE = ("after a reset that dropped poses",)
POSES = [f"{name}={bit}" for name in (*ARM_FLAGS, *BRANCHES) for bit in (0, 1)]
POSES += [f"{joint} near {angle}" for joint in ("th2", "th6") for angle in ("0", "pi")]
POSES += [f"tool {length}" for length in ("least", "0", "greatest")]
"""Properties of poses of the whole arm. "near" means at most 1/256 of a turn away."""

CHOICE_BITS = {name: flag for name, flag in CHOICE_FLAGS.items() if name.startswith(("choice", "feasible", "singular"))}
CHOICE_BITS |= {"none_feasible": 1 << 31}
CHOICES = [f"{name}={bit}" for name in CHOICE_BITS for bit in (0, 1)]  # properties of the choice of a branch


def bin_of(kind: Kind, datapath: str, stall: str) -> Point:
    """Return the coverage point of a kind of target, a datapath and a stall pattern."""
    first, *region = kind
    return Point("ik_axis" if region else "ik_arm", 0, 0, "cross", " x ".join((first, datapath, *region, stall)))


WRISTS = [kind for kind in itertools.product(("-", *CORE_FLAGS), REGIONS) if kind not in IMPOSSIBLE]
KINDS = {"lean": WRISTS, "arm": [(pose,) for pose in POSES], "choose": [(choice,) for choice in CHOICES]}
"""Datapath that has example targets (:func:`source`) -> their kinds."""


def source(datapath: str) -> str:
    """Return the datapath from which ``datapath`` takes its example targets and kinds."""
    path = MODELS[datapath]
    return "choose" if path.chooses else "arm" if path.side else "lean"


BINS = [
    bin_of(kind, datapath, stall)
    for datapath in ("lean", "paper", "fold", "arm", "fold_arm", "choose", "fold_choose")
    for kind, stall in itertools.product(KINDS[source(datapath)], STALLS)
]
BINS += [bin_of(LATE, datapath, "any") for datapath in ("arm", "fold_arm")]


def kinds_of(target: Sequence[int], results: Sequence[int], flags: int, width: int) -> list[Kind]:
    """Return the kinds of a wrist target, or of a pose with its branch, given the target's results and flags. If a pose
    has reference joints, its kinds are the properties of the branch choice."""
    if len(target) == len(FIELDS):
        return list(itertools.product(names(flags).split("+"), regions(target)))
    if len(target) > len(ARM.inputs) + 1:
        return [(f"{name}={int(flags & flag != 0)}",) for name, flag in CHOICE_BITS.items()]
    bits = {name: flags & flag != 0 for name, flag in ARM_FLAGS.items()}
    bits |= {name: target[-1] >> k & 1 for k, name in enumerate(BRANCHES)}
    kinds = [f"{name}={int(bit)}" for name, bit in bits.items()]
    half, words = 1 << width - 1, dict(zip(ARM.results, results, strict=True))
    for joint in ("th2", "th6"):
        size = min(abs(words[joint]), half) << 7
        kinds += [f"{joint} near 0"] * (size <= half) + [f"{joint} near pi"] * (size >= 127 * half)
    lengths = {-half: "least", 0: "0", half - 1: "greatest"}
    tool = target[ARM.inputs.index("tool")]
    kinds += [f"tool {lengths[length]}" for length in {tool} & lengths.keys()]
    return [(kind,) for kind in kinds]


def regions(target: Sequence[int]) -> list[str]:
    """Return the regions of a wrist target. "stretched" includes targets that are too far, "closed" those too near."""
    x, y, z, _, d1, d2 = (int(word) for word in target)
    reach, nearest = abs(d1) + abs(d2), abs(abs(d1) - abs(d2))
    off, far = isqrt(x * x + y * y), isqrt(x * x + y * y + z * z)
    near = {
        "axis": NEAR * off <= far,
        "shoulder": NEAR * far <= reach,
        "stretched": NEAR * far >= (NEAR - 1) * reach,
        "closed": NEAR * (far - nearest) <= reach,
    }
    return [name for name, is_near in near.items() if is_near] or ["regular"]


@functools.cache
def examples(width: int, datapath: str) -> dict[Kind, tuple[int, ...]]:
    """Return kind -> words of an example target of ``datapath``, for each kind that occurs."""
    k, targets = 1 << width - 5, mixed(4000, width, 8)
    if datapath == "lean":
        targets = np.array([*targets, (k - 2, 0, 0, 9, k, 1), (k + 2, 0, 0, 9, k, 1)])
    else:
        targets = hands(targets, width, 8) if datapath == "arm" else usual_words(datapath, 4000, width, 8)
    run = answer(targets, width, datapath)
    targets_of: dict[Kind, tuple[int, ...]] = {}
    for target, results, flags in zip(targets.tolist(), run.results.tolist(), run.flags.tolist(), strict=True):
        for kind in kinds_of(target, results, flags, width):
            targets_of.setdefault(kind, tuple(target))
    return targets_of


def every_kind(width: int, datapath: str = "lean", stall: str = "") -> np.ndarray:
    """Return targets (N, words) for ``datapath`` that cover all kinds or, given a stall pattern, the kinds whose bins
    have no sample."""
    path = MODELS[datapath]
    name = path.name if path.side else path.rtl
    wanted = [
        target
        for kind, target in examples(width, source(datapath)).items()
        if not stall or not HITS[bin_of(kind, name, stall)]
    ]
    return np.array(list(dict.fromkeys(wanted))).reshape(-1, len(path.inputs) + bool(path.side))


HITS: Counter[Point] = Counter()  # samples of this simulation


def sample(kinds: Sequence[Kind], datapath: str, gap: bool, held: bool, late: bool) -> None:
    """Count a result in the bins of its kinds. ``gap``: its target followed idle clocks. ``held``: the result had to
    wait. ``late``: the result is the first after a reset that dropped poses."""
    HITS.update(bin_of(kind, datapath, STALLS[gap + 2 * held]) for kind in kinds)
    if late:
        HITS[bin_of(LATE, datapath, "any")] += 1


def keep() -> None:
    """Write all samples so far, if the environment names a folder for coverage counts."""
    if folder := coverage.folder():
        coverage.write(folder / FILE, HITS)
