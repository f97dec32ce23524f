# SPDX-License-Identifier: Apache-2.0
"""Functional coverage at the ports of ``ik_axis``: flag x datapath x singular region x stall pattern.

:class:`tb.core.pipeline.Pipeline` samples each result that leaves; samples are kept once a test has checked its
results. cocotb-coverage is needed only when coverage is enabled, and requires Python 3.11.
"""

from __future__ import annotations

import ast
import itertools
import uuid
from collections.abc import Sequence
from math import isqrt
from pathlib import Path

import numpy as np

from model.io.flags import FLAGS, SATURATED, expected_flags, names
from model.io.stimuli import mixed

NAME = "ik_axis.flag_datapath_region_stall"
NEAR = 64
"""A target is near a singular pose if it is within reach / NEAR of it."""

SIMULATION = uuid.uuid4().hex
"""Identifier shared by all tests of one simulation, and thus by their bins."""

AXES = {
    "flag": ["-", *(flag.name for flag in FLAGS if flag.bit != SATURATED)],
    "datapath": ["lean", "paper", "fold"],
    "region": ["regular", "axis", "shoulder", "stretched", "folded"],
    "stall": ["none", "gap", "held", "gap and held"],
}

IMPOSSIBLE = {
    ("too_far", None, "regular", None): "beyond full stretch",
    ("too_near", None, "regular", None): "inside full fold",
    ("on_axis", None, "regular", None): "on the axis",
    ("at_shoulder", None, "regular", None): "at the shoulder",
    ("too_far", None, "shoulder", None): "farther than d1 + d2 is not within a 64th of it",
}
"""Bins that cannot be hit, and the reason."""


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


def every_kind(width: int) -> np.ndarray:
    """Return targets with each flag, and none, in each region where it can occur."""
    k = 1 << width - 5
    found = {}
    for target in [*mixed(4000, width, 8).tolist(), (k - 2, 0, 0, 9, k, 1), (k + 2, 0, 0, 9, k, 1)]:
        flags = names(int(expected_flags(np.array([target]), width)[0])).split("+")
        for kind in itertools.product(flags, regions(target)):
            found.setdefault(kind, target)
    return np.array(list(dict.fromkeys(map(tuple, found.values()))))


def merged(folder: Path) -> dict[tuple[str, ...], int]:
    """Merge all simulations in ``folder``; return bin of the cross -> hits, empty without a simulation."""
    import yaml
    from cocotb_coverage.coverage import merge_coverage

    files = sorted(map(str, folder.glob("*.yml")))
    if not files:
        return {}
    whole = folder / "crosses.yaml"
    merge_coverage(lambda _: None, str(whole), *files)
    hits = yaml.safe_load(whole.read_text())[NAME]["bins:_hits"]
    return {ast.literal_eval(name): count for name, count in hits.items()}


class Crosses:
    """Coverage of one simulation; :meth:`keep` writes it to its own file in ``folder``."""

    def __init__(self, folder: Path) -> None:
        from cocotb_coverage.coverage import CoverCross, CoverPoint, coverage_db

        self.path, self.bins = folder / f"{SIMULATION}.yml", coverage_db

        def sample(flag, datapath, region, stall):
            """Receive the lists of bins that are hit."""

        points = [
            CoverPoint(f"ik_axis.{name}", vname=name, rel=_among, bins=bins, inj=False) for name, bins in AXES.items()
        ]
        self.sample = CoverCross(NAME, items=[f"ik_axis.{name}" for name in AXES], ign_bins=list(IMPOSSIBLE))(sample)
        for point in points:
            self.sample = point(self.sample)

    def result(self, flags: int, datapath: str, target: Sequence[int], gap: bool, held: bool) -> None:
        """Sample a result; ``gap``: its target followed idle clocks, ``held``: the result had to wait."""
        stall = AXES["stall"][gap + 2 * held]
        self.sample(names(flags).split("+"), [datapath], regions(target), [stall])

    def keep(self) -> None:
        """Write everything sampled so far."""
        self.bins.export_to_yaml(str(self.path))


def _among(seen: Sequence[str], of: str) -> bool:
    return of in seen
