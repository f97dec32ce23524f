# SPDX-License-Identifier: Apache-2.0
"""Throughput of ``ik_axi`` against memory latency: clocks of jobs and utilization of the read bus."""

from __future__ import annotations

import json
import os
from pathlib import Path

import cocotb
from cocotb.triggers import FallingEdge

from model.io.trajectories import make
from model.io.words import BYTES, result_words, to_words
from tb.axi.machine import started

QUICKEST = 2
"""Clocks from AR accepted to the first R beat for a memory without added latency."""

LATENCIES = tuple(QUICKEST + more for more in (0, 16, 32, 64, 128))
"""Memory latencies in clocks; B is delayed by the same additional clocks as R."""

BATCH, LONG = 100, 600
"""Targets of a job: `reach` once, and `reach` repeated."""


@cocotb.test()
@cocotb.parametrize(latency=LATENCIES)
async def rates(dut, latency):
    """Require 95 % use of the read bus without added latency; append a row to the file IK_AXI_RATES."""
    words, _ = to_words(make("reach"), 32)
    machine = await started(dut, latency=latency - QUICKEST, words=words)
    assert machine.pool == BATCH
    monitor = machine.monitor
    clocks = {}
    for count in (1, BATCH):
        await machine.solve(0x40000, 0x80000, count)
        clocks[count] = await machine.read("CLOCKS")
    results = result_words(machine.memory.peek(0x80000, BATCH * BYTES), machine.width)
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
    assert beats[0] - taken[0] == latency, f"{beats[0] - taken[0]} clocks to the first beat, {latency} stated"
    span = beats[-1] - beats[0] + 1
    share = len(beats) / span
    if path := os.environ.get("IK_AXI_RATES"):
        row = {"whole": machine.whole, "latency": latency, "share": share, "each": span / LONG}
        row |= {"first": clocks[1], "last": clocks[BATCH], "results": results.tolist()}
        with Path(path).open("a") as file:
            file.write(json.dumps(row) + "\n")
    assert latency > QUICKEST or share >= 0.95, f"{share:.3f} of the bus for {LONG * BYTES} bytes"
