# SPDX-License-Identifier: Apache-2.0
"""Accuracy of the datapaths by workspace region: hand and joint angle errors of the bit-true model."""

from collections.abc import Iterator

import numpy as np

from model.dataflow import fixed
from model.dataflow.datapaths import DATAPATHS
from model.io.stimuli import REGIONS, region
from model.io.words import RESULT_FIELDS, Targets, from_words, result_values
from model.reference.kinematics import angle_between, forward
from model.reference.lean_equations import solve_lean
from scripts.generate.render import error

TARGETS, SEED, WIDTH = 4000, 1, 32


def hand_errors(answers: np.ndarray, targets: Targets) -> np.ndarray:
    """Return the hand errors / reach (N,) of answers (N, 6)."""
    answers = np.asarray(answers, dtype=np.float64)
    wrist = forward(answers[:, :4], answers[:, 4:], targets.d1, targets.d2)[1]
    return np.linalg.norm(wrist - targets.position, axis=1) / targets.reach


def errors(words: np.ndarray, width: int, datapath: str) -> tuple[np.ndarray, float]:
    """Solve reachable targets with the bit-true model of a datapath; return the errors of the hands / reach, (N,), and
    the largest difference of a joint angle from double precision (rad)."""
    values = result_values(fixed.run(words, width, datapath).results, width)
    asked = from_words(words, 0, width, "words")
    pose = solve_lean(asked.x, asked.y, asked.z, asked.phi, asked.d1, asked.d2)
    pose = np.column_stack([pose[name] for name in RESULT_FIELDS])
    shoulder = angle_between(values[:, :4], pose[:, :4])
    elbow = angle_between(*(np.pad(each[:, 4:], ((0, 0), (0, 2))) for each in (values, pose)))
    return hand_errors(values, asked), max(shoulder.max(), elbow.max())


def by_region() -> Iterator[tuple[str, ...]]:
    """Yield rows: region, then for each datapath the median and largest hand error and the largest angle error."""
    for name in REGIONS:
        words = region(name, TARGETS, WIDTH, SEED)
        found = [errors(words, WIDTH, path) for path in DATAPATHS]
        yield name, *(error(v) for hand, angle in found for v in (np.median(hand), hand.max(), angle))
