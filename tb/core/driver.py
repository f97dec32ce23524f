# SPDX-License-Identifier: Apache-2.0
"""Driver of the input stream: targets with tags, pauses, and X between beats."""

import itertools
from collections.abc import Iterable

import numpy as np
from cocotb.triggers import FallingEdge
from cocotb.types import LogicArray
from cocotbext.axi import AxiStreamBus, AxiStreamFrame, AxiStreamSource

from model.io.words import pack
from tb.core.scoreboard import Scoreboard
from tb.sim.job import answer


class Driver:
    """Driver that sends targets with incrementing tags, and announces the model's answers.

    ``bench`` is a :class:`tb.core.pipeline.Pipeline`. ``words`` holds the announced targets in order, and ``expected``
    the words, tag and flags of their results; the scoreboard gets their nodes.
    """

    def __init__(self, bench, scoreboard: Scoreboard) -> None:
        self.bench, self.scoreboard = bench, scoreboard
        dut, path = bench.dut, bench.path
        bus = AxiStreamBus.from_prefix(dut, "s_axis")
        self.source = AxiStreamSource(bus, dut.clk, dut.rst, byte_lanes=1, reset_active_level=True)
        self.words = np.zeros((0, len(path.inputs) + bool(path.side)), dtype=np.int64)
        self.expected: list[tuple[tuple[int, ...], int, int]] = []

    def send(self, words: np.ndarray) -> None:
        """Queue targets: wrist targets (N, 6), or poses with their branch (N, 12). Padding above words is random."""
        bench, count = self.bench, len(self.bench.path.inputs)
        model = answer(words, bench.width, bench.datapath, bench.limits)
        self.words = np.concatenate([self.words, words])
        self.scoreboard.expect(model)
        words, branches = words[:, :count], words[:, count:].sum(axis=1)
        padding = np.random.default_rng(len(words)).integers(1 << bench.slot - bench.width, size=words.shape)
        half = 1 << bench.slot - 1
        padded = ((words & (1 << bench.width) - 1 | padding << bench.width) ^ half) - half
        columns = pack(padded, bench.slot), branches.tolist(), model.results.tolist(), model.flags.tolist()
        for beat, branch, results, flags in zip(*columns, strict=True):
            tag = len(self.expected) & ((1 << bench.tag_width) - 1)
            self.expected.append((tuple(results), tag, flags))
            self.source.send_nowait(AxiStreamFrame([beat], tuser=branch << bench.tag_width | tag))

    def forget(self, kept: int) -> None:
        """Forget all announced targets except the first ``kept``."""
        self.words = self.words[:kept]
        del self.expected[kept:]
        for values in self.scoreboard.expected.values():
            del values[kept:]

    async def unknown_while_idle(self) -> None:
        """Drive X on the input data while tvalid is low, until the driver's next beat. Start this as a task."""
        dut = self.bench.dut
        while True:
            await FallingEdge(dut.clk)
            if dut.s_axis_tvalid.value == 0:
                for line in (dut.s_axis_tdata, dut.s_axis_tuser):
                    line.value = LogicArray("X" * len(line))


def bursts(random: np.random.Generator) -> Iterable[bool]:
    """Yield True for a clock with a pause, else False, in runs of 1 to 11 clocks."""
    while True:
        yield from [bool(random.integers(2))] * int(random.integers(1, 12))


PATTERNS = {
    "none": lambda random: None,
    "single": lambda random: itertools.cycle([True, False]),
    "bursts": bursts,
    "long": lambda random: itertools.cycle([False] * int(random.integers(20, 60)) + [True] * 700),
}
"""Pause patterns of a stream: no pause; every other clock; random lengths; 700 clocks after every 20 to 59 clocks."""


def pause(pattern: str, seed: int) -> Iterable[bool] | None:
    """Return a pause generator, or None for no pauses."""
    return PATTERNS[pattern](np.random.default_rng(seed))
