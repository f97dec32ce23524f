# SPDX-License-Identifier: Apache-2.0
"""Bench of ``ik_axis`` and ``ik_arm``: clock, reset, driver, monitor, and a scoreboard for all nodes.

``ik_axis_bytes`` and ``ik_arm_bytes`` use the same bench, without comparing nodes. Tests build on :class:`Pipeline`;
test_plain.py shows a bench without it. All sampling is done at the falling edge of the clock, when inputs and registers
have settled in both simulators.
"""

import logging
from functools import reduce

import cocotb
import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge, RisingEdge
from cocotbext.axi import AxiStreamBus, AxiStreamSink

from model.dataflow import fixed
from model.dataflow.datapaths import MODELS
from model.dataflow.nodes import Limits, Node
from tb.core import functional_coverage
from tb.core.driver import Driver
from tb.core.monitor import Monitor
from tb.core.scoreboard import Scoreboard
from tb.sim.job import limits_port, usual_limits, usual_words


def configuration(dut) -> str:
    """Return the name of the datapath that ``ik_axis`` or ``ik_arm`` is built with."""
    top = "ik_arm" if hasattr(dut, "limits") else "ik_axis"
    return next(
        name
        for name, path in MODELS.items()
        if path.top == top and all(int(getattr(dut, key).value) == value for key, value in path.parameters.items())
    )


class Pipeline:
    """Bench of one ``ik_axis`` or ``ik_arm``. ``limits`` are the joints' limits, by default :func:`.usual_limits`.

    With ``nodes`` every node is compared, otherwise results only.
    """

    def __init__(self, dut, nodes: bool = True, limits: Limits | None = None) -> None:
        self.dut = dut
        self.width, self.tag_width = int(dut.W.value), int(dut.TAG_W.value)
        self.slot = -(-self.width // 8) * 8 if dut._name.endswith("_bytes") else self.width  # bits of a word in tdata
        self.datapath = configuration(dut)
        self.path = path = MODELS[self.datapath]
        self.period = path.lap(self.width)
        ports = dut.s_axis_tdata, dut.s_axis_tuser, dut.m_axis_tdata, dut.m_axis_tuser
        data = [len(words) * self.slot for words in (path.inputs, path.results)]
        sizes = [data[0], self.tag_width + len(path.side), data[1], self.tag_width + path.flag_bits]
        assert [len(port) for port in ports] == sizes
        self.limits = limits or usual_limits(self.datapath, self.width)
        if path.side:
            dut.limits.value = limits_port(self.limits, self.width)
        logging.getLogger(f"cocotb.{dut._name}").setLevel(logging.WARNING)  # hides the drivers' banners
        Clock(dut.clk, 10, unit="ns").start(start_high=False)
        dut.rst.value = 1
        compared = fixed.nodes(self.datapath, self.width).values() if nodes else ()
        self.scoreboard = Scoreboard(lambda node: getattr(self.module(node), node.name), compared)
        self.driver = Driver(self, self.scoreboard)
        self.sink = AxiStreamSink(
            AxiStreamBus.from_prefix(dut, "m_axis"), dut.clk, dut.rst, byte_lanes=1, reset_active_level=True
        )
        self.monitor = Monitor(self, self.driver, self.scoreboard)
        cocotb.start_soon(self.monitor.run())

    @property
    def core(self):
        """The instance of the datapath, without the stream logic."""
        return getattr(self.dut, f"g_{self.path.rtl}").u_core

    def module(self, node: Node):
        """Return the module instance that contains a node."""
        return reduce(getattr, filter(None, self.path.instance(node).split(".")), self.core)

    async def reset(self, clocks: int = 4) -> None:
        """Assert reset for ``clocks`` clocks. Core, drivers and scoreboard drop all targets in flight."""
        await RisingEdge(self.dut.clk)
        self.dut.rst.value = 1
        self.driver.source.clear()
        await ClockCycles(self.dut.clk, clocks)
        self.sink.clear()
        self.driver.forget(len(self.monitor.admitted))  # also the targets that were never admitted
        self.dut.rst.value = 0
        # A beat queued at the rising edge is driven at once in one simulator and a clock later in the other.
        await FallingEdge(self.dut.clk)

    def mixed(self, count: int, seed: int) -> np.ndarray:
        """Return shuffled targets of every kind, as in a :class:`tb.sim.job.Job`."""
        return usual_words(self.datapath, count, self.width, seed)

    def around(self, words: np.ndarray) -> np.ndarray:
        """Return the wrist targets ``words``; for the whole arm, return poses with these wrists."""
        hands = [(0, 1 << self.width - 2, 0, 0, 0, n % 8) for n in range(len(words))]  # tool, Qh, branch
        return np.column_stack([words, hands]) if self.path.side else words

    async def drain(self, most_clocks: int = 20000) -> None:
        """Wait for all results; fail after ``most_clocks`` clocks without a result."""
        monitor, announced = self.monitor, self.driver.words
        seen, since = len(monitor.results), monitor.clock
        while len(monitor.admitted) < len(announced) or monitor.due:
            await FallingEdge(self.dut.clk)
            if len(monitor.results) != seen:
                seen, since = len(monitor.results), monitor.clock
            assert monitor.clock - since < most_clocks, (
                f"no result for {most_clocks} clocks: {len(announced)} targets announced, {len(monitor.admitted)} "
                f"admitted, {len(monitor.results)} results"
            )
        await ClockCycles(self.dut.clk, 8, FallingEdge)  # no further result may follow

    async def finish(self) -> None:
        await self.drain()
        self.check()

    def check(self) -> None:
        """Check everything that must hold after a drain: results, order, tags, flags and all compared nodes."""
        errors, board = self.monitor.errors, self.scoreboard
        assert not errors, f"{len(errors)} errors, the first: {errors[0]}"
        assert not board.mismatching_bits, f"{board.mismatching_bits} bits differ\n{board.report()}"
        assert board.compared or not (board.nodes and self.monitor.results), "the scoreboard compared nothing"
        functional_coverage.keep()
