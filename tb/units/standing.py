# SPDX-License-Identifier: Apache-2.0
"""A module of the folded core, which stands still where ``go`` is 0."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field

from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge

Given = dict[str, int]
"""Port -> word of a clock."""


@dataclass
class Standing:
    """``expected(taken, now)``: the outputs that are defined, from what was given in clocks with ``go``, the newest
    last, and in this one; ``clocks``: of how many it needs to know."""

    dut: object
    expected: Callable[[Sequence[Given], Given], Given]
    clocks: int
    taken: list[Given] = field(default_factory=list)

    async def check(self, vectors: Iterable[Given]) -> None:
        """One a clock, three in ten without ``go``: of those nothing may be taken."""
        dut = self.dut
        Clock(dut.clk, 10, unit="ns").start()
        for now in vectors:
            go = random.random() < 0.7
            await RisingEdge(dut.clk)
            dut.go.value = int(go)
            for port, word in now.items():
                getattr(dut, port).value = word
            await FallingEdge(dut.clk)
            if len(self.taken) >= self.clocks:
                wanted = self.expected(self.taken, now)
                found = {port: str(getattr(dut, port).value) for port in wanted}
                bits = {port: f"{word:0{len(found[port])}b}" for port, word in wanted.items()}
                assert found == bits, f"after {self.taken[-self.clocks :]} and with {now}: {found} instead of {bits}"
            if go:
                self.taken.append(now)
