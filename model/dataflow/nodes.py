# SPDX-License-Identifier: Apache-2.0
"""Building blocks of the dataflows: formats, nodes, latencies, and the operations of a domain.

A dataflow (:mod:`model.dataflow.paper`, :mod:`model.dataflow.lean`) is written once against a small set of operations
(:class:`Domain`) and therefore runs in several ways:

* :class:`model.dataflow.fixed.Bits` - integers, equal to the RTL in every bit of every node;
* :class:`model.bounds.predict.Real` - double precision with any single node disturbed, for predicted errors;
* :class:`model.bounds.ranges.Ranges` - intervals, for proofs;
* as a table of formats and clocks, from which ``scripts/generate/headers.py`` writes the ``*_nodes.vh`` of the RTL.

Formats.  A node is a two's complement word of ``W`` bits with ``i`` integer bits: range [-2^i, 2^i), ``W-1-i``
fraction bits.  Products that feed a sum, and sums of such products that feed a root or a division, have ``GUARD`` more
fraction bits (``wide``).

Rounding.  ``mul`` and ``sum`` round half up (add half an ulp, drop the bits); ``div`` and ``root`` take the floor.
A product always fits its format; a sum and a quotient are narrowed by geometry (|p_e| <= d1, ...), and saturate.  By
proof (:mod:`model.bounds.ranges`) only nodes with ``limited`` ever saturate.
"""

from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..io.words import BRANCHES, FIELDS
from .angles import iterations
from .annotations import Case, Facts, Within, leading
from .operations import TILE, Unrounded, mul3_error, room
from .quadratic import INVERSE_ROOT, SINE, SINE_FRACS, rsqrt_places

GUARD = 8  # extra fraction bits of a product that feeds a sum

EXACT = (0.0, 0.0)
HALF_UP = (-0.5, 0.5)
FLOOR = (-1.0, 0.0)
JAM = (-1.0, 1.0)
CORDIC = (-2.0, 2.0)
"""Error range of each rounding rule, in ulps of the result.  CORDIC: W iterations drop less than one of 2^6 guarded
ulps each in both coordinates, the residual angle is below one ulp, and the result is rounded."""

WIDTHS = range(16, 33)  # word lengths supported by the datapaths

INNER_FRAC = 33
"""Maximum fraction bits of an inner word of the lean datapath: with two integer bits it fits two tiles of 18 bits."""

ROOT_FRACS = 22, 31
"""Fraction bits of the lean roots: for words of up to 18 bits, where the short form suffices, and the maximum."""


def effective_width(width: int) -> int:
    """Return the word length that sets the lean formats: the shorter words of the exhaustive test use the minimum."""
    return max(width, WIDTHS[0])


def inner_frac(width: int) -> int:
    """Return F, the fraction bits of an inner word of the lean datapath at word length ``width``."""
    return max(min(effective_width(width) + 5, INNER_FRAC), ROOT_FRACS[0])


def root_frac(width: int) -> int:
    """Return the fraction bits of the lean datapath's roots at word length ``width``."""
    short, most = ROOT_FRACS
    return short if width <= 18 else min(inner_frac(width), most)


class FormatError(ValueError):
    """Node format that does not match its operands' formats; the text names the node."""


Value = Any  # a domain's values: an array over targets, an interval


