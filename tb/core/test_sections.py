# SPDX-License-Identifier: Apache-2.0
"""Each section's module alone, at several word lengths: every named node equals the bit-true model's in its clock."""

import re

import numpy as np
import pytest

from model.dataflow import fixed
from model.dataflow.datapaths import DATAPATHS
from model.dataflow.nodes import inner_frac
from tb.core.ports import inputs
from tb.sim.env import ROOT, cores
from tb.sim.runner import simulate, with_cores
from tb.sim.wrapper_top import TOP, top_of

# results has no module
MODULES = [(name, section) for name, path in DATAPATHS.items() for section in path.sections if section != "results"]
INNER = "direction", "triangle", "turn"
"""Sections of the lean datapath that have the width of an inner word as a parameter."""
TARGETS = 300


@pytest.mark.parametrize(("datapath", "section"), MODULES)
def test_section_drives_every_input_of_the_module(datapath, section):
    """The inputs that the bench drives are the inputs declared in Verilog."""
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
    """Signal x_at_y is x in the clock of node y, or of the first node whose name starts with y."""
    path = DATAPATHS[datapath]
    nodes = fixed.run(np.zeros((1, 6), dtype=np.int64), 32, datapath).bits.nodes
    at = {name: node.time for name, node in nodes.items()} | {"out": max(nodes[n].time for n in fixed.RESULT_FIELDS)}

    def clock(name):
        return at[name] if name in at else next(at[node] for node in nodes if node.startswith(name))

    seen = 0
    for file in sorted((ROOT / path.folder).glob("*.v")):
        for wait, given, held in DELAYS.findall(file.read_text()):
            clocks = eval(re.sub(r"T_(\w+)", lambda m: str(clock(m[1].lower())), wait))
            for source, copy in zip(given.strip("{}").split(","), held.strip("{}").split(","), strict=True):
                if copy == "out_tag":  # not a node
                    continue
                name, _, when = re.match(r"\s*(\w+)", source)[1].partition("_at_")
                until = copy.partition("_at_")[2]
                assert until, f"{file.name}: {copy} does not say its clock"
                assert clock(until) - clock(when or name) == clocks, f"{file.name}: {copy} is {source} after {wait}"
                seen += 1
    assert seen > 20


# test_hardest.py compares other word lengths in whole cores.
MORE = [("paper", 32), ("lean", 18)]
BUILT = [("lean", 32), ("paper", 18), *(pytest.param(*one, marks=pytest.mark.slow) for one in MORE)]


@pytest.mark.sim
@pytest.mark.parametrize(("datapath", "width"), BUILT)
def test_sections(datapath, width):
    """Random, clamped, extreme and named corner targets, back to back with gaps of random words."""
    path = DATAPATHS[datapath]
    modules = {section: path.module(section) for name, section in MODULES if name == datapath}
    inner = {"W": width, "N": inner_frac(width) + 2}
    instances = {
        name: (module, with_cores(module, inner if name in INNER else {"W": width}, cores()))
        for name, module in modules.items()
    }
    simulate(
        TOP,
        "tb.core.section",
        top=top_of(instances),
        env={"IK_DATAPATH": datapath, "IK_WIDTH": str(width), "IK_TARGETS": str(TARGETS)},
        name=datapath,
        seed=1,
    )
