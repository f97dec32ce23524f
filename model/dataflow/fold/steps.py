# SPDX-License-Identifier: Apache-2.0
"""Steps of the fold datapath, and the clocks in which a step reads, computes and writes, counted from its issue.

A step reads two words, multiplies them, adds the product to the addend S or subtracts it from S, and writes the sum T.
Steps cover the whole dataflow, because a product with a power of two is a copy or a shift.  The steps of a group are a
fixed number of clocks apart, because the addend of each step after the first is the T of an earlier step.

A program is repeated in every lap, and around the end of a lap two targets are in flight.  The clocks of a program are
counted from the start of the lap that loads the target; a clock modulo the lap's period addresses a program word.
"""

from dataclasses import dataclass
from typing import NamedTuple

ZERO, ONE, HALF, POWER = "0", "1", "1/2", "2^-n"
"""Constant memory words; ``POWER`` is selected by the count."""

PLAIN, DOUBLE = 1, 2
"""Windows of T that can become a word, named by how far the first bit is below a product's second-highest bit."""

CUTS = ("exact", "power", "plain", "double", "word", "root", "sine")
"""Lowest bit that is kept of each tile of a product.  exact: all bits.  power: all bits; for a large count, a larger
power is stored and its product shifted down.  plain, double: two bits below an inner word's LSB in that window.  word:
an inner word's LSB in the plain window.  root, sine: the LSB of the function's sum."""

ADDENDS: tuple[str, ...] = ("hold", "zero", "half_plain", "half_double", "result_plain", "result_double", "T", "T_half")
ADDENDS += ("slope", "slope_less", "value", "length", "none_or_half")
"""Addend S of a step.  hold: the previous S.  half_: half an ulp of an inner word.  result_: half an ulp of an inner
word plus half an ulp of a result.  T: the T of the step two clocks before.  T_half: that T, truncated, plus half an
ulp.  slope, slope_less, value: words of a table.  length: 1/2, or 1 by a flag.  none_or_half: 0, or 1/2 by a flag."""

NORMS = ("even", "inverse", "arm", "count", "unit")
"""Left shift that normalizes T.  even: by pairs of bits.  inverse: ~T, by pairs.  arm: d1 or d2 without the sign, by
pairs.  count: by the step's count.  unit: by pairs, without the bits below an inner word's LSB, and limited below 1."""


@dataclass(frozen=True)
class Selector:
    """Condition that selects an operand, an addend or a sign: the mask ``node`` or, if ``negative``, the sign of the
    word ``node``.  If ``inverted``, the condition is negated.  It is 0 while the mask ``unless`` is 1."""

    node: str = ""
    negative: bool = False
    inverted: bool = False
    unless: str = ""

    def __bool__(self) -> bool:
        return bool(self.node)

    def __str__(self) -> str:
        return f"{'~' * self.inverted}{self.node}{'<0' * self.negative}" + f" & ~{self.unless}" * bool(self.unless)

    @property
    def code(self) -> str:
        """Verilog name of the selector's code."""
        return f"{'not_' * self.inverted}{self.node or 'none'}" + f"_and_not_{self.unless}" * bool(self.unless)


NEVER, ALWAYS, NO_COUNT = Selector(), Selector("always"), Selector("n_0")
"""Selectors without a mask: never, always, and while the step's count is 0."""


@dataclass(frozen=True)
class Pick:
    """One of two memory words: the word ``pair`` or, if ``second``, its partner; a ``flag`` of 1 swaps the two.

    The two are the larger and the smaller part of a rotation, in adjacent places.  With a ``constant``, the partner is
    instead that constant, a fixed word :data:`.program.PLACES` addresses after the word ``pair``."""

    pair: str
    flag: Selector
    second: bool = False
    constant: str = ""


Operand = str | Pick


@dataclass(frozen=True)
class Write:
    """Memory write of one of T's windows."""

    to: Operand
    window: int = PLAIN
    double_by: Selector = NEVER  # selects the double window
    limit: bool = False  # values above the window become the largest word
    last: str = "inner"  # word whose LSB is the last bit kept: inner, root, sine or slope
    source: str = "sum"  # sum: T; result: the result word; wrist: the saturated coordinate


@dataclass(frozen=True)
class Normal:
    """Normalization: write normalized T to the memory word ``to`` and the shift count to the register ``count``."""

    kind: str
    to: str
    count: str = ""


@dataclass(frozen=True)
class Row:
    """Row of a function's table, addressed by the word ``of``.  Read c0 if ``value``, otherwise c1 and c2."""

    function: str  # root, sine or cosine
    of: str
    value: bool


@dataclass(frozen=True)
class Counted:
    """Shift count of a step: ``base`` + factor * register for each of ``terms``; it equals ``node`` + ``offset``."""

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
    addend_by: Selector = NEVER  # flag of the addends length and none_or_half
    minus: Selector = NEVER  # subtract the product from the addend
    carry: str = ""  # carry into the last bit of the sum; "minus": 1 if the product is subtracted
    place: str = ""  # if set, b is u, the position in a table segment: "all" bits, or its "high" part
    write: Write | None = None
    norm: Normal | None = None
    result: str = ""  # T becomes this result
    rows: tuple[Row, ...] = ()  # read for c2, and for the addend
    count: Counted | None = None
    sign: str = ""  # name of the node, if T's sign is kept in a register
    term: str = ""  # name of the product, if T is another node

    @property
    def reads(self) -> list[str]:
        """Variables whose memory words the step reads."""
        return [word_of(o) for o in (self.a, self.b) if o is not None] + [row.of for row in self.rows]


