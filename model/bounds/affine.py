# SPDX-License-Identifier: Apache-2.0
"""Proved errors at given poses: the dataflow in affine arithmetic, one symbol per rounding.

Intervals lose the origin of an error; an affine form

    value = centre + sum_n c_n e_n + rest,        every e_n in [-1, 1], |rest| <= r

keeps it.  e_n is the rounding of node n, so a rounding that reaches a node by two paths is added with its signs and
cancels where the equations cancel it.  Nonlinear parts (products of two errors, the curvature of a root or a
quotient) go into ``rest`` with a proved bound.  At a pose the result encloses every output of the RTL; over whole
ranges of inputs, where terms take every sign, intervals (:mod:`model.bounds.ranges`) are as good.

Decisions (shift counts, masks) are taken from the integer run.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..dataflow import fixed
from ..dataflow.nodes import Domain, Node
from ..dataflow.paper import sections
from ..dataflow.reals import Real

SLACK = 2.0**-50
"""Relative allowance for the double precision in which the forms are computed."""


@dataclass(frozen=True)
class Form:
    """Affine form at N poses: ``centre`` (N,), ``terms`` symbol -> (N,), ``rest`` (N,) >= 0."""

    centre: np.ndarray
    terms: dict[str, np.ndarray]
    rest: np.ndarray

    @classmethod
    def exact(cls, value) -> Form:
        """Return a value without error."""
        value = np.asarray(value, dtype=np.float64)
        return cls(value, {}, np.zeros_like(value))

    @property
    def radius(self) -> np.ndarray:
        """Largest distance from the centre, (N,)."""
        return sum((np.abs(c) for c in self.terms.values()), self.rest)

    def __neg__(self) -> Form:
        return self.linear(-1.0)

    def __add__(self, other: Form) -> Form:
        terms = dict(self.terms)
        for name, c in other.terms.items():
            terms[name] = terms[name] + c if name in terms else c
        centre = self.centre + other.centre
        return Form(centre, terms, self.rest + other.rest + SLACK * np.abs(centre))

    def __sub__(self, other: Form) -> Form:
        return self + -other

    def __mul__(self, other: Form) -> Form:
        """Return the product; the product of both radii goes into the rest."""
        terms = {name: c * other.centre for name, c in self.terms.items()}
        for name, c in other.terms.items():
            terms[name] = terms[name] + c * self.centre if name in terms else c * self.centre
        rest = self.rest * np.abs(other.centre) + other.rest * np.abs(self.centre) + self.radius * other.radius
        centre = self.centre * other.centre
        return Form(centre, terms, rest + SLACK * np.abs(centre))

    def linear(self, slope, centre=None, rest=0.0) -> Form:
        """Return slope (value - centre) + ``centre`` (default: slope times the centre), adding ``rest`` to the rest."""
        centre = slope * self.centre if centre is None else centre
        terms = {name: c * slope for name, c in self.terms.items()}
        return Form(centre, terms, self.rest * np.abs(slope) + rest + SLACK * np.abs(centre))

    def inverse(self) -> Form:
        """Return 1 / value: the tangent, plus curvature r^2 / (v^2 (v - r)); the rest is infinite where 0 is inside."""
        v, r = self.centre, self.radius
        least = np.abs(v) - r
        curved = np.where(least > 0, r**2 / (v**2 * np.where(least > 0, least, 1.0)), np.inf)
        return self.linear(-1.0 / v**2, 1.0 / v, curved)

    def root(self) -> Form:
        """Return sqrt(value): the tangent and its curvature; where 0 is inside, everything is rest."""
        v, r = self.centre, self.radius
        least = v - r
        tangent = least > 0
        safe = np.where(tangent, v, 1.0)
        curved = r**2 / (8 * np.where(tangent, least, 1.0) ** 1.5)
        whole = np.sqrt(np.maximum(v + r, 0.0))
        slope = np.where(tangent, 0.5 / np.sqrt(safe), 0.0)
        return self.linear(slope, np.where(tangent, np.sqrt(safe), whole / 2), np.where(tangent, curved, whole / 2))

    def rounded(self, name: str, error: tuple[float, float], ulp: float) -> Form:
        """Add the rounding of node ``name``, ``error`` ulps, as its own symbol."""
        low, high = error
        if low == high == 0.0:
            return self
        terms = {**self.terms, name: np.full_like(self.centre, (high - low) / 2 * ulp)}
        return Form(self.centre + (low + high) / 2 * ulp, terms, self.rest)


class Affine(Domain):
    """Dataflow in affine forms at the poses of ``bits``; the input words are exact."""

    def __init__(self, bits: fixed.Bits) -> None:
        super().__init__(bits.width, tile=bits.tile)
        self.bits = bits
        self.exact = {name: node.value for name, node in Real(bits, {}).nodes.items()}
        for name, node in bits.nodes.items():
            if node.section == "guard":
                value = Form.exact(node.value * node.format.ulp if node.format.signed else node.value)
                # The guard rounds in integers, so its words are exact here.
                self.nodes[name] = Node(**{**node.__dict__, "value": value})
        sections(self, self.nodes["phi"])

    def make(self, name, op, operands, fmt, latency, value, after=None, error=(0.0, 0.0)):
        if isinstance(value, Form):
            value = value.rounded(name, error, fmt.ulp)
        return super().make(name, op, operands, fmt, latency, value, after, error)

    def constant(self, value, fmt):
        return Node("", "", "", "constant", (), fmt, None, 0, Form.exact(value))

    def apply(self, name, operands, fmt, bits, real):
        if real is None:
            return Form.exact(self.bits.nodes[name].value)
        forms = [n.value for n in operands]
        # Selections, sign changes, limits and additions are piecewise linear: the step of each symbol gives its slope.
        # The ends of each operand's range must lie on the same piece; any difference is uncertainty.  A mask has no
        # error.
        centres = [f.centre for f in forms]
        centre = real(*centres)
        terms: dict[str, np.ndarray] = {}
        rest = spread = np.zeros_like(centre, dtype=np.float64)
        for k, form in enumerate(forms):
            radius = form.radius
            if not radius.any():
                continue
            ends = [real(*centres[:k], centres[k] + side * radius, *centres[k + 1 :]) - centre for side in (1, -1)]
            slope = np.divide(ends[0] - ends[1], 2 * radius, out=np.zeros_like(radius), where=radius > 0)
            rest = rest + np.where(slope == 0, 0.0, np.abs(slope) * form.rest)
            spread = spread + np.abs(ends[0] + ends[1])
            for symbol, c in form.terms.items():
                terms[symbol] = terms.get(symbol, 0.0) + slope * c
        return Form(centre, terms, rest + spread + SLACK * np.abs(centre))

    def product(self, name, a, b, fmt, scale):
        return (a.value * b.value).linear(2.0**scale)

    def total(self, name, signs, nodes, fmt):
        first, *others = (n.value if s > 0 else -n.value for s, n in zip(signs, nodes, strict=True))
        return sum(others, first)

    def quotient(self, name, n, d, fmt):
        return n.value * d.value.inverse()

    def square_root(self, name, n, fmt):
        return n.value.root()

    def mantissa(self, name, word, words, counts, fill):
        empty = np.logical_and.reduce([w.value == 0 for w in self.bits.nodes[name].operands])
        slope = np.where(empty, 0.0, 2.0 ** (counts.value.centre - (word.format.width - 1 - word.format.frac)))
        return word.value.linear(slope, np.where(empty, 0.5 if fill else 0.0, slope * word.value.centre))

    def cordic(self, names, phi):
        half = phi.value.centre * (np.pi / 2)
        return Form.exact(np.sin(half)), Form.exact(np.cos(half))

    def error_ulps(self, name: str) -> np.ndarray:
        """Return the largest distance of a node's word from exact arithmetic on the guard's words, (N,) ulps."""
        form = self.nodes[name].value
        with np.errstate(invalid="ignore"):
            bound = form.radius + np.abs(form.centre - self.exact[name])
        return _known(bound) / self.nodes[name].format.ulp

    def hand(self, d1, d2) -> tuple[Form, Form, Form]:
        """Return the wrist of an arm d1, d2 (N,): :func:`model.reference.kinematics.forward` in affine forms."""
        w, i, j, k, e_w, e_i = (self.nodes[f"q{s}_{u}"].value for s, u in zip("ssssee", "wijkwi", strict=True))
        # Qe (-d2 e3) Qe~ = d2 (0, 2 w i, i^2 - w^2)
        v_y = (e_w * e_i).linear(2 * d2)
        v_z = (e_i * e_i - e_w * e_w).linear(d2) + Form.exact(d1)
        two = 2.0
        x = (i * j - w * k).linear(two) * v_y + (i * k + w * j).linear(two) * v_z
        y = (w * w - i * i + j * j - k * k) * v_y + (j * k - w * i).linear(two) * v_z
        z = (j * k + w * i).linear(two) * v_y + (w * w - i * i - j * j + k * k) * v_z
        return x, y, z


def _known(bound: np.ndarray) -> np.ndarray:
    """Replace NaN, an unbounded term times zero, by infinity."""
    return np.where(np.isnan(bound), np.inf, bound)


POSES = 1000
"""Number of poses per pass of :func:`hand_bound`."""


def hand_bound(words: np.ndarray, width: int) -> np.ndarray:
    """Return a proved upper bound of hand error / reach for input words (N, 6); shape (N,), infinite where unproved.

    The error is measured from the target before it was rounded to input words, half an ulp each.
    """
    length = 2.0 ** (2 - width)
    bounds = []
    for start in range(0, len(words), POSES):
        part = words[start : start + POSES]
        d1, d2 = part[:, 4] * length, part[:, 5] * length
        with np.errstate(all="ignore"):
            wrist = Affine(fixed.run(part, width).bits).hand(d1, d2)
            far = [np.abs(f.centre - part[:, a] * length) + f.radius for a, f in enumerate(wrist)]
        bounds.append((_known(np.linalg.norm(far, axis=0)) + (np.sqrt(3) / 2 + 1) * length) / (d1 + d2))
    return np.concatenate(bounds)
