# SPDX-License-Identifier: Apache-2.0
"""Several ``ik_axis`` and ``ik_arm`` of different parameters in one top, side by side, each compared with its model."""

import json
import os

import cocotb

from tb.core.pipeline import Pipeline, pause


@cocotb.test()
async def side_by_side(dut):
    """All instances run at once, with gaps and stalls."""
    benches = [Pipeline(getattr(dut, name), nodes=False) for name in json.loads(os.environ["IK_INSTANCES"])]
    for bench in benches:
        await bench.reset()
    for seed, bench in enumerate(benches):
        bench.source.set_pause_generator(pause("bursts", seed))
        bench.sink.set_pause_generator(pause("bursts", seed + 10))
        bench.send(bench.mixed(60 if bench.period == 1 else 12, seed=seed))
    for bench in benches:
        await bench.drain()
        bench.check()
        assert len(bench.results) == len(bench.words) > 0
