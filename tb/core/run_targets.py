# SPDX-License-Identifier: Apache-2.0
"""cocotb side of ``tb/sim/simulate.py``: runs jobs of targets through ``ik_axis`` without stalls.

IK_JOBS names an .npz file with one array of target words per job, and for the whole arm the ``limits`` of the joints;
IK_RESULTS the .npz file to write, with for job k the arrays ``results_k`` (N, words), ``flags_k`` (N,), ``facts_k`` =
latency, clocks from first in to last out, mismatching bits, and ``first_k``, the first difference as text. IK_PROGRESS
names a file for the number of results so far.
"""

import os
from pathlib import Path

import cocotb
import numpy as np
from cocotb.triggers import FallingEdge

from tb.core.pipeline import Pipeline


@cocotb.test()
async def run_targets(dut):
    """Run each job after its own reset."""
    progress = Path(os.environ["IK_PROGRESS"])
    with np.load(os.environ["IK_JOBS"]) as jobs:
        given = dict(jobs)
    bench = Pipeline(dut, limits=given.pop("limits", np.empty(0)).tolist())
    written: dict[str, np.ndarray] = {}
    board = bench.scoreboard

    async def report():
        while True:
            for _ in range(100):
                await FallingEdge(dut.clk)
            progress.write_text(str(len(bench.results)))

    cocotb.start_soon(report())
    for k in range(len(given)):
        await bench.reset()
        first, bits = len(bench.results), board.mismatching_bits
        since = len(bench.admitted)
        board.differences.clear()
        bench.send(given[f"words_{k}"])
        await bench.drain()
        rows = bench.results[first:]
        clocks = rows[-1][3] - bench.admitted[-len(rows)] + 1
        written[f"results_{k}"] = np.array([r[0] for r in rows], dtype=np.int64)
        written[f"flags_{k}"] = np.array([r[2] for r in rows], dtype=np.int64)
        written[f"facts_{k}"] = np.array([bench.latencies[first], clocks, board.mismatching_bits - bits])
        written[f"first_{k}"] = np.array(board.report(since=since))
    # A node mismatch is a result of the run; only a broken stream fails it.
    streams = [e for e in bench.errors if ": RTL " not in e]
    assert not streams, f"{len(streams)} errors, the first: {streams[0]}"
    np.savez(os.environ["IK_RESULTS"], **written)
