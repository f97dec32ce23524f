# SPDX-License-Identifier: Apache-2.0
"""Lean dataflow and whole arm as steps of the fold datapath.

:class:`Lowering` collects the steps of all nodes; each node's operation adds its steps (``Operation.lower``).  The code
here depends on the names of inputs and results, and of the node ``bend_swap``.

Each memory word, of B = ``bits`` bits, is aligned as far to the left as its largest value permits, so products of all
formats are cut at the same bits.  The first bit of a word of ``weight`` w weighs -2^w.  The product of two words, with
weights w and w', has 2 B bits; bit 2 B - 2 weighs 2^(w + w').  The window :data:`PLAIN` or :data:`DOUBLE` of a
step's sum T is written to memory.
"""

from collections import defaultdict
from dataclasses import dataclass, replace
from typing import Any

from ...io.words import ARM_FIELDS, ARM_RESULT_FIELDS, ARMS, BRANCHES, FIELDS, RESULT_FIELDS
from .. import arm, lean
from ..expressions import EXACT, FLOOR, HALF_UP, Constant, Term
from ..formats import inner_frac, root_frac
from ..nodes import Dataflow, Node
from . import steps as timing
from .steps import ALWAYS, DOUBLE, HALF, NEVER, ONE, PLAIN, ZERO, Normal, Pick, Selector, Step, Write

EXACT_WEIGHT = 2  # weight of input words and their sums, the operands of squares

ONE_WEIGHT = 1
"""Weight of ``ONE`` and ``HALF``; the plain window of a product with ``ONE`` is the other factor."""

RESULT_WEIGHT = 1  # weight of a result's first bit

POSITION = ("x", "y", "z")


Groups = dict[str, list[tuple[int, Step]]]
"""Name of a group's first step -> the group's steps, each with its distance from the first in clocks."""


@dataclass(frozen=True)
class Sum:
    """Sum of the term ``term`` and either a group's first term or an earlier sum."""

    name: str
    term: str
    minus: Selector = NEVER  # the term is subtracted
    inverse: bool = False  # T is ~node: the node is the term minus the addend, but T can only subtract the term
    write: Write | None = None
    result: str = ""


