# SPDX-License-Identifier: Apache-2.0
"""Proved ranges: the dataflows run on intervals, over every input word, with geometry as rules.

A node's :class:`Bound` is the interval of exact arithmetic (``low``, ``high``) and the largest rounding error of its
word (``error``), propagated forward: the operation's own rounding plus the operands' errors, multiplied by the largest
other operand.  The word lies within the sum of both, which must fit the format.  Geometry's ranges, error growth and
intended saturation are stated at the nodes (:mod:`model.dataflow.annotations`), each with its reason.

* :class:`Ranges`, of the paper's dataflow: plain intervals, which a rule narrows at single nodes.  The input words are
  split into :func:`model.dataflow.annotations.cases`; a node's range is the union over them.
* :class:`LeanRanges`, of the lean dataflow and the whole arm: every range is stated, and `make formal` proves ranges
  and errors (``tb/formal/lean_proofs.py``).  Unused words of a clamped target (K and its dependents) or a bad hand (its
  products) may lose high bits.
"""

import itertools
import math
from dataclasses import dataclass, replace
from functools import cache, reduce

import numpy as np

from ..dataflow.angles import gain, length_bound
from ..dataflow.annotations import ANYTHING, Case, Given, Rule, Within, cases
from ..dataflow.datapaths import MODELS
from ..dataflow.nodes import CORDIC, EXACT, Domain, Format, Node, real_value
from ..dataflow.paper import paper
from ..io.words import ARMS

SLACK = 2.0**-48
"""Relative allowance for the double precision in which the paper's bounds themselves are computed."""

UP = 1 + 2.0**-50  # the same for the lean dataflow's errors, rounded upwards


class RangeError(Exception):
    """Proved range that does not fit the node's format; the text names the node."""


@dataclass(frozen=True)
class Bound:
    """Exact arithmetic gives [low, high]; the word is within ``error`` of it and within [floor, ceiling], the
    operation's range on its operands' words."""

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


class Intervals(Domain):
    """Dataflow on intervals.  ``failed`` collects the nodes that do not fit, each with a line that names it;
    ``formats`` replaces the dataflow's formats for single nodes."""

    def __init__(self, width: int, formats: dict[str, Format] | None = None) -> None:
        super().__init__(width)
        self.formats = formats or {}
        self.failed: dict[str, str] = {}

    def _fail(self, name: str, fmt: Format, low: float, high: float, where: str = "") -> None:
        self.failed[name] = (
            f"{name} {self._equation}: proved range [{low:.9g}, {high:.9g}] does not fit its format "
            f"[{fmt.low * fmt.ulp:.9g}, {fmt.high * fmt.ulp:.9g}], {fmt.width} bits, {fmt.frac} of them fraction "
            f"(W = {self.width}{where})"
        )


