# SPDX-License-Identifier: Apache-2.0
"""Proved ranges: the dataflows evaluated on intervals that contain every input word, narrowed by geometric rules.

A node's :class:`Bound` has the interval of exact arithmetic (``low``, ``high``) and the largest error of its word
(``error``): the operation's own rounding plus the operands' errors; in a product, each of these is multiplied by the
largest value of the other operand. The interval, widened by the error, must fit the format. Each node states its range
from geometry, its error growth and any intended saturation (:mod:`model.dataflow.nodes`), with the reason.

* :class:`Ranges`, paper dataflow: interval arithmetic, narrowed by rules at some nodes. The input words are split into
  :func:`cases`; a node's range is the union over the cases.
* :class:`LeanRanges`, lean dataflow and whole arm: the nodes state all ranges, and `make formal` proves ranges and
  errors (``tb/formal/lean_proofs.py``). Unused words may lose high bits: K and the nodes computed from K if the target
  is clamped, and the hand's products if the hand is bad.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache, reduce

import numpy as np

from ..dataflow.expressions import Constant, Term
from ..dataflow.fixed import dataflow
from ..dataflow.formats import Format
from ..dataflow.nodes import ANYTHING, Given, Node, RangeError, Rule, Within
from ..io.words import ARMS

SLACK = 2.0**-48
"""Relative allowance for the rounding of the bounds themselves, which :class:`Ranges` computes in doubles."""

UP = 1 + 2.0**-50  # factor by which LeanRanges rounds its errors upwards

SQRT2, SQRT3 = math.sqrt(2), math.sqrt(3)


@dataclass(frozen=True)
class Bound:
    """Bounds of a node.  Its value in exact arithmetic lies in [low, high].  Its word differs from this value by at
    most ``error``, and lies in [floor, ceiling], the operation's range over its operands' words."""

    low: float
    high: float
    error: float = 0.0
    floor: float = -math.inf
    ceiling: float = math.inf

    @property
    def word(self) -> tuple[float, float]:
        """Range of the word's value."""
        return max(self.low - self.error, self.floor), min(self.high + self.error, self.ceiling)

    @property
    def size(self) -> float:
        """Largest magnitude in exact arithmetic."""
        return max(abs(self.low), abs(self.high))


@dataclass(frozen=True)
class Case:
    """Part of the paper datapath's input domain: bounds of d1 and d2, of the exponent j in p_w = 2^j p_a, and of the
    lengths of the vectors p_w and b.  Names of the cases:

    * ``exact``: the target is in reach, and d1 + d2 < 2: scaling loses no bit of d1 and d2.
    * ``long``: the target is in reach, and d1 + d2 >= 2: scaling rounds odd lengths, so d1 + d2 is off by ulps.
    * ``clamped``: any other target, computed with d1 = d2 = 1/4 (see :func:`model.dataflow.paper.guard`).
    """

    name: str
    clamped: bool
    d_high: float  # upper bound of d1 and d2
    j: tuple[int, int]
    long: bool = False  # scaling may round d1 and d2
    p: tuple[float, float] = (0.5, SQRT3)
    b: tuple[float, float] = (0.5, SQRT2)
    ulp: float = 0.0  # ulp of d1 and d2
    elbow: float = 0.0  # ulp of p_e
    tilt: float = 0.0  # sine of the angle between p_w and the plane that the words pi_swivel define
    straight: float = 0.0  # error of the vector p_e relative to a + t m (:func:`off_length`)
    square: float = 0.0  # error of |p_e|^2 computed from the words p_e

    def tilted(self, error: float) -> Case:
        """Return the case in which the words pi_swivel, whose error is at most ``error``, count as exact."""
        b = self.b[0] - error, self.b[1] + error
        return replace(self, b=b, tilt=error / b[0])

    @property
    def excess(self) -> float:
        """Largest increase of |k_e| due to rounded lengths: the rounding error of d1 + d2, times |d1 - d2|."""
        return 4 * self.ulp if self.long else 0.0

    @property
    def k_e(self) -> float:
        """Upper bound of |k_e|: 2 d1 |p_w| + excess, limited to s_j + (d1 + d2) |d_dif_j| if d1 and d2 are rounded."""
        limit = 2 * self.d_high * self.p[1] + self.excess
        return min(limit, self.p[1] ** 2 * 2.0 ** -self.j[0] + 2) if self.long else limit

    @property
    def p_e(self) -> float:
        """Upper bound of |p_e|: the maximum of d1 and |k_e| / (2 |p_w|), divided by the cosine of the tilt."""
        return (self.d_high + self.excess / (2 * self.p[0])) / math.sqrt(1 - self.tilt**2)

    @property
    def pp(self) -> tuple[float, float]:
        """Range of |PP^-| = 2 |p_w| |pi_swivel|; the tilt reduces the lower end."""
        return 2 * self.p[0] * self.b[0] * math.sqrt(1 - self.tilt**2), 2 * self.p[1] * self.b[1]

    @property
    def tmp1(self) -> tuple[float, float]:
        """Range of (d1 sin a)^2 |PP^-|^2, or of |pi_swivel|^2 ((2 d1 |p_w|)^2 - k_e^2) if d1 and d2 are rounded."""
        most = (min(self.d_high, 0.5) * self.pp[1]) ** 2
        tilted = (self.pp[1] * self.p_e * self.tilt) ** 2
        if not self.long:
            return -tilted, most
        # from |k_e| <= 2 d1 |p_w| + excess, or from |k_e| alone
        near = 4 * self.d_high * self.p[1] * self.excess + self.excess**2
        return -(self.b[1] ** 2) * min(near, self.k_e**2) - tilted, most

    @property
    def t_e(self) -> tuple[float, float]:
        """Range of p_e (p_e - p_w), which is d1 d2 times a cosine."""
        if self.clamped:
            return 0.0, 0.75
        most = (self.p_e + self.elbow) ** 2 if self.long else 0.25 + (self.p_e * self.tilt) ** 2
        return -most, most

    @property
    def forearm(self) -> float:
        """Upper bound of |p_e - p_w|, which is d2 unless rounded lengths do not reach the target."""
        return math.sqrt((self.p_e + self.elbow) ** 2 + self.square) + 2 * self.ulp

    @property
    def p_e_words(self) -> float:
        """Upper bound of |p_e| computed from the rounded words p_e."""
        return math.sqrt(self.p_e**2 + self.square)


