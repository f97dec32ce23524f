# SPDX-License-Identifier: Apache-2.0
"""Records of 32 bytes in memory, as ``rtl/ik_axi.v`` reads and writes them, and the words of the core.

A record is eight 32-bit words, little endian, independent of the core's word length.  Target: x, y, z
(Q2.30), phi (one turn = 2^32), d1, d2 (Q2.30), tag, 0.  Result: qs_w, qs_i, qs_j, qs_k, qe_w, qe_i (Q2.30), flags << 24
| tag (24 bits), index of the record in its job.
"""

from __future__ import annotations

import numpy as np

from .words import FIELDS, RESULT_FIELDS

BYTES = 32
"""Bytes of a record."""

WORD = np.dtype("<i4")

TAG_BITS = 24
"""Bits of a tag that a result record returns."""


def target_records(words: np.ndarray, tags: np.ndarray) -> bytes:
    """Return the target records of words (N, 6) of 32 bits as `FIELDS`, tags (N,) of 32 bits."""
    records = np.zeros((len(words), BYTES // 4), dtype=np.int64)
    records[:, : len(FIELDS)] = words
    records[:, len(FIELDS)] = tags
    return (records & 0xFFFFFFFF).astype("<u4").tobytes()


def core_words(records: bytes, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Decode target records into words of `width` bits: (N, 6) int64 and tags (N,).

    Words are rounded half up; a length beyond the format saturates, an angle wraps.
    """
    table = np.frombuffer(records, dtype=WORD).astype(np.int64).reshape(-1, BYTES // 4)
    dropped = 32 - width
    half = (1 << dropped) >> 1
    most = (1 << (width - 1)) - 1
    words = (table[:, : len(FIELDS)] + half) >> dropped
    phi = FIELDS.index("phi")
    angle = words[:, phi].copy()
    words = np.minimum(words, most)
    words[:, phi] = ((angle + most + 1) & ((1 << width) - 1)) - (most + 1)
    return words, table[:, len(FIELDS)] & ((1 << TAG_BITS) - 1)


def result_records(results: np.ndarray, flags: np.ndarray, tags: np.ndarray, width: int) -> bytes:
    """Return the result records of a job: results (N, 6) of `width` bits, flags and tags (N,)."""
    count, fields = results.shape
    records = np.zeros((count, BYTES // 4), dtype=np.int64)
    records[:, :fields] = results << (32 - width)
    records[:, fields] = flags << TAG_BITS | tags
    records[:, fields + 1] = np.arange(count)
    return (records & 0xFFFFFFFF).astype("<u4").tobytes()


def result_words(records: bytes, width: int) -> np.ndarray:
    """Return the results (N, 6) of `width` bits in result records."""
    table = np.frombuffer(records, dtype=WORD).astype(np.int64).reshape(-1, BYTES // 4)
    return table[:, : len(RESULT_FIELDS)] >> (32 - width)
