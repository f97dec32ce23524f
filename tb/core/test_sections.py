# SPDX-License-Identifier: Apache-2.0
"""Each section's module alone, at several word lengths: every named node equals the bit-true model's at its clock."""

import re

import numpy as np
import pytest

from model.dataflow import fixed
from model.dataflow.datapaths import DATAPATHS
from tb.core.section import inputs
from tb.sim.env import simulator
from tb.sim.runner import ROOT, simulate

# results has no module of its own
MODULES = [(name, section) for name, path in DATAPATHS.items() for section in path.sections if section != "results"]
TARGETS = 300


@pytest.mark.parametrize(("datapath", "section"), MODULES)
def test_section_drives_every_input_of_the_module(datapath, section):
    """The ports that the testbench drives are the inputs that the Verilog declares."""
    path = DATAPATHS[datapath]
    text = (ROOT / path.folder / f"{path.module(section)}.v").read_text()
    ports = re.findall(r"^\s*input\s+wire\s+(?:signed\s+)?(?:\[[^]]*\]\s*)?(\w+)", text, re.MULTILINE)
    nodes = fixed.run(np.zeros((1, 6), dtype=np.int64), 32, datapath).bits.nodes
    assert sorted(ports) == sorted(["clk", *inputs(section, nodes)])


# Two word lengths of every section; more of the lean ones, whose formats follow from W, where a build costs nothing.
BUILT = [(*module, width) for module in MODULES for width in (32, 18)]
if simulator() == "icarus":
    BUILT += [(*module, width) for module in MODULES if module[0] == "lean" for width in (16, 24, 27)]


@pytest.mark.parametrize(("datapath", "section", "width"), BUILT)
def test_section(datapath, section, width):
    """Random, clamped, extreme and named corner targets, back to back with gaps of random words."""
    simulate(
        DATAPATHS[datapath].module(section),
        "tb.core.section",
        parameters={"W": width},
        env={"IK_DATAPATH": datapath, "IK_SECTION": section, "IK_WIDTH": str(width), "IK_TARGETS": str(TARGETS)},
        seed=1,
    )
