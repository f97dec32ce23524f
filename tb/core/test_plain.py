# SPDX-License-Identifier: Apache-2.0
"""A complete bench of `ik_axis` on one page: clock, reset, driver, monitor, model, comparison, stalls. Start here."""

import itertools
from collections.abc import Iterable

import cocotb
import pytest
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles
from cocotbext.axi import AxiStreamBus, AxiStreamFrame, AxiStreamSink, AxiStreamSource

from model.dataflow import fixed
from model.io.stimuli import mixed
from model.io.words import pack
from tb.sim.shared import passes

WIDTH, TAG_WIDTH = 18, 8


async def solve(dut, pauses: Iterable[bool] | None = None) -> None:
    """Send targets of every kind, and compare each result, with its flags and tag, with the bit-true model."""
    Clock(dut.clk, 10, unit="ns").start()
    dut.rst.value = 1
    source = AxiStreamSource(AxiStreamBus.from_prefix(dut, "s_axis"), dut.clk, dut.rst, byte_lanes=1)
    sink = AxiStreamSink(AxiStreamBus.from_prefix(dut, "m_axis"), dut.clk, dut.rst, byte_lanes=1)
    sink.set_pause_generator(pauses)
    await ClockCycles(dut.clk, 4)
    dut.rst.value = 0
    words = mixed(100, WIDTH, seed=1)  # x, y, z, phi, d1, d2 of each target
    for tag, beat in enumerate(pack(words, WIDTH)):
        source.send_nowait(AxiStreamFrame([beat], tuser=tag))
    model = fixed.run(words, WIDTH, "lean")
    for tag, (beat, flags) in enumerate(zip(pack(model.results, WIDTH), model.flags.tolist(), strict=True)):
        frame = await sink.recv()
        assert frame.tdata == [beat] and frame.tuser == flags << TAG_WIDTH | tag, f"target {tag}: {words[tag]}"


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def one_result_per_clock(dut):
    await solve(dut)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def stalls(dut):
    await solve(dut, pauses=itertools.cycle([True, False, True]))


@pytest.mark.sim
@pytest.mark.bench("ik_axis", without=("ik_paper", "ik_fold"))
def test_plain():
    parameters = {"W": WIDTH, "TAG_W": TAG_WIDTH}
    passes("plain", toplevel="ik_axis", module="tb.core.test_plain", parameters=parameters)
