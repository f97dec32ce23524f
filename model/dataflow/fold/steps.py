# SPDX-License-Identifier: Apache-2.0
"""Steps of the fold datapath, and the lean dataflow as a list of steps.

A step reads two words, multiplies them, adds the product to the addend S or subtracts it, and writes the sum T.  This
covers the whole dataflow, because a product with a power of two is a copy or a shift.  Steps of a :class:`Group` have
a fixed distance: their addend is the T of an earlier step.

:class:`Lowering` is a domain of the dataflow: it derives the steps of a node from its operation, and uses no node
names except the flags'.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field, replace

import numpy as np

from ...io.words import ARMS
from .. import lean
from ..nodes import Domain, Node
from ..operations import (
    Addition,
    Count,
    Elbow,
    HalfLength,
    HalfPart,
    Limit,
    Mantissa,
    PartSum,
    Product,
    Result,
    Shift,
    Turned,
)
from .layout import DOUBLE, EXACT_WEIGHT, PLAIN, Layout

ZERO, ONE, HALF, POWER = "0", "1", "1/2", "2^-n"
"""Constant memory words; ``POWER`` is selected by the count."""

ONE_WEIGHT = 1
"""Weight of ``ONE`` and ``HALF``: a product with ``ONE`` is the other word in the plain window."""

POSITION = ("x", "y", "z")

CUTS = ("exact", "power", "plain", "double", "word", "root", "sine")
"""Position at which a product's tiles are cut: none; none, with the power of a large count replaced by a smaller one's;
two bits below the last place of either window; at the last place of the plain one; at the last place of a table
function's sum."""

ADDENDS = (
    "hold", "zero", "half_plain", "half_double", "result_plain", "result_double", "T", "T_half", "slope", "slope_less",
    "value", "length", "none_or_half",
)  # fmt: skip
"""Addend S of a step: its previous value; constants, of which the halves round, also to a result; the T of the step two
before, or that plus a rounding half; words of a table; 1/2, or 1 by a flag; 0, or 1/2 by a flag."""

NORMS = ("even", "inverse", "arm", "count", "unit")
"""Normalization of T: by pairs; by pairs, inverted; by pairs without the sign of an arm; by the count; by pairs, with
bits below the last place dropped, and limited."""


@dataclass(frozen=True)
class Pick:
    """One of two words at adjacent places: the larger and the smaller part of a rotation, which a flag assigns to the
    first or second place; or a word and 0.  ``second`` selects the second place; the flag swaps the two."""

    pair: str
    flag: str
    second: bool = False


Operand = str | Pick


@dataclass(frozen=True)
class Write:
    """Write of T, from one of its windows, to the memory."""

    to: Operand
    window: int = PLAIN
    double_by: str = ""  # flag that selects the double window
    limit: bool = False  # values above the window become the largest word
    last: str = "inner"  # the last place kept: of an inner word, a root, a sine, a slope


@dataclass(frozen=True)
class Normal:
    """Write of the normalized T to the memory, and of its shift count to a register."""

    kind: str
    to: str
    count: str = ""


@dataclass(frozen=True)
class Row:
    """Row of a table, addressed by a word: the ``function``, and its words for the slope (and bend) or the value."""

    function: str  # root, sine or cosine
    of: str
    value: bool


@dataclass(frozen=True)
class Counted:
    """Count that a step needs: ``base`` and terms (factor, register); it exceeds the ``node`` by ``offset``."""

    base: int
    terms: tuple[tuple[int, str], ...]
    node: str = ""
    offset: int = 0


@dataclass(frozen=True)
class Step:
    """One pass through the multiplier."""

    name: str
    a: Operand | None  # None: c2 of the table's row
    b: Operand
    cut: str = "exact"
    addend: str = "zero"
    addend_by: str = ""  # the flag of the addends length and none_or_half
    minus: str = ""  # subtract the product from the addend: "always", or the flag that selects it
    carry: str = ""  # carry into the last bit of the sum: "minus": with subtraction
    place: str = ""  # b is the position in a row's segment: "all" of it, or its "high" part
    write: Write | None = None
    norm: Normal | None = None
    result: str = ""  # T becomes this result
    rows: tuple[Row, ...] = ()  # read for c2, and for the addend
    count: Counted | None = None
    sign: str = ""  # flag set to T's sign
    term: str = ""  # the product, where it is not the node T

    @property
    def reads(self) -> tuple[Operand, ...]:
        """Memory words that it needs."""
        operands = tuple(o for o in (self.a, self.b) if o is not None)
        return operands + tuple(row.of for row in self.rows)

    @property
    def flags(self) -> set[str]:
        """Flags that it needs."""
        named = {self.addend_by, self.minus, self.write.double_by if self.write else ""}
        named |= {o.flag for o in (self.a, self.b, self.write and self.write.to) if isinstance(o, Pick)}
        return named - {"", "always"}