@dataclass(frozen=True)
class Latency:
    """Clocks of each kind of operation at word length ``width``; the Verilog names are ``LAT_<KIND>``."""

    width: int
    tile: int = TILE  # of :class:`Domain`

    # kind -> (clocks per bit of the word, fixed clocks, description)
    TABLE = {
        "mul": (0, 4, "operands, tile products, tile sums, rounding"),
        "sum2": (0, 2, "add, round and saturate"),
        "sum3": (0, 3, "add, add, round and saturate"),
        "norm": (0, 3, "magnitudes, leading-zero count, shift"),
        "lzc": (0, 2, "magnitudes, leading-zero count"),
        "shift": (0, 2, "barrel shift: by eights, by ones"),
        "mux": (0, 1, "an exact addition, a choice, a sign change or a comparison"),
        "div": (1, 2, "pipelined radix-2 divider: magnitude, one row a quotient bit, sign"),
        "root": (1, 0, "pipelined radix-2 square root: one row a result bit, output"),
        "sincos": (1, 1, "CORDIC: one iteration a bit, rounding"),
        "mul3": (0, 3, "three tile products, tile sums, rounded sum"),
        "mul3_far": (0, 4, "operands, three tile products, tile sums, rounded sum"),
        "product": (0, 4, "operands, tile products, tile sums, sum"),
        "square": (0, 3, "operands, tile products, sum"),
        "wide": (0, 1, "an exact addition of long words"),
        "even": (0, 3, "zero pairs in groups, shift by groups, shift by pairs"),
        "shift3": (0, 3, "barrel shift: by sixteens, by fours, by ones"),
        "rsqrt": (0, 0, "a table and u times a slope; in the long form in tiles, the slope by another product"),
        "rsqrt_far": (0, 0, "the table's address, and the same"),
        "vector": (0, 0, "CORDIC: one iteration a clock, output"),
        "vector_x": (0, 0, "the iterations that change its length, output"),
        "vector_y": (0, 0, "the other iterations"),
        "trig": (0, 0, "magnitude, a table and u times a slope, as for rsqrt, sign"),
    }

    # kind -> clocks as a Verilog expression, see :func:`model.dataflow.angles.iterations`
    VECTORS = {
        "vector": "(W + 1) / 2 + ((W < 28) ? W / 2 + 2 : 16)",
        "vector_x": "(W + 1) / 2",
        "vector_y": "(W < 28) ? W / 2 + 2 : 16",
    }

    # kind -> (fraction bits that select the form, table, further clocks)
    FORMS = {
        "rsqrt": ("ROOT_FRAC", INVERSE_ROOT, 0),
        "rsqrt_far": ("ROOT_FRAC", INVERSE_ROOT, 1),
        "trig": ("FRAC", SINE, 0),
    }

    def __getitem__(self, kind: str) -> int:
        """Return the clocks of operation ``kind``."""
        if kind in self.FORMS:
            frac, table, more = self.FORMS[kind]
            bits = root_frac(self.width) if frac == "ROOT_FRAC" else inner_frac(self.width)
            return table.clocks(bits, self.tile) + more
        if kind in self.VECTORS:
            head, last = iterations(self.width)
            return {"vector": last + 1, "vector_x": head + 1, "vector_y": last - head}[kind]
        bits, besides, _ = self.TABLE[kind]
        return bits * self.width + besides

    @classmethod
    def expression(cls, kind: str) -> str:
        """Return the clocks as a Verilog expression; the small form takes as long as the long one."""
        if kind in cls.FORMS:
            frac, table, more = cls.FORMS[kind]
            short, long = (table.clocks(table.short_frac + longer) + more for longer in (0, 1))
            return f"(TILE < {TILE} || {frac} > {table.short_frac}) ? {long} : {short}"
        if kind in cls.VECTORS:
            return cls.VECTORS[kind]
        bits, besides, _ = cls.TABLE[kind]
        return " + ".join(["W"] * bits + [str(besides)] * (besides > 0 or not bits))


@dataclass(frozen=True)
class Format:
    """Fixed-point format: ``width`` bits of which ``frac`` are fraction bits.

    ``frac_expr`` is the same fraction length as a Verilog expression of ``W`` (and ``GUARD``).
    """

    width: int
    frac: int
    frac_expr: str
    signed: bool = True

    @property
    def low(self) -> int:
        """Smallest word."""
        return -(1 << (self.width - 1)) if self.signed else 0

    @property
    def high(self) -> int:
        """Largest word."""
        return (1 << (self.width - (1 if self.signed else 0))) - 1

    @property
    def ulp(self) -> float:
        """Value of the LSB."""
        return 2.0**-self.frac


@dataclass
class Node:
    """Named value of the dataflow.

    ``time`` counts clocks from the clock in which the target is at the input; ``value`` is of the domain's type (an
    array over targets).  ``after`` is a node that the operation waits for without using it, to align its result with
    its neighbours.  ``error`` is the range, in ulps, of the rounding added by the operation, and ``facts`` holds the
    dataflow's annotations.
    """

    name: str
    section: str
    equation: str
    op: str
    operands: tuple["Node", ...]
    format: Format
    latency: str | None
    time: int
    value: Any = field(repr=False, default=None)
    after: "Node | None" = None
    error: tuple[float, float] = (0.0, 0.0)
    facts: Facts = Facts()

    def __neg__(self) -> "Negated":
        return Negated(self)

    @property
    def instance(self) -> str:
        """Instance in ``ik_paper`` that holds the node's signal: its section's; none for inputs and final flags."""
        return "" if self.op == "input" or self.section == "results" else f"u_{self.section}"


@dataclass(frozen=True)
class Negated:
    """Negated node, as a term of a sum."""

    node: Node


Limits = Sequence[tuple[int, int]]  # lower and upper limit of each joint, words of a turn


