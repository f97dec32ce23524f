# SPDX-License-Identifier: Apache-2.0
"""cocotb tests for ``test_rules.py``: traces for the monitors.

There are legal traces, and for each AXI rule at least one trace that breaks it. A trace is a dict
clock -> signal -> value; all other signals are 0. Reset is active in clocks 0 and 1. A trace that breaks a rule is
usually laid over a legal trace, which is cut after the last clock of the overlay.
"""

import re
from typing import NamedTuple

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge
from cocotb.types import LogicArray

from tb.axi.bench import CHANNELS
from tb.sim.sources import RULES
from tb.sim.timeout import timed_test

Trace = dict[int, dict[str, int | str]]

X = "X"

STREAM = {4: {"valid": 1, "payload": 5}, 5: {"valid": 1, "ready": 1, "payload": 5}, 6: {"valid": 1, "ready": 1}}

AW = {"awvalid": 1, "awaddr": 0x1000, "awlen": 1, "awsize": 3, "awburst": 1, "awcache": 3, "awid": 0}
AR = {"arvalid": 1, "araddr": 0x2000, "arlen": 1, "arsize": 3, "arburst": 1, "arcache": 3, "arid": 0}
W = {"wvalid": 1, "wdata": 7, "wstrb": 255}
LAST = {**W, "wlast": 1}


def over(*traces: Trace) -> Trace:
    """Overlay traces; later ones take precedence."""
    clocks = sorted(set().union(*traces))
    return {clock: {k: v for trace in traces for k, v in trace.get(clock, {}).items()} for clock in clocks}


WRITES = {  # burst with ID 0: each channel stalls once; burst with ID 1: data before the address
    4: AW,
    5: {**AW, **W, "awready": 1},
    6: {**W, "wready": 1},
    7: {**LAST, "wready": 1},
    8: {"bvalid": 1},
    9: {"bvalid": 1, "bready": 1},
    10: {**W, "wready": 1},
    11: {**LAST, "wready": 1},
    12: {**AW, "awid": 1, "awready": 1},
    14: {"bvalid": 1, "bid": 1, "bresp": 2, "bready": 1},
}
READS = {  # the burst of ID 1 lies between address and data of the burst of ID 0
    4: AR,
    5: {**AR, "arready": 1},
    6: {**AR, "arid": 1, "arlen": 0, "arready": 1},
    8: {"rvalid": 1, "rid": 1, "rlast": 1, "rready": 1},
    9: {"rvalid": 1},
    10: {"rvalid": 1, "rready": 1},
    11: {"rvalid": 1, "rlast": 1, "rready": 1},
}
AXI4 = over(WRITES, READS)
LITE = {
    4: {"awvalid": 1, "arvalid": 1, "wvalid": 1, "wstrb": 15},
    5: {"awvalid": 1, "arvalid": 1, "wvalid": 1, "wstrb": 15, "awready": 1, "arready": 1},
    6: {"wvalid": 1, "wstrb": 15, "wready": 1},
    7: {"rvalid": 1},
    8: {"rvalid": 1, "rready": 1, "bvalid": 1},
    9: {"bvalid": 1, "bready": 1},
}
BASES = {"stream": STREAM, "lite": LITE, "axi4": AXI4}

NARROW = {4: {"awsize": 2}, 5: {"awsize": 2, "wstrb": 0x0F}, 6: {"wstrb": 0x0F}, 7: {"wstrb": 0xF0}}  # 4 bytes a beat
LEGAL = [
    {},
    NARROW,
    {4: {"awaddr": 0x1004}, 5: {"awaddr": 0x1004, "wstrb": 0xF0}, 6: {"wstrb": 0xF0}, 7: {"wstrb": 0x80}},
    {4: {"awburst": 0}, 5: {"awburst": 0}, 7: {"wstrb": 0}},
    {4: {"awburst": 2, "awaddr": 0x1008}, 5: {"awburst": 2, "awaddr": 0x1008}},
    {4: {"awaddr": 0x1FF0, "araddr": 0x1FF4}, 5: {"awaddr": 0x1FF0, "araddr": 0x1FF4}},
    {4: {"awcache": 15, "arcache": 2, "awprot": 7}, 5: {"awcache": 15, "arcache": 2, "awprot": 7}},
    {8: {"rresp": 3, "bresp": 3}, 9: {"bresp": 3}},
    {12: {"bready": 1, "rready": 1, "wready": 1}},
]
"""Overlays of :data:`AXI4` that break no rule."""