@dataclass
class Group:
    """Steps at fixed distances."""

    steps: list[tuple[int, Step]] = field(default_factory=list)

    @property
    def name(self) -> str:
        """Name of the first step."""
        return self.steps[0][1].name

    def add(self, after: int, step: Step) -> None:
        """Add a step ``after`` slots after the first."""
        self.steps.append((after, step))


ALWAYS, NO_COUNT = "always", "n=0"
"""Flags besides masks and signs: unconditional, and the step's count is 0."""


@dataclass(frozen=True)
class Sum:
    """Sum of a group's first term, or of an earlier sum, and the term of another name."""

    name: str
    term: str
    minus: str = ""  # the term is subtracted: "always" or by a flag
    inverse: bool = False  # T is the inverted node: the term is subtracted from the addend, not vice versa
    write: Write | None = None


def sign(name: str, unless: str = "") -> str:
    """Return the name of the flag that a node is negative."""
    return f"{name}<0" + (f" & ~{unless}" if unless else "")


class Lowering(Domain):
    """Lean dataflow as steps: run it, then call :meth:`groups`."""

    def __init__(self, layout: Layout) -> None:
        super().__init__(layout.width, lean.WIDTHS)
        self.layout = layout
        self.weight: dict[str, int] = {}
        self.terms: dict[str, Step] = {}  # products, and nodes computed like one, without an earlier addend
        self.sums: defaultdict[str, list[Sum]] = defaultdict(list)  # by the first term
        self.norms: dict[str, tuple[Normal, Counted | None]] = {}  # of a term or a sum
        self.counts: dict[str, tuple[Count, tuple[str, ...]]] = {}
        self.signs: set[str] = set()  # nodes whose signs are flags
        self.pairs: dict[str, tuple[str, str]] = {}  # the two parts of a rotation, whose places a flag selects
        self.picks: dict[str, Pick] = {}  # place of a squared length, or a word that a flag replaces by 0

    def inputs(self, value=lambda name, fmt: None):
        inputs = super().inputs(value)
        self.weight |= dict.fromkeys(inputs, EXACT_WEIGHT)
        return inputs

    # ---- operations and their operands ---------------------------------------------------------------------------

    def op(self, name, operands, fmt, latency, words, error=(0.0, 0.0), **facts):
        node = super().op(name, operands, fmt, latency, words, error, **facts)
        read = [n.name for n in node.operands]
        match words:
            case Count():
                self.counts[name] = words, tuple(read)
            case Shift():
                self._shift(node, words, *read)
            case Limit():
                raw = self.terms[read[0]]
                assert raw.write
                self.terms[raw.name] = replace(raw, write=replace(raw.write, to=name, limit=True))
                self.weight[name] = self.weight[raw.name]
            case Mantissa():
                self.norms[read[0]] = Normal("unit", name, "e" + name.removeprefix("m")), None
                self.weight[name] = 0
            case HalfLength():
                self._half_length(node, *read)
            case HalfPart():
                self._half_part(node, words, *read)
            case PartSum():
                self.sums[read[0]].append(
                    Sum(name, f"{read[1]}/2", ALWAYS if words.sign < 0 else "", write=Write(name))
                )
            case Turned():
                self.sums[read[0]].append(Sum(name, read[1], f"~{read[2]}", write=Write(name)))
            case Result() | Elbow():
                flag = read[1] if isinstance(words, Result) else ALWAYS if words.sign < 0 else ""
                raw = self.terms[read[0]]
                addend = raw.addend.replace("half", "result")
                self.terms[raw.name] = replace(raw, minus=flag, result=name, write=None, addend=addend)
            case Product():
                self.terms[name] = Step(name, read[0], read[-1])
            case Addition():
                first, second = read
                self._plus(node, first, second, less=words.sign < 0)
            case _:  # a mask
                self.signs |= {n.name for n in node.operands if n.format != self.bit} - set(POSITION)
        if isinstance(words, Turned | PartSum):
            self.weight[name] = self._weight(node)
        return node

    def _weight(self, node: Node) -> int:
        """Return the weight of an inner word: all inner words share the last place."""
        return self.layout.inner - 1 - node.format.frac

    def _plus(self, node: Node, first: str, second: str, less: bool) -> None:
        name = node.name
        if first in ARMS:  # halved: an arm is normalized from T
            window = Write(name, DOUBLE)
            half = f"{first}/2"  # not the normalized T: both would be written in the same clock
            for term, arm in ((first, first), (half, first), (second, second)):
                self.terms[term] = Step(term, arm, HALF, write=None)
            self.sums[half].append(Sum(name, second, ALWAYS if less else "", write=window))
            self.weight[name] = EXACT_WEIGHT
        elif less and second not in self.terms:
            self.sums[second].append(Sum(name, first, ALWAYS, inverse=True))
        else:
            exact = node.format.width > self.layout.bits
            if not exact:
                self.weight[name] = self._weight(node)
            self.sums[first].append(Sum(name, second, ALWAYS if less else "", write=None if exact else Write(name)))

    def _shift(self, node: Node, shift: Shift, value: str, count: str) -> None:
        power = shift.power(node.operands[0].format.frac, node.format.frac)
        self.weight[node.name] = weight = 0 if node.format.frac == node.format.width - 1 else 1
        if shift.sign > 0:  # to the left, by the normalizer, whose first bit has twice a product's weight
            is_word = value in self.weight
            first = (self.weight[value] + ONE_WEIGHT if is_word else 2 * EXACT_WEIGHT) + 1
            normal = Normal("count", node.name), self._counted(count, power + first - weight)
            if is_word:
                self.terms[node.name] = Step(node.name, value, ONE)
            self.norms[node.name if is_word else value] = normal
        else:
            offset = weight - self.weight[value] - power
            window = PLAIN if offset + PLAIN >= 0 else DOUBLE
            counted = self._counted(count, offset + window)
            self.terms[node.name] = Step(
                node.name,
                value,
                POWER,
                "power",
                minus=NO_COUNT,
                carry="minus",
                write=Write(node.name, window),
                count=counted,
            )

    def _counted(self, name: str, offset: int) -> Counted:
        """Return a count plus ``offset``; an arm is shifted one pair more than its node's count (:data:`NORMS`)."""
        count, registers = self.counts.get(name, (Count((1,)), (name,)))
        arms = {normal.count for normal, _ in self.norms.values() if normal.kind == "arm"}
        terms = tuple(zip(count.factors, registers, strict=True))
        further = sum(factor for factor, register in terms if register in arms)
        return Counted(count.constant + offset - further, terms, name, offset)

    def _half_length(self, node: Node, cosine: str, mask: str = "") -> None:
        self.signs.add(cosine)
        self.weight[node.name] = 1
        a: Operand = cosine
        if mask:
            a = self.picks[cosine] = Pick(cosine, mask)
        self.terms[node.name] = Step(
            node.name, a, HALF, cut="word", addend="length", addend_by=mask, minus=sign(cosine, mask)
        )

    def _half_part(self, node: Node, part: HalfPart, length: str, cosine: str, sine: str, *masks: str) -> None:
        """Record the parts of a rotation: the larger is written with the squared length, the smaller by its own step;
        both are created on the second call."""
        self.weight[node.name] = 1
        lengths = (name for name, term in self.terms.items() if term.addend == "length")
        length = next(name for name in lengths if cosine in map(self._variable, self.terms[name].reads))
        if length not in self.pairs:
            self.pairs[length] = (node.name, "")
            return
        first, second = self.pairs[length][0], node.name
        self.pairs[length] = first, second
        second_larger = bool(part.large(np.int64(1), *(np.False_ for _ in masks)))
        flag = "arm_swap" if part.none else sign(cosine)
        self.picks[length] = Pick(first, flag, second_larger)
        self.terms[length] = replace(self.terms[length], write=Write(self.picks[length]))
        a: Operand = sine
        if part.none:
            a = self.picks[sine] = Pick(sine, masks[0])
        small = Step(f"{sine}/2", a, HALF, cut="word", write=Write(Pick(first, flag, not second_larger)))
        if masks and not part.none:  # both parts are 1/2
            small = replace(small, addend="none_or_half", addend_by=masks[0])
        self.terms[small.name] = small

    def _norm(self, value: str, normal: Normal) -> None:
        self.norms[value] = normal, None
        self.weight[normal.to] = 0

    # ---- products, roots, sines ----------------------------------------------------------------------------------

    def product3(self, name, a, b, fmt, scale):
        layout = self.layout
        weight = layout.inner - 1 - fmt.frac
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
        write = Write(name, PLAIN, twice.name if twice else "", last="root")
        self._table(name, Row("root", m.name, False), write)

    def half_sincos(self, names, phi, fmt):
        sine, cosine = names
        angle = f"|{phi.name}|"
        self.signs.add(phi.name)
        negative = sign(phi.name)
        self.terms[angle] = Step(angle, phi.name, ONE, minus=negative, carry="minus", write=Write(angle))
        self._table(f"|{sine}|", Row("sine", angle, False), Write(f"|{sine}|", DOUBLE, last="sine"))
        self.terms[sine] = Step(sine, f"|{sine}|", ONE, minus=negative, carry="minus", write=Write(sine))
        self._table(cosine, Row("cosine", angle, False), Write(cosine, DOUBLE, last="sine"))
        self.weight |= {angle: 1, f"|{sine}|": 1, sine: 1}
        return None, None

    def _table(self, name: str, row: Row, write: Write) -> None:
        """Add the steps of a quadratic: the slope in the row's segment, and the value."""
        self.weight[name] = 1
        falls = "" if row.function == "sine" else ALWAYS
        bends_down = "" if row.function == "cosine" else ALWAYS
        slope = f"{name}'"
        self.terms[slope] = Step(
            slope,
            None,
            row.of,
            addend="slope_less" if bends_down else "slope",
            minus=bends_down,
            carry="minus",
            place="high",
            write=Write(slope, last="slope"),
            rows=(row,),
        )
        self.terms[name] = Step(
            name,
            slope,
            row.of,
            "root" if row.function == "root" else "sine",
            "value",
            minus=falls,
            carry="minus",
            place="all",
            write=write,
            rows=(replace(row, value=True),),
        )

    def apply(self, name, operands, fmt, words):
        return None

    # ---- groups --------------------------------------------------------------------------------------------------

    def groups(self) -> list[Group]:
        """Return all steps; a step whose addend is the T of another is in its group."""
        read = {name for step in self.terms.values() for name in map(self._variable, step.reads)}
        groups = []
        for name, step in self.terms.items():
            paired = isinstance(step.write and step.write.to, Pick)
            wanted = step.result or name in self.norms or name in self.sums or paired
            if wanted or (step.write and step.write.to in read):
                groups.append(Group())
                kept = step if step.write is None or isinstance(step.write.to, Pick) or step.write.to in read else None
                self._extend(groups[-1], 0, kept or replace(step, write=None))
        return groups

    def _variable(self, operand: Operand) -> str:
        return operand.pair if isinstance(operand, Pick) else operand

    def _picked(self, operand: Operand | None) -> Operand | None:
        """Return a word of a pair, or one that a flag replaces by 0, as a :class:`Pick`; others unchanged."""
        if not isinstance(operand, str):
            return operand
        for pair in self.pairs.values():
            if operand in pair:
                return Pick(pair[0], "", operand == pair[1])
        return self.picks.get(operand, operand)

    def _extend(self, group: Group, at: int, step: Step) -> None:
        """Add a step, and the steps whose addend is its T."""
        normal, counted = self.norms.get(step.name, (None, step.count))
        step = replace(
            step,
            a=self._picked(step.a),
            b=self._picked(step.b) or ZERO,
            norm=normal,
            count=counted,
            sign=sign(step.name) if step.name in self.signs else "",
        )
        group.add(at, step)
        sums = sorted(self.sums.get(step.name, ()), key=lambda s: s.name in self.sums)
        for number, of in enumerate(sums):
            term = self.terms[of.term]
            words = term.addend.startswith("half")
            addend = "hold" if number else "T_half" if words else "T"
            carry = "minus" if of.minus and not words and not of.inverse else ""
            made = replace(
                term,
                name=of.name,
                addend=addend,
                addend_by="",
                minus=of.minus,
                carry=carry,
                write=of.write,
                norm=None,
                term=of.term,
            )
            self._extend(group, at + 2 + number, made)


def lower(layout: Layout) -> tuple[Lowering, list[Group]]:
    """Lower the lean dataflow to steps with these words."""
    lowering = Lowering(layout)
    lean.lean(lowering, lowering.inputs())
    return lowering, lowering.groups()
