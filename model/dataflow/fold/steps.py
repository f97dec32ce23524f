# SPDX-License-Identifier: Apache-2.0
"""Steps of the fold datapath, and the clocks in which a step reads, computes and writes, counted from its issue.

A step reads two words, multiplies them, adds the product to the addend S or subtracts it, and writes the sum T.  This
covers the whole dataflow, because a product with a power of two is a copy or a shift.  Steps of a group have a fixed
distance: their addend is the T of an earlier step.

A program repeats with the period of a lap, and around the lap's end two targets are in flight.  Clocks here count from
the start of the target's own lap: modulo the period they are places in the program.
"""

from dataclasses import dataclass
from typing import NamedTuple

ZERO, ONE, HALF, POWER = "0", "1", "1/2", "2^-n"
"""Constant memory words; ``POWER`` is selected by the count."""

PLAIN, DOUBLE = 1, 2
"""Distance of a window's first bit from a product's second-highest bit."""

CUTS = ("exact", "power", "plain", "double", "word", "root", "sine")
"""Position at which a product's tiles are cut: none; none, with the power of a large count replaced by a smaller one's;
two bits below the last place of either window; at the last place of the plain one; at the last place of a table
function's sum."""

ADDENDS: tuple[str, ...] = ("hold", "zero", "half_plain", "half_double", "result_plain", "result_double", "T", "T_half")
ADDENDS += ("slope", "slope_less", "value", "length", "none_or_half")
"""Addend S of a step: its previous value; constants, of which the halves round, also to a result; the T of the step two
before, or that plus a rounding half; words of a table; 1/2, or 1 by a flag; 0, or 1/2 by a flag."""

NORMS = ("even", "inverse", "arm", "count", "unit")
"""Normalization of T: by pairs; by pairs, inverted; by pairs without the sign of an arm; by the count; by pairs, with
bits below the last place dropped, and limited."""


@dataclass(frozen=True)
class Selector:
    """Selector of an operand, an addend or a sign: a mask, or the sign of a word if ``negative``; ``inverted``, or
    only while the mask ``unless`` is 0."""

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
        """Name of its code in Verilog."""
        return f"{'not_' * self.inverted}{self.node or 'none'}" + f"_and_not_{self.unless}" * bool(self.unless)


NEVER, ALWAYS, NO_COUNT = Selector(), Selector("always"), Selector("n_0")
"""Selectors without a mask: never, unconditional, and while the step's count is 0."""


@dataclass(frozen=True)
class Pick:
    """One of two words at adjacent places: the larger and the smaller part of a rotation, which a flag assigns to the
    first or second place; or a word and 0.  ``second`` selects the second place; the flag swaps the two.  Or a word and
    a ``constant``, which is :data:`PLACES` further and needs no second place."""

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
    last: str = "inner"  # the last place kept: of an inner word, a root, a sine, a slope
    source: str = "sum"  # or the result word, or the saturated wrist


@dataclass(frozen=True)
class Normal:
    """Normalization: the normalized T goes to the memory, its shift count to a register."""

    kind: str
    to: str
    count: str = ""


@dataclass(frozen=True)
class Row:
    """Row of a function's table, addressed by the word ``of``. ``value``: read the value, not the slope and bend."""

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
    addend_by: Selector = NEVER  # of the addends length and none_or_half
    minus: Selector = NEVER  # subtract the product from the addend
    carry: str = ""  # carry into the last bit of the sum: "minus": with subtraction
    place: str = ""  # b is the position in a row's segment: "all" of it, or its "high" part
    write: Write | None = None
    norm: Normal | None = None
    result: str = ""  # T becomes this result
    rows: tuple[Row, ...] = ()  # read for c2, and for the addend
    count: Counted | None = None
    sign: str = ""  # the node, if T's sign is kept
    term: str = ""  # the product, where it is not the node T

    @property
    def reads(self) -> list[str]:
        """Variables of the memory words that it needs."""
        return [word_of(o) for o in (self.a, self.b) if o is not None] + [row.of for row in self.rows]

    @property
    def selectors(self) -> list[Selector]:
        """Its selectors; some may be :data:`NEVER`."""
        picks = [o.flag for o in (self.write and self.write.to, self.a, self.b) if isinstance(o, Pick)]
        return [self.minus, *picks, self.addend_by]


