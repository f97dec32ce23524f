# SPDX-License-Identifier: Apache-2.0
"""Nodes of a dataflow, and the dataflow that collects them.

A dataflow (:mod:`model.dataflow.paper`, :mod:`model.dataflow.lean`, :mod:`model.dataflow.arm`) is written once, as
nodes.  Each node has an operation (:mod:`model.dataflow.expressions`), from which everything else is computed:

* words, equal to the RTL in every bit: :func:`model.dataflow.fixed.run`;
* double precision with chosen nodes disturbed: :class:`model.bounds.predict.Real`;
* intervals and error growth: :mod:`model.bounds.ranges`;
* formulas over the reals: :class:`tb.formal.lean_proofs.Exact`;
* the equation as text, for pages and for the comments of the RTL;
* steps of the folded program: :class:`model.dataflow.fold.lowering.Lowering`;
* formats and clocks, from which ``scripts/generate/headers.py`` writes the ``*_nodes.vh`` of the RTL.

Rounding.  A node is exact, or its ``rounding`` is half up (add half an ulp, drop the lower bits), floor or JAM.  A word
outside the format saturates or wraps if the node has ``ends``.  Only nodes with ``limited`` ever saturate, as
:mod:`model.bounds.ranges` proves.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..io.words import BRANCHES, FIELDS, REFERENCES
from .expressions import EXACT, HALF_UP, JAM, Operation, Term, round_shift, wrap
from .formats import GUARD, WIDTHS, Format, Latency
from .mul3 import TILE

WIDE = 0.999 * 2.0**62  # largest magnitude that is computed in 64 bits
SATURATE, WRAP = "saturate", "wrap"

# ---- statements about a node -----------------------------------------------------------------------------------------


class RangeError(Exception):
    """Range or format that does not fit the node; the message names the node."""


Interval = tuple[float, float]
ANYTHING = -math.inf, math.inf


@dataclass(frozen=True)
class Within:
    """Range [low, high] of a node in exact arithmetic, from geometry; ``why`` is the reason.

    ``below``: the value is less than ``high``, and so is the node's word, because the word is exact or truncated.
    """

    low: float
    high: float
    why: str
    below: bool = False


@dataclass(frozen=True)
class Rule:
    """Rule for one node of the paper datapath; ``why`` is the reason.  Each function takes a
    :class:`model.bounds.ranges.Case`: ``limit`` returns a range that narrows the one computed from the operands,
    ``word`` returns the range of the rounded word, and ``error`` returns an upper bound of the error."""

    why: str
    limit: Callable[[Any], Interval]
    word: Callable[[Any], Interval] = lambda case: ANYTHING
    error: Callable[[Any], float] = lambda case: math.inf


class Given(Rule):
    """Rule for an exact word whose range does not follow from the operands' ranges, for example a count or a word that
    wraps where it is unused.  ``limit`` returns the permitted part of the word's format."""


@dataclass(frozen=True)
class Growth:
    """Error growth of an operation: the largest of the operands' errors, or their sum if ``added``.  Before that, each
    error is multiplied by the operand's entry in ``gains`` (default 1).  Masks and counts have no error and no entry.
    Unless ``exact``, rounding adds an ulp."""

    gains: tuple[float, ...] = ()
    added: bool = False
    exact: bool = False

    def __call__(self, errors: Sequence[float], ulp: float) -> float:
        """Return the error of the result from the operands' errors."""
        grown = [gain * error for gain, error in zip(self.gains, errors, strict=True)] if self.gains else errors
        return (sum(grown) if self.added else max(grown)) + (0.0 if self.exact else ulp)


@dataclass(frozen=True)
class Limited:
    """Intended saturation at the end of the format; ``why`` is the reason.  ``clamped``: only for clamped targets."""

    why: str
    clamped: bool = False


SAME = Growth(exact=True)  # growth of a selection: the result is one of the operands

SUM = Growth(added=True, exact=True)


# ---- nodes -----------------------------------------------------------------------------------------------------------


