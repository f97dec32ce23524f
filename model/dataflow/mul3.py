# SPDX-License-Identifier: Apache-2.0
"""Products from three tiles, as ``ik_mul3`` computes them."""

from .expressions import Product, number, wrap

TILE = 18
"""Default width of a tile: the longer operand of the multipliers into which a product is split."""


def cuts(a_width: int, b_width: int, tile: int = TILE) -> tuple[int, int]:
    """Return how many low bits of a and b, operands of :func:`mul3`, are below a's highest ``tile`` bits and b's
    highest min(``tile``, 18) bits."""
    return max(a_width - tile, 0), max(b_width - min(tile, 18), 0)


def unseen(a_width: int, b_width: int, tile: int = TILE) -> tuple[int, int]:
    """Return how many low bits of a and of b are ignored by :func:`mul3` because they do not fit two signed tiles."""
    return max(a_width - 2 * tile + 1, 0), max(b_width - 2 * min(tile, 18) + 1, 0)


def mul3(a, b, shift: int, a_width: int, b_width: int, tile: int = TILE):
    """Return a b / 2^shift as ``ik_mul3`` computes it: from three tile products, without the product of the low parts,
    rounded half up.

    Each tile product is truncated two bits below the result's ulp.  The rounding constant enters as a carry into each
    of the two sums.  If the LSB of the highest product lies above these two bits, they are filled with an estimate of
    the omitted product: the product of the two highest bits of each low part.  Errors: :func:`mul3_error`.
    """
    a_unseen, b_unseen = unseen(a_width, b_width, tile)
    a, b, shift = a >> a_unseen, b >> b_unseen, shift - a_unseen - b_unseen
    a_bits, b_bits = cuts(a_width - a_unseen, b_width - b_unseen, tile)
    a_hi, a_lo = a >> a_bits, a & ((1 << a_bits) - 1)
    b_hi, b_lo = b >> b_bits, b & ((1 << b_bits) - 1)
    drop = shift - 2
    mid = (a_hi * b_lo >> drop - a_bits) + (a_lo * b_hi >> drop - b_bits) + 1
    up = a_bits + b_bits - drop
    if up > 0:
        guess = (4 * a_lo >> a_bits) * (4 * b_lo >> b_bits)
        outer = (a_hi * b_hi << up) + (guess << up >> 4)
    else:
        outer = a_hi * b_hi >> -up
    return outer + mid + 1 >> 2


def mul3_error(shift: int, a_width: int, b_width: int, tile: int = TILE) -> tuple[float, float]:
    """Return the least and greatest error of :func:`mul3`, in ulps of the result.

    The omitted product is nonnegative and less than 2^(c - shift) ulps, where c is the sum of :func:`cuts`; with the
    estimate, 7/16 of this limit remains.  Each of the two mixed products loses less than a quarter ulp.  All other
    truncated bits are part of the rounding, which is half up.  An operand's ignored bits add an error of less
    than the unit of that operand's last used bit, times the other operand.
    """
    out = unseen(a_width, b_width, tile)
    aside = sum(2.0 ** (bits + other - 1 - shift) for bits, other in zip(out, (b_width, a_width), strict=True) if bits)
    low = cuts(a_width - out[0], b_width - out[1], tile)
    up = sum(low) - shift + sum(out) + 2
    left_out = 2.0 ** (up - 2) * (7 / 16 if up > 0 else 1) if all(low) else 0.0
    return -left_out - 1 - aside, 0.5 + aside


class Mul3(Product):
    """Product a * b * 2^scale from three tiles.  Bits above the format, set only for clamped targets, are dropped."""

    kind, latency, adds_rounding = "mul3", "mul3", True

    def _cut(self, node) -> tuple[int, int, int]:
        """Return the number of fraction bits dropped, and the operands' widths as signed words."""
        a, b = (part.format.width + (not part.format.signed) for part in self.parts)
        return self.frac - node.frac, a, b

    def error(self, node):
        return mul3_error(*self._cut(node), node.flow.tile)

    def result(self, node, values):
        a, b = (part.words(values) for part in self.parts)
        return wrap(mul3(a, b, *self._cut(node), node.flow.tile), node.format.width)

    def growth(self, node, bounds):
        p, q = (bounds[part.name] for part in self.parts)
        return ((p.size + p.error) * q.error + (q.size + q.error) * p.error) * 2.0**self.scale

    def formula(self, domain):
        a, b = (part.formula(domain) for part in self.parts)
        return f"(* {number(2.0**self.scale)} {a} {b})"

    def lower(self, to, node):
        to.product(node, *self.parts, self.scale)