class Ranges(Intervals):
    """Paper's dataflow over one :class:`Case`.  ``saturated`` collects the nodes that saturate by design."""

    def __init__(self, width: int, case: Case, formats: dict[str, Format] | None = None) -> None:
        super().__init__(width, formats)
        self.case = replace(case, elbow=self.word(1).ulp)
        self.saturated: set[str] = set()
        self.proved: dict[str, Bound] = {}

        def word(name, fmt):
            least = 1 if name in ARMS and not self.case.clamped else fmt.low
            return self._fit(name, Bound(least * fmt.ulp, fmt.high * fmt.ulp), fmt)

        paper(self, self.inputs(word))

    def _fit(self, name: str, bound: Bound, fmt: Format) -> Bound:
        """Check a bound against the format; a bound that does not fit is recorded and limited to the format's range."""
        fmt = self.formats.get(name, fmt)
        floor, ceiling = fmt.low * fmt.ulp, fmt.high * fmt.ulp
        low, high = bound.word
        slack = SLACK * max(abs(low), abs(high))
        # A word lies on the format's grid: a value less than an ulp beyond the last one is the last one.
        if math.ceil((low + slack) / fmt.ulp) < fmt.low or math.floor((high - slack) / fmt.ulp) > fmt.high:
            limited = self.facts[name].limited
            if limited is None or limited.clamped and not self.case.clamped:
                self._fail(name, fmt, low, high, f", case {self.case.name}")
            else:
                self.saturated.add(name)
                bound = replace(bound, floor=floor, ceiling=ceiling)
        self.proved[name] = bound
        # Words outside the format saturate.  Saturation only moves a word closer to its exact value, unless the exact
        # value is itself outside.
        if bound.low < floor or bound.high > ceiling:
            return Bound(max(bound.low, floor), min(bound.high, ceiling), bound.error, floor, ceiling)
        return replace(bound, floor=max(bound.floor, floor), ceiling=min(bound.ceiling, ceiling))

    def learn(self, fact):
        self.case = fact(self.case)

    def restart(self, *names):
        nodes = [self.nodes[name] for name in names]
        self.case = self.case.tilted(reduce(math.hypot, (node.value.error for node in nodes)))
        for node in nodes:
            low, high = node.value.word
            node.value = replace(node.value, low=low, high=high, error=0.0)

    def _rule(self, name: str, low: float, high: float, error: float, fmt: Format, word=ANYTHING) -> Bound:
        """Return the result of an operation, narrowed by the node's rule if it has one."""
        rule = self.facts[name].within
        if not isinstance(rule, Rule):
            return self._fit(name, Bound(low, high, error, *word), fmt)
        least, most = rule.limit(self.case)
        low, high = max(low, least), min(high, most)
        if low > high and self.failed:
            low, high = least, most  # an operand saturated
        if low > high:
            raise RangeError(f"{name}: its interval contradicts the rule '{rule.why}'")
        floor, ceiling = rule.word(self.case)
        error = min(error, rule.error(self.case))
        return self._fit(name, Bound(low, high, error, max(word[0], floor), min(word[1], ceiling)), fmt)

    def _given(self, name: str, fmt: Format) -> Bound:
        given = self.facts[name].within
        least, most = given.limit(self.case) if isinstance(given, Given) else ANYTHING
        return self._fit(name, Bound(max(fmt.low * fmt.ulp, least), min(fmt.high * fmt.ulp, most)), fmt)

    # ---- the operations ------------------------------------------------------------------------------------------

    def constant(self, value, fmt):
        return Node("", "", "", "constant", (), fmt, None, 0, Bound(value, value))

    def product(self, name, a, b, fmt, scale):
        p, q = a.value, b.value
        square = a is b
        ends = [u * v * 2.0**scale for u in (p.low, p.high) for v in (q.low, q.high)]
        low = 0.0 if square and p.low <= 0 <= p.high else min(p.low**2, p.high**2) if square else min(ends)
        error = (p.size * q.error + q.size * p.error + p.error * q.error) * 2.0**scale
        rounding = 0.5 * fmt.ulp if a.format.frac + b.format.frac - scale > fmt.frac else 0.0
        words = [u * v * 2.0**scale for u in p.word for v in q.word]
        least = 0.0 if square else min(words) - rounding  # rounding half up preserves the sign
        return self._rule(name, low, max(ends), error + rounding, fmt, (least, max(words) + rounding))

    def total(self, name, signs, nodes, fmt):
        low = sum(n.value.low if s > 0 else -n.value.high for s, n in zip(signs, nodes, strict=True))
        high = sum(n.value.high if s > 0 else -n.value.low for s, n in zip(signs, nodes, strict=True))
        rounding = 0.5 * fmt.ulp if nodes[0].format.frac > fmt.frac else 0.0
        ends = ((s, *n.value.word) for s, n in zip(signs, nodes, strict=True))
        words = [(least, most) if s > 0 else (-most, -least) for s, least, most in ends]
        least = sum(w[0] for w in words)
        word = least - (rounding if least < 0 else min(rounding, least)), sum(w[1] for w in words) + rounding
        return self._rule(name, low, high, sum(n.value.error for n in nodes) + rounding, fmt, word)

    def quotient(self, name, n, d, fmt):
        p, q = n.value, d.value
        if self.facts[name].limited:
            self.saturated.add(name)
            return self._fit(name, Bound(fmt.low * fmt.ulp, fmt.high * fmt.ulp), fmt)
        least = q.word[0]
        if q.low <= 0 or least <= 0:
            raise RangeError(f"{name}: its divisor {d.name} may be 0: [{q.low:.9g}, {q.high:.9g}] +- {q.error:.3g}")
        ends = [u / v for u in (p.low, p.high) for v in (q.low, q.high)]
        rule = self.facts[name].within
        size = max(map(abs, ends))
        if isinstance(rule, Rule):
            size = min(size, max(map(abs, rule.limit(self.case))))
        words = [u / v for u in p.word for v in q.word]
        word = min(words) - fmt.ulp, max(words)
        return self._rule(name, min(ends), max(ends), (p.error + size * q.error) / least + fmt.ulp, fmt, word)

    def square_root(self, name, n, fmt):
        v = n.value
        low, high = math.sqrt(max(v.low, 0)), math.sqrt(max(v.high, 0))
        # |sqrt a - sqrt b| = |a - b| / (sqrt a + sqrt b), at most sqrt |a - b|; below 0 both roots are 0.
        ends = low + math.sqrt(max(v.word[0], 0))
        error = math.sqrt(v.error) if ends == 0 else min(v.error / ends, math.sqrt(v.error))
        word = tuple(math.sqrt(max(w, 0)) for w in v.word)
        return self._rule(name, low, high, error + fmt.ulp, fmt, (max(word[0] - fmt.ulp, 0.0), word[1]))

    def mantissa(self, name, word, words, counts, fill):
        # Exact: a shift changes the unit, not the vector.  Bounds downstream refer to the actual words.
        return self._given(name, self.word(0))

    def cordic(self, names, phi):
        fmt = self.word(1)
        return tuple(self._rule(name, -1.0, 1.0, CORDIC[1] * fmt.ulp, fmt) for name in names)

    def apply(self, name, operands, fmt, words):
        if isinstance(self.facts[name].within, Given) or fmt.width == 1:
            return self._given(name, fmt)
        # Selections, shifts and additions are monotone in each operand while the others (and the sign of a comparison's
        # operand) are fixed: the extremes lie at corners of the operands' ranges, 0 and -1 included.
        corners = [self._corners(n) for n in operands]
        grid = [np.array(c, dtype=object) for c in zip(*itertools.product(*corners), strict=True)]
        grid = [g if any(abs(v) >= 1 << 62 for v in g) else g.astype(np.int64) for g in grid]
        ends = [int(w) for w in np.atleast_1d(words(*grid))]
        word = min(ends) * fmt.ulp, max(ends) * fmt.ulp
        if self.decides(fmt):
            return self._rule(name, *word, 0.0, fmt)
        values = [sorted({n.value.low, n.value.high, min(max(0.0, n.value.low), n.value.high)}) for n in operands]
        points = [np.array(c, dtype=np.float64) for c in zip(*itertools.product(*values), strict=True)]
        exact = real_value(words, operands, points, fmt)
        low, high = float(np.min(exact)), float(np.max(exact))
        error = self.facts[name].grows([n.value.error for n in operands], fmt.ulp)
        return self._rule(name, low, high, error, fmt, word)

    def _corners(self, node: Node) -> list[int]:
        ulp = node.format.ulp
        low, high = (round(v / ulp) for v in on_grid(node.value.word, node.format))
        return sorted({low, high, *(v for v in (-1, 0, 1) if low <= v <= high)})


