# SPDX-License-Identifier: Apache-2.0
"""Words of the folded machine at one word length: where the bits of a node lie in a word of its memory.

Each word is as far to the left as its largest value allows, so that products of all formats are cut at the same
places.  ``weight`` w of a word: its first bit counts -2^w.  The product of two words has 2 ``bits`` bits, and its bit
2 ``bits`` - 2 counts 2^(w + w'); what is written back is taken from its :data:`PLAIN` or :data:`DOUBLE` window.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from ..nodes import Format, inner_frac, root_frac

PLAIN, DOUBLE = 1, 2
"""A window begins so many bits below the highest bit of a product but one."""

EXACT_WEIGHT = 2
"""Of input words and their sums, which squares are made of."""


@dataclass(frozen=True)
class Layout:
    """The machine's words at word length ``width``, even, with tiles of ``tile`` bits."""

    width: int
    tile: int = 18

    @cached_property
    def inner(self) -> int:
        """Bits of an inner word."""
        return inner_frac(self.width) + 2

    @cached_property
    def bits(self) -> int:
        """Of a word of the memory: an inner word, or a mantissa with a sign."""
        return max(self.inner, root_frac(self.width) + 4)

    @property
    def low(self) -> int:
        """Bits of a word below its tile."""
        return self.bits - self.tile

    @property
    def product(self) -> int:
        """Bits of a product."""
        return 2 * self.bits

    @property
    def lowest(self) -> int:
        """The lowest bit of a sum of products that is kept: that of an exact square."""
        return self.product - (2 * self.width + 2)

    def window(self, window: int) -> int:
        """Bit of a sum of products that becomes bit 0 of a word."""
        return self.bits - 1 - window

    def last_place(self, window: int) -> int:
        """Bit of a sum of products that becomes the last place of an inner word."""
        return self.window(window) + self.bits - self.inner

    def place(self, fmt: Format, weight: int) -> int:
        """Bit of a word that is the last place of a node; its first bit counts -2^``weight``."""
        place = self.bits - 1 - weight - fmt.frac
        if place < 0:
            raise ValueError(f"{fmt} does not fit a word of {self.bits} bits from 2^{weight} on")
        return place

    def one(self) -> int:
        """The factor that changes nothing in the plain window."""
        return 1 << self.bits - 2

    def power(self, count: int) -> int:
        """The factor 2^(1 - count) of the plain window, negative where count = 0.  After the last bit of a word comes
        that again, with which a step takes the plain window for the double one, and 0."""
        if count == 0:
            return -(1 << self.bits - 1)
        return int(count == self.bits) or 1 << self.bits - 1 >> count