def off_length(c: Case, nodes: Mapping[str, Node], bounds: Mapping[str, Bound]) -> Case:
    """Return the case with bounds of the errors of p_e (``straight``) and |p_e|^2 (``square``).

    In (13), p_e = a + t m, where a is along p_w, and m = PP^- / |PP^-|^2 is perpendicular to p_w.  The root t = tmp_sqr
    may lose half of its digits, and so may p_e.  But |p_e|^2 = |a|^2 + t^2 |m|^2 contains only t^2, which is precise.
    """
    root, inf, worst = bounds["tmp_sqr"], bounds["inf_pp"], 0.0
    if min(inf.low, inf.word[0]) <= 0:
        return c  # the division then raises RangeError
    for axis, m in zip("xyz", "123", strict=True):
        if f"e_{axis}_pp" not in bounds:  # not yet evaluated: use the first axis's bound
            axis, m = "x", max("123", key=lambda k: bounds[f"pp_{k}_m"].error)
        along = bounds[f"e_{axis}_pp"].error + root.word[1] * bounds[f"pp_{m}_m"].error
        num = along + nodes[f"e_{axis}_pp"].format.ulp
        worst = max(worst, (num + c.p_e * 1.1 * inf.error) / inf.word[0] + c.elbow)
    straight = SQRT3 * worst
    square = bounds["tmp1"].error + 2 * root.word[1] * nodes["tmp_sqr"].format.ulp
    return replace(c, straight=straight, square=square / inf.low + 2 * straight * c.p_e * 1.1 + straight**2)


EDGES_P = (0.5, math.sqrt(0.5), 1.0, SQRT2, SQRT3)
EDGES_B = (0.5, math.sqrt(0.5), 1.0, SQRT2)
"""Boundaries that divide the ranges of |p_w| and |b| into parts; quotients have tighter bounds in a narrow part."""


def cases(width: int) -> list[Case]:
    """Return the parts of the input domain; together they contain every target."""
    ulp = 2.0 ** (1 - width)
    last = 1 - 2 * ulp  # d1 + d2 <= 1 - ulp, d2 >= ulp
    whole = [
        Case("exact", False, last, (0, width - 1)),
        Case("long", False, 0.5, (0, width), True),
        Case("clamped", True, 0.25, (2, 2)),
    ]
    boxes = list(itertools.product(itertools.pairwise(EDGES_P), itertools.pairwise(EDGES_B)))
    return [replace(c, p=p, b=b, ulp=ulp) for c in whole for p, b in boxes]


def unfit(node: Node, low: float, high: float, where: str = "") -> str:
    """Return the message that a proved range does not fit the node's format."""
    label, fmt = f"{node.name} {node.equation}".strip(), node.format
    return (
        f"{label}: proved range [{low:.9g}, {high:.9g}] does not fit its format "
        f"[{fmt.low * fmt.ulp:.9g}, {fmt.high * fmt.ulp:.9g}], {fmt.width} bits, {fmt.frac} of them fraction "
        f"(W = {node.flow.width}{where})"
    )


