# SPDX-License-Identifier: Apache-2.0
"""What the lean dataflow does with words, integers or their real values, in one line each."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np


def plus(a, b):
    return a + b


def minus(a, b):
    return a - b


def times(a, b):
    """The product of integers of any size."""
    return a.astype(object) * b


def square(a):
    return times(a, a)


def half_up(words, drop: int):
    """Without their last ``drop`` bits, rounded half up."""
    return (words + (1 << (drop - 1))) >> drop


def down_from_4(words, count):
    """4 words 2^-count."""
    return (words << 2) >> count


def scaled_by(power: int, sign: int) -> Callable:
    """(v, count) -> v 2^(power + sign count), in double precision."""

    def scaled(v, count):
        return v * 2.0 ** (power + sign * count)

    return scaled


def magnitude(words):
    """|c|, or one less: the one's complement of what is negative."""
    return np.where(words < 0, ~words, words)


def truth(mask):
    """A mask that ``~`` negates."""
    return np.asarray(mask).astype(bool)
