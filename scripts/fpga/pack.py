# SPDX-License-Identifier: Apache-2.0
"""Register packing into ECP5 multipliers and memories, between Yosys and nextpnr."""

from __future__ import annotations

import re
from collections import Counter

PACKER = "3"
"""Version of the function below."""


def pack_registers(module: dict) -> dict:
    """Move registers into MULT18X18D and DP16KD, as Lattice's tools do and Yosys does not (module of write_json).

    Output register of a multiplier or memory port: used if all its readers are plain flip-flops of one clock.
    Input registers of a multiplier: used if A and B both come from plain flip-flops of that clock or are constant. A
    flip-flop with other readers is kept for them; one behind a memory, whose outputs are late, stays near it. Returns
    the number of registers of each kind and of removed flip-flops.
    """
    cells = module["cells"]
    memories = [cell["connections"] for cell in cells.values() if cell["type"] == "DP16KD"]
    late = {net for nets in memories for port in nets if port.startswith("DO") for net in nets[port]}
    plain = {"CEMUX": "1 ", "CLKMUX": "CLK", "REGSET": "RESET"}
    source, readers = {}, {}
    for name, cell in cells.items():
        flop = cell["type"] == "TRELLIS_FF"
        simple = (
            flop
            and all(cell["parameters"].get(k) == v for k, v in plain.items())
            and cell["connections"].get("LSR", ["0"]) == ["0"]
        )
        for port, nets in cell["connections"].items():
            for bit, net in enumerate(nets):
                if not isinstance(net, int):
                    continue
                if cell["port_directions"][port] == "input":
                    readers.setdefault(net, []).append((name, port, bit, simple))
                elif simple and port == "Q":
                    source[net] = name
    for port in module["ports"].values():
        for net in port["bits"]:
            if port["direction"] == "output":
                readers.setdefault(net, []).append(("", "", 0, False))

    def clock(name):
        return cells[name]["connections"]["CLK"][0]

    def data(name):
        nets = cells[name]["connections"]
        return nets.get("DI", nets.get("M", ["0"]))[0]

    def registers(nets, ports):
        """Return port -> flip-flops behind it; empty if the ports have other readers or more than one clock."""
        behind = {port: readers.get(nets.get(port, ["x"])[0], []) for port in ports}
        flat = [r for readers_of in behind.values() for r in readers_of]
        if not all(simple and port == "DI" for _, port, _, simple in flat) or len({clock(r[0]) for r in flat}) != 1:
            return {}
        return {port: [r[0] for r in readers_of] for port, readers_of in behind.items() if readers_of}

    def take_over(nets, behind):
        """Connect ports to the nets of the flip-flops behind them; merge several flip-flops of one bit."""
        for port, flops in behind.items():
            first, *others = [cells[f]["connections"]["Q"][0] for f in flops]
            nets[port] = [first]
            gone.update(flops)
            for other in others:
                for reader, its_port, bit, _ in readers.get(other, []):
                    cells[reader]["connections"][its_port][bit] = first
                    readers.setdefault(first, []).append((reader, its_port, bit, False))
            for f in flops:
                source.pop(cells[f]["connections"]["Q"][0], None)

    multipliers = [name for name, cell in cells.items() if cell["type"] == "MULT18X18D"]
    counts = Counter(multipliers=len(multipliers))
    gone = set()
    for name in multipliers:
        nets = cells[name]["connections"]
        outputs = registers(nets, [f"P{k}" for k in range(36)])
        clocks = {clock(f) for flops in outputs.values() for f in flops}
        ins = {port: nets[port][0] for port in nets if re.fullmatch(r"[AB]\d+", port)}
        fed = [source.get(net) for net in ins.values() if isinstance(net, int)]
        loaded = bool(fed) and all(fed) and len({clock(f) for f in fed} | clocks) == 1
        loaded = loaded and not any(data(f) in late for f in fed)
        if loaded:
            clocks = {clock(f) for f in fed}
            for port, net in ins.items():
                if isinstance(net, int):
                    nets[port] = [data(source[net])]
                    readers[net] = [r for r in readers[net] if r[:2] != (name, port)]
                    if isinstance(nets[port][0], int):
                        readers.setdefault(nets[port][0], []).append((name, port, 0, False))
        take_over(nets, outputs)
        if loaded or outputs:
            nets |= {"CLK0": [clocks.pop()], "CE0": ["1"], "RST0": ["0"]}
            cells[name]["port_directions"] |= {"CLK0": "input", "CE0": "input", "RST0": "input"}
        for which, wanted in (("INPUTA", loaded), ("INPUTB", loaded), ("OUTPUT", outputs)):
            if wanted:
                cells[name]["parameters"] |= {f"REG_{which}_{pin}": f"{pin}0" for pin in ("CLK", "CE", "RST")}
        counts["input"] += loaded
        counts["output"] += bool(outputs)
    for cell in cells.values():
        for side in "AB" if cell["type"] == "DP16KD" else "":
            nets = cell["connections"]
            outputs = registers(nets, [f"DO{side}{k}" for k in range(18)])
            if not outputs or nets[f"CLK{side}"] != [clock(next(iter(outputs.values()))[0])]:
                continue
            take_over(nets, outputs)
            cell["parameters"][f"REGMODE_{side}"] = "OUTREG"
            counts["memory"] += 1
    # remove flip-flops without readers, and then their sources that have become unread
    todo = [f for f in set(source.values())]
    while todo:
        name = todo.pop()
        if name in gone or readers.get(cells[name]["connections"]["Q"][0]):
            continue
        gone.add(name)
        net = data(name)
        readers[net] = [r for r in readers.get(net, []) if r[0] != name]
        if net in source:
            todo.append(source[net])
    for name in gone:
        del cells[name]
    return {**counts, "flip_flops": len(gone)}