class Ranges:
    """Bounds of the paper dataflow in one :class:`Case`, by node name; ``proved``: bounds before formats limit them.
    ``saturated``: nodes that saturate by design; ``failed``: name of any other node that does not fit -> message."""

    def __init__(self, width: int, case: Case) -> None:
        self.flow, self.bounds, self.failed = dataflow("paper", width), dict[str, Bound](), dict[str, str]()
        self.case = replace(case, elbow=self.flow.word(1).ulp)
        self.saturated: set[str] = set()
        self.proved: dict[str, Bound] = {}
        for number, node in enumerate(self.flow.nodes.values()):
            if number in self.flow.learned:
                self.case = off_length(self.case, self.flow.nodes, self.bounds)
            if names := self.flow.restarts.get(number, ()):
                self.case = self.case.tilted(reduce(math.hypot, (self.bounds[name].error for name in names)))
                for name in names:
                    low, high = self.bounds[name].word
                    self.bounds[name] = replace(self.bounds[name], low=low, high=high, error=0.0)
            self.bounds[node.name] = self._bound(node)

    def __call__(self, term: Term) -> Bound:
        """Return the bound of an operand."""
        if isinstance(term, Constant):
            return Bound(float(term.value), float(term.value))
        assert isinstance(term, Node)
        return self.bounds[term.name]

    def limit(self, node: Node) -> float:
        """Return the largest magnitude that the node's rule permits; inf without a rule."""
        return max(map(abs, node.within.limit(self.case))) if isinstance(node.within, Rule) else math.inf

    def _bound(self, node: Node) -> Bound:
        fmt = node.format
        if node.kind == "input":
            least = 1 if node.name in ARMS and not self.case.clamped else fmt.low
            return self._fit(node, Bound(least * fmt.ulp, fmt.high * fmt.ulp))
        interval = getattr(node.op, "interval", None)
        if interval is None:
            return self._of_expression(node)
        if node.kind == "div" and node.limited:
            self.saturated.add(node.name)
            return self._fit(node, Bound(fmt.low * fmt.ulp, fmt.high * fmt.ulp))
        return self._rule(node, *interval(node, self))

    def _fit(self, node: Node, bound: Bound) -> Bound:
        """Return a bound limited to the node's format; record the node if the bound does not fit."""
        fmt = node.format
        floor, ceiling = fmt.low * fmt.ulp, fmt.high * fmt.ulp
        low, high = bound.word
        slack = SLACK * max(abs(low), abs(high))
        # Words are multiples of the ulp: a bound less than an ulp beyond the last word still fits.
        if math.ceil((low + slack) / fmt.ulp) < fmt.low or math.floor((high - slack) / fmt.ulp) > fmt.high:
            if node.limited is None or node.limited.clamped and not self.case.clamped:
                self.failed[node.name] = unfit(node, low, high, f", case {self.case.name}")
            else:
                self.saturated.add(node.name)
                bound = replace(bound, floor=floor, ceiling=ceiling)
        self.proved[node.name] = bound
        # Words outside the format saturate.  Saturation only moves a word closer to its exact value, unless the exact
        # value is itself outside.
        if bound.low < floor or bound.high > ceiling:
            return Bound(max(bound.low, floor), min(bound.high, ceiling), bound.error, floor, ceiling)
        return replace(bound, floor=max(bound.floor, floor), ceiling=min(bound.ceiling, ceiling))

    def _rule(self, node: Node, low: float, high: float, error: float, word=ANYTHING) -> Bound:
        """Return the bound of an operation's result, narrowed by the node's rule if it has one."""
        rule = node.within
        if not isinstance(rule, Rule):
            return self._fit(node, Bound(low, high, error, *word))
        least, most = rule.limit(self.case)
        low, high = max(low, least), min(high, most)
        if low > high and self.failed:
            low, high = least, most  # an operand saturated
        if low > high:
            raise RangeError(f"{node.name}: its interval contradicts the rule '{rule.why}'")
        floor, ceiling = rule.word(self.case)
        error = min(error, rule.error(self.case))
        return self._fit(node, Bound(low, high, error, max(word[0], floor), min(word[1], ceiling)))

    def _of_expression(self, node: Node) -> Bound:
        fmt = node.format
        if isinstance(node.within, Given) or fmt.width == 1:
            least, most = node.within.limit(self.case) if isinstance(node.within, Given) else ANYTHING
            return self._fit(node, Bound(max(fmt.low * fmt.ulp, least), min(fmt.high * fmt.ulp, most)))
        # Selections, shifts and additions are monotone in each operand while the other operands and the signs of
        # compared operands are fixed. The extremes lie at the ends of the operands' ranges or at -1, 0 or 1 within.
        ends = [int(word) for word in np.atleast_1d(node.evaluate(_grid(node, self._corners)))]
        word = min(ends) * fmt.ulp, max(ends) * fmt.ulp
        if node.decision:
            return self._rule(node, *word, 0.0)
        exact = np.atleast_1d(node.op.real_result(node, _grid(node, self._ends))) * fmt.ulp
        error = node.op.growth(node, self.bounds)
        return self._rule(node, float(np.min(exact)), float(np.max(exact)), error, word)

    def _corners(self, node: Node) -> list[int]:
        ulp = node.format.ulp
        low, high = (round(v / ulp) for v in on_grid(self.bounds[node.name].word, node.format))
        return sorted({low, high, *(v for v in (-1, 0, 1) if low <= v <= high)})

    def _ends(self, node: Node) -> list[float]:
        bound, ulp = self.bounds[node.name], node.format.ulp
        return sorted({bound.low / ulp, bound.high / ulp, min(max(0.0, bound.low), bound.high) / ulp})


