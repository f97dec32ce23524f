# SPDX-License-Identifier: Apache-2.0
"""Proved ranges: the dataflow run on intervals, over every input word, with geometry as named rules.

A node's :class:`Bound` is the interval that exact arithmetic gives (``low``, ``high``), and how far rounding can have
taken the word from it (``error``): precision, propagated forward.  Plain intervals know nothing of geometry, so at
single nodes a :class:`Rule` of :data:`RULES` narrows what exact arithmetic can give; each rule says why in a sentence.
What saturates on purpose stands in :data:`BY_DESIGN`.

The input words fall into cases (:func:`cases`) and a node's range is the union over them:

* ``exact``: in reach, and the arms leave room for a shift: their words lose nothing when they are halved;
* ``long``: in reach, d1 + d2 >= 2: halving rounds odd lengths, so d1 + d2 is off by ulps (d1 - d2 stays exact);
* ``clamped``: everything else; it takes the way of an arm d1 = d2 = 1/4 (see :func:`model.dataflow.nodes.guard`).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from model.dataflow.nodes import CORDIC, Domain, Format, Node
from model.dataflow.paper import paper
from model.targets.words import FIELDS

SQRT2, SQRT3 = math.sqrt(2), math.sqrt(3)

SLACK = 2.0**-48
"""Relative allowance for the double precision in which the bounds themselves are computed."""


class RangeError(Exception):
    """A node's proved range does not fit its format; the text names the node."""


@dataclass(frozen=True)
class Bound:
    """Exact arithmetic gives [low, high]; the word is within ``error`` of that, and within [floor, ceiling]: what the
    operation makes of its operands' words.  ``rule`` narrowed it, if any did."""

    low: float
    high: float
    error: float = 0.0
    rule: str = ""
    floor: float = -math.inf
    ceiling: float = math.inf

    @property
    def word(self) -> tuple[float, float]:
        """The range of the word's value."""
        return max(self.low - self.error, self.floor), min(self.high + self.error, self.ceiling)

    @property
    def size(self) -> float:
        """Largest magnitude in exact arithmetic."""
        return max(abs(self.low), abs(self.high))


@dataclass(frozen=True)
class Case:
    """A part of the input domain: bounds of the arms and of j in their own unit, and of |p_w| and |b|."""

    name: str
    clamped: bool
    d_high: float  # either arm
    j: tuple[int, int]
    long: bool = False  # halving may round the arms
    p: tuple[float, float] = (0.5, SQRT3)
    b: tuple[float, float] = (0.5, SQRT2)
    ulp: float = 0.0  # of the arms
    tilt: float = 0.0  # sine of the angle between p_w and the plane of the words pi_swivel

    @property
    def excess(self) -> float:
        """What rounded arms add to |k_e|: the rounding of d1 + d2, times |d1 - d2|."""
        return 4 * self.ulp if self.long else 0.0

    @property
    def k_e(self) -> float:
        """|k_e| <= 2 d1 |p_w|, and <= s_j + (d1 + d2) |d_dif_j| where arms are rounded."""
        limit = 2 * self.d_high * self.p[1] + self.excess
        return min(limit, self.p[1] ** 2 * 2.0 ** -self.j[0] + 2) if self.long else limit

    @property
    def p_e(self) -> float:
        """|p_e| = max(d1, |k_e| / 2|p_w|), the latter over the cosine of the tilt."""
        return (self.d_high + self.excess / (2 * self.p[0])) / math.sqrt(1 - self.tilt**2)

    @property
    def pp(self) -> tuple[float, float]:
        """|PP^-| = 2 |p_w| |pi_swivel|."""
        return 2 * self.p[0] * self.b[0] * math.sqrt(1 - self.tilt**2), 2 * self.p[1] * self.b[1]


EDGES_P = (0.5, math.sqrt(0.5), 1.0, SQRT2, SQRT3)
EDGES_B = (0.5, math.sqrt(0.5), 1.0, SQRT2)
"""Where the lengths of the two mantissa vectors are cut: within a part, numerators and divisors keep step."""