def on_grid(word: tuple[float, float], fmt: Format) -> tuple[float, float]:
    """Return the outermost words of ``fmt`` inside a range."""
    low = math.ceil((word[0] - SLACK * abs(word[0])) / fmt.ulp)
    high = math.floor((word[1] + SLACK * abs(word[1])) / fmt.ulp)
    return low * fmt.ulp, max(low, high) * fmt.ulp


# -- over all cases --------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Proved:
    """Properties of a node of the paper's dataflow over all inputs: range of its word, error bound in ulps."""

    node: Node
    low: float
    high: float
    error_ulps: float

    @property
    def bits_wasted(self) -> int:
        """Leading bits that only repeat the sign."""
        fmt = self.node.format
        words = (round(self.low / fmt.ulp), round(self.high / fmt.ulp))
        needed = max(w.bit_length() if w >= 0 else (~w).bit_length() for w in words)
        return max(0, fmt.width - (1 if fmt.signed else 0) - needed)


@cache
def analyse(width: int, **formats: Format) -> tuple[dict[str, Proved], dict[str, str]]:
    """Return every node's proved range at word length ``width``, and the failures: node -> one line.

    ``formats`` replaces the dataflow's formats for single nodes.
    """
    runs = [Ranges(width, case, formats) for case in cases(width)]
    failed = {name: line for run in reversed(runs) for name, line in run.failed.items()}  # of the first case
    table = {}
    for name, node in runs[0].nodes.items():
        ranges = [on_grid(run.proved[name].word, node.format) for run in runs]
        error = max(run.proved[name].error for run in runs) / node.format.ulp
        table[name] = Proved(node, min(r[0] for r in ranges), max(r[1] for r in ranges), error)
    return table, failed