BEND, READ, ROW, ADD, SUM, WRITE, NORM = -1, 0, 1, 3, 4, 5, 7
"""Clocks of a step, from its issue: read the row for c2; read the words; read the row for the addend; take the addend
and the product's sign; product ready; write T and take its sign; write the normalized word."""

FETCH = 3  # clocks from a step's place in the program to its issue
ELBOW = ("elbow_w", "elbow_i")  # steps whose results are constants where there is no elbow


class AngleClocks(NamedTuple):
    """Latencies of ``ik_fold_angle``, in clocks.

    * ``iterated``: from loading y to the second stage
    * ``shown``: from the second stage to the angle
    * ``again``: from the second stage until the vector of two lengths enters it
    """

    iterated: int
    shown: int
    again: int


ANGLE_CLOCKS = {24: AngleClocks(12, 15, 16), 32: AngleClocks(16, 17, 18)}
"""Longest word length of each program of the whole arm -> its clocks; ``again`` is at least ``shown`` + 1."""
COMPARED = 2  # clocks from a joint's angle until its comparison with the limits


@dataclass(frozen=True)
class Vector:
    """Vector (x, y) or (x, -y) of two result words, or of the lengths of the two preceding vectors."""

    angle: str
    length: str | None
    x: str
    y: str
    opposite: bool
    lengths: bool


@dataclass(frozen=True)
class Joint:
    """Joint angle: a vector's angle, doubled or with another one added, and the branch bits that change it."""

    name: str
    angle: str
    other: str = ""  # "": the angle is doubled
    minus: bool = False
    branch: tuple[str, ...] = ()

    @property
    def late(self) -> bool:
        """True if its angle is written in the second of the two clocks that show it."""
        return self.minus or not self.other

    @property
    def by(self) -> str:
        """Name of its branch bits' code."""
        return "_".join(name.removeprefix("branch_") for name in self.branch)


@dataclass(frozen=True)
class Placed:
    """Step with the clock of its issue."""

    at: int
    step: Step


class Use(NamedTuple):
    """Use of a word or a register in a clock."""

    of: str
    at: int


def word_of(operand: Operand) -> str:
    """Return the variable of an operand; both words of a pair share one."""
    return operand.pair if isinstance(operand, Pick) else operand


def row_reads(placed: Placed) -> list[int]:
    """Return the clocks in which the step reads a table row's argument."""
    bend = [placed.at + BEND] if placed.step.a is None else []
    return bend + [placed.at + ROW] * bool(placed.step.rows)


def word_reads(placed: Placed) -> list[Use]:
    """Return the words read and their clocks, without constants."""
    step, at = placed.step, placed.at
    operands = [word_of(o) for o in (step.a, step.b) if o is not None]
    uses = [Use(name, at + READ) for name in operands if name not in ("0", "1", "1/2", POWER)]
    return uses + [Use(step.rows[0].of, clock) for clock in row_reads(placed)]


def word_writes(placed: Placed) -> list[Use]:
    """Return the words written and their clocks."""
    step, at = placed.step, placed.at
    written = [Use(word_of(step.write.to), at + WRITE)] if step.write else []
    return written + ([Use(step.norm.to, at + NORM)] if step.norm else [])


def selections(placed: Placed) -> list[tuple[Selector, int]]:
    """Return the selectors and the clocks in which they are needed."""
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
"""Count register -> register set when the normalized word was 0."""


def registers_set(placed: Placed) -> list[Use]:
    """Return the registers that the step sets and their clocks; usable one clock later."""
    step, at = placed.step, placed.at
    sets = [Use(step.sign, at + WRITE)] if step.sign else []
    if step.norm and step.norm.count:
        sets.append(Use(step.norm.count, at + NORM))
        if step.norm.count in ZEROS:
            sets.append(Use(ZEROS[step.norm.count], at + NORM))
    return sets


def first_count(placed: Placed) -> int:
    """Return the clock that adds the first term of a step's count; the last is added just before its use."""
    assert placed.step.count
    return placed.at + (WRITE if placed.step.norm else READ) - len(placed.step.count.terms)


def last_count(placed: Placed) -> int:
    """Return the last clock in which the count is needed."""
    return placed.at + (NORM if placed.step.norm else ADD)
