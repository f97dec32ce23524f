# SPDX-License-Identifier: Apache-2.0
"""How quick ``ik_axi`` is from a memory of a given latency: clocks of jobs, and how much of the read bus is used."""

from __future__ import annotations

import json
import os
from pathlib import Path

import cocotb
from cocotb.triggers import FallingEdge

from model.targets.records import BYTES
from tb.axi.machine import started

LATENCIES = (0, 16, 32, 64, 128)
"""Clocks that the memory takes longer than at its quickest, to the first beat of R and to B."""

LONG, SHORT = 600, 100


@cocotb.test()
@cocotb.parametrize(latency=LATENCIES)
async def rates(dut, latency):
    """Of a memory that answers in every clock at least 95 % of the read bus are used; a row goes to the file
    IK_AXI_RATES."""
    machine = await started(dut, pool=LONG, latency=latency)
    monitor = machine.monitor
    await machine.solve(0x40000, 0x80000, SHORT)
    clocks = await machine.read("CLOCKS")
    monitor.beats_read.clear()
    taken = []

    async def first():
        while not (dut.m_axi_arvalid.value == 1 and dut.m_axi_arready.value == 1):
            await FallingEdge(dut.clk)
        taken.append(monitor.clock)

    cocotb.start_soon(first())
    await machine.solve(0x40000, 0x80000, LONG)
    machine.check()
    beats = monitor.beats_read
    share = len(beats) / (beats[-1] - beats[0] + 1)
    if path := os.environ.get("IK_AXI_RATES"):
        row = {"data_width": machine.data_width, "whole": machine.whole, "latency": beats[0] - taken[0]}
        with Path(path).open("a") as file:
            file.write(json.dumps({**row, "share": share, "clocks": clocks}) + "\n")
    assert latency or share >= 0.95, f"{share:.3f} of the bus for {LONG * BYTES} bytes"
