# SPDX-License-Identifier: Apache-2.0
"""Serial frames of examples/icebreaker.

Target: A5, tag, x, y, z, phi, d1, d2 (3 bytes each, little endian), CRC-16. Answer: 5A, tag, flags, qs_w, qs_i, qs_j,
qs_k, qe_w, qe_i (likewise), CRC-16. With ARM = 1: A5, tag, branch, 11 words; 5A, tag, flags (2 bytes), 17
words.
"""

import binascii
from collections.abc import Sequence

WIDTH = 24  # word length W
WORD = WIDTH // 8
TARGET, ANSWER = b"\xa5", b"\x5a"
ANSWER_BYTES = 1 + 2 + 6 * WORD + 2
ARM_ANSWER_BYTES = 1 + 3 + 17 * WORD + 2


def frame(tag: int, words: Sequence[int]) -> bytes:
    """Return the frame of a target of six signed words, or of a hand pose of eleven and its branch."""
    payload = bytes([tag, *map(int, words[11:])])
    payload += b"".join(int(word).to_bytes(WORD, "little", signed=True) for word in words[:11])
    return TARGET + payload + binascii.crc_hqx(payload, 0xFFFF).to_bytes(2, "big")


class Answers:
    """Decoder of answer frames, by default to targets; other bytes and frames with a wrong CRC are skipped."""

    def __init__(self, size: int = ANSWER_BYTES) -> None:
        self.bytes, self.size = b"", size

    def __call__(self, more: bytes) -> list[tuple[int, int, list[int]]]:
        """Return the answers completed by these bytes: tag, flags, signed words."""
        self.bytes += more
        found = []
        while (start := self.bytes.find(ANSWER)) >= 0 and len(self.bytes) - start >= self.size:
            payload = self.bytes[start + 1 : start + self.size]
            if binascii.crc_hqx(payload, 0xFFFF):  # over payload and CRC
                self.bytes = self.bytes[start + 1 :]
                continue
            self.bytes = self.bytes[start + self.size :]
            first = (len(payload) - 2) % WORD or WORD  # tag and flags
            words = (payload[k : k + WORD] for k in range(first, len(payload) - 2, WORD))
            flags = int.from_bytes(payload[1:first], "little")
            found.append((payload[0], flags, [int.from_bytes(word, "little", signed=True) for word in words]))
        return found
