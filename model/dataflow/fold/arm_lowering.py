# SPDX-License-Identifier: Apache-2.0
"""Lower the whole arm to steps of the fold datapath, around the core's steps, and to vectors of its angle unit.

The hand's words have weight 1, as results do, so that their products have the weight of inner words' products.  The
sums of their squares wrap at 8.  A wrist coordinate is summed as half its value.
"""

from dataclasses import replace

from ...io.words import ARM_FIELDS, ARM_RESULT_FIELDS, BRANCHES, FIELDS
from .. import arm
from ..nodes import Node
from .lowering import EXACT_WEIGHT, RESULT_WEIGHT, Lowering, Sum
from .steps import ALWAYS, HALF, NEVER, ONE, ZERO, Joint, Pick, Selector, Step, Vector, Write

HALF_ROW = "1/2 of r_z"  # step of the constant in the third row


class ArmLowering(Lowering):
    """Whole arm as steps."""

    INPUTS, SIDE, RESULTS = ARM_FIELDS, BRANCHES, ARM_RESULT_FIELDS

    def flow(self, inputs: dict[str, Node]) -> None:
        self.weight |= {name: RESULT_WEIGHT for name in self.INPUTS if name not in FIELDS}
        arm.arm(self, inputs)

    def _mask(self, node: Node, kind: str) -> set[str]:
        if kind == "outside":  # set after the joint's angle
            return {node.name}
        if kind == "outside_format":
            wrists = {of.name for sums in self.sums.values() for of in sums if of.write and of.write.source == "wrist"}
            self.signs |= wrists  # their registers
            return wrists
        return super()._mask(node, kind)

    def _plus_wrapped(self, node: Node, a: str, b: str, width: int) -> None:
        self._plus(node, a, b)

    def _chosen(self, node: Node, word: str, mask: str, unit: int | None) -> None:
        self.weight[node.name] = RESULT_WEIGHT
        self.picks[node.name] = Pick(word, Selector(mask), constant=ZERO if unit is None else ONE)

    def _chain(self, first: str, *terms: tuple[str, str, int], write: Write | None = None, result: str = "") -> None:
        """Add terms (sum, term, sign) to a first one, and write the last sum or make it a result."""
        for name, term, sign in terms:
            self.sums[first].append(Sum(name, term, NEVER if sign > 0 else ALWAYS))
            last, first = first, name
        self.sums[last][-1] = replace(self.sums[last][-1], write=write, result=result)

    def _half_row(self, node: Node, a: str, b: str, signs: tuple[int, int], half: int, width: int) -> None:
        name, self.weight[node.name] = node.name, self._weight(node)
        if half:
            self.terms[HALF_ROW] = Step(HALF_ROW, ONE, HALF)
            self._chain(HALF_ROW, (f"{name}'", a, signs[0]), (name, b, signs[1]), write=Write(name))
        else:
            assert signs[0] > 0
            self._chain(a, (name, b, signs[1]), write=Write(name))

    def _target(self, node: Node, point: str, off: str, **shifts: int) -> None:
        self.weight[node.name] = EXACT_WEIGHT
        self.terms[f"{point}/2"] = Step(f"{point}/2", point, HALF, addend="result_double")
        self._chain(f"{point}/2", (node.name, off, -1), write=Write(node.name, source="wrist"))

    def _elbow(self, node: Node, raw: str, clamp: str, fold: str, sign: int, **words: int) -> None:
        """Keep the word, and make it a result later: from the first result to the last one there is less than a lap."""
        super()._elbow(node, raw, clamp, fold, sign, **words)
        self.terms[raw] = replace(self.terms[raw], result=raw)
        self.terms[node.name] = Step(node.name, node.name, ONE, result=node.name)

    def _four(self, node: Node, *terms: str, signs: tuple[int, ...]) -> None:
        assert signs[0] > 0
        self.weight[node.name] = self._weight(node)
        names = *(f"{node.name}{n}" for n in (2, 3)), node.name
        self._chain(terms[0], *zip(names, terms[1:], signs[1:], strict=True), write=Write(node.name))

    def _two(self, node: Node, a: str, b: str, sign: int, drop: int) -> None:
        self.terms[a] = replace(self.terms[a], minus=ALWAYS, addend="result_plain", write=None, term=a)
        self._chain(a, (node.name, b, sign), result=node.name)

    def vector(self, length, angle, x, y, within) -> None:
        super().vector(length, angle, x, y, within)
        word, opposite = (y, False) if isinstance(y, Node) else (y.node, True)
        self.vectors[angle] = Vector(angle, length, x.name, word.name, opposite, x.name not in ARM_RESULT_FIELDS)

    def polar(self, names, x, y, sign):
        return None, None

    def _joint(self, node: Node, s: str, d: str, *turned: str, sign: int, **words: int) -> None:
        self.joints[node.name] = Joint(node.name, s, d, sign < 0, turned)

    def _twice(self, node: Node, half: str, negated: str, **words: int) -> None:
        self.joints[node.name] = Joint(node.name, half, branch=(negated,))
