# SPDX-License-Identifier: Apache-2.0
"""Proved ranges of the lean dataflow, for every reachable target: nothing in it can overflow.

A node's :class:`Bound` holds what exact arithmetic can give, from geometry (:data:`EXACT`: sines, cosines, unit
quaternions, mantissas), and how far rounding can have taken the word from it: each operation's own rounding and what
its operands bring, multiplied by the largest other operand.  The word is within the sum of both, and that must fit.

Targets that are clamped are left out: of them some words are cut off (K and what is computed from it) and not used.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from model.bounds.ranges import RangeError
from model.dataflow.lean import lean
from model.dataflow.nodes import Domain, Format, Node
from model.targets.words import FIELDS

SIGNED, POSITIVE = (-1.0, 1.0), (0.0, 1.0)
INVERSE = (0.0, 1.0)  # 1/(2 sqrt m), m in [1/4, 1); 0 where m = 0


@dataclass(frozen=True)
class Bound:
    """Exact arithmetic gives [low, high], and the word is within ``error`` of it."""

    low: float
    high: float
    error: float = 0.0

    @property
    def size(self) -> float:
        """Largest magnitude of the word."""
        return max(abs(self.low), abs(self.high)) + self.error


def _named(limits: tuple[float, float], *names: str) -> dict[str, tuple[float, float]]:
    return dict.fromkeys(names, limits)


RULES = {
    "squares of words in [-2, 2)": {
        **_named((0.0, 4.0), "x_sq", "y_sq", "z_sq", "d_dif_sq"), "rho_sq": (0.0, 8.0), "s": (0.0, 12.0),
        "d_sum_sq": (0.0, 16.0), "sum_dif": (-4.0, 4.0),
        "a_far": (0.0, 16.0), "b_near": (0.0, 12.0), "k_law": (-4.0, 16.0),
        "d_sum": (0.0, 4.0), "d_dif": (-2.0, 2.0),
    },
    "mantissa": {**_named((0.0, 1.0), *(f"m_{k}" for k in ("rho", "s", "far", "near", "1", "2"))), "m_q": (0.25, 1.0)},
    "1/(2 sqrt m) with m >= 1/4": _named(INVERSE, *(f"inv_{k}" for k in ("rho", "s", "far", "near", "1", "2", "q"))),
    "coordinates are no longer than the vector": _named(SIGNED, "x_n", "y_n", "z_n"),
    "a sine or cosine": {**_named(SIGNED, "u_x", "u_y", "sin_el", "cos_a", "sin_h"),
                         **_named(POSITIVE, "cos_el", "sin_a", "cos_h")},
    "the root of a mantissa": _named(POSITIVE, "root_rho", "root_far", "root_near", "root_ab"),
    "e_rho >= e_s, because rho <= |p|": _named(POSITIVE, "inv_s_el"),
    "(1 + |c|)/2": _named((0.5, 1.0), "az_sq", "tilt_sq", "arm_sq"),
    "a product of such": {"az_tilt_sq": (0.25, 1.0), "length_sq": (0.125, 1.0)},
    "half angles: squared length (1 + |c|)/2": _named(
        SIGNED, *(f"{k}_{p}" for k in ("az", "tilt", "arm") for p in "cs")
    ),
    "products of inverses": _named(POSITIVE, "inv_12", "inv_11"),
    "inv_law = 2 inv_11 inv_s": _named((0.0, 2.0), "inv_law_raw", "inv_law"),
    "sqrt A <= 2 sqrt(d1 d2), and root_far >= 1/2": _named(
        (0.0, 2.0), "inv_12_far_raw", "inv_12_near_raw", "inv_12_far", "inv_12_near"
    ),
    "sin a <= 1, and root_ab >= 1/4": _named((0.0, 2.0), "inv_law_ab_raw", "inv_law_ab"),
    "|K| <= 2 d1 |p|, and inv_law > 1/4": {"k_scaled": (-2.0, 2.0)},
    "a component of Qe": {**_named(POSITIVE, "elbow_w", "elbow_i", "qe_w"), "qe_i": (-1.0, 0.0)},
    "parts of quaternions no longer than 1": _named(
        SIGNED, "cc", "ss", "sc", "cs", "c_plus", "c_minus", "s_plus", "s_minus",
        *(f"{u}_{k}" for u in "wijk" for k in ("0", "c", "s", "1", "n", "q")), *(f"qs_{u}" for u in "wijk"),
    ),
}  # fmt: skip
"""Why -> node -> (low, high) in exact arithmetic."""

EXACT = {name: limits for rule in RULES.values() for name, limits in rule.items()}
WHY = {name: why for why, rule in RULES.items() for name in rule}

STEEP = {"inv_12_far_raw": 8.0, "inv_12_near_raw": 8.0, "inv_law_ab_raw": 4.0}
"""Shifts that can enlarge a word, and by how much at most: what is shifted is at least 1/4 and comes out at most 2
(inv_12), or is shifted by at most 2 places (inv_law)."""


LIMITED = ("m_q", "inv_12_far", "inv_12_near", "inv_law_ab", "inv_law")
"""Nodes in which the largest word stands for what is larger."""

CUT = ("m_rho", "m_s", "m_far", "m_near", "m_1", "m_2", "x_n", "y_n", "z_n", "k_scaled", "d_sum")
"""Nodes that are exact or cut off, never rounded up, of numbers in their format: below 1, 2 (k_scaled), 4 (d_sum)."""


def _fits(bound: Bound, fmt: Format, limited: bool) -> bool:
    low, high = fmt.low * fmt.ulp, (fmt.high + 1) * fmt.ulp
    if bound.low - bound.error < low:
        return False
    return limited or bound.high + bound.error < high


class LeanRanges(Domain):
    """The lean dataflow on bounds.  ``failed`` collects the nodes that do not fit, each with a line that names it."""

    def __init__(self, width: int, formats: dict[str, Format] | None = None) -> None:
        super().__init__(width)
        self.formats = formats or {}
        self.failed: dict[str, str] = {}
        target = {}
        for name in FIELDS:
            fmt = self.word(0) if name == "phi" else self.word(1)
            bound = Bound(fmt.ulp if name in ("d1", "d2") else fmt.low * fmt.ulp, fmt.high * fmt.ulp)
            target[name] = self.make(name, "input", (), fmt, None, bound)
        lean(self, target)

    def make(self, name, op, operands, fmt, latency, value, after=None, error=(0.0, 0.0)):
        if op in ("rsqrt", "trig", "mul3"):  # the rounding that the dataflow itself states
            value = replace(value, error=value.error + max(map(abs, error)) * fmt.ulp)
        node = super().make(name, op, operands, fmt, latency, value, after, error)
        held = self.formats.get(name, fmt)
        if fmt.frac and not _fits(replace(value, error=0.0, high=value.high - fmt.ulp) if name in CUT else value,
                                  held, name in LIMITED):  # fmt: skip
            low, high = held.low * held.ulp, held.high * held.ulp
            self.failed[name] = (
                f"{name} {node.equation}: proved range [{value.low:g}, {value.high:g}] +- {value.error:.3g} does not "
                f"fit its format [{low:.9g}, {high:.9g}], {held.width} bits, {held.frac} of them fraction "
                f"(W = {self.width})"
            )
        return node

    def _bound(self, name: str, carried: float, fmt: Format, error: tuple[float, float]) -> Bound:
        if name not in EXACT:
            raise RangeError(f"{name}: no rule says what exact arithmetic gives")
        return Bound(*EXACT[name], carried + max(map(abs, error)) * fmt.ulp)

    def constant(self, value, fmt):
        raise NotImplementedError

    def apply(self, name, operands, fmt, bits, real):
        if real is None:
            decided = fmt.width == 1 or fmt.frac == 0
            return Bound(0.0, float(fmt.high)) if decided else Bound(*EXACT[name])  # exact integers are not rounded
        carried = [n.value.error for n in operands if n.format.frac]
        if name in STEEP:
            return self._bound(name, STEEP[name] * carried[0], fmt, (-1.0, 0.0))
        if name in ("w_n", "i_n", "j_n", "k_n"):
            return self._bound(name, 2 * carried[0], fmt, (0.0, 0.0))  # doubled where the length is below 1/4
        if name in ("c_plus", "c_minus", "s_plus", "s_minus", "w_1", "i_1", "j_1", "k_1"):
            return self._bound(name, sum(carried), fmt, (0.0, 0.0))
        if name == "m_q":
            return Bound(*EXACT[name], 4 * carried[0] + fmt.ulp)  # the largest word stands for 1
        return self._bound(name, max(carried, default=0.0), fmt, (-1.0, 1.0))

    def product3(self, name, a, b, fmt, scale):
        p, q = a.value, b.value
        return self._bound(name, (p.size * q.error + q.size * p.error) * 2.0**scale, fmt, (0.0, 0.0))

    def even_mantissa(self, name, value, width, fmt):
        return Bound(0.0, width / 2 - 1), self._bound(name, 0.0, fmt, (-1.0, 0.0))

    def reciprocal_root(self, name, m, fmt):
        # 1/(2 sqrt m) is at most 2 times as steep as m is off (m >= 1/4); a mantissa cut off is part of "faithful"
        return self._bound(name, 0.0 if m.op == "even" else 2 * m.value.error, fmt, (0.0, 0.0))

    def half_sincos(self, phi, fmt):
        return tuple(self._bound(name, 0.0, fmt, (0.0, 0.0)) for name in ("sin_h", "cos_h"))

    # operations of the paper's datapath only
    overflowed = product = total = quotient = square_root = mantissa = sincos = constant


def check(width: int) -> None:
    """Raises :class:`RangeError` naming every node that does not fit."""
    failed = LeanRanges(width).failed
    if failed:
        raise RangeError("\n".join(failed.values()))


def error_ulps(node: Node) -> float:
    """The proved error of a node's word, in its ulps."""
    return node.value.error / node.format.ulp
