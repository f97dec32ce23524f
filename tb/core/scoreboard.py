# SPDX-License-Identifier: Apache-2.0
"""Scoreboard for the nodes of a core."""

from collections.abc import Iterable

from model.dataflow import fixed
from model.dataflow.nodes import Node
from tb.sim.job import KEPT, Difference, report


class Scoreboard:
    """Scoreboard that compares every named node of every target with the model, in the clock where the node is valid.

    ``handle_of(node)`` returns the signal of a node. Call ``expect`` with targets in order of admission. When a
    target is admitted, set ``in_clock[clock] = target``. Call ``sample`` once per clock.
    """

    def __init__(self, handle_of, nodes: Iterable[Node]) -> None:
        self.nodes = list(nodes)
        self.by_time: dict[int, list[tuple[Node, object]]] = {}
        for node in self.nodes:
            self.by_time.setdefault(node.time, []).append((node, handle_of(node)))
        self.expected: dict[str, list[int]] = {node.name: [] for node in self.nodes}
        self.in_clock: dict[int, int] = {}  # clock of admission -> target
        self.compared = 0
        self.mismatching_bits = 0
        self.differences: list[Difference] = []

    def expect(self, answer: fixed.Answer) -> None:
        """Append the model's node values of the next targets."""
        for name, values in self.expected.items():
            node = answer.bits.nodes[name]
            mask = (1 << node.format.width) - 1
            values += [int(v) & mask for v in node.value.tolist()]

    def sample(self, clock: int, now: int) -> None:
        """Compare all valid nodes. ``clock`` counts clocks without a stall; ``now`` counts all clocks, for messages."""
        for time, pairs in self.by_time.items():
            target = self.in_clock.get(clock - time)
            if target is None:
                continue
            for node, handle in pairs:
                bits = str(handle.value)  # as text: X or Z is a difference, not an error of the bench
                expected = self.expected[node.name][target]
                self.compared += 1
                if bits != format(expected, f"0{node.format.width}b"):
                    difference = Difference(node, target, now, bits, expected)
                    self.mismatching_bits += difference.bits()
                    if len(self.differences) < KEPT:
                        self.differences.append(difference)

    def report(self, since: int = 0) -> str:
        """Return a message about the first target that differs; empty if none does. Numbers count from ``since``."""
        return report(self.differences, self.nodes, since=since)