def _grid(node: Node, corners) -> dict[str, np.ndarray]:
    """Return a dict: operand of a node -> array; the arrays together list all combinations of ``corners(operand)``."""
    columns = zip(*itertools.product(*(corners(operand) for operand in node.operands)), strict=True)
    return {operand.name: np.array(column) for operand, column in zip(node.operands, columns, strict=True)}


def on_grid(word: tuple[float, float], fmt: Format) -> tuple[float, float]:
    """Return the values of the lowest and the highest word of ``fmt`` inside the range ``word``."""
    low = math.ceil((word[0] - SLACK * abs(word[0])) / fmt.ulp)
    high = math.floor((word[1] + SLACK * abs(word[1])) / fmt.ulp)
    return low * fmt.ulp, max(low, high) * fmt.ulp


# -- over all cases --------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Proved:
    """Proved range of a paper node's word over all inputs, and proved bound of the word's error in ulps."""

    node: Node
    low: float
    high: float
    error_ulps: float


@cache
def analyse(width: int) -> tuple[dict[str, Proved], dict[str, str]]:
    """Return two dicts for the paper dataflow: node -> proved range, and node that does not fit -> one-line message."""
    runs = [Ranges(width, case) for case in cases(width)]
    failed = {name: line for run in reversed(runs) for name, line in run.failed.items()}  # the first case wins
    table = {}
    for name, node in dataflow("paper", width).nodes.items():
        ranges = [on_grid(run.proved[name].word, node.format) for run in runs]
        error = max(run.proved[name].error for run in runs) / node.format.ulp
        table[name] = Proved(node, min(r[0] for r in ranges), max(r[1] for r in ranges), error)
    return table, failed


# -- lean dataflow -----------------------------------------------------------------------------------------------------


class LeanRanges:
    """Bounds of the lean dataflow or of the whole arm, by node name; ``failed``: node that does not fit its format ->
    message."""

    def __init__(self, width: int, datapath: str = "lean") -> None:
        self.flow, self.bounds, self.failed = dataflow(datapath, width), dict[str, Bound](), dict[str, str]()
        for node in self.flow.nodes.values():
            taken = (self.flow.nodes[name] for name in node.as_words)
            exact = {operand.name: Bound(*on_grid(self.bounds[operand.name].word, operand.format)) for operand in taken}
            self.bounds[node.name] = bound = self._bound(node, self.bounds | exact)
            fmt, (least, most) = node.format, bound.word
            if isinstance(node.within, Within) and node.within.below:
                least, most = bound.low, bound.high - fmt.ulp
            if node.frac and (least < fmt.low * fmt.ulp or most >= (fmt.high + 1) * fmt.ulp and not node.limited):
                self.failed[node.name] = unfit(node, least, most)

    def _bound(self, node: Node, operands: Mapping[str, Bound]) -> Bound:
        fmt = node.format
        if node.kind == "input":
            return Bound((1 if node.name in ARMS else fmt.low) * fmt.ulp, fmt.high * fmt.ulp)
        if not node.frac:
            return Bound(0.0, getattr(node.op, "most", float(fmt.high)))
        if not isinstance(node.within, Within):
            raise RangeError(f"{node.name}: the dataflow states no range")
        error = 0.0 if node.decision else UP * node.op.growth(node, operands)  # decisions are exact integers
        if node.op.adds_rounding:
            error = UP * (error + max(map(abs, node.error)) * fmt.ulp)
        bound = Bound(node.within.low, node.within.high, error)
        return replace(bound, floor=0.0) if node.kind == "vector" and not fmt.signed else bound  # a length