@dataclass(eq=False)
class Node(Term):
    """Named value of a dataflow.

    * ``time``: clock in which the node is valid; the target is at the input in clock 0; -1 without a signal in the RTL
    * ``after``: node that is not an operand, but for which the operation waits, to align results
    * ``rounding``, ``ends``: treatment of the bits below and above the format; ``limited``: intended saturation
    * ``within``: range in exact arithmetic; ``proof``: facts that prove it (:mod:`tb.formal.lean_proofs`)
    * ``grows``: error growth; ``as_words``: operands whose words count as exact
    * ``value``: array over targets, in a run
    """

    name: str
    section: str
    equation: str  # number in the paper
    op: Operation
    format: Format
    latency: str | None
    time: int
    flow: Dataflow = field(repr=False)
    after: Node | None = None
    rounding: tuple[float, float] = EXACT
    ends: str = ""
    within: Within | Rule | None = None
    grows: Growth = Growth()
    limited: Limited | None = None
    proof: tuple[str, ...] | None = None
    as_words: frozenset[str] = frozenset()
    value: Any = field(repr=False, default=None)

    def __post_init__(self) -> None:
        self.frac, self.leaves = self.format.frac, (self,)

    @property
    def operands(self) -> tuple[Node, ...]:
        return self.op.operands

    @property
    def kind(self) -> str:
        return self.op.kind

    @property
    def error(self) -> tuple[float, float]:
        """Range (low, high) of the rounding error that the operation adds, in ulps."""
        return self.op.error(self)

    @property
    def right_side(self) -> str:
        """Right side of the node's equation, as text."""
        return self.op.text()

    @property
    def decision(self) -> bool:
        """True if the node counts as exact: a mask, a shift count, or a node of the section ``guard``."""
        return self.section == "guard" or not self.frac

    @property
    def in_rtl(self) -> bool:
        """True if the RTL has a signal with the node's name."""
        return self.time >= 0

    @property
    def instance(self) -> str:
        """Verilog instance that holds the node's signal; empty for inputs and nodes of the section ``results``."""
        return "" if self.kind == "input" or self.section == "results" else f"u_{self.section}"

    # ---- as a term of other nodes' operations ----------------------------------------------------------------------

    def words(self, values):
        return values[self.name]

    def formula(self, domain):
        return domain.name(self)

    def text(self, level=0):
        return self.name

    # ---- words of the node itself ----------------------------------------------------------------------------------

    def rounded(self, words):
        """Return the operation's words, rounded to the fraction bits of the format."""
        drop = self.op.frac - self.frac
        if drop <= 0:
            return words * (1 << -drop) if drop else words
        if self.rounding == HALF_UP:
            return round_shift(words, drop)
        return words >> drop | (words & (1 << drop) - 1 != 0) if self.rounding == JAM else words >> drop

    def narrowed(self, words):
        """Return words, saturated or wrapped to the format if the node has ``ends``."""
        if self.ends == SATURATE:
            return np.clip(words, self.format.low, self.format.high)
        return wrap(words, self.format.width) if self.ends == WRAP else words

    def evaluate(self, values: dict):
        """Return the node's words.  ``values``: operand name -> words."""
        if self.format.width > 63 and self.ends != WRAP:  # words that may exceed 64 bits become Python integers
            operands = {operand.name: np.asarray(values[operand.name]) for operand in self.operands}
            as_floats = {name: word.astype(np.float64) for name, word in operands.items()}
            if np.max(np.abs(self.op.words(as_floats)), initial=0) > WIDE:
                values = {name: word.astype(object) for name, word in operands.items()}
        return self.op.result(self, values)


Record = dict[str, Any]  # further fields of a node

Limits = Sequence[Sequence[int]]  # (lower, upper) limit of each joint, words with one turn = 2^W


class Input(Operation):
    """Input word of a target."""

    kind, latency, pattern = "input", None, "input"

    def lower(self, to, node):
        pass