def cases(width: int) -> list[Case]:
    """The parts of the input domain; together they hold every input word."""
    ulp = 2.0 ** (1 - width)
    last = 1 - 2 * ulp  # d1 + d2 <= 1 - ulp, d2 >= ulp
    whole = [
        Case("exact", False, last, (0, width - 1)),
        Case("long", False, 0.5, (0, width), True),
        Case("clamped", True, 0.25, (2, 2)),
    ]
    boxes = list(itertools.product(itertools.pairwise(EDGES_P), itertools.pairwise(EDGES_B)))
    return [replace(c, p=p, b=b, ulp=ulp) for c in whole for p, b in boxes]


# -- what geometry knows ---------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Rule:
    """What geometry says of some nodes in exact arithmetic: ``limit(case)`` gives (low, high)."""

    name: str
    why: str
    nodes: tuple[str, ...]
    limit: Callable[[Case], tuple[float, float]]


def _within(size: Callable[[Case], float]) -> Callable[[Case], tuple[float, float]]:
    return lambda c: (-size(c), size(c))


def _each(pattern: str, *letters: str) -> tuple[str, ...]:
    return tuple(pattern.format(a) for a in letters)


SAME_SIGN = ("rho_x", "rho_y", "uu_x", "uu_y")
"""Products of a component with itself in another unit."""

XYZ, IJK = ("x", "y", "z"), ("i", "j", "k")


def _tmp1(c: Case) -> tuple[float, float]:
    most = (min(c.d_high, 0.5) * c.pp[1]) ** 2
    if not c.long:
        return -((c.pp[1] * c.p_e * c.tilt) ** 2), most
    # tmp1 = |pi|^2 ((2 d1 |p_w|)^2 - k_e^2): by |k_e| <= 2 d1 |p_w| + excess, or by |k_e| alone
    near = 4 * c.d_high * c.p[1] * c.excess + c.excess**2
    # Where j >= 2, |d1 - d2| <= |p_a| + ulps leaves d1 >= 1/8.
    least = (c.p[0] / 4) ** 2 if c.j[0] >= 3 else 0.0
    return -(c.b[1] ** 2) * min(near, c.k_e**2 - least) - (c.pp[1] * c.p_e * c.tilt) ** 2, most


def _t_e(c: Case) -> tuple[float, float]:
    if c.clamped:
        return 0.0, 0.75
    most = (c.p_e + 2 * c.ulp) ** 2 if c.long else 0.25 + (c.p_e * c.tilt) ** 2
    return -most, most


