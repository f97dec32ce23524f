# SPDX-License-Identifier: Apache-2.0
"""Serial frames of examples/icebreaker.

Target: A5, tag, x, y, z, phi, d1, d2 (3 bytes each, little endian), CRC-16. Answer: 5A, tag, flags, qs_w, qs_i, qs_j,
qs_k, qe_w, qe_i (likewise), CRC-16.
"""

import binascii
from collections.abc import Sequence

WIDTH = 24  # word length W
WORD = WIDTH // 8
TARGET, ANSWER = b"\xa5", b"\x5a"
ANSWER_BYTES = 1 + 2 + 6 * WORD + 2


def frame(tag: int, words: Sequence[int]) -> bytes:
    """Return the frame of a target of six signed words."""
    payload = bytes([tag]) + b"".join(int(word).to_bytes(WORD, "little", signed=True) for word in words)
    return TARGET + payload + binascii.crc_hqx(payload, 0xFFFF).to_bytes(2, "big")


class Answers:
    """Decoder of answer frames; other bytes and frames with a wrong CRC are skipped."""

    def __init__(self) -> None:
        self.bytes = b""

    def __call__(self, more: bytes) -> list[tuple[int, int, list[int]]]:
        """Return the answers completed by these bytes: tag, flags, six signed words."""
        self.bytes += more
        found = []
        while (start := self.bytes.find(ANSWER)) >= 0 and len(self.bytes) - start >= ANSWER_BYTES:
            payload = self.bytes[start + 1 : start + ANSWER_BYTES]
            if binascii.crc_hqx(payload, 0xFFFF):  # over payload and CRC
                self.bytes = self.bytes[start + 1 :]
                continue
            self.bytes = self.bytes[start + ANSWER_BYTES :]
            words = (payload[2 + WORD * k : 2 + WORD * (k + 1)] for k in range(6))
            found.append((payload[0], payload[1], [int.from_bytes(word, "little", signed=True) for word in words]))
        return found
