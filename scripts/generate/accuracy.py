# SPDX-License-Identifier: Apache-2.0
"""Accuracy of the datapaths by workspace region: hand and joint angle errors of the bit-true model."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from model.dataflow import fixed
from model.dataflow.datapaths import DATAPATHS
from model.io.stimuli import REGIONS, region
from model.io.words import RESULT_FIELDS, from_words, result_values
from model.reference.kinematics import angle_between, forward
from model.reference.lean_equations import solve_lean
from scripts.generate.render import error

TARGETS, SEED, WIDTH = 4000, 1, 32


@dataclass(frozen=True)
class Errors:
    """Errors of targets (N,): hand / reach relative to the target, joint angles (rad) relative to double precision,
    and the larger abs(norm^2 - 1) of the two quaternions."""

    hand: np.ndarray
    shoulder: np.ndarray
    elbow: np.ndarray
    norm: np.ndarray

    @classmethod
    def of(cls, words: np.ndarray, width: int, datapath: str) -> Errors:
        """Solve reachable targets with the bit-true model of a datapath."""
        values = result_values(fixed.run(words, width, datapath).results, width)
        asked = from_words(words, 0, width, "words")
        pose = solve_lean(asked.x, asked.y, asked.z, asked.phi, asked.d1, asked.d2)
        pose = np.column_stack([pose[name] for name in RESULT_FIELDS])
        qs, qe = values[:, :4], values[:, 4:]
        wrist = forward(qs, qe, asked.d1, asked.d2)[1]
        rest = np.zeros_like(qe)
        return cls(
            np.linalg.norm(wrist - asked.position, axis=1) / asked.reach,
            angle_between(qs, pose[:, :4]),
            angle_between(np.hstack([qe, rest]), np.hstack([pose[:, 4:], rest])),
            np.maximum(*(np.abs((q**2).sum(axis=1) - 1) for q in (qs, qe))),
        )

    @property
    def angle(self) -> float:
        """Largest joint angle error (rad)."""
        return max(self.shoulder.max(), self.elbow.max())


def by_region() -> Iterator[tuple[str, ...]]:
    """Yield rows: region, then for each datapath the median and largest hand error and the largest angle error."""
    for name in REGIONS:
        words = region(name, TARGETS, WIDTH, SEED)
        found = [Errors.of(words, WIDTH, path) for path in DATAPATHS]
        yield name, *(error(v) for e in found for v in (np.median(e.hand), e.hand.max(), e.angle))
