# SPDX-License-Identifier: Apache-2.0
"""Words of the fold datapath at one word length: the position of a node's bits in a memory word.

Each word is aligned as far to the left as its largest value permits, so products of all formats are cut at the same
places.  ``weight`` w of a word: its first bit weighs -2^w.  The product of two words has 2 ``bits`` bits, and its bit
2 ``bits`` - 2 weighs 2^(w + w'); the word written back is its :data:`PLAIN` or :data:`DOUBLE` window.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from ..nodes import inner_frac, root_frac

PLAIN, DOUBLE = 1, 2
"""Distance of a window's first bit from a product's second-highest bit."""

EXACT_WEIGHT = 2
"""Weight of input words and their sums, the operands of squares."""


@dataclass(frozen=True)
class Layout:
    """Memory words at an even word length ``width``."""

    width: int

    @cached_property
    def inner(self) -> int:
        """Bits of an inner word."""
        return inner_frac(self.width) + 2

    @cached_property
    def bits(self) -> int:
        """Bits of a memory word: an inner word, or a mantissa with a sign."""
        return max(self.inner, root_frac(self.width) + 4)
