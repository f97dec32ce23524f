# SPDX-License-Identifier: Apache-2.0
"""``ik_fold_memory`` against lists: 64 read/write words, the powers of two after them, and stalls."""

import random

from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge

from tb.units.unit import Tests, places, runs, sets_of

WRITTEN, POWERS = 64, 64


class Memory:
    """Bench of ``ik_fold_memory`` with reference words and a check of the previous clock's reads."""

    def __init__(self, dut, d: int, ad: int, down: int, rw: int) -> None:
        self.dut, self.d, self.rw = dut, d, rw
        self.cut = d - ad
        self.words = [0] * WRITTEN + [1 << d - 1 >> (n if n < ad else n - down) for n in range(POWERS)]
        self.due: list[int] | None = None
        Clock(dut.clk, 10, unit="ns").start()

    async def step(self, a: int, b: int, r: int, write: int | None = None, word: int = 0, go: bool = True) -> None:
        """Run one clock: read three addresses, and write one unless ``write`` is None."""
        dut = self.dut
        await RisingEdge(dut.clk)
        dut.go.value = int(go)
        dut.a_at.value, dut.b_at.value, dut.r_at.value = a, b, r
        dut.w_en.value, dut.w_at.value, dut.w.value = int(write is not None), write or 0, word
        await FallingEdge(dut.clk)
        if self.due is not None:
            found = [str(port.value) for port in (dut.a, dut.b, dut.r)]
            widths = self.d - self.cut, self.d, self.rw
            assert found == [f"{value:0{w}b}" for value, w in zip(self.due, widths, strict=True)]
        if go:
            row = self.words[r] >> self.d - 1 - self.rw & (1 << self.rw) - 1
            self.due = [self.words[a] >> self.cut, self.words[b], row]
            if write is not None:
                self.words[write] = word


async def words(memory: Memory) -> None:
    """Read all addresses before and after writing each; then random accesses with stalls, in which nothing may change.

    No clock reads the address it writes, because the result is undefined.
    """
    for _ in range(2):
        for at in range(WRITTEN + POWERS):
            await memory.step(at, at ^ 1, at % WRITTEN)
        for at in range(WRITTEN):
            await memory.step(at ^ 1, at ^ 2, at ^ 4, write=at, word=random.getrandbits(memory.d))
    for _ in range(3000):
        at = random.randrange(WRITTEN)
        read = [random.randrange(last) for last in (WRITTEN + POWERS, WRITTEN + POWERS, WRITTEN)]
        write = None if at in read else at
        await memory.step(*read, write=write, word=random.getrandbits(memory.d), go=random.random() < 0.8)
    await memory.step(0, 0, 0)


def bench(D: int, AD: int, DOWN: int, RW: int) -> Tests:
    async def all_words(dut) -> None:
        await words(Memory(dut, D, AD, DOWN, RW))

    return {
        "words": all_words,
        "places_a": places("mem_a", WRITTEN + POWERS, AD),
        "places_b": places("mem_b", WRITTEN + POWERS, D),
        "places_r": places("mem_r", WRITTEN, RW),
    }


memory = sets_of("D AD DOWN RW")
test_ik_fold_memory = runs("ik_fold_memory", bench, memory(26, 26, 11, 11), memory(33, 31, 11, 11))