RULES = (
    Rule(
        "unit mantissa",
        "a vector shifted until its largest component fills the word has that component in [1/2, 1], so its squared "
        "length is in [1/4, 3] (with two components: at most 2)",
        ("s",),
        lambda c: (c.p[0] ** 2, c.p[1] ** 2),
    ),
    Rule("unit mantissa", "the same of L_m", ("tmp2",), lambda c: (0.25, 3.0)),
    Rule(
        "unit mantissa, length",
        "the root of the squared length: |p_w| and |L_m| are in [1/2, sqrt 3]",
        ("l_sw",),
        lambda c: c.p,
    ),
    Rule("unit mantissa, length", "the same of L_m", ("l_m",), lambda c: (0.5, SQRT3)),
    Rule(
        "same direction",
        "p_w and b are the same target in two units, so each p_x b_x >= 0 and the sum is |p_xy| |b| <= 2",
        (*SAME_SIGN[:2], "rho"),
        lambda c: (0.0, min(2.0, c.p[1] * c.b[1])),
    ),
    Rule("cosine", "a sine or cosine", ("sin_h", "cos_h", "sin_phi", "cos_phi", "c3"), lambda c: (-1.0, 1.0)),
    Rule("cosine", "a squared cosine, doubled", ("cos2_sq",), lambda c: (0.0, 2.0)),
    Rule(
        "|pi_swivel| = |b|",
        "the two terms of (11) are orthogonal and of length |b| |sin phi| and |b| |cos phi|, and |b| <= sqrt 2",
        _each("pi_swivel_{}", *XYZ),
        _within(lambda c: c.b[1]),
    ),
    Rule(
        "|pi_swivel| = |b|",
        "before the division by |L_sw| <= sqrt 3",
        _each("pi_num_{}", *XYZ),
        _within(lambda c: c.p[1] * c.b[1]),
    ),
    Rule(
        "|pi_swivel| = |b|",
        "squared, with |b| in [1/2, sqrt 2]",
        ("pi_sq",),
        lambda c: (c.b[0] ** 2, c.b[1] ** 2),
    ),
    Rule("|pi_swivel| = |b|", "its root", ("pi_abs",), lambda c: c.b),
    Rule("|pi_swivel| = |b|", "its inverse", ("pi_inv",), lambda c: (1 / c.b[1], 1 / c.b[0])),
    Rule(
        "arms' unit",
        "d1 + d2 is shifted to [1/2, 1); halving never makes 1 of it, since the largest length, all ones, is rounded "
        "down",
        ("d_sum",),
        lambda c: (0.5, 0.5) if c.clamped else (0.5 - c.ulp, 1 - c.ulp),
    ),
    Rule("arms' unit", "d1 d2 <= ((d1 + d2) / 2)^2", ("d_12",), lambda c: (0.0, 0.25)),
    Rule(
        "not too near",
        "|d1 - d2| <= |p|, in the target's unit <= |p_w| <= sqrt 3",
        ("d_dif_j",),
        lambda c: (0.0, 0.0) if c.clamped else (-c.p[1], c.p[1]),
    ),
    Rule(
        "target's unit",
        "2^j |p_a|^2 = |p_w| |p_a|, with |p_a| <= d1 + d2 <= 1",
        ("s_j",),
        lambda c: (0.0, min(c.p[1] ** 2 * 2.0 ** -c.j[0], c.p[1])),
    ),
    Rule(
        "triangle",
        "|p_w^2 + d1^2 - d2^2| = 2 d1 |p_w| |cos a| <= 2 d1 |p_w| by the law of cosines",
        ("k_e",),
        _within(lambda c: c.k_e),
    ),
    Rule("triangle", "times |pi_swivel| <= sqrt 2", _each("pp_{}", *IJK), _within(lambda c: c.k_e * c.b[1])),
    Rule("triangle", "(k_e |pi_swivel|)^2", ("pp_sq",), lambda c: (0.0, (c.b[1] * c.k_e) ** 2)),
    Rule(
        "Cauchy-Schwarz",
        "2 p_w x pi_swivel is no longer than 2 |p_w| |pi_swivel| <= 2 sqrt 6",
        _each("pp_{}_m", *"123"),
        _within(lambda c: c.pp[1]),
    ),
    Rule(
        "orthogonal",
        "p_w lies in the swivel plane, so |PP^-| = 2 |p_w| |pi_swivel| exactly; its square is in [1/4, 24]",
        ("inf_pp",),
        lambda c: (c.pp[0] ** 2, c.pp[1] ** 2),
    ),
    Rule("orthogonal", "d1^2 |PP^-|^2", ("pp_pm",), lambda c: (0.0, (c.d_high * c.pp[1]) ** 2)),
    Rule(
        "d1 sin a <= min(d1, d2)",
        "tmp1 = (d1 sin a)^2 |PP^-|^2, and the triangle's height over p_w is no longer than the shorter arm <= 1/2",
        ("tmp1",),
        _tmp1,
    ),
    Rule("d1 sin a <= min(d1, d2)", "its root", ("tmp_sqr",), lambda c: (0.0, math.sqrt(_tmp1(c)[1]))),
    Rule(
        "|p_e| <= d1",
        "the numerators of (13) are the components of p_e times |PP^-|^2",
        (*_each("e_{}_pp", *XYZ), *_each("e_{}_num", *XYZ)),
        _within(lambda c: c.p_e * c.pp[1] ** 2),
    ),
    Rule(
        "|p_e| <= d1",
        "the elbow is d1 away from the shoulder (with rounded arms at most |k_e| / 2|p_w|)",
        _each("e_{}_quo", *XYZ),
        _within(lambda c: c.p_e),
    ),
    Rule(
        "law of cosines",
        "|p_e (p_e - p_w)| = d1 d2 |cos| <= 1/4; rounded arms that do not reach lie on one line; clamped ones do not "
        "count",
        ("t_e",),
        _t_e,
    ),
    Rule("unit vectors", "components of a vector of length 1", _each("q12_{}", *IJK), _within(lambda c: 1.0)),
    Rule("unit vectors", "(q_k^2 + q_j^2) - q_i^2, and the three make 1", ("r_x",), _within(lambda c: 1.0)),
    Rule("unit vectors", "|(q_j, q_k)| |pi_swivel| <= sqrt 2", ("g",), _within(lambda c: c.b[1])),
    Rule("unit vectors", "|(q_j, q_k)| |side| <= sqrt 3", ("sg",), _within(lambda c: SQRT3)),
    Rule(
        "2 a b <= a^2 + b^2",
        "2 |q_i| |(q_j, q_k)| <= 1, so the product is no longer than the vector: |pi_swivel| <= sqrt 2",
        ("c3_g",),
        _within(lambda c: c.b[1]),
    ),
    Rule("2 a b <= a^2 + b^2", "the same with |side| <= sqrt 3", ("sg_g",), _within(lambda c: SQRT3)),
    Rule("unit vectors", "pi_swivel times a unit vector", ("c3_num",), _within(lambda c: c.b[1])),
    Rule("unit vectors", "the side vector times a unit vector", ("sign",), _within(lambda c: SQRT3)),
    Rule("unit vectors", "q_i c + q_j s, with c^2 + s^2 = 1", _each("qs_{}", "i", "j"), _within(lambda c: 1.0)),
    Rule("same direction", "u and p_e as well", SAME_SIGN[2:], lambda c: (0.0, SQRT3 / 2 if c.clamped else c.p_e)),
    Rule(
        "mantissa of p_e",
        "|u| |p_xy| <= sqrt 2 |p_e|",
        ("uu",),
        lambda c: (0.0, SQRT2 * (SQRT3 / 2 if c.clamped else c.p_e)),
    ),
)
"""Every piece of geometry that narrows a range; the page of word lengths prints them."""

