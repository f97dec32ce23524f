# SPDX-License-Identifier: Apache-2.0
"""The cocotb side of ``test_sections.py``: one section's module alone, every named node of it compared.

IK_DATAPATH and IK_SECTION are the names, IK_WIDTH the word length, IK_TARGETS how many targets.  The section's inputs
are the nodes of other sections that it uses; each is driven with the model's words in the clocks that belong to it.  A
new target comes every clock but for idle gaps, in which the inputs hold random words.
"""

from __future__ import annotations

import os

import cocotb
import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge

from model.dataflow import fixed
from model.targets.stimuli import mixed
from tb.core.pipeline import Scoreboard

GAP = 0.1
"""How likely an idle gap is after a target."""


@cocotb.test()
async def every_node_of_the_section(dut):
    """Targets of every kind, most of them back to back."""
    datapath, section = os.environ["IK_DATAPATH"], os.environ["IK_SECTION"]
    width, count = int(os.environ["IK_WIDTH"]), int(os.environ["IK_TARGETS"])
    random = np.random.default_rng(cocotb.RANDOM_SEED)
    answer = fixed.run(mixed(count, width, seed=cocotb.RANDOM_SEED), width, datapath)
    nodes = answer.bits.nodes
    own = [node for node in nodes.values() if node.section == section and node.op != "input"]
    missing = [node.name for node in own if not hasattr(dut, node.name)]
    assert own and not missing, f"{dut._name} has no signals {', '.join(missing) or '(nor the model nodes)'}"

    # Clock 0 of each target, and what every input holds in every clock.
    gaps = np.where(random.random(count) < GAP, random.integers(1, 10, count), 0)
    starts = np.arange(count) + np.cumsum(gaps)
    last = int(starts[-1]) + max(node.time for node in own)
    driven = []
    for name, (source, time) in inputs(section, nodes).items():
        bits = source.format.width
        words = [int.from_bytes(random.bytes(-(-bits // 8)), "little") for _ in range(last + 1)]
        for clock, word in zip((starts + time).tolist(), source.value.tolist(), strict=True):
            words[clock] = int(word)
        driven.append((getattr(dut, name), [word & ((1 << bits) - 1) for word in words]))

    board = Scoreboard(lambda node: getattr(dut, node.name), own)
    board.expect(answer)
    for target, clock in enumerate(starts.tolist()):
        board.admitted(clock, target)

    Clock(dut.clk, 10, unit="ns").start()
    for clock in range(last + 1):
        await RisingEdge(dut.clk)
        for handle, words in driven:
            handle.value = words[clock]
        await FallingEdge(dut.clk)
        board.sample(clock)

    assert not board.mismatching_bits, f"{board.mismatching_bits} bits differ\n{board.report()}"
    assert board.compared == count * len(own), f"{board.compared} words compared, not {count} of {len(own)} nodes"
    unknown = [node.name for node in own if not getattr(dut, node.name).value.is_resolvable]
    assert not unknown, f"X in idle clocks, long after every input was known: {', '.join(unknown)}"
    dut._log.info(f"{section} W={width}: {count} targets, {len(own)} nodes, {board.compared} words equal")


def inputs(section: str, nodes) -> dict[str, tuple]:
    """Port of a section's module -> (node, clock in which the port holds it).

    A port has the name and the clock of its node.  The target is the exception: 3.2 and 3.5 get it delayed to the clock
    of the swivel plane, and there its ports are called ``p_w_x_at_pi_swivel`` and so on.
    """
    ports = {}
    for node in nodes.values():
        if node.section != section or node.op == "input":
            continue
        for source in (*node.operands, *([node.after] if node.after else [])):
            if source.op == "constant" or (source.section == section and source.op != "input"):
                continue
            if source.name.startswith("p_w_") and section in ("elbow", "to_wrist"):
                ports[f"{source.name}_at_pi_swivel"] = (source, nodes["pi_swivel_x"].time)
            else:
                ports[source.name] = (source, source.time)
    return ports
