# SPDX-License-Identifier: Apache-2.0
"""Word lengths, formats of nodes, and latencies of operations.

A two's complement word of ``W`` bits with ``i`` integer bits has the range [-2^i, 2^i) and ``W-1-i`` fraction bits.  In
the paper's datapath, most products that feed a sum, and some sums of such products, have ``GUARD`` more fraction bits.
"""

from dataclasses import dataclass

from .angles import iterations
from .mul3 import TILE
from .quadratic import INVERSE_ROOT, SINE

GUARD = 8  # extra fraction bits of a product that feeds a sum

WIDTHS = range(16, 33)  # word lengths supported by the datapaths

INNER_FRAC = 33
"""Maximum fraction bits of the lean datapath's inner words: with two bits above, a word fits two tiles of 18 bits."""

ROOT_FRACS = 22, 31
"""Fraction bits of the lean datapath's roots: up to W = 18, where the table's short form suffices; most for W > 18."""


def effective_width(width: int) -> int:
    """Return the word length that sets the lean formats: ``width``, but at least 16 (exhaustive tests use less)."""
    return max(width, WIDTHS[0])


def inner_frac(width: int) -> int:
    """Return F, the number of fraction bits of the lean datapath's inner words at word length ``width``."""
    return max(min(effective_width(width) + 5, INNER_FRAC), ROOT_FRACS[0])


def root_frac(width: int) -> int:
    """Return the number of fraction bits of the lean datapath's roots at word length ``width``."""
    short, most = ROOT_FRACS
    return short if width <= 18 else min(inner_frac(width), most)


@dataclass(frozen=True)
class Latency:
    """Latency of each kind of operation at word length ``width``, in clocks; the Verilog names are ``LAT_<KIND>``."""

    width: int
    tile: int = TILE

    # operation -> (clocks per bit of the word, fixed clocks, kind in pictures and operation counts, description)
    TABLE = {
        "mul": (0, 4, "mul", "operands, tile products, tile sums, rounding"),
        "sum2": (0, 2, "add", "add, round and saturate"),
        "sum3": (0, 3, "add", "add, add, round and saturate"),
        "norm": (0, 3, "scale", "magnitudes, leading-zero count, shift"),
        "lzc": (0, 2, "scale", "magnitudes, leading-zero count"),
        "shift": (0, 2, "scale", "barrel shift: by eights, by ones"),
        "mux": (0, 1, "choose", "an exact addition, a choice, a sign change or a comparison"),
        "div": (1, 2, "div", "pipelined radix-2 divider: magnitude, one row a quotient bit, sign"),
        "root": (1, 0, "root", "pipelined radix-2 square root: one row a result bit, output"),
        "sincos": (1, 1, "sincos", "CORDIC: one iteration a bit, rounding"),
        "mul3": (0, 3, "mul", "three tile products, tile sums, rounded sum"),
        "mul3_far": (0, 4, "mul", "operands, three tile products, tile sums, rounded sum"),
        "product": (0, 4, "mul", "operands, tile products, tile sums, sum"),
        "square": (0, 3, "mul", "operands, tile products, sum"),
        "wide": (0, 1, "add", "an exact addition of long words"),
        "even": (0, 3, "scale", "zero pairs in groups, shift by groups, shift by pairs"),
        "shift3": (0, 3, "scale", "barrel shift: by sixteens, by fours, by ones"),
        "rsqrt": (0, 0, "root", "a table and u times a slope; in the long form in tiles, the slope by another product"),
        "rsqrt_far": (0, 0, "root", "the table's address, and the same"),
        "vector": (0, 0, "sincos", "CORDIC: one iteration a clock, output"),
        "vector_x": (0, 0, "sincos", "the iterations that change its length, output"),
        "vector_y": (0, 0, "sincos", "the other iterations"),
        "trig": (0, 0, "sincos", "magnitude, a table and u times a slope, as for rsqrt, sign"),
    }

    # kind -> clocks as a Verilog expression, see :func:`model.dataflow.angles.iterations`
    VECTORS = {
        "vector": "(W + 1) / 2 + ((W < 28) ? W / 2 + 2 : 16)",
        "vector_x": "(W + 1) / 2",
        "vector_y": "(W < 28) ? W / 2 + 2 : 16",
    }

    # kind -> (Verilog name of the fraction bits that select the table's form, table, additional clocks)
    FORMS = {
        "rsqrt": ("ROOT_FRAC", INVERSE_ROOT, 0),
        "rsqrt_far": ("ROOT_FRAC", INVERSE_ROOT, 1),
        "trig": ("FRAC", SINE, 0),
    }

    def __getitem__(self, kind: str) -> int:
        """Return the clocks of operation ``kind``."""
        if kind in self.FORMS:
            frac, table, more = self.FORMS[kind]
            bits = root_frac(self.width) if frac == "ROOT_FRAC" else inner_frac(self.width)
            return table.clocks(bits, self.tile) + more
        if kind in self.VECTORS:
            head, last = iterations(self.width)
            return {"vector": last + 1, "vector_x": head + 1, "vector_y": last - head}[kind]
        bits, besides, *_ = self.TABLE[kind]
        return bits * self.width + besides

    @classmethod
    def expression(cls, kind: str) -> str:
        """Return ``kind``'s latency (clocks) as a Verilog expression; a table's small and long form share it."""
        if kind in cls.FORMS:
            frac, table, more = cls.FORMS[kind]
            short, long = (table.clocks(table.short_frac + longer) + more for longer in (0, 1))
            return f"(TILE < {TILE} || {frac} > {table.short_frac}) ? {long} : {short}"
        if kind in cls.VECTORS:
            return cls.VECTORS[kind]
        bits, besides, *_ = cls.TABLE[kind]
        return " + ".join(["W"] * bits + [str(besides)] * (besides > 0 or not bits))


@dataclass(frozen=True)
class Format:
    """Fixed-point format: ``width`` bits of which ``frac`` are fraction bits.

    ``frac_expr`` is ``frac`` as a Verilog expression of ``W`` and of constants such as ``GUARD``.
    """

    width: int
    frac: int
    frac_expr: str
    signed: bool = True

    @property
    def low(self) -> int:
        """Smallest word."""
        return -(1 << (self.width - 1)) if self.signed else 0

    @property
    def high(self) -> int:
        """Largest word."""
        return (1 << (self.width - (1 if self.signed else 0))) - 1

    @property
    def ulp(self) -> float:
        """Value of the LSB."""
        return 2.0**-self.frac


class LeanFormats:
    """Formats of the lean dataflow at one word length."""

    def __init__(self, width: int) -> None:
        self.frac = frac = inner_frac(width)
        self.even_width = width + width % 2  # width of a length rounded up to even, as its shifts are even
        self.odd = width % 2
        self.inner = Format(frac + 2, frac, "FRAC")
        root = root_frac(width)
        self.mantissa = Format(root + 3, root + 3, "ROOT_FRAC + 3", signed=False)
        self.exact = Format(2 * width + 2, 2 * width - 4, "2*W - 4")
        self.length = Format(width + 1, width - 2, "W - 2")
        self.doubled = Format(frac + 3, frac, "FRAC")  # fits slightly more than 2
        self.raised = Format(frac + 5, frac, "FRAC")  # shifted left by 2
        effective = effective_width(width)
        self.shifted = Format(effective + 1, effective, "WX")
        self.result = Format(width, width - 2, "W - 2")
