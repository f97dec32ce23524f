# SPDX-License-Identifier: Apache-2.0
"""Five cores of different datapath, word length, tile and tag in one top: no instance changes another."""

import json

import pytest

from model.dataflow.datapaths import MODELS
from tb.sim.runner import simulate
from tb.sim.wrapper_top import TOP, top_of

CORES = {
    f"{path}_{width}": (MODELS[path].top, {"W": width, "TAG_W": tag, **MODELS[path].parameters})
    for path, width, tag in (("lean", 32, 8), ("lean25", 18, 3), ("fold", 24, 5), ("paper", 16, 1), ("arm", 17, 2))
}


@pytest.mark.sim
@pytest.mark.slow
@pytest.mark.cost(60)
def test_five_cores_in_one_top():
    simulate(TOP, "tb.core.one_top", top=top_of(CORES), env={"IK_INSTANCES": json.dumps(list(CORES))}, name="five")
