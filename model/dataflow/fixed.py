# SPDX-License-Identifier: Apache-2.0
"""Layer 4: bit-true fixed-point model of the RTL, every node, in integers.

A node's value is an int64 array over targets (an object array of Python integers where it exceeds 64 bits).  No result
depends on a float: products and sums are exact and rounded once, division and root take the floor.
"""

import math
from dataclasses import dataclass
from functools import cache

import mpmath
import numpy as np

from ..io.words import FIELDS
from . import arm
from .angles import TABLE_BITS, atan_table, iterate, vector
from .datapaths import DEFAULT, MODELS
from .nodes import Domain, Format, Limits, Node, effective_width
from .operations import even, mul3, round_shift, wrap
from .quadratic import SINE_FRACS, half_sincos, rsqrt

SINCOS_GUARD = 6
"""Guard bits of the CORDIC: each of its W iterations drops less than one ulp of the guarded word."""

FIFO_CLOCKS = 2
"""Clocks that the output FIFO of ``ik_axis`` adds to a datapath's latency: memory, output register."""

WIDE = 0.999 * 2.0**62  # largest sum of squares that is computed in 64 bits


@cache
def cordic_gain() -> int:
    """Return round(2^TABLE_BITS prod_i 1/sqrt(1 + 4^-i)), which compensates the gain of the rotations in advance."""
    with mpmath.workprec(200):
        gain = mpmath.fprod(1 / mpmath.sqrt(1 + mpmath.mpf(4) ** -i) for i in range(100))
        return int(mpmath.nint(gain * 2**TABLE_BITS))


def floor_div(n, d, shift: int, fmt: Format):
    """Compute ``ik_div``: floor(n 2^shift / d) saturated to ``fmt``; by the sign of n where d <= 0.

    Returns the quotient and a mask of saturated quotients.
    """
    positive = d > 0
    q = (n << shift) // np.where(positive, d, 1)
    q = np.where(positive, q, np.where(n < 0, fmt.low, fmt.high))
    fits = positive & (q >= fmt.low) & (q <= fmt.high)
    return np.clip(q, fmt.low, fmt.high), ~fits


def floor_root(n, shift: int):
    """Compute ``ik_root``: floor(sqrt(n 2^shift)), 0 where n < 0.  n 2^shift must stay below 2^63."""
    v = np.maximum(n, 0) << shift
    r = np.sqrt(v.astype(np.float64)).astype(np.int64)
    # The float of v has a relative error of at most 2^-53, its root at most half an ulp: at most 1 too large, never too
    # small.
    return r - (r * r > v)


def cordic(phi, width: int):
    """Compute ``ik_sincos``: (sin, cos) of phi/2 in words with one integer bit; one turn of phi = 2^width."""
    drop = TABLE_BITS - (width + SINCOS_GUARD)
    inner = width + SINCOS_GUARD - 2  # internal fraction bits
    angles = [round_shift(a, drop) for a in atan_table()]
    z = phi << SINCOS_GUARD
    x = np.full_like(z, round_shift(cordic_gain(), TABLE_BITS - inner))
    y = np.zeros_like(z)
    for i in range(width):
        left = z >= 0
        x, y = np.where(left, x - (y >> i), x + (y >> i)), np.where(left, y + (x >> i), y - (x >> i))
        z = np.where(left, z - angles[i], z + angles[i])
    return round_shift(y, SINCOS_GUARD), round_shift(x, SINCOS_GUARD)


def sincos_bound(width: int) -> float:
    """Return the largest error of ``ik_sincos`` in ulps, 2^-(width-2).

    With G guard bits, in units g = 2^-G ulp:

    * x and y lose less than 1 g in each iteration i >= 1 (the shift of iteration 0 is exact), a vector of less than
      sqrt(2) g; later iterations stretch it by the product of their sqrt(1 + 4^-j);
    * the error of the rounded gain word is stretched by K = 1.6468;
    * the angle: one ulp of z is pi/4 g as an arc.  After n = width iterations the residual is at most the last angle,
      atan(2^-(n-1)).  The rounding of each table angle counts twice: once in the angle turned, and once in the
      residual, because the remaining rounded angles may fall short by that much;
    * rounding the result: half an ulp.
    """
    inner = width + SINCOS_GUARD
    stretch = [math.prod(math.sqrt(1 + 4.0**-j) for j in range(i + 1, width)) for i in range(width)]
    lost = math.sqrt(2) * sum(stretch[1:])
    with mpmath.workprec(200):
        exact = mpmath.fprod(1 / mpmath.sqrt(1 + mpmath.mpf(4) ** -i) for i in range(100))
        off = float(abs(round_shift(cordic_gain(), TABLE_BITS - inner + 2) - exact * 2 ** (inner - 2)))
        angles = (mpmath.atan(mpmath.mpf(2) ** -i) / mpmath.pi * 2**inner for i in range(width))
        words = (round_shift(word, TABLE_BITS - inner) for word in atan_table())
        table = float(sum(abs(word - angle) for word, angle in zip(words, angles, strict=False)))
    gain = off * stretch[0] * math.sqrt(2)
    angle = math.atan(2.0 ** (1 - width)) * 2.0 ** (inner - 2) + 2 * table * math.pi / 4
    return 0.5 + (lost + gain + angle) / 2**SINCOS_GUARD


