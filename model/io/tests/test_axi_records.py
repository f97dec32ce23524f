# SPDX-License-Identifier: Apache-2.0
"""Records in memory against exact arithmetic on their bytes."""

import struct
from fractions import Fraction
from math import floor

import numpy as np
import pytest

from model.io.axi_records import BYTES, core_words, result_records, target_records
from model.io.words import FIELDS

CORNERS = [0, 1, -1, 2**31 - 1, -(2**31), 2**30, -(2**30), 2**13 - 1, 2**13, -(2**13), -(2**13) - 1, 0x7FFFE000]


def test_a_target_in_memory():
    (x, y, z, phi, d1, d2), tag = (1, -2, 3, -4, 5, 6), 0xDEADBEEF
    data = target_records(np.array([(x, y, z, phi, d1, d2)]), np.array([tag]))
    assert data == struct.pack("<6iII", x, y, z, phi, d1, d2, tag, 0) and len(data) == BYTES


@pytest.mark.parametrize("width", [16, 18, 25, 31, 32])
def test_half_up_and_then_saturated_or_wrapped(width):
    random = np.random.default_rng(width)
    words = np.concatenate([np.array([[c] * 6 for c in CORNERS]), random.integers(-(2**31), 2**31, (500, 6))])
    tags = random.integers(0, 2**32, len(words))
    got, kept = core_words(target_records(words, tags), width)
    assert kept.tolist() == [int(tag) % 2**24 for tag in tags]
    least, most = -(2 ** (width - 1)), 2 ** (width - 1) - 1
    for row, mine in zip(words.tolist(), got.tolist(), strict=True):
        for name, word, rounded in zip(FIELDS, row, mine, strict=True):
            exact = floor(Fraction(word, 2 ** (32 - width)) + Fraction(1, 2)) if width < 32 else word
            if name == "phi":
                exact = (exact - least) % 2**width + least
            assert rounded == min(exact, most), f"{name} of {word:#x}"


@pytest.mark.parametrize("width", [16, 18, 32])
def test_a_result_in_memory(width):
    results = np.array([[-(2 ** (width - 1)), 2 ** (width - 1) - 1, 1, -1, 0, 5]] * 3)
    data = result_records(results, np.array([0x81, 0, 0x3F]), np.array([0xABCDEF, 1, 2]), width)
    first = [int(word) << (32 - width) for word in results[0]]
    assert data[:BYTES] == struct.pack("<6iII", *first, 0x81ABCDEF, 0)
    assert data[-8:] == struct.pack("<II", 0x3F000002, 2)
