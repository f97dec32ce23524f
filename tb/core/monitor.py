# SPDX-License-Identifier: Apache-2.0
"""Monitor of both streams and of the nodes."""

from cocotb.triggers import FallingEdge, Timer

from model.io.words import unpack
from tb.core import functional_coverage
from tb.core.driver import Driver
from tb.core.scoreboard import Scoreboard


class Monitor:
    """Monitor of a core: compares each result with the driver's expectation, and lets the scoreboard compare nodes.

    ``bench`` is a :class:`tb.core.pipeline.Pipeline`. ``results`` holds (words, tag, flags, clock) of every output beat
    in order, ``latencies`` the clocks from admission to result, ``errors`` a message for each difference.
    """

    def __init__(self, bench, driver: Driver, scoreboard: Scoreboard) -> None:
        self.bench, self.driver, self.scoreboard = bench, driver, scoreboard
        self.go = bench.core.go if bench.path.times else None  # low: the core is stalled
        self.clock = 0
        self.ran = 0  # clocks in which the core was not stalled
        self.admitted: list[int] = []  # clock of admission of each target
        self.due: list[int] = []  # targets whose result has not left yet
        self.results: list[tuple[tuple[int, ...], int, int, int]] = []
        self.latencies: list[int] = []
        self.errors: list[str] = []
        self.gap = self.held = False  # since the last beat: the input was idle; a result had to wait
        self.gaps: list[bool] = []
        self.lost = False  # a reset has dropped poses, and no result has left since

    async def run(self) -> None:
        """Sample admissions, departures and nodes once per clock. The stream rules are checked by tb/axi/rules."""
        dut = self.bench.dut
        # Verilator randomizes the initial clock level: ignore an edge at time 0.
        await Timer(1, unit="ns")
        while True:
            await FallingEdge(dut.clk)
            self.clock += 1
            if dut.rst.value != 0:
                self.scoreboard.in_clock.clear()
                self.lost |= bool(self.due)
                self.due.clear()
                self.gap = self.held = False
                # Registers keep old values until the first rising edge with rst high; ignore all clocks in reset.
                continue
            if dut.s_axis_tvalid.value == 0:
                self.gap = True
            elif dut.s_axis_tready.value == 1:
                self._admit()
            if dut.m_axis_tvalid.value == 1 and dut.m_axis_tready.value == 1:
                self._leave(str(dut.m_axis_tdata.value), str(dut.m_axis_tuser.value))
            elif dut.m_axis_tvalid.value == 1:
                self.held = True
            self.scoreboard.sample(self.ran, self.clock)
            self.ran += self.go is None or self.go.value == 1

    def _admit(self) -> None:
        target = len(self.admitted)
        self.admitted.append(self.clock)
        self.due.append(target)
        self.gaps.append(self.gap)
        self.gap = False
        if target >= len(self.driver.words):
            self.errors.append(f"target {target} was admitted and never sent")
        else:
            self.scoreboard.in_clock[self.ran] = target

    def _leave(self, data: str, user: str) -> None:
        if "x" in (data + user).lower() or "z" in (data + user).lower():
            self.errors.append(f"X on a valid beat in clock {self.clock}: tdata {data} tuser {user}")
            return
        path, tag_width = self.bench.path, self.bench.tag_width
        words = tuple(unpack([int(data, 2)], self.bench.slot, len(path.results))[0].tolist())
        flags, tag = int(user, 2) >> tag_width, int(user, 2) & ((1 << tag_width) - 1)
        if not self.due:
            self.errors.append(f"a result with tag {tag} in clock {self.clock} without a target")
            return
        target = self.due.pop(0)
        self.results.append((words, tag, flags, self.clock))
        kinds = functional_coverage.kinds_of(self.driver.words[target].tolist(), words, flags, self.bench.width)
        name, late = (path.name, self.lost) if path.side else (path.rtl, False)
        functional_coverage.sample(kinds, name, self.gaps[target], self.held, late)
        self.lost = self.held = False
        self.latencies.append(self.clock - self.admitted[target])
        if (words, tag, flags) != (model := self.driver.expected[target]):
            self.errors.append(f"target {target}: RTL {(words, tag, flags)}, model {model}, in clock {self.clock}")