BY_DESIGN = {
    "c4_quo": "d1 d2 may be an ulp; the quotient saturates, and (14) limits it to [-1, 1]",
    "t_e": "only of clamped targets, whose c4 is set from outside",
    "h": "of an arm that is all upper arm, d1 + |p_ez| may be rounded to 2, and is limited to the largest word",
}
"""Nodes that saturate on purpose: their range is their format."""

# -- intervals -------------------------------------------------------------------------------------------------------


class Ranges(Domain):
    """The dataflow on intervals over one :class:`Case`.  ``failed`` collects the nodes that do not fit."""

    def __init__(self, width: int, case: Case, formats: dict[str, Format] | None = None) -> None:
        super().__init__(width)
        self.case = case
        self.formats = formats or {}
        self.failed: dict[str, str] = {}
        self.proved: dict[str, Bound] = {}
        self.plane_error = 0.0
        self.rules = {name: rule for rule in RULES for name in rule.nodes}

    def run(self) -> Ranges:
        """The whole datapath."""
        low, high = -(1 << (self.width - 1)), (1 << (self.width - 1)) - 1
        target = {}
        for name in FIELDS:
            fmt = self.word(1) if name != "phi" else self.word(0)
            least = 1 if name in ("d1", "d2") and not self.case.clamped else low
            value = self._fit(name, Bound(least * fmt.ulp, high * fmt.ulp), fmt)
            target[name] = self.make(name, "input", (), fmt, None, value)
        paper(self, target)
        return self

    def _fit(self, name: str, bound: Bound, fmt: Format) -> Bound:
        """Holds a bound against the format; what does not fit is noted, and the format's range goes on."""
        fmt = self.formats.get(name, fmt)
        floor, ceiling = fmt.low * fmt.ulp, fmt.high * fmt.ulp
        low, high = bound.word
        slack = SLACK * max(abs(low), abs(high))
        # A word lies on the format's grid: what is beyond the last one by less than an ulp is that last one.
        if math.ceil((low + slack) / fmt.ulp) < fmt.low or math.floor((high - slack) / fmt.ulp) > fmt.high:
            if not (name in BY_DESIGN and (name != "t_e" or self.case.clamped)):
                self.failed[name] = (
                    f"{name} {self._equation}: proved range [{low:.9g}, {high:.9g}] does not fit its format "
                    f"[{floor:.9g}, {ceiling:.9g}], {fmt.width} bits, {fmt.frac} of them fraction "
                    f"(W = {self.width}, case {self.case.name})"
                )
            else:
                bound = Bound(bound.low, bound.high, bound.error, "saturates by design", floor, ceiling)
        self.proved[name] = bound
        # What does not fit saturates; so does what may.  The word only comes closer to what exact arithmetic gives,
        # unless that lies outside itself.
        if bound.low < floor or bound.high > ceiling:
            return Bound(max(bound.low, floor), min(bound.high, ceiling), bound.error, bound.rule, floor, ceiling)
        return replace(bound, floor=max(bound.floor, floor), ceiling=min(bound.ceiling, ceiling))

    def _rule(self, name: str, low: float, high: float, error: float, fmt: Format, word=(-math.inf, math.inf)) -> Bound:
        rule = self.rules.get(name)
        text = ""
        if rule is not None:
            least, most = rule.limit(self.case)
            if least > low or most < high:
                text = rule.name
            low, high = max(low, least), min(high, most)
            if low > high and self.failed:
                low, high = least, most  # an operand saturated
            if low > high:
                raise RangeError(f"{name}: rule '{rule.name}' contradicts the interval")
        return self._fit(name, Bound(low, high, error, text, *word), fmt)

    # ---- the operations ------------------------------------------------------------------------------------------

    def constant(self, value, fmt):
        return Node("", "", "", "constant", (), fmt, None, 0, Bound(value, value))

    def overflowed(self, watched, unless):
        return Bound(0, 1)

    def product(self, name, a, b, fmt, scale):
        p, q = a.value, b.value
        square = a is b
        ends = [u * v * 2.0**scale for u in (p.low, p.high) for v in (q.low, q.high)]
        low = 0.0 if square and p.low <= 0 <= p.high else min(p.low**2, p.high**2) if square else min(ends)
        error = (p.size * q.error + q.size * p.error + p.error * q.error) * 2.0**scale
        rounding = 0.5 * fmt.ulp if a.format.frac + b.format.frac - scale > fmt.frac else 0.0
        words = [u * v * 2.0**scale for u in p.word for v in q.word]
        positive = square or name in SAME_SIGN  # and rounding half up keeps it so
        least = 0.0 if positive else min(words) - rounding
        return self._rule(name, low, max(ends), error + rounding, fmt, (least, max(words) + rounding))

    def total(self, name, signs, nodes, fmt):
        low = sum(n.value.low if s > 0 else -n.value.high for s, n in zip(signs, nodes, strict=True))
        high = sum(n.value.high if s > 0 else -n.value.low for s, n in zip(signs, nodes, strict=True))
        rounding = 0.5 * fmt.ulp if nodes[0].format.frac > fmt.frac else 0.0
        ends = ((s, *n.value.word) for s, n in zip(signs, nodes, strict=True))
        words = [(least, most) if s > 0 else (-most, -least) for s, least, most in ends]
        least = sum(w[0] for w in words)
        word = least - (rounding if least < 0 else min(rounding, least)), sum(w[1] for w in words) + rounding
        if name == "uu" and not self.case.clamped:
            p_e = math.sqrt(self.case.p_e**2 + self._length_error(fmt))
            word = max(word[0], -fmt.ulp), min(word[1], SQRT2 * p_e + 2 * fmt.ulp)
        error = self._squared(name, fmt) or sum(n.value.error for n in nodes) + rounding
        return self._rule(name, low, high, error, fmt, word)

    def quotient(self, name, n, d, fmt):
        p, q = n.value, d.value
        if name in BY_DESIGN:
            return self._fit(name, Bound(fmt.low * fmt.ulp, fmt.high * fmt.ulp, 0.0, "saturates by design"), fmt)
        least = q.word[0]
        if q.low <= 0 or least <= 0:
            raise RangeError(f"{name}: its divisor {d.name} may be 0: [{q.low:.9g}, {q.high:.9g}] +- {q.error:.3g}")
        ends = [u / v for u in (p.low, p.high) for v in (q.low, q.high)]
        first = self.rules.get(name)
        size = max(map(abs, ends))
        if first is not None:
            size = min(size, max(map(abs, first.limit(self.case))))
        words = [u / v for u in p.word for v in q.word]
        word = min(words) - fmt.ulp, max(words)
        if name.startswith("e_"):
            most = math.sqrt(self.case.p_e**2 + self._length_error(fmt)) + fmt.ulp
            word = max(word[0], -most), min(word[1], most)
        bound = self._rule(name, min(ends), max(ends), (p.error + size * q.error) / least + fmt.ulp, fmt, word)
        return self._restart(name, bound) if name.startswith("pi_swivel") else bound

    # (12) and all that follows hold for any plane, so the words of pi_swivel may stand for exact ones: their rounding
    # goes no further.  Exact arithmetic with them gives k_e / 2 = p_e p_w and |p_e| = d1 as before; p_w is out of their
    # plane by the tilt, which enters squared.

    def _restart(self, name: str, bound: Bound) -> Bound:
        self.plane_error = math.hypot(self.plane_error, bound.error)
        if name == "pi_swivel_z":
            least, most = self.case.b
            b = least - self.plane_error, most + self.plane_error
            self.case = replace(self.case, b=b, tilt=self.plane_error / b[0])
        low, high = bound.word
        return replace(bound, low=low, high=high, error=0.0)

    # The root of (13) may lose half of its digits, and p_e with it, but across |p_e|^2 = |a|^2 + t^2 |m|^2 (a along
    # p_w, t = tmp_sqr, m = PP^- / |PP^-|^2 at right angles to it) the square undoes the root.

    def _straight_error(self, fmt: Format) -> float:
        """Length of what is between p_e and a + t m, with t as the word stands."""
        v = {name: node.value for name, node in self.nodes.items()}
        wide = self.wide(5).ulp
        worst = 0.0
        for axis, m in zip("xyz", "123", strict=True):
            if f"e_{axis}_pp" not in v or f"pp_{m}_m" not in v:
                axis, m = "x", max("123", key=lambda k: v[f"pp_{k}_m"].error)
            num = v[f"e_{axis}_pp"].error + v["tmp_sqr"].word[1] * v[f"pp_{m}_m"].error + wide
            inf = v["inf_pp"]
            worst = max(worst, (num + self.case.p_e * 1.1 * inf.error) / inf.word[0] + fmt.ulp)
        return SQRT3 * worst

    def _length_error(self, fmt: Format) -> float:
        """How far |p_e|^2, or |p_e - p_w|^2, is from exact arithmetic."""
        v = {name: self.nodes[name].value for name in ("tmp1", "tmp_sqr", "inf_pp")}
        straight = self._straight_error(fmt)
        square = v["tmp1"].error + 2 * v["tmp_sqr"].word[1] * self.nodes["tmp_sqr"].format.ulp
        return square / v["inf_pp"].low + 2 * straight * self.case.p_e * 1.1 + straight**2

    def _squared(self, name: str, fmt: Format) -> float:
        """The error of t_e = |p_e|^2 - p_e p_w, by the same."""
        if name != "t_e" or self.case.clamped:
            return 0.0
        inner = self.word(1)
        rounding = 1.5 * self.wide(1).ulp + SQRT3 * inner.ulp * self.case.p_e + 0.5 * fmt.ulp
        return self._length_error(inner) + self._straight_error(inner) + rounding

    def square_root(self, name, n, fmt):
        v = n.value
        low, high = math.sqrt(max(v.low, 0)), math.sqrt(max(v.high, 0))
        # |sqrt a - sqrt b| = |a - b| / (sqrt a + sqrt b), and never more than sqrt |a - b|; below 0 both are 0.
        ends = low + math.sqrt(max(v.word[0], 0))
        error = math.sqrt(v.error) if ends == 0 else min(v.error / ends, math.sqrt(v.error))
        word = tuple(math.sqrt(max(w, 0)) for w in v.word)
        return self._rule(name, low, high, error + fmt.ulp, fmt, (max(word[0] - fmt.ulp, 0.0), word[1]))

    def mantissa(self, name, word, words, counts, fill):
        # Exact: shifting changes the unit, not the vector.  Bounds downstream are about the words as they stand.
        fmt = self.word(0)
        most = {"p": self.case.p[1], "b": self.case.b[1]}.get(name[0], 1.0)
        bound = Bound(max(fmt.low * fmt.ulp, -most), min(fmt.high * fmt.ulp, most), 0.0, "unit mantissa")
        return self._fit(name, bound, fmt)

    def sincos(self, sin, cos, phi):
        fmt = self.word(1)
        bounds = {n: self._rule(n, -1.0, 1.0, CORDIC[1] * fmt.ulp, fmt) for n in (sin, cos)}
        return tuple(self.make(n, "sincos", (phi,), fmt, "sincos", bound, error=CORDIC) for n, bound in bounds.items())

    def apply(self, name, operands, fmt, bits, real):
        special = self._special(name, fmt)
        if special is not None:
            return self._fit(name, special, fmt)
        # Choices, shifts and additions are monotone in each operand while the others (and the sign of a comparison's
        # operand) stand still: their extremes lie at corners of the operands' ranges, 0 and -1 included.
        corners = [self._corners(n) for n in operands]
        grid = [np.array(c, dtype=object) for c in zip(*itertools.product(*corners), strict=True)]
        grid = [g if _large(g) else g.astype(np.int64) for g in grid]
        words = [int(w) for w in np.atleast_1d(bits(*grid))]
        word = min(words) * fmt.ulp, max(words) * fmt.ulp
        if real is None:
            return self._rule(name, *word, 0.0, fmt)
        values = [sorted({n.value.low, n.value.high, min(max(0.0, n.value.low), n.value.high)}) for n in operands]
        exact = real(*(np.array(c, dtype=np.float64) for c in zip(*itertools.product(*values), strict=True)))
        low, high = float(np.min(exact)), float(np.max(exact))
        error = self._carried(name, operands) + self._rounding(name, fmt)
        if name in self.rules:
            return self._rule(name, low, high, error, fmt, word)
        if name in ("f_x", "f_y", "f_z") and not self.case.clamped:
            # |p_e - p_w|^2 = d2^2, or d2^2 + |p_e|^2 - d1^2 where rounded arms do not reach
            most = math.sqrt((self.case.p_e + 2 * self.case.ulp) ** 2 + self._length_error(fmt)) + fmt.ulp
            return self._fit(name, Bound(max(low, -most), min(high, most), error, "forearm", -most, most), fmt)
        return self._fit(name, Bound(low, high, error, "", *word), fmt)

    def _corners(self, node: Node) -> list[int]:
        ulp = node.format.ulp
        low, high = (round(v / ulp) for v in _on_grid(node.value.word, node.format))
        return sorted({low, high, *(v for v in (-1, 0, 1) if low <= v <= high)})

    def _carried(self, name: str, operands) -> float:
        """Errors of the operands: these operations scale them by 1 at most, but for the ones listed."""
        if name.startswith(("side_",)):
            return max(operands[0].value.error, operands[1].value.error / 8)
        if name.startswith(("h4_", "h3_")):
            return operands[0].value.error / 2
        if name.startswith(("f_", "h", "d_sum", "d_dif")):
            return sum(n.value.error for n in operands)
        return max(n.value.error for n in operands)

    def _rounding(self, name: str, fmt: Format) -> float:
        exact = name.startswith(("d_sum", "d_dif", "h", "m_", "c4", "side_", "q3_k", "qe_i"))
        return 0.0 if exact else fmt.ulp

    def _special(self, name: str, fmt: Format) -> Bound | None:
        """The guard's shifts wrap where a target is clamped, so corners say nothing; and counts."""
        c = self.case
        u, full = fmt.ulp, (fmt.low * fmt.ulp, fmt.high * fmt.ulp)
        if fmt.width == 1 and not fmt.signed:
            fixed = {"clamp": int(c.clamped), "bad_length": 0, "too_far": 0, "too_near": 0, "at_shoulder": 0}
            if name == "clamp" or (not c.clamped and name in (*fixed, "fold", "away")):
                return Bound(fixed.get(name, 0), fixed.get(name, 0))
            return Bound(0, 1)
        if name.startswith("lz_"):
            return Bound(0, self.width if name == "lz_r" else self.width - 1, 0.0, "leading sign bits")
        if name == "scale_j":
            return Bound(*c.j, 0.0, "target's unit")
        if name == "d_dif_sh":
            # wrapped, and not used, where clamped
            return Bound(*full) if c.clamped else Bound(-c.p[1], c.p[1], 0.0, "not too near")
        if name in ("d_1_sh", "d_2_sh"):
            # wrapped, and not used, where clamped
            return Bound(*full) if c.clamped else Bound(2 * u, min(2 * c.d_high, 2) / 2, 0.0, "arms' unit")
        if name in ("d_1", "d_2"):
            most = 0.25 if c.clamped else c.d_high - (u if c.long else 0)
            return Bound(0.25 if c.clamped else u, most, 0.0, "arms' unit")
        if name.startswith("p_a_"):
            if name.endswith("_sh"):
                return Bound(*full) if c.clamped else Bound(-1.0 + u, 1 - u, 0.0, "in reach: |p| <= d1 + d2")
            return Bound(0, 0) if c.clamped else Bound(-1.0, 1 - u, 0.0, "in reach: |p| <= d1 + d2")
        return None


