# SPDX-License-Identifier: Apache-2.0
"""A datapath elaborated by Yosys: the operator that drives each node, and the nodes that are its operands.

Wires are followed bit by bit through delays, ports, concatenations and shifts by a constant, and into an operator up to
the delay of its operand. The result describes the elaborated design, parameters included.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from functools import cached_property

DELAYS = ("ik_delay", "ik_ring")
"""Modules whose q is d delayed by N clocks."""

OWN = ("ik_pick",)
"""Modules whose instances count as the section's own logic."""

WAITS = ("DA", "DB", "DC", "DD")
"""Parameters that delay an operand: an operator is proved without them."""

HIERARCHY = ("ik_lean_root",)
"""Modules other than sections that are entered."""


class NetlistError(Exception):
    """A signal differs from the model; the text names the node."""


@dataclass(frozen=True)
class Bit:
    """Origin of a bit: `constant` 0 or 1, a bit of a `node`, a cell's output or a top-level port."""

    kind: str  # "constant", "node", "cell", "local", "outside"
    name: str = ""  # of the node, of the cell's path, of the port
    index: int = 0  # the constant's value, the bit of the node or of the cell's output
    port: str = ""
    clocks: int = 0  # of the delays on the way


@dataclass(frozen=True)
class Operand:
    """Value of a port: bits low .. low+width-1 of `node` times 2^shift, or a constant, after `clocks` of delay."""

    node: str
    shift: int = 0
    low: int = 0
    width: int = 0
    signed: bool = True
    constant: int = 0
    clocks: int = 0


@dataclass(frozen=True)
class Driver:
    """Driver of a node: the operator `module` at `path` with its parameters, or "" for logic of `section`."""

    module: str
    section: str
    path: str
    port: str = ""
    parameters: tuple = ()

    @property
    def values(self) -> dict[str, int]:
        return dict(self.parameters)


