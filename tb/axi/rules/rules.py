# SPDX-License-Identifier: Apache-2.0
"""cocotb tests for ``test_rules.py``: traces for the monitors, and drivers that break a rule while a core runs."""

import os

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge, RisingEdge
from cocotb.types import LogicArray

from model.io.stimuli import mixed
from tb.axi.bench import CHANNELS as AXI_CHANNELS
from tb.axi.bench import started
from tb.axi.rules.traces import BASES, BREAKS, LEGAL, Trace, X, names, over
from tb.core.pipeline import Pipeline
from tb.sim.timeout import timed_test

ADDRESS, CHANNEL = "ik_rules_address", "ik_rules_channel"
CHANNELS = {name: CHANNEL for name in ("aw", "w", "b", "ar", "r")}
PARTS = {  # port -> instance in it -> module
    "stream": {"": CHANNEL},
    "lite": {"": "ik_rules_lite", **CHANNELS},
    "axi4": {**CHANNELS, "aw_burst": ADDRESS, "ar_burst": ADDRESS, "write": "ik_rules_write", "read": "ik_rules_read"},
}
FOUR_STATE = cocotb.SIM_NAME.startswith("Icarus")


class Port:
    def __init__(self, top, name: str) -> None:
        self.shell = getattr(top, name)
        self.monitors = [
            (f"{part}." if part else "", getattr(self.shell.u, part) if part else self.shell.u, names(module))
            for part, module in PARTS[name].items()
        ]
        self.inputs = [port for port in self.shell if port._name.islower() and port._name not in ("u", "clk", "rst")]
        Clock(self.shell.clk, 10, unit="ns").start(start_high=False)

    async def broken(self, trace: Trace) -> set[str]:
        """Drive a trace and return the names of the rules that it breaks."""
        for _, monitor, _ in self.monitors:
            monitor.broken.value = 0
        for clock in range(max(trace) + 1):
            self.shell.rst.value = clock < 2
            row = trace.get(clock, {})
            for handle in self.inputs:
                value = row.get(handle._name, 0)
                handle.value = LogicArray(X * len(handle)) if value == X else value
            await RisingEdge(self.shell.clk)
        await FallingEdge(self.shell.clk)
        return {
            f"{prefix}{name}"
            for prefix, monitor, rules in self.monitors
            for number, name in rules.items()
            if int(monitor.broken.value) >> number & 1
        }


@timed_test()
async def legal_traces(top):
    for name, base in BASES.items():
        port = Port(top, name)
        for over_it in LEGAL if name == "axi4" else [{}]:
            broken = await port.broken(over(base, over_it))
            assert not broken, f"{name} {over_it}: {broken}"


@timed_test()
async def each_rule(top):
    """Each trace breaks exactly its rules, and every rule of every port has a trace."""
    ports = {name: Port(top, name) for name in PARTS}
    unbroken = {
        (name, f"{prefix}{rule}")
        for name, port in ports.items()
        for prefix, _, rules in port.monitors
        for rule in rules.values()
    }
    wrong = []
    for case in BREAKS:
        unbroken -= {(case.port, rule) for rule in case.rules}
        if not FOUR_STATE and any(X in row.values() for row in case.trace.values()):
            continue
        last = max(case.trace)
        base = {clock: row for clock, row in BASES[case.port].items() if clock <= last} if case.base else {}
        broken = await ports[case.port].broken(over(base, case.trace))
        if broken != case.rules:
            wrong.append(f"{case.port} {case.trace if case.base else ''}: {broken}, expected {case.rules}")
    assert not wrong, "\n".join(wrong)
    assert not unbroken, f"no trace for {sorted(unbroken)}"


async def force(dut) -> None:
    """Override signals of the bench in every second clock. A monitor must then end the simulation.

    IK_FORCE is a comma-separated list of signal=value. IK_WHEN is a condition signal=value: the override starts one
    clock after it first holds. Unless the signal is rst, the first 12 clocks, with the reset, are skipped.
    """
    forced = [item.split("=") for item in os.environ["IK_FORCE"].split(",")]
    when, at = os.environ["IK_WHEN"].split("=")
    if when != "rst":
        await ClockCycles(dut.clk, 12)
    await FallingEdge(dut.clk)
    while getattr(dut, when).value != int(at):
        await FallingEdge(dut.clk)
    await FallingEdge(dut.clk)
    while True:
        for signal, value in forced:
            getattr(dut, signal).value = int(value)
        await ClockCycles(dut.clk, 2)
        await FallingEdge(dut.clk)


@timed_test()
async def stream(dut):
    """Send more targets than the core has slots, while no result is accepted."""
    bench = Pipeline(dut)
    cocotb.start_soon(force(dut))
    await bench.reset()
    bench.sink.pause = True
    bench.driver.send(mixed(200, bench.width, seed=3))
    await ClockCycles(dut.clk, 300)


@timed_test()
async def memory(dut):
    cocotb.start_soon(force(dut))
    bench = await started(dut, latency=9)
    bench.stall(*AXI_CHANNELS)
    await bench.solve(0x40000, 0x80000, 60)