def _on_grid(word: tuple[float, float], fmt: Format) -> tuple[float, float]:
    """The outermost words of ``fmt`` inside a range."""
    low = math.ceil((word[0] - SLACK * abs(word[0])) / fmt.ulp)
    high = math.floor((word[1] + SLACK * abs(word[1])) / fmt.ulp)
    return low * fmt.ulp, max(low, high) * fmt.ulp


def _large(column) -> bool:
    return any(abs(v) >= 1 << 62 for v in column)


# -- over all cases --------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Proved:
    """What holds of a node for every input: the range of its word, the error bound in ulps, and by which rules."""

    node: Node
    low: float
    high: float
    error_ulps: float
    rules: tuple[str, ...]

    @property
    def bits_wasted(self) -> int:
        """Leading bits that never carry anything but the sign."""
        fmt = self.node.format
        words = (round(self.low / fmt.ulp), round(self.high / fmt.ulp))
        needed = max(w.bit_length() if w >= 0 else (~w).bit_length() for w in words)
        return max(0, fmt.width - (1 if fmt.signed else 0) - needed)


def analyse(width: int, formats: dict[str, Format] | None = None) -> tuple[dict[str, Proved], dict[str, str]]:
    """Every node's proved range at word length ``width``, and what does not fit: node -> one line.

    ``formats`` holds single nodes against other formats than the dataflow's.
    """
    runs = [Ranges(width, case, formats).run() for case in cases(width)]
    failed: dict[str, str] = {}
    for run in runs:
        for name, line in run.failed.items():
            failed.setdefault(name, line)
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
    """Every node's proved range with the dataflow's own formats."""
    return _as_built(width)[0]


def failures(width: int) -> dict[str, str]:
    """The nodes whose proved range does not fit, each with one line that names it."""
    return _as_built(width)[1]


def check(width: int) -> None:
    """Raises :class:`RangeError` naming every node that does not fit."""
    found = failures(width)
    if found:
        raise RangeError("\n".join(found.values()))
