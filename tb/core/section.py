# SPDX-License-Identifier: Apache-2.0
"""cocotb side of ``test_sections.py``: each section's module alone, with every named node compared.

IK_DATAPATH is the datapath, IK_WIDTH the word length, IK_TARGETS the number of targets. A section's inputs are nodes of
other sections; each is driven with the model's words in its own clocks. A target enters in every clock except idle
gaps, in which the inputs hold random words.
"""

from __future__ import annotations

import os

import cocotb
import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge

from model.dataflow import fixed
from model.dataflow.datapaths import CONFIGURATIONS
from model.io.stimuli import mixed
from tb.core.pipeline import Scoreboard
from tb.core.ports import inputs

GAP = 0.1
"""Probability of an idle gap after a target."""


DATAPATH, WIDTH, COUNT = os.environ["IK_DATAPATH"], int(os.environ["IK_WIDTH"]), int(os.environ["IK_TARGETS"])


@cocotb.test()
@cocotb.parametrize(section=[name for name in CONFIGURATIONS[DATAPATH].sections if name != "results"])
async def every_node_of_the_section(top, section):
    """Targets of every kind, most of them back to back."""
    shell = getattr(top, section)  # from tb/sim/wrapper_top.py
    dut = shell.u
    random = np.random.default_rng(cocotb.RANDOM_SEED)
    answer = fixed.run(mixed(COUNT, WIDTH, seed=cocotb.RANDOM_SEED), WIDTH, DATAPATH)
    nodes = answer.bits.nodes
    own = [node for node in nodes.values() if node.section == section and node.op != "input"]
    missing = [node.name for node in own if not hasattr(dut, node.name)]
    assert own and not missing, f"{section} has no signals {', '.join(missing) or '(nor the model nodes)'}"

    # First clock of each target, and the words of every input in every clock.
    gaps = np.where(random.random(COUNT) < GAP, random.integers(1, 10, COUNT), 0)
    starts = np.arange(COUNT) + np.cumsum(gaps)
    last = int(starts[-1]) + max(node.time for node in own)
    driven = []
    for name, (source, time) in inputs(section, nodes).items():
        bits = source.format.width
        words = [int.from_bytes(random.bytes(-(-bits // 8)), "little") for _ in range(last + 1)]
        for clock, word in zip((starts + time).tolist(), source.value.tolist(), strict=True):
            words[clock] = int(word)
        driven.append((getattr(shell, name), [word & ((1 << bits) - 1) for word in words]))

    board = Scoreboard(lambda node: getattr(dut, node.name), own)
    board.expect(answer)
    for target, clock in enumerate(starts.tolist()):
        board.admitted(clock, target)

    Clock(shell.clk, 10, unit="ns").start()
    for clock in range(last + 1):
        await RisingEdge(shell.clk)
        for handle, words in driven:
            handle.value = words[clock]
        await FallingEdge(shell.clk)
        board.sample(clock, clock)

    assert not board.mismatching_bits, f"{board.mismatching_bits} bits differ\n{board.report()}"
    assert board.compared == COUNT * len(own), f"{board.compared} words compared, not {COUNT} of {len(own)} nodes"
    unknown = [node.name for node in own if not getattr(dut, node.name).value.is_resolvable]
    assert not unknown, f"X in idle clocks, long after every input was known: {', '.join(unknown)}"
    dut._log.info(f"{section} W={WIDTH}: {COUNT} targets, {len(own)} nodes, {board.compared} words equal")
