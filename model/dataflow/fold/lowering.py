# SPDX-License-Identifier: Apache-2.0
"""Lean dataflow and whole arm as steps of the fold datapath.

:class:`Lowering` is a domain of the dataflow: it derives the steps of a node from its operation.  It knows by name only
the inputs, ``arm_swap``, and of a mantissa ``m...`` the count ``e...``.

Each word is aligned as far to the left as its largest value permits, so products of all formats are cut at the same
places.  ``weight`` w of a word: its first bit weighs -2^w.  The product of two words has 2 ``bits`` bits, and its bit
2 ``bits`` - 2 weighs 2^(w + w'); the word written back is its :data:`PLAIN` or :data:`DOUBLE` window.
"""

from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ...io.words import ARM_FIELDS, ARM_RESULT_FIELDS, ARMS, BRANCHES, FIELDS, RESULT_FIELDS
from .. import arm, lean
from ..nodes import Domain, Node, inner_frac, root_frac
from ..operations import operation
from .steps import (
    ALWAYS,
    ANGLE_CLOCKS,
    DOUBLE,
    HALF,
    NEVER,
    NO_COUNT,
    ONE,
    PLAIN,
    POWER,
    ZERO,
    Counted,
    Joint,
    Normal,
    Pick,
    Row,
    Selector,
    Step,
    Vector,
    Write,
)

EXACT_WEIGHT = 2  # weight of input words and their sums, the operands of squares

ONE_WEIGHT = 1
"""Weight of ``ONE`` and ``HALF``: a product with ``ONE`` is the other word in the plain window."""

RESULT_WEIGHT = 1  # weight of a result's first bit

POSITION = ("x", "y", "z")


Groups = dict[str, list[tuple[int, Step]]]
"""Name of a group's first step -> its steps, at fixed distances from the first."""


@dataclass(frozen=True)
class Sum:
    """Sum of a group's first term, or of an earlier sum, and the term of another name."""

    name: str
    term: str
    minus: Selector = NEVER  # the term is subtracted
    inverse: bool = False  # T is the inverted node: the term is subtracted from the addend, not vice versa
    write: Write | None = None
    result: str = ""


