# SPDX-License-Identifier: Apache-2.0
"""Proved ranges of the lean dataflow: no node overflows for any reachable target.

A node's :class:`Bound` holds its exact range, from geometry, and the largest rounding error of its word: the
operation's own rounding plus the operands' errors, multiplied by the largest other operand.  The word lies within the
sum of both, which must fit the format.  Geometry's ranges (:class:`.annotations.Within`) and error growth are stated
at the nodes, in :mod:`model.dataflow.lean`; `make formal` proves both (``tb/formal/lean_proofs.py``).

Clamped targets are excluded: some of their words (K and its dependents) lose high bits and are unused.
"""

from __future__ import annotations

from dataclasses import replace

from ..dataflow.annotations import Within
from ..dataflow.lean import lean
from ..dataflow.nodes import Domain, Format
from ..io.words import ARMS
from .ranges import Bound, RangeError

UP = 1 + 2.0**-50
"""Relative allowance for the double precision in which errors are computed, rounded upwards."""


class LeanRanges(Domain):
    """Lean dataflow on bounds.  ``failed`` collects the nodes that do not fit, each with a line that names it."""

    def __init__(self, width: int, formats: dict[str, Format] | None = None) -> None:
        super().__init__(width)
        self.formats = formats or {}
        self.failed: dict[str, str] = {}

        def word(name, fmt):
            return Bound(fmt.ulp if name in ARMS else fmt.low * fmt.ulp, fmt.high * fmt.ulp)

        lean(self, self.inputs(word))

    def make(self, name, op, operands, fmt, latency, value, after=None, error=(0.0, 0.0)):
        if op in ("rsqrt", "trig", "mul3"):  # the operation states its own rounding
            value = replace(value, error=UP * (value.error + max(map(abs, error)) * fmt.ulp))
        node = super().make(name, op, operands, fmt, latency, value, after, error)
        held = self.formats.get(name, fmt)
        low, high = held.low * held.ulp, held.high * held.ulp
        least, most = value.word
        if isinstance(node.facts.within, Within) and node.facts.within.below:
            least, most = value.low, value.high - fmt.ulp
        if fmt.frac and (least < low or most >= high + held.ulp and not node.facts.limited):
            self.failed[name] = (
                f"{name} {node.equation}: proved range [{value.low:g}, {value.high:g}] +- {value.error:.3g} does not "
                f"fit its format [{low:.9g}, {high:.9g}], {held.width} bits, {held.frac} of them fraction "
                f"(W = {self.width})"
            )
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


def check(width: int) -> None:
    """Raise :class:`RangeError` naming every node that does not fit."""
    if failed := LeanRanges(width).failed:
        raise RangeError("\n".join(failed.values()))
