# SPDX-License-Identifier: Apache-2.0
"""Origins of the bits of a datapath that Yosys has flattened: a bit is followed through registers and delays."""

import json
from dataclasses import dataclass
from pathlib import Path

RING = "ik_ring"  # module whose q is d delayed by N clocks, in a memory


class NetlistError(Exception):
    """A signal differs from the model; the text names it."""


@dataclass(frozen=True)
class Bit:
    """Origin of a bit: `constant` 0 or 1, a bit of a `node`, of a `cell`'s output or of an input `port`."""

    kind: str
    name: str = ""  # of the node, the cell or the port
    index: int = 0  # the constant's value, else the number of the bit
    clocks: int = 0  # of the delays on the way


class Netlist:
    """The module `top` in a file of `write_json`; `nodes` maps a node to its signal and width."""

    def __init__(self, path: Path, top: str, nodes: dict[str, tuple[str, int]]) -> None:
        self.modules = json.loads(path.read_text())["modules"]
        module = self.modules[top]
        self.wires = {name: wire["bits"] for name, wire in module["netnames"].items()}
        self.cells = module["cells"]
        self.origins = {
            bit: Bit("port", name, index)
            for name, port in module["ports"].items()
            for index, bit in enumerate(port["bits"])
            if port["direction"] == "input"
        }
        for name, (signal, width) in reversed(nodes.items()):  # a wire may be two nodes: keep the first
            bits = self.wires[signal]
            if len(bits) != width:
                raise NetlistError(f"{name}: {len(bits)} bits in the netlist, {width} in the model")
            self.origins |= {bit: Bit("node", name, index) for index, bit in enumerate(bits)}
        self.drivers = {
            bit: (name, port, index)
            for name, cell in self.cells.items()
            for port, direction in cell["port_directions"].items()
            for index, bit in enumerate(cell["connections"][port])
            if direction == "output"
        }

    def _delay(self, cell: dict) -> tuple[int, str]:
        """Return the clocks of a register or delay, 0 for any other cell, and its input."""
        if cell["type"] == "$dff":
            return 1, "D"
        module = self.modules.get(cell["type"], {})
        is_ring = module.get("attributes", {}).get("hdlname", cell["type"]).endswith(RING)
        return int(module["parameter_default_values"]["N"], 2) if is_ring else 0, "d"

    def origin(self, bit: int | str) -> Bit:
        """Return the origin of a bit."""
        clocks = 0
        while not isinstance(bit, str):
            if bit in self.origins:
                origin = self.origins[bit]
                return Bit(origin.kind, origin.name, origin.index, clocks)
            if bit not in self.drivers:
                raise NetlistError(f"bit {bit} has no driver")
            name, port, index = self.drivers[bit]
            delay, source = self._delay(self.cells[name])
            if not delay:
                return Bit("cell", name, index, clocks)
            bit, clocks = self.cells[name]["connections"][source][index], clocks + delay
        if bit not in "01":
            raise NetlistError(f"a bit is '{bit}'")
        return Bit("constant", index=int(bit))