class Dataflow:
    """Dataflow at one word length: its nodes in order, and statements for ranges and proofs.

    * ``limits``: (lower, upper) limit of each joint of the whole arm, as words (one turn is 2^W); by default no limits
    * ``learned``: indices of nodes before which :func:`model.bounds.ranges.off_length` tightens the bounds of a case
    * ``restarts``: index of a node -> names of earlier nodes that define a plane.  From the node with this
      index on, the words of these earlier nodes count as exact, because all later nodes are correct for any plane
    * ``lemmas``: name -> (statement, facts that prove it); without facts the statement is assumed
    * ``definitions``: name -> expression that the name abbreviates in lemmas; proofs treat the name as one number
    """

    def __init__(self, width: int, widths: range = WIDTHS, tile: int = TILE, limits: Limits | None = None) -> None:
        if width not in widths:
            raise ValueError(f"width {width}: the datapath is built for {widths[0]} to {widths[-1]}")
        self.width, self.tile = width, tile
        self.limits = limits or [(-(1 << width - 1), (1 << width - 1) - 1)] * 7
        self.latency = Latency(width, tile)
        self.nodes: dict[str, Node] = {}
        self.learned: set[int] = set()
        self.restarts: dict[int, tuple[str, ...]] = {}
        self.lemmas: dict[str, tuple[str, tuple[str, ...]]] = {}
        self.definitions: dict[str, str] = {}
        self.half_angle: tuple[str, str] = ("", "")  # names of sine and cosine of phi/2
        self._section, self._equation = "guard", ""
        self._since: Node | None = None  # no later node starts before this node's clock
        self._as_words: frozenset[str] = frozenset()

    def at(self, section: str | None = None, equation: str = "") -> None:
        """Set the section and the paper's equation of the following nodes."""
        self._section = section or self._section
        self._equation = equation

    # ---- formats -------------------------------------------------------------------------------------------------

    def word(self, i: int) -> Format:
        """Return a ``W``-bit format with ``i`` integer bits."""
        return Format(self.width, self.width - 1 - i, f"W - {1 + i}" if i != -1 else "W")

    def wide(self, i: int) -> Format:
        """Return the format of a product in a sum: ``i`` integer bits, ``GUARD`` more fraction bits than a word."""
        return Format(self.width + GUARD, self.width + GUARD - 1 - i, f"W + GUARD - {1 + i}")

    bit = Format(1, 0, "0", signed=False)  # format of a mask

    count = Format(6, 0, "0", signed=False)  # format of a shift count

    # ---- making nodes --------------------------------------------------------------------------------------------

    def node(self, name: str, op: Operation, fmt: Format, latency: str | None = "", after=None, **record) -> Node:
        """Add and return a node.  ``latency`` is a key of :class:`.formats.Latency`, by default the operation's; it
        counts from the latest time of the operands and ``after``.  ``record``: further fields of :class:`Node`, of
        which ``proof`` is a text of facts separated by semicolons.  Raises ValueError if the name is taken."""
        if name in self.nodes:
            raise ValueError(f"node {name} is defined twice")
        latency = op.latency if latency == "" else latency
        after = after or self._since
        start = max((node.time for node in (*op.operands, after) if node), default=0)
        time = start + (self.latency[latency] if latency else 0)
        as_words = self._as_words & {operand.name for operand in op.operands}
        where = self._section, self._equation
        if "proof" in record:
            record["proof"] = tuple(record["proof"].split("; "))
        node = Node(name, *where, op, fmt, latency, time, self, after, as_words=as_words, **record)
        node.op.error(node)  # may raise RangeError
        self.nodes[name] = node
        return node

    def mask(self, name: str, op: Operation, latency: str | None = "mux", **record) -> Node:
        return self.node(name, op, self.bit, latency, **record)

    def inputs(self, fields: tuple[str, ...] = FIELDS) -> dict[str, Node]:
        """Add and return the nodes of the input words; their time is 0, the clock in which the target is accepted."""
        formats = {
            name: self.bit if name in BRANCHES else self.word(int(name not in ("phi", *REFERENCES))) for name in fields
        }
        return {name: self.node(name, Input(), fmt) for name, fmt in formats.items()}

    # ---- statements between nodes ----------------------------------------------------------------------------------

    def words(self, *names: str) -> None:
        """Treat the named nodes' words as exact in later nodes, which start only when the last named node is valid."""
        self._since = self.nodes[names[-1]]
        self._as_words |= {*names}

    def lemma(self, name: str, statement: str, facts: str = "") -> None:
        """Add a lemma for proofs of ranges, with the facts that prove it; without facts the lemma is assumed."""
        self.lemmas[name] = statement, tuple(facts.split("; ")) if facts else ()
