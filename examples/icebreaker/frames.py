# SPDX-License-Identifier: Apache-2.0
"""Serial frames between a host and examples/icebreaker.

    target                 A5, tag, x, y, z, phi, d1, d2, CRC
    answer                 5A, tag, flags, qs_w, qs_i, qs_j, qs_k, qe_w, qe_i, CRC
    hand pose (ARM = 1)    A5, tag, branch, 11 words, CRC
    answer (ARM = 1)       5A, tag, flags (2 bytes), 17 words, CRC

A word has 3 bytes, little endian. The CRC-16 (big endian) covers all preceding bytes except the first.
"""

import binascii
from collections.abc import Sequence

WIDTH = 24  # word length W
WORD = WIDTH // 8
TARGET, ANSWER = b"\xa5", b"\x5a"
ANSWER_BYTES = 1 + 2 + 6 * WORD + 2
ARM_ANSWER_BYTES = 1 + 3 + 17 * WORD + 2


def frame(tag: int, words: Sequence[int]) -> bytes:
    """Return the frame of a target (six signed words), or of a hand pose (eleven signed words, then the branch)."""
    payload = bytes([tag, *map(int, words[11:])])
    payload += b"".join(int(word).to_bytes(WORD, "little", signed=True) for word in words[:11])
    return TARGET + payload + binascii.crc_hqx(payload, 0xFFFF).to_bytes(2, "big")


class Answers:
    """Decoder of answer frames of `size` bytes. It skips frames with a wrong CRC, and bytes outside of frames."""

    def __init__(self, size: int = ANSWER_BYTES) -> None:
        self.bytes, self.size = b"", size

    def __call__(self, more: bytes) -> list[tuple[int, int, list[int]]]:
        """Add received bytes; return the answers that they complete: tag, flags, signed words."""
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
