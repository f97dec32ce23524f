# SPDX-License-Identifier: Apache-2.0
"""Nodes of a dataflow, and the dataflow that collects them.

A dataflow (:mod:`model.dataflow.paper`, :mod:`model.dataflow.lean`, :mod:`model.dataflow.arm`) is written once, as
nodes.  Each node has an operation (:mod:`model.dataflow.expressions`), and each operation has all its readings:

* words, equal to the RTL in every bit: :class:`model.dataflow.fixed.Bits`;
* double precision with any single node disturbed: :class:`model.bounds.predict.Real`;
* intervals and error growth: :mod:`model.bounds.ranges`;
* formulas over the reals: :class:`tb.formal.lean_exact.Exact`;
* the equation as text, for pages and for the comments of the RTL;
* steps of the folded program: :class:`model.dataflow.fold.lowering.Lowering`;
* formats and clocks, from which ``scripts/generate/headers.py`` writes the ``*_nodes.vh`` of the RTL.

Rounding.  A node of an expression is exact, or rounded as its ``rounding`` says: half up (add half an ulp, drop the
bits) or floor.  A word beyond the format saturates or wraps if the node's ``ends`` states it.  By proof
(:mod:`model.bounds.ranges`) only nodes with ``limited`` ever saturate.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..io.words import BRANCHES, FIELDS
from .annotations import Bound, Case, Growth, Limited, Rule, Within
from .expressions import EXACT, HALF_UP, JAM, Operation, Term, round_shift, wrap
from .formats import GUARD, WIDTHS, Format, Latency
from .mul3 import TILE

WIDE = 0.999 * 2.0**62  # largest magnitude that is computed in 64 bits
SATURATE, WRAP = "saturate", "wrap"


@dataclass(eq=False)
class Node(Term):
    """Named value of a dataflow.

    ``time`` counts clocks from the clock in which the target is at the input; ``after`` is a node that the operation
    waits for without using it, to align its result with its neighbours.  ``rounding`` and ``ends`` define how a word is
    brought to the format, ``error`` is the range, in ulps, of the rounding added.  ``within`` is the range in exact
    arithmetic with its reason, ``grows`` the error growth, ``limited`` an intended saturation, ``proof`` the facts
    that prove the range (:mod:`tb.formal.lean_proofs`).  ``as_words``: operands whose words the node takes as exact.
    ``value`` is of a run: an array over targets.
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
        """Nodes that the operation reads."""
        return self.op.operands

    @property
    def kind(self) -> str:
        """Kind of its operation."""
        return self.op.kind

    @property
    def error(self) -> tuple[float, float]:
        """Range of the rounding added by the operation, in ulps."""
        return self.op.error(self)

    @property
    def right_side(self) -> str:
        """The node's equation without its name."""
        return self.op.text()

    @property
    def decision(self) -> bool:
        """True if it is computed in integers only: a mask, a shift count, or a node of the guard."""
        return self.section == "guard" or not self.frac

    @property
    def instance(self) -> str:
        """Instance in ``ik_paper`` that holds the node's signal: its section's; none for inputs and final flags."""
        return "" if self.kind == "input" or self.section == "results" else f"u_{self.section}"

    # ---- as a term of other nodes' operations ----------------------------------------------------------------------

    def words(self, values):
        return values[self.name]

    def formula(self, domain):
        return domain.name(self)

    def text(self, level=0):
        return self.name

    # ---- words of its own ------------------------------------------------------------------------------------------

    def rounded(self, words):
        """Return words of the operation with the fraction bits of the format."""
        drop = self.op.frac - self.frac
        if drop <= 0:
            return words * (1 << -drop) if drop else words
        if self.rounding == HALF_UP:
            return round_shift(words, drop)
        return words >> drop | (words & (1 << drop) - 1 != 0) if self.rounding == JAM else words >> drop

    def narrowed(self, words):
        """Return words brought into the format, if they can leave it."""
        if self.ends == SATURATE:
            return np.clip(words, self.format.low, self.format.high)
        return wrap(words, self.format.width) if self.ends == WRAP else words

    def evaluate(self, values: dict):
        """Return the node's words from its operands' words by name."""
        if self.format.width > 63 and self.ends != WRAP:  # beyond 64 bits, words of the longest lengths are Python's
            operands = {operand.name: np.asarray(values[operand.name]) for operand in self.operands}
            as_floats = {name: word.astype(np.float64) for name, word in operands.items()}
            if np.max(np.abs(self.op.words(as_floats)), initial=0) > WIDE:
                values = {name: word.astype(object) for name, word in operands.items()}
        return self.op.result(self, values)