class Bits(Domain):
    """Dataflow in integers.  ``overflow`` maps every product, sum and quotient to a mask of words that did not fit."""

    def __init__(self, width: int, datapath: str = DEFAULT, limits: Limits | None = None) -> None:
        path = MODELS[datapath]
        super().__init__(width, path.widths, path.tile)
        self.datapath, self.limits = datapath, limits
        self.overflow: dict[str, np.ndarray] = {}

    def summed(self, names, size):
        # Sums of squares can exceed 64 bits, though not for a target in reach of an arm shorter than 2: then the words
        # are Python integers.
        nodes = [self.nodes[name] for name in names]
        if self.width > 31 and np.max(size(*(np.abs(n.value, dtype=np.float64) for n in nodes)), initial=0) > WIDE:
            for node in nodes:
                node.value = node.value.astype(object)

    def constant(self, value, fmt):
        return Node("", "", "", "constant", (), fmt, None, 0, np.int64(round(value * 2.0**fmt.frac)))

    def apply(self, name, operands, fmt, words):
        return words(*(n.value for n in operands))

    def _narrow(self, name, value, fmt):
        self.overflow[name] = (value < fmt.low) | (value > fmt.high)
        return np.clip(value, fmt.low, fmt.high)

    def product(self, name, a, b, fmt, scale):
        value = round_shift(a.value * b.value, a.format.frac + b.format.frac - scale - fmt.frac)
        return self._narrow(name, value, fmt)

    def total(self, name, signs, nodes, fmt):
        value = sum(s * n.value for s, n in zip(signs, nodes, strict=True))
        return self._narrow(name, round_shift(value, nodes[0].format.frac - fmt.frac), fmt)

    def quotient(self, name, n, d, fmt):
        value, self.overflow[name] = floor_div(n.value, d.value, fmt.frac - n.format.frac + d.format.frac, fmt)
        return value

    def square_root(self, name, n, fmt):
        return floor_root(n.value, 2 * fmt.frac - n.format.frac)

    def product3(self, name, a, b, fmt, scale):
        # Bits beyond the format are dropped: only words of a clamped target lose bits here.
        shift, widths = self.cut(a, b, fmt, scale)
        return wrap(mul3(a.value, b.value, shift, *widths, self.tile), fmt.width)

    def even_mantissa(self, count, name, value, width, fmt):
        word = value.value
        return even(word if word.dtype == np.int64 and width > 63 else word & ((1 << width) - 1), width, fmt.width)

    def reciprocal_root(self, name, m, fmt, twice):
        # A root has no more fraction bits than its mantissa supports; an inner word may have more.
        frac = m.format.frac - 3
        y = rsqrt(m.value, frac, self.tile) << (fmt.frac - frac)
        return y << np.where(twice.value, 1, 0) if twice else y

    def half_sincos(self, names, phi, fmt):
        width = effective_width(self.width)  # a shorter angle is padded with zeros
        frac = min(fmt.frac, SINE_FRACS[-1])
        pair = half_sincos(phi.value << (width - self.width), width, frac, self.tile)
        return tuple(v << (fmt.frac - frac) for v in pair)

    def mantissa(self, name, word, words, counts, fill):
        empty = np.logical_and.reduce([w.value == 0 for w in words])
        return np.where(empty, fill, word.value << counts.value)

    def polar(self, names, x, y, sign):
        of = vector if x.format.frac == self.width - 2 else iterate  # words, or lengths
        return of(x.value, sign * y.value, self.width)

    def cordic(self, names, phi):
        return cordic(phi.value, self.width)


@dataclass(frozen=True)
class Answer:
    """Outputs of the datapath for N targets: ``results`` (N, 6) words in the order of the datapath's results,
    ``flags`` (N,), and every node."""

    results: np.ndarray
    flags: np.ndarray
    bits: Bits


def run(words: np.ndarray, width: int, datapath: str = DEFAULT, branch=0, limits: Limits | None = None) -> Answer:
    """Run N targets, input words in the order of the datapath's inputs, through a datapath.

    For the whole arm: ``branch``, a number or (N,), and the joints' limits, seven pairs of words; none by default.
    """
    return answer(words, Bits(width, datapath, limits), branch)


def nodes(datapath: str, width: int) -> dict[str, Node]:
    """Return the nodes of a datapath in dataflow order, with their formats and clocks; their values are of one
    target."""
    return run(np.zeros((1, len(MODELS[datapath].inputs)), dtype=np.int64), width, datapath).bits.nodes


def latency(datapath: str, width: int) -> int:
    """Return the clocks of ``ik_axis`` from a target's input to its result's output, without stalls."""
    return max(node.time for node in nodes(datapath, width).values()) + MODELS[datapath].behind


def of_hands(words: np.ndarray, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the core's input words (N, 6) for hand poses, input words (N, 11) of the whole arm, and the flags (N,)
    of the hand."""
    path, bits = MODELS["arm"], Bits(width, "arm")
    columns = dict(zip(path.inputs, np.asarray(words, dtype=np.int64).T, strict=True))
    arm.hand(bits, bits.inputs(lambda name, fmt: columns[name], path.inputs))
    value = {k: n.value for k, n in bits.nodes.items()}
    flags = sum(value[name] * np.int64(flag) for name, flag in path.flags.items() if name in value)
    return np.stack([value[k] for k in FIELDS], axis=1), flags


def answer(words: np.ndarray, bits: Bits, branch=0) -> Answer:
    """Run N targets, as :func:`run`, in an unused domain."""
    path = MODELS[bits.datapath]
    columns = dict(zip(path.inputs, np.asarray(words, dtype=np.int64).T, strict=True))
    columns |= {name: np.broadcast_to(branch, len(words)) >> k & 1 for k, name in enumerate(path.side)}
    path.flow(bits, bits.inputs(lambda name, fmt: columns[name], (*path.inputs, *path.side)))
    for name, time in path.times(bits.width).items() if path.times else ():
        bits.nodes[name].time = time
    value = {k: n.value for k, n in bits.nodes.items()}
    flags = sum(value[name] * np.int64(flag) for name, flag in path.flags.items())
    return Answer(np.stack([value[k] for k in path.results], axis=1), flags, bits)
