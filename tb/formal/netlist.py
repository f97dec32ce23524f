# SPDX-License-Identifier: Apache-2.0
"""Origins of the bits of a datapath that Yosys has elaborated.

A bit is followed through delays, ports, concatenations and shifts by a constant, in the top and in its sections.
"""

import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

DELAYS = ("ik_delay", "ik_ring")  # modules whose q is d delayed by N clocks


class NetlistError(Exception):
    """A signal differs from the model; the text names it."""


@dataclass(frozen=True)
class Bit:
    """Origin of a bit: `constant` 0 or 1, a bit of a `node`, of a `cell`'s output or of an input `port` of the top."""

    kind: str
    name: str = ""  # of the node, the cell or the port
    index: int = 0  # the constant's value, else the number of the bit
    clocks: int = 0  # of the delays on the way


class Netlist:
    """The elaborated `top` in a file of `write_json`; `nodes` maps a node to its section ("" for the top) and width."""

    def __init__(self, path: Path, top: str, nodes: dict[str, tuple[str, int]]) -> None:
        self.modules = json.loads(path.read_text())["modules"]
        cells = self.modules[top]["cells"].items()
        sections = {
            name: cell["type"] for name, cell in cells if cell["type"] in self.modules and not self._delay(cell)
        }
        self.paths = {"": top, **sections}
        self.nodes: dict[tuple[str, int], tuple[str, int]] = {}
        for name, (section, width) in nodes.items():
            bits = self.wire(section, name)
            if len(bits) != width:
                raise NetlistError(f"{name}: {len(bits)} bits in the netlist, {width} in the model")
            for index, bit in enumerate(bits):
                # one wire may be two nodes (inv_law_raw and inv_law below its limit): keep the first
                self.nodes.setdefault((section, bit), (name, index))

    def _delay(self, cell: dict) -> int:
        """Return the clocks of a delay or register, 0 for any other cell."""
        if cell["type"] == "$dff":
            return 1
        module = self.modules.get(cell["type"], {})
        if module.get("attributes", {}).get("hdlname", cell["type"]).split("\\")[-1] not in DELAYS:
            return 0
        return int(module["parameter_default_values"]["N"], 2)

    def _ports(self, cell: dict, direction: str) -> set[str]:
        """Return a cell's inputs or outputs, as ``direction`` selects. Outputs of Yosys' own cells are Y and Q."""
        if cell["type"] not in self.modules:
            return {"Y", "Q"} if direction == "output" else set()
        return {name for name, port in self.modules[cell["type"]]["ports"].items() if port["direction"] == direction}

    def wire(self, section: str, name: str) -> list:
        """Return the bits of a wire, lowest first."""
        try:
            return self.modules[self.paths[section]]["netnames"][name]["bits"]
        except KeyError:
            raise NetlistError(f"{name}: no such signal in {section or 'the top'}") from None

    @cached_property
    def _drivers(self) -> dict[tuple[str, int], tuple[str, str, int]]:
        """Return a dict: (section, bit) -> (cell, output port, index) that drives it."""
        return {
            (section, bit): (name, port, index)
            for section, module in self.paths.items()
            for name, cell in self.modules[module]["cells"].items()
            for port in self._ports(cell, "output") & cell["connections"].keys()
            for index, bit in enumerate(cell["connections"][port])
        }

    @cached_property
    def _inputs(self) -> dict[tuple[str, int], tuple[str, int]]:
        """Return a dict: (section, bit) -> (input port, index) that it is connected to."""
        return {
            (section, bit): (name, index)
            for section, module in self.paths.items()
            for name, port in self.modules[module]["ports"].items()
            if port["direction"] == "input"
            for index, bit in enumerate(port["bits"])
        }

    def origin(self, section: str, bit: int | str) -> Bit:
        """Return the origin of a bit."""
        clocks = 0
        while not isinstance(bit, str):
            here = section, bit
            if here in self.nodes:
                return Bit("node", *self.nodes[here], clocks)
            if here in self._inputs:
                port, index = self._inputs[here]
                if not section:
                    return Bit("port", port, index, clocks)
                section, bit = "", self.modules[self.paths[""]]["cells"][section]["connections"][port][index]
                continue
            if here not in self._drivers:
                raise NetlistError(f"{section or 'top'}: bit {bit} has no driver")
            name, port, index = self._drivers[here]
            cell = self.modules[self.paths[section]]["cells"][name]
            if delay := self._delay(cell):
                given = cell["connections"]["D" if cell["type"] == "$dff" else "d"]
                bit, clocks = given[index], clocks + delay
            elif not section and name in self.paths:
                section, bit = name, self.modules[cell["type"]]["ports"][port]["bits"][index]
            else:
                return Bit("cell", f"{section}.{name}".lstrip("."), index, clocks)
        if bit not in "01":
            raise NetlistError(f"{section or 'top'}: a bit is '{bit}'")
        return Bit("constant", index=int(bit))
