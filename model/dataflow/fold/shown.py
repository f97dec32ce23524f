# SPDX-License-Identifier: Apache-2.0
"""Location and clock of each node of the dataflow in the fold datapath, for testbenches and waves.

A node can be found in T, a product, a written word, a mantissa, a count, a flag or a result.  ``ik_fold_nodes.vh``
copies the node from there to a register with the node's name; no logic reads this register.
"""

from dataclasses import dataclass
from functools import cache

from ..nodes import Node
from . import steps as timing
from .lowering import Lowering
from .program import Program, program
from .steps import DOUBLE, ELBOW, PLAIN, Pick, Placed, Selector, Step


@dataclass(frozen=True)
class Shown:
    """Location of a node: Verilog expression ``text``, valid in clocks ``clocks`` of a target while ``when`` holds."""

    node: Node
    clocks: tuple[int, ...]
    text: str
    when: str = ""

    @property
    def time(self) -> int:
        """First clock, counted as ``clocks`` are, in which the register of the node holds its word."""
        return max(self.clocks) + 1


class _Finder:
    def __init__(self, lowering: Lowering, program: Program) -> None:
        self.lowering, self.program = lowering, program
        self.nodes: dict[str, Node] = lowering.nodes
        self.found: dict[str, Shown] = {}

    def add(self, name: str, clock: int, text: str) -> None:
        if name in self.nodes and name not in self.found:
            self.found[name] = Shown(self.nodes[name], (clock,), text)

    def place(self, name: str) -> str:
        """Return the index of a node's LSB in a memory word, as Verilog text."""
        return f"D - {1 + self.lowering.weight[name]} - ({self.nodes[name].format.frac_expr})"

    def bits(self, word: str, at: str, name: str) -> str:
        of = self.nodes[name].format
        return f"{word}[{at} +: {of.frac_expr} + {of.width - of.frac}]"

    def of_sum(self, name: str, step: Step) -> str:
        """Return the bits of T that hold the node."""
        width = self.nodes[name].format.width
        if width == 2 * self.lowering.width + 2:
            return "~t" if step.norm and step.norm.kind == "inverse" else "t"
        if width == 2 * self.lowering.width:
            return "t[XW-1:2]"
        if step.write and step.write.double_by:
            plain, double = (self.of_window(name, window) for window in (PLAIN, DOUBLE))
            return f"doubled ? {double} : {plain}"
        return self.of_window(name, step.write.window if step.write else DOUBLE if step.cut == "double" else PLAIN)

    def of_window(self, name: str, window: int) -> str:
        """Return the bits of T that hold the node, if the node's word is the window ``window`` of T."""
        node, last = self.nodes[name], f"XW - D - {1 + window} + {self.place(name)}"
        above = node.format.width - node.format.frac - self.lowering.weight[name] - 2 - window
        if above > 0:  # T has fewer high bits: extend the sign
            return f"{{{{{above}{{t[XW-1]}}}}, t[XW-1:{last}]}}"
        return self.bits("t", last, name)

    def of_product(self, name: str, cut: str) -> str:
        """Return the bits of the product that hold the node."""
        if cut == "exact":
            return f"p[2*D-1 -: {'2*W' if self.nodes[name].format.width == 2 * self.lowering.width else 'XW'}]"
        return f"p_{cut}[FRAC+2:1]"

    def step(self, placed: Placed) -> None:
        step, at = placed.step, placed.at
        write, norm = step.write, step.norm
        if step.count:
            of = step.count
            clock = at + (timing.WRITE if norm else timing.READ)
            self.add(of.node if of.node in self.lowering.counts else "", clock, f"n - 6'd{of.offset & 63}")
        if step.term in self.nodes:
            self.add(step.term, at + timing.SUM, self.of_product(step.term, step.cut))
        if isinstance(step.b, Pick) and step.b.constant:
            for name in (name for name, pick in self.lowering.picks.items() if pick == step.b):
                self.add(name, at + timing.READ + 1, self.bits("b", self.place(name), name))
        if norm:
            self.add(norm.to, at + timing.NORM, self.bits("normal", self.place(norm.to), norm.to))
            self.add(norm.count, at + timing.NORM, "pairs - 6'd1" if norm.kind == "arm" else "pairs")
        if write and isinstance(write.to, str) and write.to in self.nodes:
            format = self.nodes[write.to].format
            if format.width - 1 - format.frac <= self.lowering.weight[write.to]:
                self.add(write.to, at + timing.WRITE, self.bits("w", self.place(write.to), write.to))
        if step.name in self.nodes and step.name not in self.lowering.INPUTS and not (norm and norm.to == step.name):
            if not step.result:
                self.add(step.name, at + timing.WRITE, self.of_sum(step.name, step))
            elif step.name != step.result or step.name in ELBOW:
                self.add(step.name, at + timing.SUM, self.of_product(step.name, step.cut))
        if step.result:
            self.add(step.result, at + timing.WRITE, "answer")

    def pairs(self) -> None:
        for first, second in self.lowering.pairs.values():
            writes = ((p.at + timing.WRITE, p.step.write.to) for p in self.program.steps if p.step.write)
            clocks = tuple(clock for clock, to in writes if isinstance(to, Pick) and to.pair == first)
            for name, which in ((first, "!"), (second, "")):
                text = self.bits("w", self.place(name), name)
                self.found[name] = Shown(self.nodes[name], clocks, text, f"{which}w_place[0]")

    def flags(self) -> None:
        set_at: dict[str, int] = {}
        for placed in self.program.steps:
            for use in timing.registers_set(placed):
                set_at[use.of] = max(set_at.get(use.of, 0), use.at)
        wires = {"bad_hand": "hand_nodes[0]", "saturated": "hand_nodes[1]", "low": ""}
        joints = {f"over_{name[-1]}": clock for name, clock in self.program.shown.items()}
        masks = [name for name in self.lowering.made_of if name not in wires and name not in joints]
        wires |= {name: f"flag_nodes[{bit}]" for bit, name in enumerate(masks)}  # of ik_fold_flags
        for name in self.lowering.made_of.keys() - joints.keys() - {"low"}:
            registers = self.lowering.registers(Selector(name))
            if unset := registers - set_at.keys():
                unknown = f"no step sets {', '.join(unset)}; mask_registers of its operation names others"
                raise LookupError(f"{name}: {unknown}")
            self.add(name, max(set_at[root] for root in registers) + 1, wires[name])
        self.add("low", set_at["e_q"] + 2, "q_low")
        for name, clock in joints.items():
            self.add(name, clock + timing.COMPARED, "over")

    def angles(self) -> None:
        """Add the angles, the joints and the lengths; a length is read when its vector is handed over."""
        joints = {joint.angle: 8 if joint.other else 4 for joint in self.lowering.joints.values()}
        for angle, turn in self.program.turns.items():
            self.add(turn.vector.length or "", turn.over, "length")
            half = "1'b0" if turn.vector.lengths else "left"
            self.add(angle, turn.over + self.lowering.angle_clocks.shown, f"angle(4'd{joints.get(angle, 0)}, {half})")
        for name, clock in self.program.shown.items():
            self.add(name, clock, "th")


def shown(lowering: Lowering, program: Program) -> dict[str, Shown]:
    """Return the location of each node, in dataflow order.  Raises LookupError if a node has no location."""
    finder = _Finder(lowering, program)
    for name, clock in program.loads.items():
        finder.add(name, clock, "in")
    for name in lowering.SIDE:
        finder.add(name, max(program.loads.values()) + 1, f"branch_in[{lowering.SIDE.index(name)}]")
    finder.pairs()
    finder.flags()
    finder.angles()
    for placed in program.steps:
        finder.step(placed)
    missing = [name for name in lowering.nodes if name not in finder.found]
    if missing:
        raise LookupError(f"no location in the fold datapath for {', '.join(missing)}")
    return {name: finder.found[name] for name in lowering.nodes}


@cache
def times(width: int, name: str = "fold") -> dict[str, int]:
    """Return a dict: node -> first clock in which its register is valid, counted from the acceptance of its target."""
    lowering, made = program(width, name)
    taken = max(made.loads.values())
    return {name: max(of.time - taken, 1) for name, of in shown(lowering, made).items()}