class Lowering:
    """Lean dataflow, and its steps, which :meth:`groups` returns.

    An operation's ``lower`` calls the method of this class that the operation names, with the node and its terms.
    """

    FLOW = staticmethod(lean.lean)
    INPUTS: tuple[str, ...] = FIELDS
    SIDE: tuple[str, ...] = ()
    RESULTS: tuple[str, ...] = RESULT_FIELDS

    def __init__(self, width: int) -> None:
        self.width = width
        self.flow = Dataflow(width, lean.WIDTHS)
        self.nodes = self.flow.nodes
        self.inner = inner_frac(width) + 2  # bits of an inner word
        self.bits = max(self.inner, root_frac(width) + 4)  # of a memory word: an inner word, or a mantissa with a sign
        self.weight = dict.fromkeys(self.INPUTS, RESULT_WEIGHT) | dict.fromkeys(FIELDS, EXACT_WEIGHT)
        self.terms: dict[str, Step] = {}  # products, and nodes computed like a product, without an earlier addend
        self.sums: defaultdict[str, list[Sum]] = defaultdict(list)  # by the first term
        self.norms: dict[str, tuple[Normal, timing.Counted | None]] = {}  # by the term or sum that is normalized
        self.counts: dict[str, tuple[int, tuple[tuple[int, str], ...]]] = {}  # constant, (factor, register) terms
        self.signs: set[str] = set()  # nodes whose signs select
        self.made_of: dict[str, set[str]] = {}  # mask -> the signs, zeros and counts that it depends on
        self.pairs: dict[str, tuple[str, str]] = {}  # squared length -> a rotation's parts, whose places a flag swaps
        self.picks: dict[Any, Pick] = {}  # pairs, squared lengths, and words that a flag replaces by a constant
        self.vectors: dict[str, timing.Vector] = {}  # of the angle unit
        self.joints: dict[str, timing.Joint] = {}
        self.rounded: set[str] = set()  # nodes whose steps round half up or down, as the node does
        self.angle_clocks = next(of for longest, of in timing.ANGLE_CLOCKS.items() if width <= longest)
        self.FLOW(self.flow, self.flow.inputs((*self.INPUTS, *self.SIDE)))
        for node in self.nodes.values():
            if node.format != self.flow.bit:
                node.op.lower(self, node)
                self._check_rounding(node)
            elif node.operands:
                self.made_of[node.name] = node.op.mask_registers(self, node)

    def _check_rounding(self, node: Node) -> None:
        """Raise NotImplementedError if the node's steps do not round as the node does."""
        other = (HALF_UP,) if node.name in self.joints else (EXACT, FLOOR)
        if node.rounding not in ((HALF_UP, FLOOR) if node.name in self.rounded else other):
            kind = type(node.op)
            method = f"called by {kind.__name__}.lower" if "lower" in vars(kind) else node.op.method
            where = f"model/dataflow/fold/lowering.py, class {type(self).__name__}, method {method}"
            raise NotImplementedError(f"{node.name}: the folded program lacks its rounding; implement it in {where}")

    # ---- masks ---------------------------------------------------------------------------------------------------

    def operand_registers(self, mask: Node, of: Node) -> set[str]:
        """Return the registers for a mask's operand ``of``: all registers of a mask, or the sign and zero of a word."""
        if of.format == self.flow.bit:
            return self.made_of[of.name]
        if of.name in POSITION:  # a register with the mask's name shows if the sum of squares is 0
            return {mask.name}
        self.signs.add(of.name)
        return {of.name} | ({f"no_{of.name[1:]}"} if of.name in ARMS else set())

    def wrist_registers(self) -> set[str]:
        """Return the registers that show whether a coordinate of the wrist saturates."""
        wrists = {of.name for sums in self.sums.values() for of in sums if of.write and of.write.source == "wrist"}
        self.signs |= wrists
        return wrists

    def registers(self, selector: Selector) -> set[str]:
        """Return the registers on which a selector depends."""
        names = {selector.node, selector.unless} - {NEVER.node, ALWAYS.node, timing.NO_COUNT.node}
        return set().union(*(self.made_of.get(name, {name}) for name in names))

    # ---- sums and products ---------------------------------------------------------------------------------------

    def _weight(self, node: Node) -> int:
        """Return the weight of a node whose LSB, in a memory word, is aligned with the LSB of an inner word."""
        return self.inner - 1 - node.format.frac

    def sum(self, node: Node, terms: tuple[tuple[int, Any], ...]) -> None:
        """Add a sum's steps: one step for two terms; a chain for more, if the first is 1/2, or if the sum wraps."""
        (_, first), (sign, second), *others = terms
        if not (others or isinstance(first, Constant) or node.ends):
            self.plus(node, first, second, sign < 0)
            return
        name, self.weight[node.name] = node.name, self._weight(node)
        if isinstance(first, Constant):
            self.terms[HALF_ROW] = Step(HALF_ROW, ONE, HALF)
            start, names = HALF_ROW, [f"{name}'"]
        else:
            start, names = first.name, [f"{name}{n}" for n in range(2, len(terms))]
        rest = zip([*names, name], terms[1:], strict=True)
        self._chain(start, *((made, term.name, sign) for made, (sign, term) in rest), write=Write(name))

    def plus(self, node: Node, a: Node, b: Node, less: bool = False) -> None:
        name, first, second, minus = node.name, a.name, b.name, ALWAYS if less else NEVER
        if first in ARMS:  # T is half of a length, and is normalized
            half = f"{first}/2"  # a separate step, or normalized T and sum would be written in the same clock
            for term, arm in ((first, first), (half, first), (second, second)):
                self.terms[term] = Step(term, arm, HALF, write=None)
            self.sums[half].append(Sum(name, second, minus, write=Write(name, DOUBLE)))
            self.weight[name] = EXACT_WEIGHT
        elif less and second not in self.terms:
            self.sums[second].append(Sum(name, first, ALWAYS, inverse=True))
        elif node.format.width > self.bits:  # an exact sum
            self.sums[first].append(Sum(name, second, minus))
        else:
            self._further(node, first, second, minus)

    def _chain(self, first: str, *terms: tuple[str, str, int], write: Write | None = None, result: str = "") -> None:
        """Add ``terms`` (name of the sum, term, sign) to ``first`` in turn; write the last sum or make it a result."""
        for name, term, sign in terms:
            self.sums[first].append(Sum(name, term, NEVER if sign > 0 else ALWAYS))
            last, first = first, name
        self.sums[last][-1] = replace(self.sums[last][-1], write=write, result=result)

    def _further(self, node: Node, first: str, term: str, minus: Selector) -> None:
        self.sums[first].append(Sum(node.name, term, minus, write=Write(node.name)))
        self.weight[node.name] = self._weight(node)

    def half_sum(self, node: Node, length: Node, sine: Node, sign: int) -> None:
        self._further(node, length.name, f"{sine.name}/2", ALWAYS if sign < 0 else NEVER)

    def add_sub(self, node: Node, whole: Node, part: Node, add: Node) -> None:
        self._further(node, whole.name, part.name, Selector(add.name, inverted=True))

    def exact_product(self, node: Node, a: Node, b: Node) -> None:
        self.terms[node.name] = Step(node.name, a.name, b.name)

    def product(self, node: Node, a: Node, b: Node, scale: int) -> None:
        weight = self._weight(node)
        for word in (a, b):
            top = word.format.width - word.format.signed - word.format.frac
            if top != self.weight[word.name]:
                raise ValueError(f"{node.name}: {word.name} does not begin at the first bit of a word")
        window = self.weight[a.name] + self.weight[b.name] + scale - weight
        kind = {PLAIN: "plain", DOUBLE: "double"}[window]
        self.weight[node.name] = weight
        self.terms[node.name] = Step(node.name, a.name, b.name, kind, f"half_{kind}", write=Write(node.name, window))

    # ---- shifts --------------------------------------------------------------------------------------------------

    def even(self, node: Node, value: Node, count: str) -> None:
        inverse = any(of.inverse and of.name == value.name for sums in self.sums.values() for of in sums)
        kind = "arm" if value.name in ARMS else "inverse" if inverse else "even"
        self.norms[value.name] = Normal(kind, node.name, count), None
        self.weight[node.name] = 0

    def shift_up(self, node: Node, value: Node, count: str, power: int) -> None:
        """Shift to the left in the normalizer; T's first bit weighs twice as much as a product's second-highest bit."""
        is_word = value.name in self.weight
        first = (self.weight[value.name] + ONE_WEIGHT if is_word else 2 * EXACT_WEIGHT) + 1
        normal = Normal("count", node.name), self._counted(count, power + first - self._shifted(node))
        if is_word:
            self.terms[node.name] = Step(node.name, value.name, ONE)
        self.norms[node.name if is_word else value.name] = normal

    def shift_down(self, node: Node, value: Node, count: str, power: int) -> None:
        offset = self._shifted(node) - self.weight[value.name] - power
        window = PLAIN if offset + PLAIN >= 0 else DOUBLE
        step = Step(node.name, value.name, timing.POWER, "power", minus=timing.NO_COUNT, carry="minus")
        counted = self._counted(count, offset + window)
        self.terms[node.name] = replace(step, write=Write(node.name, window), count=counted)

    def _shifted(self, node: Node) -> int:
        """Set and return the weight of a shifted word."""
        self.weight[node.name] = weight = 0 if node.format.frac == node.format.width - 1 else 1
        return weight

    def _counted(self, name: str, offset: int) -> timing.Counted:
        """Return the count ``name`` plus ``offset``; the register of a length's count holds 1 more than the count."""
        constant, terms = self.counts.get(name, (0, ((1, name),)))
        arms = {normal.count for normal, _ in self.norms.values() if normal.kind == "arm"}
        further = sum(factor for factor, register in terms if register in arms)
        return timing.Counted(constant + offset - further, terms, name, offset)

    # ---- selections ----------------------------------------------------------------------------------------------

    def limit(self, node: Node, raw: Node) -> None:
        step = self.terms[raw.name]
        assert step.write
        self.terms[raw.name] = replace(step, write=replace(step.write, to=node.name, limit=True))
        self.weight[node.name] = self.weight[raw.name]

    def mantissa(self, node: Node, value: Node, low: Node) -> None:
        count = "e" + node.name.removeprefix("m")
        self.norms[value.name] = Normal("unit", node.name, count), None
        self.weight[node.name], self.made_of[low.name] = 0, {count}
        self.signs.discard(value.name)  # the count, not the sign, decides

    def result(self, node: Node, raw: Node, negative: Node) -> None:
        self._answer(node, raw.name, Selector(negative.name))

    def elbow(self, node: Node, raw: Node, sign: int) -> None:
        self._answer(node, raw.name, ALWAYS if sign < 0 else NEVER)

    def _answer(self, node: Node, raw: str, minus: Selector) -> None:
        step, self.weight[node.name] = self.terms[raw], RESULT_WEIGHT
        addend, write = self._result_addend(node, step.addend), Write(node.name, source="result")
        self.terms[raw] = replace(step, minus=minus, result=node.name, write=write, addend=addend)

    def _result_addend(self, node: Node, half: str) -> str:
        """Return a result's addend: ``half`` (half an ulp of an inner word), plus half a result's ulp for HALF_UP."""
        self.rounded.add(node.name)
        return half.replace("half", "result") if node.rounding == HALF_UP else half

    def half_length(self, node: Node, cosine: Node, mask: Node | None) -> None:
        self.signs.add(cosine.name)
        self.weight[node.name] = 1
        unit = mask.name if mask else ""
        if mask:
            self.picks[cosine.name] = Pick(cosine.name, Selector(unit), constant=ZERO)
        by, minus = Selector(unit), Selector(cosine.name, True, unless=unit)
        self.terms[node.name] = Step(node.name, cosine.name, HALF, "word", "length", addend_by=by, minus=minus)

    def half_part(self, node: Node, cosine: Node, sine: Node, large: Term, none: Node | None) -> None:
        """Record one part of a rotation.  The call for the second part adds the writes of both: the step of the squared
        length writes the larger part, and a new step the smaller part."""
        self.weight[node.name] = 1
        lengths = (name for name, term in self.terms.items() if term.addend == "length")
        length = next(name for name in lengths if cosine.name in self.terms[name].reads)
        masks = [operand.name for operand in large.leaves if operand.format == self.flow.bit]
        if length not in self.pairs:
            self.pairs[length] = (node.name, masks[0] if masks else "")
            return
        first, mask = self.pairs[length]
        self.pairs[length] = first, node.name
        self.picks |= {first: Pick(first, NEVER), node.name: Pick(first, NEVER, second=True)}
        # A positive cosine and no mask: is the second part the larger one?
        second_larger = bool(large.words({cosine.name: 1, **dict.fromkeys(masks, False)}))
        flag = Selector("bend_swap") if none else Selector(cosine.name, negative=True)
        self.picks[length] = Pick(first, flag, second_larger)
        self.terms[length] = replace(self.terms[length], write=Write(self.picks[length]))
        if none:
            self.picks[sine.name] = Pick(sine.name, Selector(none.name), constant=ZERO)
        name = f"{sine.name}/2"
        small = Step(name, sine.name, HALF, cut="word", write=Write(Pick(first, flag, not second_larger)))
        if mask and not none:  # where the mask is set, both parts are 1/2
            small = replace(small, addend="none_or_half", addend_by=Selector(mask))
        self.terms[name] = small

    # ---- tables --------------------------------------------------------------------------------------------------

    def rsqrt(self, node: Node, m: Node, twice: Node | None) -> None:
        write = Write(node.name, PLAIN, Selector(twice.name) if twice else NEVER, last="root")
        self._table(node.name, timing.Row("root", m.name, False), write)

    def half_angle(self, sine: str, cosine: str, phi: Node) -> None:
        angle = f"|{phi.name}|"
        self.signs.add(phi.name)
        negative = Selector(phi.name, negative=True)
        self.terms[angle] = Step(angle, phi.name, ONE, minus=negative, carry="minus", write=Write(angle))
        self._table(f"|{sine}|", timing.Row("sine", angle, False), Write(f"|{sine}|", DOUBLE, last="sine"))
        self.terms[sine] = Step(sine, f"|{sine}|", ONE, minus=negative, carry="minus", write=Write(sine))
        self._table(cosine, timing.Row("cosine", angle, False), Write(cosine, DOUBLE, last="sine"))
        self.weight |= {angle: 1, f"|{sine}|": 1, sine: 1}

    def _table(self, name: str, row: timing.Row, write: Write) -> None:
        """Add the two steps of a table function: the slope, and the value."""
        self.weight[name] = 1
        falls = NEVER if row.function == "sine" else ALWAYS
        bends_down = NEVER if row.function == "cosine" else ALWAYS
        slope, addend = f"{name}'", "slope_less" if bends_down else "slope"
        step = Step(slope, None, row.of, addend=addend, minus=bends_down, carry="minus", place="high", rows=(row,))
        self.terms[slope] = replace(step, write=Write(slope, last="slope"))
        cut, value = "root" if row.function == "root" else "sine", replace(row, value=True)
        step = Step(name, slope, row.of, cut, "value", minus=falls, carry="minus", place="all", rows=(value,))
        self.terms[name] = replace(step, write=write)

    # ---- groups --------------------------------------------------------------------------------------------------

    def groups(self) -> Groups:
        """Return all groups of steps.  A step whose addend is another step's T is in that step's group."""
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

    def _extend(self, group: list[tuple[int, Step]], at: int, step: Step) -> None:
        """Add a step to a group at clock ``at``, and then the steps whose addend is the T of that step."""
        normal, counted = self.norms.get(step.name, (None, step.count))
        a, b = self.picks.get(step.a, step.a), self.picks.get(step.b, step.b)
        sign = step.name if step.name in self.signs else ""
        group.append((at, replace(step, a=a, b=b, norm=normal, count=counted, sign=sign)))
        sums = sorted(self.sums.get(step.name, ()), key=lambda s: s.name in self.sums)
        for number, of in enumerate(sums):
            term = self.terms[of.term]
            words = term.addend.startswith("half")
            addend = "hold" if number else "T_half" if words else "T"
            carry = "minus" if of.minus and not words and not of.inverse else ""
            made = replace(term, name=of.name, term=of.term, minus=of.minus, write=of.write, result=of.result)
            self._extend(group, at + 2 + number, replace(made, addend=addend, addend_by=NEVER, carry=carry))


