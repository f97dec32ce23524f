# SPDX-License-Identifier: Apache-2.0
"""Error bounds of the lean datapath's words, by z3 over the reals.

A word is the node's operation applied to its operands' words, plus rounding (:meth:`Rounded.rounding`). Each operand's
word is within its own error of its exact value, which lies in its range (:mod:`tb.formal.lean_rules`). The node's error
of :mod:`model.bounds.lean_ranges` follows. ``n_w`` is the word of node n, ``n_f`` the word before rounding.
"""

from __future__ import annotations

import re

from model.dataflow.annotations import Limited
from model.dataflow.nodes import FLOOR, JAM, Node
from tb.formal.lean_exact import Exact, between, number


class Rounded:
    """Questions about the errors at one word length."""

    def __init__(self, width: int) -> None:
        self.exact = Exact(width)

    def names(self) -> list[str]:
        """Return the nodes that have a fraction and are not exact."""
        nodes = self.exact.nodes
        return [name for name in self.exact.claimed if nodes[name].format.frac and self.exact.ranges[name].value.error]

    def rounding(self, node: Node) -> tuple[float, float]:
        """Return the bounds of the rounding error in ulps: one ulp in either direction for an operation that drops
        bits, as a difference reverses the sign of an operand's rounding."""
        return JAM if node.error == FLOOR and node.op == "choose" else node.error

    def _near(self, node: Node) -> list[str]:
        """Return the known facts of a node: its range and its word's error; an exact word equals its value."""
        name, error = node.name, self.exact.ranges[node.name].value.error
        known = [self.exact.claim(name)] if name in self.exact.claimed and name != "m_q" else []
        if not error:
            return [*known, f"(= {name}_w {name})"]
        return [*known, between(-error, f"(- {name}_w {name})", error)]

    def _facts(self, name: str) -> list[str]:
        node = self.exact.nodes[name]
        fractions = [n for n in node.operands if n.format.frac]
        facts = [fact for n in node.operands if n.format.frac for fact in self._near(n)]
        facts += [self.exact.known(n.name) for n in node.operands if n.name in self.exact.claimed and not n.format.frac]
        facts += self.exact.equations[name]
        words = {n.name: f"{n.name}_w" for n in fractions}
        lowest, highest = (number(e * node.format.ulp) for e in self.rounding(node))
        if node.op in ("even", "trig") or (node.op == "rsqrt" and fractions[0].op == "even"):
            # truncating a mantissa is part of the root's error
            return [*facts, f"(<= {lowest} (- {name}_w {name}) {highest})"]
        words[name] = f"{name}_f"
        facts += [
            re.sub(r"[a-z]\w*", lambda found: words.get(found[0], found[0]), text)
            for text in self.exact.equations[name]
        ]
        top = number(node.format.high * node.format.ulp)
        held = f"(ite (< {top} {name}_f) {top} {name}_f)" if isinstance(node.facts.limited, Limited) else f"{name}_f"
        facts.append(f"(<= {lowest} (- {name}_w {held}) {highest})")
        if "low" in {n.name for n in node.operands}:  # the only decision that does not depend on signs alone
            facts.append("(= low (< length_sq_w 0.25))")
        if name == "inv_q":
            facts += self._facts("m_q")
        return facts

    def claim(self, name: str) -> str:
        """Return the error claim, and the word's range if a decision on words limits it."""
        value = self.exact.ranges[name].value
        claim = between(-value.error, f"(- {name}_w {name})", value.error)
        if name == "m_q":
            return f"(and {claim} {between(value.low - value.error, 'm_q_w', value.high + value.error)})"
        return claim

    def says(self, name: str) -> str:
        """Return the meaning of a question, for the full table."""
        node = self.exact.ranges[name]
        return f"within {node.value.error / node.format.ulp:.6g} ulps of its exact value"

    def question(self, name: str) -> str:
        """Return the formula that z3 must refute."""
        return self.exact.formula(self._facts(name), self.claim(name))

    def assumed(self, name: str) -> str:
        """Return the formula of the facts alone, which z3 must satisfy."""
        return self.exact.formula(self._facts(name), "false")
