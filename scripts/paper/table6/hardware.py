# SPDX-License-Identifier: Apache-2.0
"""The core in table 6: clocks of the simulated RTL and the error of its results.

A path is the logic around the datapath: `ik_axis` from stream to stream, `ik_axi` from memory to memory.
"""

from __future__ import annotations

import numpy as np

from model.dataflow import fixed
from model.io.trajectories import make
from model.io.words import from_words, result_values, to_words
from scripts.generate.pages import measured
from scripts.paper.table6.contenders import hand_errors
from tb.sim.env import SIMULATORS
from tb.sim.simulate import Job, SimulationError, simulate

WIDTH = 32
DATAPATHS = ("paper", "lean")
STREAMS = "stream to stream"
BUS, LATENCY = 128, 34
"""Bits of the bus and clocks of the memory in the path from memory to memory."""
CHUNK = 20_000
"""Random targets per run of the bit-true model."""


def stream_to_stream(datapath: str) -> dict:
    """Run the 100 targets of `reach` through the RTL without stalls. Return the clocks to the first and last result,
    the clocks per result, and the largest hand error / reach."""
    words, _ = to_words(make("reach"), WIDTH)
    (run,) = simulate([Job("reach", words)], simulator=SIMULATORS[0], datapath=datapath, width=WIDTH)
    if run.bit_mismatches:
        raise SimulationError(f"{datapath}: the RTL differs from the model: {run.first_mismatch}")
    first, last = run.latency_cycles, run.total_cycles
    return {"first": first, "last": last, "each": (last - first) / len(words), "reach_error": reach_error(run.results)}


def memory_to_memory(datapath: str) -> dict:
    """Return the same figures for jobs of `ik_axi`: register CLOCKS after a job of one target and after a job of all,
    clocks of channel R per target in a long job, error of the results in memory."""
    (row,) = measured(SIMULATORS[0], {"DATAPATH": int(datapath == "lean"), "DATA_W": BUS}, LATENCY)
    clocks = {name: row[name] for name in ("first", "last", "each")}
    return {**clocks, "reach_error": reach_error(np.array(row["results"]))}


def reach_error(results: np.ndarray) -> float:
    """Return the largest hand error / reach of results for `reach`."""
    words, exponent = to_words(make("reach"), WIDTH)
    return float(hand_errors(result_values(results, WIDTH), from_words(words, exponent, WIDTH, "reach")).max())


PATHS = {STREAMS: stream_to_stream, f"memory to memory, {BUS} bits, latency {LATENCY}": memory_to_memory}
"""Path -> function that measures its clocks and error."""


def random_error(words: np.ndarray, datapath: str) -> float:
    """Return the largest hand error / reach over input words, from the bit-true model (the RTL is bit-identical)."""
    parts = np.array_split(words, -(-len(words) // CHUNK))
    answers = (result_values(fixed.run(part, WIDTH, datapath).results, WIDTH) for part in parts)
    errors = (hand_errors(a, from_words(p, 0, WIDTH, "random")) for a, p in zip(answers, parts, strict=True))
    return float(max(error.max() for error in errors))
