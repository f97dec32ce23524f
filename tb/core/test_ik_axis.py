# SPDX-License-Identifier: Apache-2.0
"""Builds ``ik_axis`` at several word lengths and runs tb/core/ik_axis.py on it."""

import re
import subprocess

import pytest

from model.dataflow.datapaths import CONFIGURATIONS
from tb.sim.env import environment, simulator
from tb.sim.runner import simulate
from tb.sim.sources import includes, sources

# One of each datapath in the quick gate, with either length of words and tags.
SETS = [
    pytest.param("lean", 32, 8, marks=pytest.mark.cost(32)),
    pytest.param("paper", 18, 3, marks=pytest.mark.cost(40)),
    pytest.param("fold", 24, 8, marks=pytest.mark.cost(40)),
]
if simulator() == "icarus":  # a build takes Verilator half a minute, and a stream does not know how long its words are
    SETS += [
        pytest.param("lean", 18, 3, marks=[pytest.mark.slow, pytest.mark.cost(28)]),
        pytest.param("paper", 32, 8, marks=[pytest.mark.slow, pytest.mark.cost(73)]),
    ]


@pytest.mark.sim
@pytest.mark.parametrize(("datapath", "width", "tag_width"), SETS)
def test_streams(datapath, width, tag_width):
    parameters = {"W": width, "TAG_W": tag_width, **CONFIGURATIONS[datapath].parameters}
    simulate("ik_axis", "tb.core.ik_axis", parameters=parameters, seed=1)


def elaborated(**parameters) -> tuple[int, list[str]]:
    """Exit status of Icarus, and the modules that it misses."""
    command = ["iverilog", "-g2001", "-t", "null", "-s", "ik_axis", *(f"-I{folder}" for folder in includes())]
    command += [*(f"-Pik_axis.{name}={value}" for name, value in parameters.items()), *map(str, sources())]
    done = subprocess.run(command, env=environment(), capture_output=True, text=True, check=False)
    return done.returncode, re.findall(r"Unknown module type: (\w+)", done.stderr)


@pytest.mark.parametrize("lean", [0, 1])
@pytest.mark.parametrize("width", [3, 15, 33])
def test_another_word_length_does_not_elaborate(lean, width):
    """And the reason is one name, not all that goes wrong below."""
    status, missing = elaborated(W=width, LEAN=lean)
    assert status != 0 and missing == ["ik_axis_needs_W_of_16_to_32_folded_even_from_20_with_TILE_16_from_18_to_24"]


@pytest.mark.parametrize("width", [16, 18, 21, 31])
def test_the_folded_core_is_not_for_every_word_length(width):
    status, missing = elaborated(W=width, LEAN=2)
    assert status != 0 and missing == ["ik_axis_needs_W_of_16_to_32_folded_even_from_20_with_TILE_16_from_18_to_24"]


@pytest.mark.parametrize(
    "parameters",
    [{"W": 16}, {"W": 32}, {"W": 16, "LEAN": 0}, {"W": 3, "MIN_W": 3}, {"W": 20, "LEAN": 2}, {"W": 32, "LEAN": 2}],
)
def test_these_elaborate(parameters):
    assert elaborated(**parameters) == (0, [])
