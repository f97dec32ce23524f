# SPDX-License-Identifier: Apache-2.0
"""Checker for modules of the folded core, which hold their state while ``go`` is 0."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field

from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge

Given = dict[str, int]
"""Port -> word in one clock."""


@dataclass
class Standing:
    """Checker of a module. ``expected(taken, now)`` returns the defined outputs from the inputs of the clocks with
    ``go``, newest last, and of the present clock; ``clocks`` is the number of past inputs it needs."""

    dut: object
    expected: Callable[[Sequence[Given], Given], Given]
    clocks: int
    taken: list[Given] = field(default_factory=list)

    async def check(self, vectors: Iterable[Given]) -> None:
        """Drive one vector per clock, three in ten without ``go``: these must not be taken."""
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