class Break(NamedTuple):
    """Trace of ``port`` that breaks exactly ``rules``. If ``base``, the trace is laid over the port's legal trace."""

    port: str
    rules: set[str]
    trace: Trace
    base: bool = True


ADDRESS = {"addr": 0x1008, "len": 2, "size": 2, "burst": 2, "cache": 2, "prot": 1, "id": 1}
PAYLOADS = {  # (port, channel) -> clock in which it stalls, and payload signal -> changed value
    ("stream", ""): (4, {"payload": 6}),
    ("lite", "aw"): (4, {"addr": 4, "prot": 1}),
    ("lite", "w"): (4, {"data": 4, "strb": 7}),
    ("lite", "b"): (8, {"resp": 2}),
    ("lite", "ar"): (4, {"addr": 4, "prot": 1}),
    ("lite", "r"): (7, {"data": 4, "resp": 2}),
    ("axi4", "aw"): (4, ADDRESS),
    ("axi4", "w"): (5, {"data": 8, "strb": 1, "last": 1}),
    ("axi4", "b"): (8, {"resp": 2, "id": 1}),
    ("axi4", "ar"): (4, ADDRESS),
    ("axi4", "r"): (9, {"data": 8, "resp": 2, "last": 1, "id": 1}),
}
ALSO = {"wlast": "write.WLAST", "rlast": "read.RLAST", "rid": "read.RID", "bid": "write.BID"}
"""Payload signal -> burst rule that a change of the signal also breaks. None for AW, whose payload the monitor records
when it is first offered; none for AR, because its trace ends before the read data."""


def of_channel(port: str, name: str) -> list[Break]:
    """Return traces that break the rules of a channel: payload rules once per payload signal, other rules once."""
    stall, payload = PAYLOADS[port, name]
    rule, valid, ready = f"{name}." if name else "", f"{name}valid", f"{name}ready"
    breaks = [
        Break(port, {f"{rule}LOW_AFTER_RESET"}, {1: {valid: 1}}),
        Break(port, {f"{rule}VALID_STAYS"}, {stall + 1: {valid: 0}}),
        Break(port, {f"{rule}VALID_KNOWN"}, {3: {valid: X}}),
        Break(port, {f"{rule}READY_KNOWN"}, {3: {ready: X}}),
    ]
    for part, other in payload.items():
        signal = name + part
        also = {ALSO[signal]} if signal in ALSO and port == "axi4" else set()
        breaks.append(Break(port, {f"{rule}PAYLOAD_STAYS"} | also, {stall + 1: {signal: other}}))
        breaks.append(Break(port, {f"{rule}PAYLOAD_KNOWN"}, {stall: {signal: X}}))
    return breaks


def of_address(a: str) -> list[Break]:
    """Return traces that break the burst rules of AW or AR."""
    wrong = [
        ("BURST_TYPE", {"burst": 3}),
        ("BURST_SIZE", {"size": 4}),
        ("FIXED_LENGTH", {"burst": 0, "len": 16}),
        ("WRAP_LENGTH", {"burst": 2, "len": 2}),
        ("WRAP_LENGTH", {"burst": 2, "addr": 0x1004}),
        ("WITHIN_4K", {"addr": 0x1FF8}),
        ("WITHIN_4K", {"addr": 0x1808, "len": 255}),
        ("CACHE", {"cache": 4}),
        ("CACHE", {"cache": 9}),
    ]
    return [Break("axi4", {f"{a}_burst.{name}"}, {4: {a + k: v for k, v in at.items()}}) for name, at in wrong]