BEND, READ, ROW, ADD, SUM, WRITE, NORM = -1, 0, 1, 3, 4, 5, 7
"""Clocks of a step's actions, from its issue: read the table row for c2; read the words; read the row for the addend;
set the addend and the product's sign; product ready; write T and keep its sign; write the normalized word."""

FETCH = 3  # clocks from a step's place in the program to its issue
ELBOW = ("elbow_w", "elbow_i")  # steps whose results are constants for clamped targets


class AngleClocks(NamedTuple):
    """Latencies of ``ik_fold_angle``, in clocks.

    * ``iterated``: from loading y until the vector can be handed over to the second stage
    * ``shown``: from the hand-over to the angle
    * ``again``: from one hand-over to the next, if both components of the next vector are lengths
    """

    iterated: int
    shown: int
    again: int


ANGLE_CLOCKS = {24: AngleClocks(12, 15, 16), 32: AngleClocks(16, 17, 18)}
"""Longest word length that a program of the whole arm is for -> clocks; ``again`` is at least ``shown`` + 1."""
COMPARED = 2  # clocks from a joint's angle until its comparison with the limits


class Vector(NamedTuple):
    """Vector (x, y) of two results or, if ``lengths``, of the last two vectors' lengths; (x, -y) if ``opposite``."""

    angle: str
    length: str | None
    x: str
    y: str
    opposite: bool
    lengths: bool


class Joint(NamedTuple):
    """Joint angle: twice the vector angle ``angle``, or ``angle`` plus (if ``minus``: minus) the angle ``other``."""

    name: str
    angle: str
    other: str = ""  # "": the angle is doubled
    minus: bool = False
    branch: tuple[str, ...] = ()  # branch bits that change it

    @property
    def late(self) -> bool:
        """True if the joint is written one clock after its vector angle is ready, False if in the same clock."""
        return self.minus or not self.other

    @property
    def by(self) -> str:
        """Name of the code that selects the joint's branch bits."""
        return "_".join(name.removeprefix("branch_") for name in self.branch)


class Placed(NamedTuple):
    """Step with the clock of its issue."""

    at: int
    step: Step


class Use(NamedTuple):
    """Use of a word or a register in a clock."""

    of: str
    at: int


def word_of(operand: Operand) -> str:
    """Return the variable of an operand; both words of a pair share one variable."""
    return operand.pair if isinstance(operand, Pick) else operand


def row_reads(placed: Placed) -> list[int]:
    """Return the clocks in which the step reads the word that selects a row of a table."""
    bend = [placed.at + BEND] if placed.step.a is None else []
    return bend + [placed.at + ROW] * bool(placed.step.rows)


def word_reads(placed: Placed) -> list[Use]:
    """Return the words that the step reads, except for constants, and the clocks of these reads."""
    step, at = placed.step, placed.at
    operands = [word_of(o) for o in (step.a, step.b) if o is not None]
    uses = [Use(name, at + READ) for name in operands if name not in ("0", "1", "1/2", POWER)]
    return uses + [Use(step.rows[0].of, clock) for clock in row_reads(placed)]


def word_writes(placed: Placed) -> list[Use]:
    """Return the words that the step writes and their clocks."""
    step, at = placed.step, placed.at
    written = [Use(word_of(step.write.to), at + WRITE)] if step.write else []
    return written + ([Use(step.norm.to, at + NORM)] if step.norm else [])


def selections(placed: Placed) -> list[tuple[Selector, int]]:
    """Return the step's selectors, some of which may be :data:`NEVER`, and the clocks in which they are needed."""
    step, at = placed.step, placed.at
    needs = [(o.flag, at + READ) for o in (step.a, step.b) if isinstance(o, Pick)]
    needs += [(step.addend_by, at + ADD), (step.minus, at + ADD)]
    if step.write:
        needs.append((step.write.double_by, at + WRITE))
        if isinstance(step.write.to, Pick):
            needs.append((step.write.to.flag, at + WRITE))
    if step.name in ELBOW and step.result:
        needs += [(Selector("clamp"), at + WRITE), (Selector("closed"), at + WRITE)]
    return needs


ZEROS = {"e_rho": "on_axis", "e_s": "at_shoulder", "e_1": "no_1", "e_2": "no_2"}
"""Count register -> register that is set if the normalized word was 0."""


def registers_set(placed: Placed) -> list[Use]:
    """Return the registers that the step sets and their clocks; a register can be used one clock later."""
    step, at = placed.step, placed.at
    sets = [Use(step.sign, at + WRITE)] if step.sign else []
    if step.norm and step.norm.count:
        sets.append(Use(step.norm.count, at + NORM))
        if step.norm.count in ZEROS:
            sets.append(Use(ZEROS[step.norm.count], at + NORM))
    return sets


def first_count(placed: Placed) -> int:
    """Return the clock in which a count's first term is added; the last term is added just before the first use."""
    assert placed.step.count
    return placed.at + (WRITE if placed.step.norm else READ) - len(placed.step.count.terms)


def last_count(placed: Placed) -> int:
    """Return the last clock in which the step's count is needed."""
    return placed.at + (NORM if placed.step.norm else ADD)
