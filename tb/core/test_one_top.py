# SPDX-License-Identifier: Apache-2.0
"""Five cores of different datapath, word length, tile and tag in one top: no instance changes another."""

import json
import os

import cocotb
import pytest

from model.dataflow.datapaths import MODELS
from tb.core.pipeline import Pipeline, pause
from tb.sim.runner import simulate
from tb.sim.wrapper_top import TOP, top_of


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


CORES = {
    f"{path}_{width}": (MODELS[path].top, {"W": width, "TAG_W": tag, **MODELS[path].parameters})
    for path, width, tag in (("lean", 32, 8), ("lean25", 18, 3), ("fold", 24, 5), ("paper", 16, 1), ("arm", 17, 2))
}


@pytest.mark.sim
@pytest.mark.slow
@pytest.mark.cost(60)
def test_five_cores_in_one_top():
    simulate(TOP, "tb.core.test_one_top", top=top_of(CORES), env={"IK_INSTANCES": json.dumps(list(CORES))}, name="five")