def proved(width: int) -> dict[str, Proved]:
    """Return every node's proved range with the dataflow's own formats."""
    return analyse(width)[0]


def check(width: int) -> None:
    """Raise :class:`RangeError` naming every node that does not fit."""
    if failed := analyse(width)[1]:
        raise RangeError("\n".join(failed.values()))


# -- lean dataflow -----------------------------------------------------------------------------------------------------


class LeanRanges(Intervals):
    """Lean dataflow, or the whole arm around it, on bounds."""

    def __init__(self, width: int, formats: dict[str, Format] | None = None, datapath: str = "lean") -> None:
        super().__init__(width, formats)
        self.errors: dict[str, float] = {}  # by node, before :meth:`words` resets them
        path = MODELS[datapath]

        def word(name, fmt):
            return Bound((1 if name in ARMS else fmt.low) * fmt.ulp, fmt.high * fmt.ulp)

        path.flow(self, self.inputs(word, (*path.inputs, *path.side)))

    def words(self, *names):
        for node in (self.nodes[name] for name in names):
            node.value = Bound(*on_grid(node.value.word, node.format))

    def make(self, name, op, operands, fmt, latency, value, after=None, error=EXACT):
        if op in ("rsqrt", "trig", "mul3"):  # the operation states its own rounding
            value = replace(value, error=UP * (value.error + max(map(abs, error)) * fmt.ulp))
        node = super().make(name, op, operands, fmt, latency, value, after, error)
        held, self.errors[name] = self.formats.get(name, fmt), value.error
        least, most = value.word
        if isinstance(node.facts.within, Within) and node.facts.within.below:
            least, most = value.low, value.high - fmt.ulp
        if fmt.frac and (least < held.low * held.ulp or most >= (held.high + 1) * held.ulp and not node.facts.limited):
            self._fail(name, held, least, most)
        return node

    def _bound(self, name: str, error: float) -> Bound:
        within = self.facts[name].within
        if not isinstance(within, Within):
            raise RangeError(f"{name}: the dataflow does not say what exact arithmetic gives")
        return Bound(within.low, within.high, UP * error)

    def apply(self, name, operands, fmt, words):
        if self.decides(fmt):
            decided = fmt.width == 1 or fmt.frac == 0
            return Bound(0.0, float(fmt.high)) if decided else self._bound(name, 0.0)  # exact integers are not rounded
        return self._bound(name, self.facts[name].grows([n.value.error for n in operands], fmt.ulp))

    def product3(self, name, a, b, fmt, scale):
        p, q = a.value, b.value
        return self._bound(name, ((p.size + p.error) * q.error + (q.size + q.error) * p.error) * 2.0**scale)

    def even_mantissa(self, count, name, value, width, fmt):
        return Bound(0.0, width / 2 - 1), self._bound(name, fmt.ulp)

    def reciprocal_root(self, name, m, fmt, twice):
        # The slope of 1/(2 sqrt m) is at most 2 (m >= 1/4); "faithful" includes the truncated mantissa
        return self._bound(name, 0.0 if m.op == "even" else (4 if twice else 2) * m.value.error)

    def half_sincos(self, names, phi, fmt):
        return tuple(self._bound(name, 0.0) for name in names)

    def polar(self, names, x, y, sign):
        # An angle's error has no bound but half a turn: it grows as its vector gets shorter.
        length, angle = names
        if not length:
            return None, self._bound(angle, 0.0)
        longest = self._bound(length, 0.0).high / gain(self.width)
        error = length_bound(self.width, longest) * 2.0 ** -(self.width + 1)
        return replace(self._bound(length, error), floor=0.0), self._bound(angle, 0.0)  # a length is never negative
