# SPDX-License-Identifier: Apache-2.0
"""Proved ranges: the dataflow run on intervals, over every input word, with geometry as named rules.

A node's :class:`Bound` is the interval of exact arithmetic (``low``, ``high``) and the largest rounding error of its
word (``error``), propagated forward.  Plain intervals ignore geometry, so at single nodes a
:class:`~model.dataflow.annotations.Rule` narrows the exact range; each rule states its reason in a sentence.  The
rules, error growth and intended saturation are stated at the nodes, in :mod:`model.dataflow.paper`.

The input words are split into :func:`model.dataflow.annotations.cases`; a node's range is the union over them.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace
from functools import cache, reduce

import numpy as np

from ..dataflow.annotations import ANYTHING, Case, Given, Rule, cases
from ..dataflow.nodes import CORDIC, Domain, Format, Node, real_value
from ..dataflow.paper import paper
from ..io.words import ARMS

SLACK = 2.0**-48
"""Relative allowance for the double precision in which the bounds themselves are computed."""


EITHER = Given("", lambda case: ANYTHING)
"""Range of an unknown mask."""


class RangeError(Exception):
    """Proved range that does not fit the node's format; the text names the node."""


@dataclass(frozen=True)
class Bound:
    """Exact arithmetic gives [low, high]; the word is within ``error`` of it and within [floor, ceiling], the
    operation's range on its operands' words.  ``rule`` is the rule that narrowed it, if any."""

    low: float
    high: float
    error: float = 0.0
    rule: str = ""
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


class Ranges(Domain):
    """Dataflow on intervals over one :class:`Case`.  ``failed`` collects the nodes that do not fit."""

    def __init__(self, width: int, case: Case, formats: dict[str, Format] | None = None) -> None:
        super().__init__(width)
        self.case = replace(case, elbow=self.word(1).ulp)
        self.formats = formats or {}
        self.failed: dict[str, str] = {}
        self.proved: dict[str, Bound] = {}

    def run(self) -> Ranges:
        """Run the whole datapath."""

        def word(name, fmt):
            least = 1 if name in ARMS and not self.case.clamped else fmt.low
            return self._fit(name, Bound(least * fmt.ulp, fmt.high * fmt.ulp), fmt)

        paper(self, self.inputs(word))
        return self

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
                self.failed[name] = (
                    f"{name} {self._equation}: proved range [{low:.9g}, {high:.9g}] does not fit its format "
                    f"[{floor:.9g}, {ceiling:.9g}], {fmt.width} bits, {fmt.frac} of them fraction "
                    f"(W = {self.width}, case {self.case.name})"
                )
            else:
                bound = Bound(bound.low, bound.high, bound.error, "saturates by design", floor, ceiling)
        self.proved[name] = bound
        # Words outside the format saturate.  Saturation only moves a word closer to its exact value, unless the exact
        # value is itself outside.
        if bound.low < floor or bound.high > ceiling:
            return Bound(max(bound.low, floor), min(bound.high, ceiling), bound.error, bound.rule, floor, ceiling)
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
            return self._fit(name, Bound(low, high, error, "", *word), fmt)
        least, most = rule.limit(self.case)
        text = rule.name if least > low or most < high else ""
        low, high = max(low, least), min(high, most)
        if low > high and self.failed:
            low, high = least, most  # an operand saturated
        if low > high:
            raise RangeError(f"{name}: rule '{rule.name}' contradicts the interval")
        floor, ceiling = rule.word(self.case)
        error = min(error, rule.error(self.case))
        return self._fit(name, Bound(low, high, error, text, max(word[0], floor), min(word[1], ceiling)), fmt)

    def _given(self, name: str, fmt: Format) -> Bound:
        given = self.facts[name].within
        if not isinstance(given, Given):
            given = EITHER
        least, most = given.limit(self.case)
        low, high = max(fmt.low * fmt.ulp, least), min(fmt.high * fmt.ulp, most)
        return self._fit(name, Bound(low, high, 0.0, given.why), fmt)

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
            return self._fit(name, Bound(fmt.low * fmt.ulp, fmt.high * fmt.ulp, 0.0, "saturates by design"), fmt)
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
        grid = [g if _large(g) else g.astype(np.int64) for g in grid]
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
        low, high = (round(v / ulp) for v in _on_grid(node.value.word, node.format))
        return sorted({low, high, *(v for v in (-1, 0, 1) if low <= v <= high)})


def _on_grid(word: tuple[float, float], fmt: Format) -> tuple[float, float]:
    """Return the outermost words of ``fmt`` inside a range."""
    low = math.ceil((word[0] - SLACK * abs(word[0])) / fmt.ulp)
    high = math.floor((word[1] + SLACK * abs(word[1])) / fmt.ulp)
    return low * fmt.ulp, max(low, high) * fmt.ulp


def _large(column) -> bool:
    return any(abs(v) >= 1 << 62 for v in column)


# -- over all cases --------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Proved:
    """Properties of a node over all inputs: the range of its word, the error bound in ulps, and the rules used."""

    node: Node
    low: float
    high: float
    error_ulps: float
    rules: tuple[str, ...]

    @property
    def bits_wasted(self) -> int:
        """Leading bits that only repeat the sign."""
        fmt = self.node.format
        words = (round(self.low / fmt.ulp), round(self.high / fmt.ulp))
        needed = max(w.bit_length() if w >= 0 else (~w).bit_length() for w in words)
        return max(0, fmt.width - (1 if fmt.signed else 0) - needed)


def analyse(width: int, formats: dict[str, Format] | None = None) -> tuple[dict[str, Proved], dict[str, str]]:
    """Return every node's proved range at word length ``width``, and the failures: node -> one line.

    ``formats`` replaces the dataflow's formats for single nodes.
    """
    runs = [Ranges(width, case, formats).run() for case in cases(width)]
    failed = {name: line for run in reversed(runs) for name, line in run.failed.items()}  # of the first case
    table = {}
    for name, node in runs[0].nodes.items():
        ranges = [_on_grid(run.proved[name].word if name in run.proved else (0, 1), node.format) for run in runs]
        rules = tuple(dict.fromkeys(r.proved[name].rule for r in runs if name in r.proved and r.proved[name].rule))
        error = max(run.proved[name].error if name in run.proved else 0.0 for run in runs) / node.format.ulp
        table[name] = Proved(node, min(r[0] for r in ranges), max(r[1] for r in ranges), error, rules)
    return table, failed


@cache
def _as_built(width: int) -> tuple[dict[str, Proved], dict[str, str]]:
    return analyse(width)


def proved(width: int) -> dict[str, Proved]:
    """Return every node's proved range with the dataflow's own formats."""
    return _as_built(width)[0]


def failures(width: int) -> dict[str, str]:
    """Return the nodes whose proved range does not fit, each with one line that names it."""
    return _as_built(width)[1]


def check(width: int) -> None:
    """Raise :class:`RangeError` naming every node that does not fit."""
    if found := failures(width):
        raise RangeError("\n".join(found.values()))
