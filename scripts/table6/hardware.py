# SPDX-License-Identifier: Apache-2.0
"""The core in table 6: clocks that the RTL counts in simulation, and the error of its answers.

A path through the core is what lies around `ik_axis`: from stream to stream for now. One from memory to memory is a
row of `PATHS` with what simulates it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from model.dataflow import fixed
from model.targets.trajectories import make
from model.targets.words import from_words, result_values, to_words
from scripts.table6.contenders import hand_errors
from tb.sim.env import SIMULATORS
from tb.sim.simulate import Job, SimulationError, simulate

WIDTH = 32
DATAPATHS = ("paper", "lean")
CHUNK = 20_000
"""Random targets that the bit-true model takes at a time."""


def stream_to_stream(datapath: str) -> dict:
    """The 100 targets of `reach` through the RTL, nobody stalling: clocks to the first answer and to the last, the
    largest hand error / reach."""
    targets = make("reach")
    words, exponent = to_words(targets, WIDTH)
    (run,) = simulate([Job("reach", words)], simulator=SIMULATORS[0], datapath=datapath, width=WIDTH)
    if run.bit_mismatches:
        raise SimulationError(f"{datapath}: the RTL differs from the model: {run.first_mismatch}")
    errors = hand_errors(result_values(run.results, WIDTH), from_words(words, exponent, WIDTH, "reach"))
    return {"first": run.latency_cycles, "last": run.total_cycles, "reach_error": float(errors.max())}


PATHS: dict[str, Callable[[str], dict]] = {"stream to stream": stream_to_stream}
"""What lies around the core -> its clocks."""


def random_error(words: np.ndarray, datapath: str, progress: Callable[[int], None] = lambda done: None) -> float:
    """The largest hand error / reach over input words, by the bit-true model, which the RTL equals in every bit."""
    worst = 0.0
    for start in range(0, len(words), CHUNK):
        part = words[start : start + CHUNK]
        values = result_values(fixed.run(part, WIDTH, datapath).results, WIDTH)
        worst = max(worst, float(hand_errors(values, from_words(part, 0, WIDTH, "random")).max()))
        progress(start + len(part))
    return worst