class Netlist:
    """The elaborated `top`; `nodes` maps a node's name to its instance path ("" for the top) and width."""

    def __init__(self, design: dict, top: str, nodes: dict[str, tuple[str, int]], signed: dict[str, bool]) -> None:
        self.modules = design["modules"]
        self.top = top
        self.signed = signed
        self.paths = {"": top}
        self._enter("")
        self.homes = nodes
        self.node_bits: dict[tuple[str, int], tuple[str, int]] = {}
        for name, (path, width) in nodes.items():
            bits = self.wire(path, name)
            if len(bits) != width:
                raise NetlistError(f"{name}: {len(bits)} bits in {self.kind(path)}, {width} in the model")
            for index, bit in enumerate(bits):
                # one wire may be two nodes (inv_law_raw and inv_law below its limit): keep the first
                self.node_bits.setdefault((path, bit), (name, index))

    # ---- hierarchy ---------------------------------------------------------------------------------------------------

    def kind(self, path: str) -> str:
        """Return the source name of an instance's module."""
        return self.source_name(self.paths[path])

    def source_name(self, module: str) -> str:
        found = self.modules[module]["attributes"].get("hdlname", module) if module in self.modules else module
        return found.split("\\")[-1]

    def _enter(self, path: str) -> None:
        for name, cell in self.modules[self.paths[path]]["cells"].items():
            kind = self.source_name(cell["type"])
            if kind in HIERARCHY or (path == "" and kind not in DELAYS and not kind.startswith("$")):
                inner = f"{path}.{name}".lstrip(".")
                self.paths[inner] = cell["type"]
                self._enter(inner)

    def wire(self, path: str, name: str) -> list:
        """Return the bits of a wire, lowest first."""
        try:
            return self.modules[self.paths[path]]["netnames"][name]["bits"]
        except KeyError:
            raise NetlistError(f"{name}: no such signal in {self.kind(path)}") from None

    def width(self, module: str, name: str) -> int:
        """Return the width of a wire in an elaborated module."""
        return len(self.modules[module]["netnames"][name]["bits"])

    @cached_property
    def _drivers(self) -> dict[str, dict[int, tuple[str, str, int]]]:
        """Return path -> bit -> cell, output port and index."""
        found = {}
        for path, module in self.paths.items():
            mine = found[path] = {}
            for name, cell in self.modules[module]["cells"].items():
                for port, bits in cell["connections"].items():
                    if self._is_output(cell, port):
                        mine.update((bit, (name, port, i)) for i, bit in enumerate(bits) if isinstance(bit, int))
        return found

    @cached_property
    def _inputs(self) -> dict[str, dict[int, tuple[str, int]]]:
        """Return path -> bit -> input port and index."""
        return {
            path: {
                bit: (port, i)
                for port, what in self.modules[module]["ports"].items()
                if what["direction"] == "input"
                for i, bit in enumerate(what["bits"])
            }
            for path, module in self.paths.items()
        }

    def _operator(self, cell: dict) -> bool:
        """Return whether a cell is an operator, not section logic."""
        return cell["type"] in self.modules and self.source_name(cell["type"]) not in OWN

    def _is_output(self, cell: dict, port: str) -> bool:
        if cell["type"] in self.modules:
            return self.modules[cell["type"]]["ports"][port]["direction"] == "output"
        return port in ("Y", "Q")

    # ---- following a bit ---------------------------------------------------------------------------------------------

    def origin(self, path: str, bit, of: str = "") -> Bit:
        """Return the origin of a bit; bits of the node `of` are passed over."""
        clocks = 0
        while True:
            if isinstance(bit, str):
                if bit not in "01":
                    raise NetlistError(f"{of or path}: a bit is '{bit}'")
                return Bit("constant", index=int(bit))
            at = self.node_bits.get((path, bit))
            if at and at[0] != of:
                return Bit("node", *at, clocks=clocks)
            if bit in self._inputs[path]:
                port, index = self._inputs[path][bit]
                if not path:
                    return Bit("outside", port, index, clocks=clocks)
                parent, _, cell = path.rpartition(".")
                path, bit = parent, self.modules[self.paths[parent]]["cells"][cell]["connections"][port][index]
                continue
            if bit not in self._drivers[path]:
                raise NetlistError(f"{of or path}: a bit that nothing drives")
            name, port, index = self._drivers[path][bit]
            cell = self.modules[self.paths[path]]["cells"][name]
            inner = f"{path}.{name}".lstrip(".")
            if inner in self.paths:
                path, bit = inner, self.modules[cell["type"]]["ports"][port]["bits"][index]
            elif self.source_name(cell["type"]) in DELAYS:
                bit = cell["connections"]["d"][index]
                clocks += self.parameters(cell["type"])["N"]
            elif self._operator(cell):
                return Bit("cell", inner, index, port, clocks)
            else:
                return Bit("local", path, index, port, clocks)

    def parameters(self, module: str) -> dict[str, int]:
        """Return the parameters of an elaborated module."""
        given = self.modules[module].get("parameter_default_values", {})
        return {name: int(bits, 2) for name, bits in given.items()}

    def driver(self, name: str) -> Driver:
        """Return the driver of a node."""
        path, _ = self.homes[name]
        origins = [self.origin(path, bit, name) for bit in self.wire(path, name)]
        cells = {o.name for o in origins if o.kind == "cell"}
        if len(cells) != 1 or any(o.kind == "local" for o in origins):
            return Driver("", self.kind(path), path)
        found = next(o for o in origins if o.kind == "cell")
        parent, _, cell = found.name.rpartition(".")
        module = self.modules[self.paths[parent]]["cells"][cell]["type"]
        values = tuple(sorted(item for item in self.parameters(module).items() if item[0] not in WAITS))
        return Driver(self.source_name(module), self.kind(path), found.name, found.port, values)

    def elaborated(self, path: str) -> str:
        """Return the elaborated module of an operator's instance."""
        parent, _, cell = path.rpartition(".")
        return self.modules[self.paths[parent]]["cells"][cell]["type"]

    def operand(self, path: str, port: str) -> Operand:
        """Return the value at an operator's input port."""
        parent, _, cell = path.rpartition(".")
        bits = self.modules[self.paths[parent]]["cells"][cell]["connections"][port]
        found = self.value(f"{path}.{port}", parent, bits)
        return replace(found, clocks=found.clocks + self.waits(self.elaborated(path), port))

    def waits(self, module: str, port: str) -> int:
        """Return the clocks by which an operator delays an input before using it."""
        bits = set(self.modules[module]["ports"][port]["bits"])
        cells = self.modules[module]["cells"].values()
        readers = [cell for cell in cells if any(bits & set(wire) for wire in cell["connections"].values())]
        # a delay of only some bits is part of the operation
        delays = [c for c in readers if self.source_name(c["type"]) in DELAYS and set(c["connections"]["d"]) == bits]
        if delays and len(readers) > 1:
            raise NetlistError(f"{self.source_name(module)}: {port} is used both delayed and undelayed")
        return sum(self.parameters(cell["type"])["N"] for cell in delays)

    def value(self, what: str, path: str, bits: list) -> Operand:
        """Return bits as one word of one node."""
        origins = [self.origin(path, bit) for bit in bits]
        if all(o.kind == "constant" for o in origins):
            word = sum(o.index << i for i, o in enumerate(origins))
            return Operand("", constant=word - (origins[-1].index << len(bits)), width=len(bits))
        shift = next(i for i, o in enumerate(origins) if o.kind != "constant")
        first = origins[shift]
        if first.kind != "node" or any(o.index for o in origins[:shift]):
            raise NetlistError(f"{what}: not a word of a node ({first})")
        node, low, clocks = first.name, first.index, first.clocks
        own = self.wire(self.homes[node][0], node)
        if shift >= low and own[:low] == ["0"] * low:  # the node's low bits are constant 0
            shift, low = shift - low, 0
        count = 0
        for o in origins[shift:]:
            place = low + count
            if place == len(own):
                break
            same = o.kind == "constant" and own[place] == str(o.index)
            if not same and (o.kind, o.name, o.index, o.clocks) != ("node", node, place, clocks):
                break
            count += 1
        above = origins[shift + count :]
        whole = low + count == len(own)
        zeros = all(o.kind == "constant" and not o.index for o in above)
        copies = all((o.name, o.index, o.clocks) == (node, len(own) - 1, clocks) for o in above)
        if above and not zeros and not (copies and whole and self.signed[node]):
            raise NetlistError(f"{what}: {node} has other bits above it")
        signed = self.signed[node] and whole and not (above and zeros)
        return Operand(node, shift, low, count, signed, clocks=clocks)

    def from_outside(self, path: str, bits: list) -> bool:
        """Return whether all bits are input ports of the instance or outputs of operators in it."""
        cells = self.modules[self.paths[path]]["cells"]

        def outside(bit) -> bool:
            driver = self._drivers[path].get(bit)
            return bit in self._inputs[path] or (driver is not None and self._operator(cells[driver[0]]))

        return all(map(outside, bits))

    def positive(self, name: str) -> bool:
        """Return whether a node's sign bit is wired to 0."""
        path, _ = self.homes[name]
        return self.origin(path, self.wire(path, name)[-1], name) == Bit("constant")


def load(path) -> dict:
    """Read the output of `write_json`."""
    return json.loads(path.read_text())