HALF_ROW = "1/2 of r_z"  # step that supplies the constant 1/2 of the node r_z


class ArmLowering(Lowering):
    """Whole arm as steps, including the steps of the lean dataflow, and as vectors of the angle unit.

    The hand's words have weight 1, as results do, so that their products have the weight of inner words' products.  The
    sums of their squares wrap at 8.  The sum for a wrist coordinate is half the coordinate.
    """

    FLOW = staticmethod(arm.arm)
    INPUTS, SIDE, RESULTS = ARM_FIELDS, BRANCHES, ARM_RESULT_FIELDS

    def replaced(self, node: Node, word: Node, mask: Node, constant: int) -> None:
        self.weight[node.name] = RESULT_WEIGHT
        self.picks[node.name] = Pick(word.name, Selector(mask.name), constant=ONE if constant else ZERO)

    def wrist(self, node: Node, point: Node, off: Node) -> None:
        self.weight[node.name] = EXACT_WEIGHT
        half = f"{point.name}/2"
        self.terms[half] = Step(half, point.name, HALF, addend=self._result_addend(node, "half_double"))
        self._chain(half, (node.name, off.name, -1), write=Write(node.name, source="wrist"))

    def elbow(self, node: Node, raw: Node, sign: int) -> None:
        """Write the result word to memory and output it in a later step, so that all results leave within one lap."""
        super().elbow(node, raw, sign)
        self.terms[raw.name] = replace(self.terms[raw.name], result=raw.name)
        self.terms[node.name] = Step(node.name, node.name, ONE, result=node.name)

    def rounded_sum(self, node: Node, a: Node, b: Node, sign: int) -> None:
        addend = self._result_addend(node, "half_plain")
        self.terms[a.name] = replace(self.terms[a.name], minus=ALWAYS, addend=addend, write=None, term=a.name)
        self._chain(a.name, (node.name, b.name, sign), result=node.name)

    def vector(self, node: Node, length: str | None, x: Node, y: Node, sign: int) -> None:
        words = x.name in ARM_RESULT_FIELDS
        self.vectors[node.name] = timing.Vector(node.name, length, x.name, y.name, sign < 0, not words)

    def joint(self, node: Node, s: Node, d: Node, sign: int, turned: tuple[Node, ...]) -> None:
        self.joints[node.name] = timing.Joint(node.name, s.name, d.name, sign < 0, tuple(mask.name for mask in turned))

    def twice(self, node: Node, half: Node, negated: Node) -> None:
        self.joints[node.name] = timing.Joint(node.name, half.name, branch=(negated.name,))
