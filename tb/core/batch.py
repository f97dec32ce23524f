# SPDX-License-Identifier: Apache-2.0
"""The cocotb side of ``tb/sim/simulate.py``: run jobs of targets and keep the results for scoring."""

import os
import pickle
from pathlib import Path

import cocotb
import numpy as np
from cocotb.triggers import ClockCycles, FallingEdge

from tb.core.pipeline import Pipeline
from tb.sim.job import Run, report
from tb.sim.timeout import timed_test


@timed_test(1e6)
async def run_targets(dut):
    """Run jobs of targets without stalls, with a reset before each job.

    IK_FOLDER names a folder. Its file ``jobs`` is a pickle of each job's target words and the joints' limits. This
    writes the files ``runs``, a pickled list of :class:`Run`, and ``progress``, the number of results so far.
    """
    folder = Path(os.environ["IK_FOLDER"])
    jobs, limits = pickle.loads((folder / "jobs").read_bytes())
    bench = Pipeline(dut, limits=limits)
    monitor, board, runs = bench.monitor, bench.scoreboard, []

    async def count():
        while True:
            await ClockCycles(dut.clk, 100, FallingEdge)
            (folder / "progress").write_text(str(len(monitor.results)))

    cocotb.start_soon(count())
    for words in jobs:
        await bench.reset()
        first, since, board.mismatching_bits = len(monitor.results), len(monitor.admitted), 0
        board.differences.clear()
        bench.driver.send(words)
        await bench.drain()
        results, _, flags, clocks = zip(*monitor.results[first:], strict=True)
        cycles = monitor.latencies[first], clocks[-1] - monitor.admitted[-len(clocks)] + 1
        message = report(board.differences, board.nodes, since) or None
        runs.append(Run(np.array(results), np.array(flags), *cycles, board.mismatching_bits, message))
    # A node mismatch is a result of the run; only a broken stream fails it.
    streams = [e for e in monitor.errors if ": RTL " not in e]
    assert not streams, f"{len(streams)} errors, the first: {streams[0]}"
    (folder / "runs").write_bytes(pickle.dumps(runs))
