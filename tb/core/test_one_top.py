# SPDX-License-Identifier: Apache-2.0
"""Four cores of different datapath, word length, tile and tag in one top: no instance changes another."""

import json

import pytest

from model.dataflow.datapaths import CONFIGURATIONS
from tb.sim.runner import simulate
from tb.sim.wrapper_top import TOP, top_of

CORES = {
    f"{path}_{width}": ("ik_axis", {"W": width, "TAG_W": tag, **CONFIGURATIONS[path].parameters})
    for path, width, tag in (("lean", 32, 8), ("lean25", 18, 3), ("fold", 24, 5), ("paper", 16, 1))
}


@pytest.mark.sim
@pytest.mark.slow
@pytest.mark.cost(60)
def test_four_cores_in_one_top():
    simulate(TOP, "tb.core.one_top", top=top_of(CORES), env={"IK_INSTANCES": json.dumps(list(CORES))}, name="four")
