# SPDX-License-Identifier: Apache-2.0
"""The frames of examples/icebreaker, as bytes of a serial line.

A target: A5, its tag, x, y, z, phi, d1, d2 of 3 bytes each, lowest first, a CRC-16. Its answer: 5A, the tag, the flags,
qs_w, qs_i, qs_j, qs_k, qe_w, qe_i likewise, a CRC-16.
"""

from __future__ import annotations

import binascii
from collections.abc import Sequence

WIDTH = 24
"""Bits of a word."""
WORD = WIDTH // 8
TARGET, ANSWER = b"\xa5", b"\x5a"
ANSWER_BYTES = 1 + 2 + 6 * WORD + 2


def frame(tag: int, words: Sequence[int]) -> bytes:
    """The bytes of a target of six signed words."""
    payload = bytes([tag]) + b"".join(int(word).to_bytes(WORD, "little", signed=True) for word in words)
    return TARGET + payload + binascii.crc_hqx(payload, 0xFFFF).to_bytes(2, "big")


class Answers:
    """Bytes to answers; what is no frame, or one whose check is wrong, is passed over."""

    def __init__(self) -> None:
        self.bytes = b""

    def __call__(self, more: bytes) -> list[tuple[int, int, list[int]]]:
        """The answers that these bytes complete: tag, flags, six signed words."""
        self.bytes += more
        found = []
        while (start := self.bytes.find(ANSWER)) >= 0 and len(self.bytes) - start >= ANSWER_BYTES:
            payload = self.bytes[start + 1 : start + ANSWER_BYTES]
            if binascii.crc_hqx(payload, 0xFFFF):  # over payload and check
                self.bytes = self.bytes[start + 1 :]
                continue
            self.bytes = self.bytes[start + ANSWER_BYTES :]
            words = (payload[2 + WORD * k : 2 + WORD * (k + 1)] for k in range(6))
            found.append((payload[0], payload[1], [int.from_bytes(word, "little", signed=True) for word in words]))
        return found
