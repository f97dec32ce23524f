# SPDX-License-Identifier: Apache-2.0
"""That the words of the lean datapath are as near their exact values as its ranges count on, by z3 over the reals.

A word is what the node's operation makes of its operands' words, and what rounding adds
(:meth:`Rounded.rounding`); each operand's word is within its own error of its exact value, which lies in its range
(:mod:`tb.formal.lean_rules`). From that follows the node's error, as :mod:`model.bounds.lean_ranges` has it.
``n_w`` is the word of node n, ``n_f`` what the operation would make of the operands' words without rounding.
"""

from __future__ import annotations

import re

from model.dataflow import lean
from model.dataflow.annotations import Limited
from model.dataflow.nodes import FLOOR, JAM, Node
from tb.formal.lean_exact import Exact, between, number
from tb.formal.unrolled import Answer, ask

SOLVER = "(check-sat-using qfnra-nlsat)"
LIMIT = 60  # seconds for one question


class Rounded:
    """The questions about one word length; ``dataflow`` in place of the real one for a seeded bug."""

    def __init__(self, width: int, dataflow=lean) -> None:
        self.exact = Exact(width, dataflow)

    def names(self) -> list[str]:
        """The nodes that have a fraction and are not exact."""
        nodes = self.exact.nodes
        return [name for name in self.exact.claimed if nodes[name].format.frac and self.exact.ranges[name].value.error]

    def rounding(self, node: Node) -> tuple[float, float]:
        """What is added to the value of words, in ulps; of an operation that drops bits up to one either way, as a
        difference turns what its terms lose."""
        return JAM if node.error == FLOOR and node.op == "choose" else node.error

    def _near(self, node: Node) -> list[str]:
        """What is known of a node: its range, and its word's error; a word that is exact is its value."""
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
            # a mantissa cut off is part of the root's error
            return [*facts, f"(<= {lowest} (- {name}_w {name}) {highest})"]
        words[name] = f"{name}_f"
        facts += [
            re.sub(r"[a-z]\w*", lambda found: words.get(found[0], found[0]), text)
            for text in self.exact.equations[name]
        ]
        top = number(node.format.high * node.format.ulp)
        held = f"(ite (< {top} {name}_f) {top} {name}_f)" if isinstance(node.facts.limited, Limited) else f"{name}_f"
        facts.append(f"(<= {lowest} (- {name}_w {held}) {highest})")
        if "low" in {n.name for n in node.operands}:  # the one decision that is not of signs
            facts.append("(= low (< length_sq_w 0.25))")
        if name == "inv_q":
            facts += self._facts("m_q")
        return facts

    def claim(self, name: str) -> str:
        """The error; where a decision on words holds a range, the word's range as well."""
        value = self.exact.ranges[name].value
        claim = between(-value.error, f"(- {name}_w {name})", value.error)
        if name == "m_q":
            return f"(and {claim} {between(value.low - value.error, 'm_q_w', value.high + value.error)})"
        return claim

    def question(self, name: str) -> str:
        """What z3 is to refute."""
        return self.exact.formula(self._facts(name), self.claim(name))

    def ask(self, name: str) -> Answer:
        return ask(self.question(name), SOLVER, LIMIT)

    def meet(self, name: str) -> Answer:
        """Whether what a question assumes can be met."""
        return ask(self.exact.formula(self._facts(name), "false"), SOLVER, LIMIT)