class Lowering(Domain):
    """Lean dataflow as steps: :meth:`build` it, then call :meth:`groups`."""

    INPUTS: tuple[str, ...] = FIELDS
    SIDE: tuple[str, ...] = ()
    RESULTS: tuple[str, ...] = RESULT_FIELDS

    def __init__(self, width: int) -> None:
        super().__init__(width, lean.WIDTHS)
        self.inner = inner_frac(width) + 2  # bits of an inner word
        self.bits = max(self.inner, root_frac(width) + 4)  # of a memory word: an inner word, or a mantissa with a sign
        self.weight: dict[str, int] = {}
        self.terms: dict[str, Step] = {}  # products, and nodes computed like one, without an earlier addend
        self.sums: defaultdict[str, list[Sum]] = defaultdict(list)  # by the first term
        self.norms: dict[str, tuple[Normal, Counted | None]] = {}  # of a term or a sum
        self.counts: dict[str, tuple[int, tuple[tuple[int, str], ...]]] = {}  # constant, factors and registers
        self.signs: set[str] = set()  # nodes whose signs select
        self.made_of: dict[str, set[str]] = {}  # mask -> the signs, zeros and counts that it depends on
        self.pairs: dict[str, tuple[str, str]] = {}  # the two parts of a rotation, whose places a flag selects
        self.picks: dict[str, Pick] = {}  # place of a squared length, or a word that a flag replaces by 0
        self.vectors: dict[str, Vector] = {}  # of the angle unit
        self.joints: dict[str, Joint] = {}
        self.angle_clocks = next(of for longest, of in ANGLE_CLOCKS.items() if width <= longest)

    def build(self) -> None:
        """Build the whole dataflow."""
        inputs = self.inputs(lambda name, fmt: None, (*self.INPUTS, *self.SIDE))
        self.weight |= dict.fromkeys(FIELDS, EXACT_WEIGHT)
        self.flow(inputs)

    def flow(self, inputs: dict[str, Node]) -> None:
        lean.lean(self, inputs)

    # ---- operations and their operands ---------------------------------------------------------------------------

    def op(self, name, operands, fmt, words, *rest, **named):
        node = super().op(name, operands, fmt, words, *rest, **named)
        kind, parameters = operation(words)
        if fmt == self.bit:
            self.made_of[name] = self._mask(node, kind)
        else:
            getattr(self, f"_{kind}")(node, *(n.name for n in node.operands), **parameters)
        return node

    def _mask(self, node: Node, kind: str) -> set[str]:
        """Return the registers that a mask depends on."""
        return set().union(*(self._roots(node.name, n) for n in node.operands))

    def _roots(self, mask: str, of: Node) -> set[str]:
        """Return the registers of an operand of a mask: of another mask, the sign of a word, and whether it is 0."""
        if of.format == self.bit:
            return self.made_of[of.name]
        if of.name in POSITION:  # the sum of their squares is 0
            return {mask}
        self.signs.add(of.name)
        return {of.name} | ({f"no_{of.name[1:]}"} if of.name in ARMS else set())

    def registers(self, selector: Selector) -> set[str]:
        """Return the registers that a selector is made of."""
        names = {selector.node, selector.unless} - {NEVER.node, ALWAYS.node, NO_COUNT.node}
        return set().union(*(self.made_of.get(name, {name}) for name in names))

    def _weight(self, node: Node) -> int:
        """Return the weight of an inner word: all inner words share the last place."""
        return self.inner - 1 - node.format.frac

    def _plus(self, node: Node, first: str, second: str, less: bool = False) -> None:
        name = node.name
        if first in ARMS:  # halved: an arm is normalized from T
            window = Write(name, DOUBLE)
            half = f"{first}/2"  # not the normalized T: both would be written in the same clock
            for term, arm in ((first, first), (half, first), (second, second)):
                self.terms[term] = Step(term, arm, HALF, write=None)
            self.sums[half].append(Sum(name, second, ALWAYS if less else NEVER, write=window))
            self.weight[name] = EXACT_WEIGHT
        elif less and second not in self.terms:
            self.sums[second].append(Sum(name, first, ALWAYS, inverse=True))
        else:
            exact = node.format.width > self.bits
            if not exact:
                self.weight[name] = self._weight(node)
            self.sums[first].append(Sum(name, second, ALWAYS if less else NEVER, write=None if exact else Write(name)))

    def _minus(self, node: Node, first: str, second: str) -> None:
        self._plus(node, first, second, less=True)

    def _times(self, node: Node, a: str, b: str) -> None:
        self.terms[node.name] = Step(node.name, a, b)

    def _square(self, node: Node, a: str) -> None:
        self._times(node, a, a)

    def _count(self, node: Node, *counts: str, factors: tuple[int, ...], constant: int = 0) -> None:
        self.counts[node.name] = constant, tuple(zip(factors, counts, strict=True))

    def _limit(self, node: Node, raw: str, top: int) -> None:
        step = self.terms[raw]
        assert step.write
        self.terms[raw] = replace(step, write=replace(step.write, to=node.name, limit=True))
        self.weight[node.name] = self.weight[raw]

    def _mantissa(self, node: Node, value: str, low: str, up: int, top: int) -> None:
        count = "e" + node.name.removeprefix("m")
        self.norms[value] = Normal("unit", node.name, count), None
        self.weight[node.name], self.made_of[low] = 0, {count}
        self.signs.discard(value)  # the count decides

    def _part_sum(self, node: Node, length: str, sine: str, none: str, sign: int) -> None:
        self._further(node, length, f"{sine}/2", ALWAYS if sign < 0 else NEVER)

    def _turned(self, node: Node, whole: str, part: str, swap: str) -> None:
        self._further(node, whole, part, Selector(swap, inverted=True))

    def _further(self, node: Node, first: str, term: str, minus: Selector) -> None:
        self.sums[first].append(Sum(node.name, term, minus, write=Write(node.name)))
        self.weight[node.name] = self._weight(node)

    def _result(self, node: Node, raw: str, negative: str, drop: int) -> None:
        self._answer(node, raw, Selector(negative))

    def _elbow(self, node: Node, raw: str, clamp: str, fold: str, sign: int, **words: int) -> None:
        self._answer(node, raw, ALWAYS if sign < 0 else NEVER)

    def _answer(self, node: Node, raw: str, minus: Selector) -> None:
        step, self.weight[node.name] = self.terms[raw], RESULT_WEIGHT
        addend, write = step.addend.replace("half", "result"), Write(node.name, source="result")
        self.terms[raw] = replace(step, minus=minus, result=node.name, write=write, addend=addend)

    def _shift_up(self, node: Node, value: str, count: str, width: int, left: int = 0, right: int = 0) -> None:
        """Shift to the left, by the normalizer, whose first bit has twice a product's weight."""
        power = left - right + node.operands[0].format.frac - node.format.frac
        is_word = value in self.weight
        first = (self.weight[value] + ONE_WEIGHT if is_word else 2 * EXACT_WEIGHT) + 1
        normal = Normal("count", node.name), self._counted(count, power + first - self._shifted(node))
        if is_word:
            self.terms[node.name] = Step(node.name, value, ONE)
        self.norms[node.name if is_word else value] = normal

    def _shift_down(self, node: Node, value: str, count: str, left: int = 0) -> None:
        power = left + node.operands[0].format.frac - node.format.frac
        offset = self._shifted(node) - self.weight[value] - power
        window = PLAIN if offset + PLAIN >= 0 else DOUBLE
        write, counted = Write(node.name, window), self._counted(count, offset + window)
        self.terms[node.name] = Step(
            node.name, value, POWER, "power", minus=NO_COUNT, carry="minus", write=write, count=counted
        )

    def _shifted(self, node: Node) -> int:
        """Set and return the weight of a shifted word."""
        self.weight[node.name] = weight = 0 if node.format.frac == node.format.width - 1 else 1
        return weight

    def _counted(self, name: str, offset: int) -> Counted:
        """Return a count plus ``offset``; an arm is shifted one pair more than its node's count (:data:`NORMS`)."""
        constant, terms = self.counts.get(name, (0, ((1, name),)))
        arms = {normal.count for normal, _ in self.norms.values() if normal.kind == "arm"}
        further = sum(factor for factor, register in terms if register in arms)
        return Counted(constant + offset - further, terms, name, offset)

    def _half_length(self, node: Node, cosine: str, mask: str = "", frac: int = 0) -> None:
        self.signs.add(cosine)
        self.weight[node.name] = 1
        a: str | Pick = cosine
        if mask:
            a = self.picks[cosine] = Pick(cosine, Selector(mask))
        minus = Selector(cosine, True, unless=mask)
        self.terms[node.name] = Step(node.name, a, HALF, "word", "length", addend_by=Selector(mask), minus=minus)

    def _half_part(
        self, node: Node, length: str, cosine: str, sine: str, *masks: str, large: Callable, none=None, frac: int = 0
    ) -> None:
        """Record the parts of a rotation: the larger is written with the squared length, the smaller by its own step;
        both are created on the second call."""
        self.weight[node.name] = 1
        lengths = (name for name, term in self.terms.items() if term.addend == "length")
        length = next(name for name in lengths if cosine in self.terms[name].reads)
        if length not in self.pairs:
            self.pairs[length] = (node.name, "")
            return
        first, second = self.pairs[length][0], node.name
        self.pairs[length] = first, second
        second_larger = bool(large(np.int64(1), *(np.False_ for _ in masks)))
        flag = Selector("arm_swap") if none else Selector(cosine, negative=True)
        self.picks[length] = Pick(first, flag, second_larger)
        self.terms[length] = replace(self.terms[length], write=Write(self.picks[length]))
        a: str | Pick = sine
        if none:
            a = self.picks[sine] = Pick(sine, Selector(masks[0]))
        small = Step(f"{sine}/2", a, HALF, cut="word", write=Write(Pick(first, flag, not second_larger)))
        if masks and not none:  # both parts are 1/2
            small = replace(small, addend="none_or_half", addend_by=Selector(masks[0]))
        self.terms[small.name] = small

    def _norm(self, value: str, normal: Normal) -> None:
        self.norms[value] = normal, None
        self.weight[normal.to] = 0

    # ---- products, roots, sines ----------------------------------------------------------------------------------

    def product3(self, name, a, b, fmt, scale):
        weight = self.inner - 1 - fmt.frac
        for word in (a, b):
            top = word.format.width - word.format.signed - word.format.frac
            if top != self.weight[word.name]:
                raise ValueError(f"{name}: {word.name} does not begin at the first bit of a word")
        window = self.weight[a.name] + self.weight[b.name] + scale - weight
        kind = {PLAIN: "plain", DOUBLE: "double"}[window]
        self.weight[name] = weight
        self.terms[name] = Step(name, a.name, b.name, kind, f"half_{kind}", write=Write(name, window))

    def even_mantissa(self, count, name, value, width, fmt):
        inverse = any(of.inverse and of.name == value.name for sums in self.sums.values() for of in sums)
        kind = "arm" if value.name in ARMS else "inverse" if inverse else "even"
        self._norm(value.name, Normal(kind, name, count))
        return None, None

    def reciprocal_root(self, name, m, fmt, twice):
        write = Write(name, PLAIN, Selector(twice.name) if twice else NEVER, last="root")
        self._table(name, Row("root", m.name, False), write)

    def half_sincos(self, names, phi, fmt):
        sine, cosine = names
        angle = f"|{phi.name}|"
        self.signs.add(phi.name)
        negative = Selector(phi.name, negative=True)
        self.terms[angle] = Step(angle, phi.name, ONE, minus=negative, carry="minus", write=Write(angle))
        self._table(f"|{sine}|", Row("sine", angle, False), Write(f"|{sine}|", DOUBLE, last="sine"))
        self.terms[sine] = Step(sine, f"|{sine}|", ONE, minus=negative, carry="minus", write=Write(sine))
        self._table(cosine, Row("cosine", angle, False), Write(cosine, DOUBLE, last="sine"))
        self.weight |= {angle: 1, f"|{sine}|": 1, sine: 1}
        return None, None

    def _table(self, name: str, row: Row, write: Write) -> None:
        """Add the steps of a quadratic: the slope in the row's segment, and the value."""
        self.weight[name] = 1
        falls = NEVER if row.function == "sine" else ALWAYS
        bends_down = NEVER if row.function == "cosine" else ALWAYS
        slope, addend = f"{name}'", "slope_less" if bends_down else "slope"
        step = Step(slope, None, row.of, addend=addend, minus=bends_down, carry="minus", place="high", rows=(row,))
        self.terms[slope] = replace(step, write=Write(slope, last="slope"))
        cut, value = "root" if row.function == "root" else "sine", replace(row, value=True)
        step = Step(name, slope, row.of, cut, "value", minus=falls, carry="minus", place="all", rows=(value,))
        self.terms[name] = replace(step, write=write)

    def apply(self, name, operands, fmt, words):
        return None

    # ---- groups --------------------------------------------------------------------------------------------------

    def groups(self) -> Groups:
        """Return all steps; a step whose addend is the T of another is in its group."""
        read = {name for step in self.terms.values() for name in step.reads}
        groups: Groups = {}
        for name, step in self.terms.items():
            paired = isinstance(step.write and step.write.to, Pick)
            wanted = step.result or name in self.norms or name in self.sums or paired
            if wanted or (step.write and step.write.to in read):
                if step.write and not paired and step.write.to not in read:
                    step = replace(step, write=None)
                self._extend(groups.setdefault(name, []), 0, step)
        return groups

    def _picked(self, operand: str | Pick | None) -> str | Pick | None:
        """Return a word of a pair, or one that a flag replaces by 0, as a :class:`Pick`; others unchanged."""
        if not isinstance(operand, str):
            return operand
        for pair in self.pairs.values():
            if operand in pair:
                return Pick(pair[0], NEVER, operand == pair[1])
        return self.picks.get(operand, operand)

    def _extend(self, group: list[tuple[int, Step]], at: int, step: Step) -> None:
        """Add a step, and the steps whose addend is its T."""
        normal, counted = self.norms.get(step.name, (None, step.count))
        a, b, sign = self._picked(step.a), self._picked(step.b) or ZERO, step.name if step.name in self.signs else ""
        group.append((at, replace(step, a=a, b=b, norm=normal, count=counted, sign=sign)))
        sums = sorted(self.sums.get(step.name, ()), key=lambda s: s.name in self.sums)
        for number, of in enumerate(sums):
            term = self.terms[of.term]
            words = term.addend.startswith("half")
            addend = "hold" if number else "T_half" if words else "T"
            carry = "minus" if of.minus and not words and not of.inverse else ""
            made = replace(term, name=of.name, term=of.term, minus=of.minus, write=of.write, result=of.result)
            self._extend(group, at + 2 + number, replace(made, addend=addend, addend_by=NEVER, carry=carry))


HALF_ROW = "1/2 of r_z"  # step of the constant in the third row


class ArmLowering(Lowering):
    """Whole arm as steps around the core's, and vectors of its angle unit.

    The hand's words have weight 1, as results do, so that their products have the weight of inner words' products.  The
    sums of their squares wrap at 8.  A wrist coordinate is summed as half its value.
    """

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