B, R = {"bvalid": 1, "bready": 1}, {"rvalid": 1, "rready": 1}
MANY = range(4, 205)
BREAKS = [
    *(broken for port, name in PAYLOADS for broken in of_channel(port, name)),
    Break("stream", {"LOW_AFTER_RESET"}, {2: {"valid": 1, "ready": 1}}),
    *of_address("aw"),
    *of_address("ar"),
    Break("axi4", {"write.B_AFTER_LAST_DATA"}, {6: B}),
    Break("axi4", {"write.B_AFTER_LAST_DATA"}, {7: B}),  # together with the last beat
    Break("axi4", {"write.B_AFTER_LAST_DATA"}, {10: B}),  # a second response
    Break("axi4", {"write.B_AFTER_ADDRESS"}, {12: {**B, "bid": 1}}),
    Break("axi4", {"write.BID"}, {14: {"bid": 0}}),
    Break("axi4", {"write.BRESP"}, {14: {"bresp": 1}}),
    Break("axi4", {"write.WLAST"}, {7: {"wlast": 0}}),
    Break("axi4", {"write.WLAST"}, {5: {"wlast": 1}}),
    Break("axi4", {"write.WLAST"}, {12: {"awlen": 0}}),  # all data already sent
    Break("axi4", {"write.WLAST"}, {12: {"awlen": 2}}),
    Break("axi4", {"write.WLAST"}, {11: {**AW, "awlen": 0, "wvalid": 0}}),  # some data already sent
    Break("axi4", {"write.WSTRB"}, {4: {"awaddr": 0x1004}, 5: {"awaddr": 0x1004}}),
    Break("axi4", {"write.WSTRB"}, {4: {"awsize": 2}, 5: {"awsize": 2, "wstrb": 0x10}}),
    Break("axi4", {"write.WSTRB"}, over(NARROW, {7: {"wstrb": 0x0F}})),
    Break("axi4", {"write.MONITOR_ROOM"}, {k: {"awvalid": 1, "awready": 1} for k in MANY}, base=False),
    Break("axi4", {"read.R_AFTER_ADDRESS"}, {4: R}),
    Break("axi4", {"read.R_AFTER_ADDRESS"}, {5: R}),  # together with the address
    Break("axi4", {"read.R_AFTER_ADDRESS"}, {12: R}),  # an extra beat
    Break("axi4", {"read.RID"}, {6: {**R, "rid": 1}}),
    Break("axi4", {"read.RLAST"}, {8: {"rlast": 0}}),
    Break("axi4", {"read.RLAST"}, {9: {"rlast": 1}}),
    Break("axi4", {"read.RLAST"}, {11: {"rlast": 0}}),
    Break("axi4", {"read.RRESP"}, {8: {"rresp": 1}}),
    Break("axi4", {"read.MONITOR_ROOM"}, {k: {"arvalid": 1, "arready": 1} for k in MANY}, base=False),
    Break("lite", {"B_AFTER_ADDRESS"}, {4: {"awvalid": 0}, 5: {"awvalid": 0}, 7: B}),
    Break("lite", {"B_AFTER_DATA"}, {6: B}),
    Break("lite", {"BRESP"}, {8: {"bresp": 1}}),
    Break("lite", {"R_AFTER_ADDRESS"}, {5: R}),
    Break("lite", {"RRESP"}, {7: {"rresp": 1}}),
]


OF_CHANNELS = dict.fromkeys(CHANNELS[:-1], "channel")
PARTS = {  # port -> instance in it -> module ik_rules_MODULE
    "stream": {"": "channel"},
    "lite": {"": "lite", **OF_CHANNELS},
    "axi4": {**OF_CHANNELS, "aw_burst": "address", "ar_burst": "address", "write": "write", "read": "read"},
}
FOUR_STATE = cocotb.SIM_NAME.startswith("Icarus")


class Port:
    def __init__(self, top, name: str) -> None:
        self.shell = getattr(top, name)
        self.rules = {}  # rule -> its monitor, and its bit in the monitor's `broken`
        text = (RULES / "ik_rules.v").read_text(encoding="utf-8")
        for part, module in PARTS[name].items():
            monitor, prefix = (getattr(self.shell.u, part), f"{part}.") if part else (self.shell.u, "")
            body = text.partition(f"module ik_rules_{module} ")[2].partition("endmodule")[0]
            for bit, rule in re.findall(r'`IK_RULE\((\d), [^"]*"(\w+)", "', body):
                self.rules[prefix + rule] = monitor, int(bit)
        self.inputs = [port for port in self.shell if port._name.islower() and port._name not in ("u", "clk", "rst")]
        Clock(self.shell.clk, 10, unit="ns").start(start_high=False)

    async def broken(self, trace: Trace) -> set[str]:
        """Drive a trace and return the names of the rules that it breaks."""
        for monitor, _ in self.rules.values():
            monitor.broken.value = 0
        for clock in range(max(trace) + 1):
            self.shell.rst.value = clock < 2
            row = trace.get(clock, {})
            for handle in self.inputs:
                value = row.get(handle._name, 0)
                handle.value = LogicArray(X * len(handle)) if value == X else value
            await RisingEdge(self.shell.clk)
        await FallingEdge(self.shell.clk)
        return {rule for rule, (monitor, bit) in self.rules.items() if int(monitor.broken.value) >> bit & 1}


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
    unbroken = {(name, rule) for name, port in ports.items() for rule in port.rules}
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
