# SPDX-License-Identifier: Apache-2.0
"""Builds ``ik_axis`` at several word lengths and runs tb/core/ik_axis.py on it."""

import pytest

from model.dataflow.datapaths import CONFIGURATIONS
from tb.sim.env import simulator
from tb.sim.runner import simulate

# One of each datapath in the quick gate, with either length of words and tags. The paper's has 255 clocks at W = 23,
# where 256 places would not do.
SETS = [
    pytest.param("lean", 32, 8, marks=pytest.mark.cost(32)),
    pytest.param("paper", 23, 3, marks=pytest.mark.cost(45)),
    pytest.param("fold", 24, 8, marks=pytest.mark.cost(40)),
]
if simulator() == "icarus":  # a build takes Verilator half a minute, and a stream does not know how long its words are
    SETS.append(pytest.param("lean", 18, 3, marks=[pytest.mark.slow, pytest.mark.cost(28)]))


@pytest.mark.sim
@pytest.mark.parametrize(("datapath", "width", "tag_width"), SETS)
def test_streams(datapath, width, tag_width):
    parameters = {"W": width, "TAG_W": tag_width, **CONFIGURATIONS[datapath].parameters}
    simulate("ik_axis", "tb.core.ik_axis", parameters=parameters, seed=1)
