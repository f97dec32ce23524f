# SPDX-License-Identifier: Apache-2.0
"""Driver that breaks an AXI rule on purpose on a running ``ik_axis`` or ``ik_axi``; the simulation must end there.

IK_FORCE is a comma-separated list of signal=value that overrides the bench in every second clock. IK_WHEN is
signal=value: forcing starts in the clock after this first holds following the reset.
"""

from __future__ import annotations

import os

import cocotb
from cocotb.triggers import ClockCycles, FallingEdge

from model.io.stimuli import mixed
from tb.axi.machine import CHANNELS, started
from tb.core.pipeline import Pipeline

FORCE = [item.split("=") for item in os.environ["IK_FORCE"].split(",")]
WHEN, AT = os.environ["IK_WHEN"].split("=")


async def force(dut) -> None:
    if WHEN != "rst":
        await ClockCycles(dut.clk, 12)
    await FallingEdge(dut.clk)
    while getattr(dut, WHEN).value != int(AT):
        await FallingEdge(dut.clk)
    await FallingEdge(dut.clk)
    while True:
        for signal, value in FORCE:
            getattr(dut, signal).value = int(value)
        await ClockCycles(dut.clk, 2)
        await FallingEdge(dut.clk)


@cocotb.test()
async def stream(dut):
    """More targets than slots, while no result is accepted."""
    bench = Pipeline(dut)
    cocotb.start_soon(force(dut))
    await bench.reset()
    bench.sink.pause = True
    bench.send(mixed(200, bench.width, seed=3))
    await ClockCycles(dut.clk, 300)


@cocotb.test()
async def memory(dut):
    """A job with pauses on all channels."""
    cocotb.start_soon(force(dut))
    machine = await started(dut, latency=9)
    machine.stall(*CHANNELS)
    await machine.solve(0x40000, 0x80000, 60)
