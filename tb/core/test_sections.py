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


DELAYS = re.compile(
    r"ik_(?:delay|ring) #\(\.W\(.*?\), \.N\((.*)\)\) \w+ \(\s*\.clk\(clk\),\s*\.d\((.*?)\),\s*\.q\((.*?)\)\s*\);"
)


@pytest.mark.parametrize("datapath", DATAPATHS)
def test_a_delayed_copy_is_named_for_its_clock(datapath):
    """x_at_y is x in the clock of node y, or of the first node whose name begins with y."""
    path = DATAPATHS[datapath]
    nodes = fixed.run(np.zeros((1, 6), dtype=np.int64), 32, datapath).bits.nodes
    at = {name: node.time for name, node in nodes.items()} | {"out": max(nodes[n].time for n in fixed.RESULT_FIELDS)}

    def clock(name):
        name = name.removeprefix("ovf_")
        return at[name] if name in at else next(at[node] for node in nodes if node.startswith(name))

    seen = 0
    for file in sorted((ROOT / path.folder).glob("*.v")):
        for wait, given, held in DELAYS.findall(file.read_text()):
            clocks = eval(re.sub(r"T_(\w+)", lambda m: str(clock(m[1].lower())), wait))
            for source, copy in zip(given.strip("{}").split(","), held.strip("{}").split(","), strict=True):
                if copy == "out_tag":  # no node
                    continue
                name, _, when = re.match(r"\s*(\w+)", source)[1].partition("_at_")
                until = copy.partition("_at_")[2]
                assert until, f"{file.name}: {copy} does not say its clock"
                assert clock(until) - clock(when or name) == clocks, f"{file.name}: {copy} is {source} after {wait}"
                seen += 1
    assert seen > 20


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