Record = dict[str, Any]  # further fields of a node

Limits = Sequence[Sequence[int]]  # lower and upper limit of each joint, words of a turn


class Input(Operation):
    """Word of a target."""

    kind, latency = "input", None

    def text(self, level=0):
        return "input"

    def lower(self, to, node):
        pass


class Dataflow:
    """A dataflow at one word length: its nodes in order, and the statements between them.

    * ``limits``: lower and upper limit of each of the whole arm's joints, words of a turn;
    * ``learned``: number of nodes before it -> a fact that tightens the length bounds of a :class:`.annotations.Case`;
    * ``restarts``: likewise names of nodes whose words, which define a plane, are exact for all later nodes: these are
      correct for any plane;
    * ``lemmas``: name -> a statement, and the facts that prove it, or none if it is assumed;
    * ``definitions``: name -> its value in lemmas; proofs treat it as one number.
    """

    def __init__(self, width: int, widths: range = WIDTHS, tile: int = TILE, limits: Limits | None = None) -> None:
        if width not in widths:
            raise ValueError(f"width {width}: the datapath is built for {widths[0]} to {widths[-1]}")
        self.width, self.tile, self.limits = width, tile, limits
        self.latency = Latency(width, tile)
        self.nodes: dict[str, Node] = {}
        self.learned: dict[int, Callable[[Case, dict[str, Node], dict[str, Bound]], Case]] = {}
        self.restarts: dict[int, tuple[str, ...]] = {}
        self.lemmas: dict[str, tuple[str, tuple[str, ...]]] = {}
        self.definitions: dict[str, str] = {}
        self.half_angle: tuple[str, str] = ("", "")  # names of sine and cosine of phi/2
        self._section, self._equation = "guard", ""
        self._since: Node | None = None  # no later node starts before its clock
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
        """Return the format of an unrounded product: ``i`` integer bits, ``GUARD`` more fraction bits than a word."""
        return Format(self.width + GUARD, self.width + GUARD - 1 - i, f"W + GUARD - {1 + i}")

    bit = Format(1, 0, "0", signed=False)  # format of a mask

    count = Format(6, 0, "0", signed=False)  # format of a shift count

    # ---- making nodes --------------------------------------------------------------------------------------------

    def node(self, name: str, op: Operation, fmt: Format, latency: str | None = "", after=None, **record) -> Node:
        """Record a node that is ready ``latency``, by default its operation's, after the last of its operands (and of
        ``after``).  ``record``: further fields of :class:`Node`."""
        if name in self.nodes:
            raise ValueError(f"node {name} is defined twice")
        latency = op.latency if latency == "" else latency
        after = after or self._since
        start = max((node.time for node in (*op.operands, after) if node), default=0)
        time = start + (self.latency[latency] if latency else 0)
        as_words = self._as_words & {operand.name for operand in op.operands}
        where = self._section, self._equation
        node = Node(name, *where, op, fmt, latency, time, self, after, as_words=as_words, **record)
        node.op.error(node)  # may raise RangeError
        self.nodes[name] = node
        return node

    def mask(self, name: str, op: Operation, latency: str | None = "mux", **record) -> Node:
        """Record a mask of one bit."""
        return self.node(name, op, self.bit, latency, **record)

    def inputs(self, fields: tuple[str, ...] = FIELDS) -> dict[str, Node]:
        """Record the input words, in the clock in which the target is accepted."""
        formats = {name: self.bit if name in BRANCHES else self.word(int(name != "phi")) for name in fields}
        return {name: self.node(name, Input(), fmt) for name, fmt in formats.items()}

    # ---- statements between nodes ----------------------------------------------------------------------------------

    def words(self, *names: str) -> None:
        """Treat the words of these nodes as exact: later nodes take them as they are, and start no earlier."""
        self._since = self.nodes[names[-1]]
        self._as_words |= {*names}

    def lemma(self, name: str, statement: str, *facts: str) -> None:
        """Add a statement for proofs of ranges, with the facts that prove it; without facts it is assumed."""
        self.lemmas[name] = statement, facts
