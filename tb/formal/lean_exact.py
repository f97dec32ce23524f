# SPDX-License-Identifier: Apache-2.0
"""Exact arithmetic of the whole arm's dataflow, which contains the lean dataflow, as formulas over the reals.

Each node is a real number that satisfies the formulas of its operation (``Operation.facts``).  A count e is stated as
2^e, so a shift is a product.  The datapath decides on rounded words; here, the sign of a rounded word and every other
decision on a rounded word are free, so a proof holds for any outcome of rounding.  A node that takes operands' words as
exact (``Dataflow.words``) uses ``n_w``, the word of operand n; it differs from n's exact value by at most n's error.

The questions are in :mod:`tb.formal.lean_proofs`.
"""

from model.bounds.ranges import LeanRanges, on_grid
from model.dataflow.annotations import Within
from model.dataflow.expressions import Compared, Constant, FreeError, number
from model.dataflow.fixed import dataflow
from model.dataflow.nodes import Node
from model.io.words import ARMS
from tb.formal.smt import formula, smt


def between(low: float, term: str, high: float, below: bool = False) -> str:
    """Return the condition low <= term <= high; with ``below``, low <= term < high."""
    return f"(and (<= {number(low)} {term}) ({'<' if below else '<='} {term} {number(high)}))"


class Exact:
    """Formulas of the whole arm's dataflow at one word length."""

    def __init__(self, width: int) -> None:
        self.flow = dataflow("arm", width)
        self.nodes = dict(self.flow.nodes)
        self.errors = LeanRanges(width, datapath="arm").errors
        self.equations = {"ulp": [f"(= ulp {number(self.flow.word(1).ulp)})"]}
        self.lemmas = {name: (smt(text) if text else "", uses) for name, (text, uses) in self.flow.lemmas.items()}
        self.equations |= {name: [f"(= {name} {smt(text)})"] for name, text in self.flow.definitions.items()}
        self._node = next(iter(self.nodes.values()))  # the node whose formulas are being written
        for name, node in self.nodes.items():
            for operand in node.as_words:
                self._take_word(self.nodes[operand])
            self.equations[name] = self._facts(node)

    def _facts(self, node: Node) -> list[str]:
        """Return the formulas of a node: none for a decision that is free."""
        if node.kind == "input":
            fmt = node.format
            return [between((1 if node.name in ARMS else fmt.low) * fmt.ulp, node.name, fmt.high * fmt.ulp)]
        self._node = node
        try:
            return node.op.facts(node, self)
        except FreeError:
            if node.format.width == 1:
                return []
            raise

    def _take_word(self, node: Node) -> None:
        """Add a node's word as a number without an error, in the range of the word."""
        error, within, fmt = self.errors[node.name], node.within, node.format
        ends = fmt.low * fmt.ulp, fmt.high * fmt.ulp
        if self.equations[node.name]:
            ends = on_grid((within.low - error, within.high + error), fmt)
        word = f"{node.name}_w"
        self.equations[word], self.errors[word] = [between(ends[0], word, ends[1])], 0.0

    # ---- called by operations --------------------------------------------------------------------------------------

    def name(self, node: Node) -> str:
        """Return the name that an operand has in the formulas being written: of its exact value, or of its word."""
        return self.operand(self._node, node)

    @staticmethod
    def operand(node: Node, operand: Node) -> str:
        """Return the name that an operand has in a node's formulas."""
        return f"{operand.name}_w" if operand.name in node.as_words else operand.name

    def operands(self, name: str) -> list[str]:
        return [self.operand(self.nodes[name], operand) for operand in self.nodes[name].operands]

    def compared(self, relation: Compared) -> str:
        """Return a comparison as a formula. Raises FreeError for rounded words, except about a sign, which is free."""
        left, right = relation.parts
        rounded = [node for node in relation.operands if self.errors[self.name(node)]]
        if not rounded:
            return f"({relation.relation} {left.formula(self)} {right.formula(self)})"
        negative = f"neg_{rounded[0].name}"
        zeros = [isinstance(part, Constant) and part.value == 0 for part in (left, right)]
        if zeros[1] and relation.relation == "<":
            return negative
        if zeros[0] and relation.relation == "<=":
            return f"(not {negative})"
        raise FreeError(relation.text())

    # ---- facts -----------------------------------------------------------------------------------------------------

    def on_words(self, mask: Node) -> str:
        """Return the fact that a mask is its comparison, applied to the words of its operands."""
        left, right = (part.formula(self) if isinstance(part, Constant) else f"{part.name}_w" for part in mask.op.parts)
        return f"(= {mask.name} ({mask.op.relation} {left} {right}))"

    def near(self, name: str) -> str:
        """Return the fact that a node's word differs from the node's exact value by at most the node's error."""
        error = self.errors[name]
        return between(-error, f"(- {name}_w {name})", error) if error else f"(= {name}_w {name})"

    def within(self, name: str) -> Within:
        """Return the range that the dataflow claims for a node. Raises LookupError if it claims none."""
        if not isinstance(within := self.nodes[name].within, Within):
            raise LookupError(name)
        return within

    def claim(self, name: str) -> str:
        """Return the claim that a node's exact value is in its range; for a count, that it is above -1 and below 64."""
        within = self.within(name)
        if not self.nodes[name].frac:  # a count e, stated as 2^e: -1 < e < 64
            return f"(and (< 0.5 {name}) (< {name} {number(2.0 ** (within.high + 1))}))"
        return between(within.low, name, within.high, within.below)

    def known(self, name: str) -> str:
        """Return the fact that a proved :meth:`claim` provides: as an integer, a count above -1 is at least 0."""
        return self.claim(name) if self.nodes[name].frac else between(1.0, name, 2.0 ** self.within(name).high)

    def places(self, name: str) -> str:
        """Return the fact that |word| is 0, one ulp, or at least two. Raises LookupError if the word is rounded."""
        if self.errors[name]:
            raise LookupError(f"{name} is rounded")
        ulp = self.nodes[name].format.ulp
        size = f"(ite (< {name} 0.0) (- {name}) {name})"
        return f"(or (= {name} 0.0) (= {size} {number(ulp)}) (<= {number(2 * ulp)} {size}))"

    def formula(self, facts: list[str], goal: str) -> str:
        """Return the formula "all facts hold and the goal does not", with a declaration of each name."""

        def sort(name: str) -> str:
            mask = name.startswith("neg_") or (name in self.nodes and self.nodes[name].format.width == 1)
            return "Bool" if mask else "Real"

        return formula(facts, goal, sort)

    @property
    def claimed(self) -> list[str]:
        """Nodes with a claimed range and with formulas from which to prove it."""
        return [n for n, node in self.nodes.items() if isinstance(node.within, Within) and self.equations[n]]