class Domain:
    """Operations of a dataflow.  Each creates one or more named nodes.  ``limits``: of the whole arm's joints."""

    limits: Limits | None = None
    since: Node | None = None  # last of :meth:`words`: no later operation starts before its clock

    def __init__(self, width: int, widths: range = WIDTHS, tile=TILE) -> None:
        if width not in widths:
            raise ValueError(f"width {width}: the datapath is built for {widths[0]} to {widths[-1]}")
        self.width = width
        self.tile = tile  # of mul3; below 18 bits, roots and sines use other tables
        self.latency = Latency(width, tile)
        self.nodes: dict[str, Node] = {}
        self.facts: defaultdict[str, Facts] = defaultdict(Facts)  # by node, set before the node is created
        self._section = "guard"
        self._equation = ""

    # ---- section and equation ------------------------------------------------------------------------------------

    def at(self, section: str | None = None, equation: str = "") -> None:
        """Set the section and the equation of the following nodes."""
        self._section = section or self._section
        self._equation = equation

    def line(self, number: int) -> "Domain":
        """Set the lean equation of the following nodes, (L``number``) of :mod:`model.reference.lean_equations`."""
        self._equation = f"(L{number})"
        return self

    # ---- formats -------------------------------------------------------------------------------------------------

    def word(self, i: int) -> Format:
        """Return a ``W``-bit format with ``i`` integer bits."""
        return Format(self.width, self.width - 1 - i, f"W - {1 + i}" if i != -1 else "W")

    def wide(self, i: int) -> Format:
        """Return the format of an unrounded product: ``i`` integer bits, ``GUARD`` more fraction bits than a word."""
        return Format(self.width + GUARD, self.width + GUARD - 1 - i, f"W + GUARD - {1 + i}")

    bit = Format(1, 0, "0", signed=False)  # format of a mask

    count = Format(6, 0, "0", signed=False)  # format of a shift count

    # ---- making nodes --------------------------------------------------------------------------------------------

    def make(
        self, name, op, operands: tuple[Node, ...], fmt: Format, latency: str | None, value, after=None, error=EXACT
    ) -> Node:
        """Record a node that is ready ``latency`` after the last of its operands (and of ``after``)."""
        if name in self.nodes:
            raise ValueError(f"node {name} is made twice")
        after = after or self.since
        start = max((n.time for n in (*operands, after) if n), default=0)
        time = start + (self.latency[latency] if latency else 0)
        node = Node(
            name, self._section, self._equation, op, operands, fmt, latency, time, value, after, error, self.facts[name]
        )
        self.nodes[name] = node
        return node

    def inputs(self, value: Callable[[str, Format], Value], fields: tuple[str, ...] = FIELDS) -> dict[str, Node]:
        """Create the input words, in the clock in which the target is accepted."""
        formats = {name: self.bit if name in BRANCHES else self.word(int(name != "phi")) for name in fields}
        return {name: self.make(name, "input", (), fmt, None, value(name, fmt)) for name, fmt in formats.items()}

    def summed(self, names: tuple[str, ...], size: Callable) -> None:
        """Prepare words for exact sums of their squares; ``size`` of their magnitudes is the largest sum."""

    # ---- hooks for ranges ----------------------------------------------------------------------------------------

    def learn(self, fact: Callable[[Case], Case]) -> None:
        """Tighten the length bounds of a case from the nodes so far; only ranges are computed case by case."""

    def words(self, *names: str) -> None:
        """Treat the words of these nodes as exact: what follows is stated for any words, and waits for them."""
        self.since = self.nodes[names[-1]]

    def restart(self, *names: str) -> None:
        """Treat the words of these nodes, a plane, as exact: everything after them holds for any plane."""

    # ---- operations ----------------------------------------------------------------------------------------------

    # ``facts`` are the fields of :class:`Facts`.

    def op(self, name: str, operands, fmt: Format, words: Callable, latency="mux", error=EXACT, **facts) -> Node:
        """Create a selection, shift, sign change or comparison: ``words``, a function on words."""
        operands = tuple(self.nodes[n] if isinstance(n, str) else n for n in operands)
        self.facts[name] = Facts(**facts)
        return self.make(name, "choose", operands, fmt, latency, self.apply(name, operands, fmt, words), error=error)

    def mask(self, name: str, operands, words: Callable, latency="mux", **facts) -> Node:
        """Create a mask of one bit."""
        return self.op(name, operands, self.bit, words, latency, **facts)

    def mul(self, name: str, a: Node, b: Node, fmt: Format, scale: int = 0, **facts) -> Node:
        """Create a * b * 2^scale, rounded half up; raises :class:`FormatError`."""
        spare = a.format.frac + b.format.frac - scale - fmt.frac
        if spare < 0:
            raise FormatError(f"{name}: {fmt.frac} fraction bits, the product has only {fmt.frac + spare}")
        self.facts[name] = Facts(**facts)
        error = HALF_UP if spare else EXACT
        return self.make(name, "mul", (a, b), fmt, "mul", self.product(name, a, b, fmt, scale), error=error)

    def sum(self, name: str, *terms: Node | Negated, fmt: Format, after: Node | None = None, **facts) -> Node:
        """Create a sum of two or three terms of one format, rounded half up and saturated; raises
        :class:`FormatError`."""
        signs = tuple(-1 if isinstance(t, Negated) else 1 for t in terms)
        nodes = tuple(t.node if isinstance(t, Negated) else t for t in terms)
        if len({n.format.frac for n in nodes}) != 1:
            raise FormatError(f"{name}: terms are not aligned: {[(n.name, n.format.frac) for n in nodes]}")
        if fmt.frac > nodes[0].format.frac:
            raise FormatError(f"{name}: {fmt.frac} fraction bits, its terms have only {nodes[0].format.frac}")
        error = HALF_UP if nodes[0].format.frac > fmt.frac else EXACT
        self.facts[name] = Facts(**facts)
        value = self.total(name, signs, nodes, fmt)
        return self.make(name, "sum", nodes, fmt, f"sum{len(nodes)}", value, after, error)

    def div(self, name: str, n: Node, d: Node, fmt: Format, **facts) -> Node:
        """Create floor(n / d) in format ``fmt``, saturated; saturates by the sign of n where d <= 0."""
        self.facts[name] = Facts(**facts)
        return self.make(name, "div", (n, d), fmt, "div", self.quotient(name, n, d, fmt), error=FLOOR)

    def root(self, name: str, n: Node, fmt: Format, **facts) -> Node:
        """Create floor(sqrt(n)) in format ``fmt``; 0 where n < 0."""
        self.facts[name] = Facts(**facts)
        return self.make(name, "root", (n,), fmt, "root", self.square_root(name, n, fmt), error=FLOOR)

    def mul3(self, name: str, a: Node, b: Node, fmt: Format, scale=0, kind="mul3", after=None, **facts) -> Node:
        """Create a * b * 2^scale from three tiles (:func:`model.dataflow.operations.mul3`); the kind mul3_far adds an
        operand register for long routes.  The node also waits for ``after``."""
        self.facts[name] = Facts(**facts)
        shift, widths = self.cut(a, b, fmt, scale)
        value = self.product3(name, a, b, fmt, scale)
        return self.make(name, "mul3", (a, b), fmt, kind, value, after, mul3_error(shift, *widths, self.tile))

    @staticmethod
    def cut(a: Node, b: Node, fmt: Format, scale: int) -> tuple[int, tuple[int, int]]:
        """Return the number of fraction bits that :meth:`mul3` drops, and its operands' widths as signed words."""
        first, second = (n.format.width + (not n.format.signed) for n in (a, b))
        return a.format.frac + b.format.frac - scale - fmt.frac, (first, second)

    def even(self, count: str, name: str, value: Node, width: int, fmt: Format, **facts) -> None:
        """Shift the low ``width`` bits left by pairs until the first pair is not 0; create shift count and mantissa."""
        self.facts[name] = Facts(**facts)
        shift, mantissa = self.even_mantissa(count, name, value, width, fmt)
        self.make(count, "even", (value,), self.count, "even", shift)
        self.make(name, "even", (value,), fmt, "even", mantissa, error=FLOOR)

    def rsqrt(self, name: str, m: Node, fmt: Format, far: bool = False, twice: Node | None = None, **facts) -> Node:
        """Create 1/(2 sqrt(m)) of a mantissa in [1/4, 1); 1 where m = 0; doubled where ``twice``.  ``far`` adds a
        register for the table's address."""
        self.facts[name] = Facts(**facts)
        value = self.reciprocal_root(name, m, fmt, twice)
        frac = m.format.frac - 3
        error = _faithful(fmt, frac, rsqrt_places(frac, self.tile) * (2 if twice else 1))
        latency, operands = "rsqrt_far" if far else "rsqrt", (m, twice) if twice else (m,)
        return self.make(name, "rsqrt", operands, fmt, latency, value, error=error)

    def trig(
        self, names: tuple[str, str], phi: Node, fmt: Format, lines: tuple[int, int], within: tuple[Within, Within]
    ) -> None:
        """Create sine and cosine of phi/2 as the lean equations of numbers ``lines``."""
        for name, limits in zip(names, within, strict=True):
            self.facts[name] = Facts(within=limits)
        for name, line, value in zip(names, lines, self.half_sincos(names, phi, fmt), strict=True):
            self.line(line).make(name, "trig", (phi,), fmt, "trig", value, error=_faithful(fmt, SINE_FRACS[-1]))

    def sincos(self, names: tuple[str, str], phi: Node, **facts) -> tuple[Node, ...]:
        """Create sine and cosine of phi/2, words with one integer bit."""
        self.facts |= dict.fromkeys(names, Facts(**facts))
        values = zip(names, self.cordic(names, phi), strict=True)
        return tuple(self.make(n, "sincos", (phi,), self.word(1), "sincos", v, error=CORDIC) for n, v in values)

    def vector(self, length: str | None, angle: str, x: Node, y: Node | Negated, within: tuple[Within, ...]) -> None:
        """Create the angle of a vector of two words, or two lengths, and its length if that has a name
        (:mod:`model.dataflow.angles`)."""
        sign, other = (-1, y.node) if isinstance(y, Negated) else (1, y)
        self.facts |= {n: Facts(within=w) for n, w in zip([n for n in (length, angle) if n], within, strict=True)}
        values, bits, after = self.polar((length, angle), x, other, sign), self.width + 4, None
        if length:
            fmt = Format(bits - 1, bits - 3, "W + 1", signed=False)
            after = self.make(length, "vector", (x, other), fmt, "vector_x", values[0])
        kind, fmt = "vector_y" if length else "vector", Format(bits, bits - 1, "W + 3")
        self.make(angle, "vector", (x, other), fmt, kind, values[1], after)

    def normalize(self, names: tuple[str, ...], words: tuple[Node, ...], count: str, **facts) -> Node:
        """Shift words left together until the largest fills its word; the all-zero vector becomes (1/2, 0, ..).

        Creates the shift count (returned) and the shifted nodes, mantissas in [-1, 1): the scale is free.
        """
        width = words[0].format.width

        def least(*v):
            return np.where(np.any(v, axis=0), np.minimum.reduce([room(u, width) for u in v]), 0)

        counts = self.op(count, words, self.count, least, "norm", within=leading(width - 1))
        for k, (name, word) in enumerate(zip(names, words, strict=True)):
            self.facts[name] = Facts(**facts)
            fill = 1 << (width - 2) if k == 0 else 0
            self.make(name, "normalize", words, self.word(0), "norm", self.mantissa(name, word, words, counts, fill))
        return counts

    # ---- evaluation in a domain: values of its own type ------------------------------------------------------------

    # A domain defines the operations of the datapaths that it runs, with the parameters of :class:`.fixed.Bits`.
    apply: Callable[..., Value]  # of op
    # the paper's datapath
    product: Callable[..., Value]
    total: Callable[..., Value]  # of a sum
    quotient: Callable[..., Value]
    square_root: Callable[..., Value]
    mantissa: Callable[..., Value]
    cordic: Callable[..., tuple[Value, ...]]  # sine and cosine of phi/2
    constant: Callable[..., Node]  # wiring, ready at any time
    # the lean datapath
    product3: Callable[..., Value]
    even_mantissa: Callable[..., tuple[Value, Value]]  # shift count, mantissa
    reciprocal_root: Callable[..., Value]
    half_sincos: Callable[..., tuple[Value, ...]]  # sine and cosine of phi/2
    polar: Callable[..., tuple[Value, Value]]  # length and angle

    def decides(self, fmt: Format) -> bool:
        """Return whether the next node is computed in integers only: a mask, a shift count, or a node of the guard."""
        return self._section == "guard" or not fmt.frac


def _faithful(fmt: Format, frac: int, most: float = 1.0) -> tuple[float, float]:
    """Return the error range of ``most`` ulps of ``frac`` fraction bits, in ulps of ``fmt``, which may have more."""
    bound = most * 2.0 ** max(fmt.frac - frac, 0)
    return -bound, bound


def real_value(words: Callable, operands: tuple[Node, ...], values, fmt: Format):
    """Return the value of a function on words without rounding, from real values of its operands."""

    def scaled(value, fmt: Format):
        return (np.asarray(value, np.float64) / fmt.ulp).view(Unrounded) if fmt.frac else value

    return np.asarray(words(*(scaled(v, n.format) for v, n in zip(values, operands, strict=True)))) * fmt.ulp
