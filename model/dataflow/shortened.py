# SPDX-License-Identifier: Apache-2.0
"""The paper's datapath with words of single nodes shortened: what the search for word lengths runs.

A node that is cut by c bits is rounded c places higher, by its own rule, and ends in c zeros: places and formats stay,
and what is downstream needs no change.
"""

from __future__ import annotations

from collections.abc import Mapping

from . import fixed
from .nodes import FLOOR, HALF_UP, Format

MOST = 14
"""Bits that a node can lose: so many leave every shift of a divider and a root a shift to the left."""

ROTATED = (-2.8, 2.8)
"""What a shorter CORDIC adds, in its ulps: what it does at any length, and the places of the angle that it cuts off,
less than pi/4 ulps of a sine."""

ROUNDINGS = {"mul": HALF_UP, "sum": HALF_UP, "div": FLOOR, "root": FLOOR, "normalize": FLOOR, "sincos": ROTATED}
"""Operation -> what it adds once it drops places."""


class Shortened(fixed.Bits):
    """Runs the paper's dataflow in integers; ``cuts`` maps names of nodes to the bits that they lose.

    A node's ``error`` is in places of the whole word, as :mod:`model.bounds.predict` wants it.
    """

    def __init__(self, width: int, cuts: Mapping[str, int]) -> None:
        super().__init__(width, "paper")
        self.cuts = cuts

    def _short(self, name: str, fmt: Format) -> tuple[int, Format]:
        cut = self.cuts.get(name, 0)
        return cut, Format(fmt.width - cut, fmt.frac - cut, "", fmt.signed)

    def make(self, name, op, operands, fmt, latency, value, after=None, error=(0.0, 0.0)):
        cut = self.cuts.get(name, 0)
        if cut:
            low, high = ROUNDINGS.get(op, error)
            error = low * 2**cut, high * 2**cut
        return super().make(name, op, operands, fmt, latency, value, after, error)

    def apply(self, name, operands, fmt, bits, real):
        cut = self.cuts.get(name, 0)
        return (super().apply(name, operands, fmt, bits, real) >> cut) << cut

    def product(self, name, a, b, fmt, scale):
        cut, short = self._short(name, fmt)
        return super().product(name, a, b, short, scale) << cut

    def total(self, name, signs, nodes, fmt):
        cut, short = self._short(name, fmt)
        return super().total(name, signs, nodes, short) << cut

    def quotient(self, name, n, d, fmt):
        cut, short = self._short(name, fmt)
        return super().quotient(name, n, d, short) << cut

    def square_root(self, name, n, fmt):
        cut, short = self._short(name, fmt)
        return super().square_root(name, n, short) << cut

    def mantissa(self, name, word, words, counts, fill):
        cut = self.cuts.get(name, 0)
        return (super().mantissa(name, word, words, counts, fill) >> cut) << cut

    def cordic(self, names, phi):
        cut = self.cuts.get(names[0], 0)
        return tuple(value << cut for value in fixed.cordic(phi.value >> cut, self.width - cut))
