# SPDX-License-Identifier: Apache-2.0
"""Words of the folded machine at one word length: where the bits of a node lie in a word of its memory.

Each word is as far to the left as its largest value allows, so that products of all formats are cut at the same
places.  ``weight`` w of a word: its first bit counts -2^w.  The product of two words has 2 ``bits`` bits, and its bit
2 ``bits`` - 2 counts 2^(w + w'); what is written back is taken from its :data:`PLAIN` or :data:`DOUBLE` window.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from ..nodes import inner_frac, root_frac

PLAIN, DOUBLE = 1, 2
"""A window begins so many bits below the highest bit of a product but one."""

EXACT_WEIGHT = 2
"""Of input words and their sums, which squares are made of."""


@dataclass(frozen=True)
class Layout:
    """The machine's words at word length ``width``, even."""

    width: int

    @cached_property
    def inner(self) -> int:
        """Bits of an inner word."""
        return inner_frac(self.width) + 2

    @cached_property
    def bits(self) -> int:
        """Of a word of the memory: an inner word, or a mantissa with a sign."""
        return max(self.inner, root_frac(self.width) + 4)
