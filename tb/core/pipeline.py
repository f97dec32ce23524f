# SPDX-License-Identifier: Apache-2.0
"""Bench of ``ik_axis`` and ``ik_arm``: clock, reset, stream drivers, monitors, model, and a scoreboard for all nodes.

``ik_axis_bytes`` uses the same bench, without comparing nodes. Tests build on :class:`Pipeline`. All sampling is done
at the falling edge of the clock, when inputs and registers have settled in both simulators.
"""

import itertools
import logging
import os
import pickle
from collections.abc import Iterable
from functools import reduce
from pathlib import Path

import cocotb
import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge, RisingEdge, Timer
from cocotb.types import LogicArray
from cocotbext.axi import AxiStreamBus, AxiStreamFrame, AxiStreamSink, AxiStreamSource

from model.dataflow import fixed
from model.dataflow.datapaths import MODELS
from model.dataflow.nodes import Limits, Node
from model.io.stimuli import arm_limits, arm_targets, mixed
from model.io.words import pack, unpack
from tb.core import functional_coverage
from tb.sim.job import KEPT, Difference, Run, answer, limits_port, report


class Scoreboard:
    """Scoreboard that compares every named node of every target with the model, in the clock where the node is valid.

    ``handle_of(node)`` returns the signal of a node. Call ``expect`` with targets in order of admission. When a
    target is admitted, set ``in_clock[clock] = target``. Call ``sample`` once per clock.
    """

    def __init__(self, handle_of, nodes: Iterable[Node]) -> None:
        self.nodes = list(nodes)
        self.by_time: dict[int, list[tuple[Node, object]]] = {}
        for node in self.nodes:
            self.by_time.setdefault(node.time, []).append((node, handle_of(node)))
        self.expected: dict[str, list[int]] = {node.name: [] for node in self.nodes}
        self.in_clock: dict[int, int] = {}  # clock of admission -> target
        self.compared = 0
        self.mismatching_bits = 0
        self.differences: list[Difference] = []

    def expect(self, answer: fixed.Answer) -> None:
        """Append the model's node values of the next targets."""
        for name, values in self.expected.items():
            node = answer.bits.nodes[name]
            mask = (1 << node.format.width) - 1
            values += [int(v) & mask for v in node.value.tolist()]

    def sample(self, clock: int, now: int) -> None:
        """Compare all valid nodes. ``clock`` counts clocks without a stall; ``now`` counts all clocks, for messages."""
        for time, pairs in self.by_time.items():
            target = self.in_clock.get(clock - time)
            if target is None:
                continue
            for node, handle in pairs:
                bits = str(handle.value)
                expected = self.expected[node.name][target]
                self.compared += 1
                if bits != format(expected, f"0{node.format.width}b"):
                    difference = Difference(node, target, now, bits, expected)
                    self.mismatching_bits += difference.bits()
                    if len(self.differences) < KEPT:
                        self.differences.append(difference)

    def report(self, since: int = 0) -> str:
        """Return a message about the first target that differs; empty if none does. Numbers count from ``since``."""
        return report(self.differences, self.nodes, since=since)


def configuration(dut) -> str:
    """Return the name of the datapath that ``ik_axis`` or ``ik_arm`` is built with."""
    top = "ik_arm" if hasattr(dut, "limits") else "ik_axis"
    return next(
        name
        for name, path in MODELS.items()
        if path.top == top and all(int(getattr(dut, key).value) == value for key, value in path.parameters.items())
    )


class Pipeline:
    """Bench around one ``ik_axis`` or ``ik_arm``. ``limits`` are the joints' limits, by default :func:`arm_limits`.

    With ``nodes`` every node is compared, otherwise results only. ``results`` holds (words, tag, flags, clock) of every
    output beat in order; ``latencies`` holds the clocks from admission to result.
    """

    def __init__(self, dut, nodes: bool = True, limits: Limits | None = None) -> None:
        self.dut = dut
        self.width, self.tag_width = int(dut.W.value), int(dut.TAG_W.value)
        self.slot = -(-self.width // 8) * 8 if dut._name == "ik_axis_bytes" else self.width  # bits of a word in tdata
        self.datapath = configuration(dut)
        path, tag = MODELS[self.datapath], self.tag_width
        self.path = path
        ports = dut.s_axis_tdata, dut.s_axis_tuser, dut.m_axis_tdata, dut.m_axis_tuser
        data = [len(words) * self.slot for words in (path.inputs, path.results)]
        assert [len(port) for port in ports] == [data[0], tag + len(path.side), data[1], tag + path.flag_bits]
        self.limits = limits or arm_limits(self.width)
        if path.side:
            dut.limits.value = limits_port(self.limits, self.width)
        logging.getLogger(f"cocotb.{dut._name}").setLevel(logging.WARNING)  # hides the drivers' banners
        Clock(dut.clk, 10, unit="ns").start(start_high=False)
        dut.rst.value = 1
        self.source, self.sink = (
            kind(AxiStreamBus.from_prefix(dut, name), dut.clk, dut.rst, byte_lanes=1, reset_active_level=True)
            for kind, name in ((AxiStreamSource, "s_axis"), (AxiStreamSink, "m_axis"))
        )
        compared = fixed.nodes(self.datapath, self.width).values() if nodes else ()
        self.scoreboard = Scoreboard(lambda node: getattr(self.module(node), node.name), compared)
        self.period = path.lap(self.width)
        self.go = getattr(self.dut, f"g_{path.rtl}").u_core.go if path.times else None  # low: the core is stalled
        self.clock = 0
        self.ran = 0  # clocks in which the core was not stalled
        self.words = np.zeros((0, len(path.inputs) + bool(path.side)), dtype=np.int64)  # announced targets, in order
        self.expected: list[tuple[tuple[int, ...], int, int]] = []  # words, tag, flags of announced targets' results
        self.admitted: list[int] = []  # clock of admission of each target
        self.due: list[int] = []  # targets whose result has not left yet
        self.results: list[tuple[tuple[int, ...], int, int, int]] = []
        self.latencies: list[int] = []
        self.errors: list[str] = []
        self.gap = self.held = False  # since the last beat: the input was idle; a result had to wait
        self.gaps: list[bool] = []
        self.lost = False  # a reset has dropped poses, and no result has left since
        cocotb.start_soon(self._watch())

    def module(self, node: Node):
        """Return the module instance that contains a node."""
        core = getattr(self.dut, f"g_{self.path.rtl}").u_core
        return reduce(getattr, filter(None, self.path.instance(node).split(".")), core)

    async def reset(self, clocks: int = 4) -> None:
        """Assert reset for ``clocks`` clocks. Core, drivers and scoreboard drop all targets in flight."""
        await RisingEdge(self.dut.clk)
        self.dut.rst.value = 1
        self.source.clear()
        await ClockCycles(self.dut.clk, clocks)
        self.sink.clear()
        # Forget targets that were announced but never admitted.
        dropped = len(self.admitted)
        self.words = self.words[:dropped]
        del self.expected[dropped:]
        for values in self.scoreboard.expected.values():
            del values[dropped:]
        self.dut.rst.value = 0
        # A beat queued at the rising edge is driven at once in one simulator and a clock later in the other.
        await FallingEdge(self.dut.clk)

    def mixed(self, count: int, seed: int) -> np.ndarray:
        """Return shuffled targets of every kind: wrist targets (N, 6), or poses with their branch (N, 12)."""
        return (arm_targets if self.path.side else mixed)(count, self.width, seed)

    def around(self, words: np.ndarray) -> np.ndarray:
        """Return the wrist targets ``words``; for the whole arm, return poses with these wrists."""
        hands = [(0, 1 << self.width - 2, 0, 0, 0, n % 8) for n in range(len(words))]  # tool, Qh, branch
        return np.column_stack([words, hands]) if self.path.side else words

    def send(self, words: np.ndarray) -> None:
        """Queue targets with incrementing tags: wrist targets (N, 6), or poses with their branch (N, 12)."""
        model = answer(words, self.width, self.datapath, self.limits)
        self.words = np.concatenate([self.words, words])
        self.scoreboard.expect(model)
        count = len(self.path.inputs)
        words, branches = words[:, :count], words[:, count:].sum(axis=1)
        padding = np.random.default_rng(len(words)).integers(1 << self.slot - self.width, size=words.shape)
        half = 1 << self.slot - 1
        padded = ((words & (1 << self.width) - 1 | padding << self.width) ^ half) - half
        columns = pack(padded, self.slot), branches.tolist(), model.results.tolist(), model.flags.tolist()
        for beat, branch, results, flags in zip(*columns, strict=True):
            tag = len(self.expected) & ((1 << self.tag_width) - 1)
            self.expected.append((tuple(results), tag, flags))
            self.source.send_nowait(AxiStreamFrame([beat], tuser=branch << self.tag_width | tag))

    async def drain(self, most_clocks: int = 20000) -> None:
        """Wait for all results; fail after ``most_clocks`` clocks without a result."""
        seen, since = len(self.results), self.clock
        while len(self.admitted) < len(self.words) or self.due:
            await FallingEdge(self.dut.clk)
            if len(self.results) != seen:
                seen, since = len(self.results), self.clock
            assert self.clock - since < most_clocks, (
                f"no result for {most_clocks} clocks: {len(self.words)} targets announced, {len(self.admitted)} "
                f"admitted, {len(self.results)} results"
            )
        await ClockCycles(self.dut.clk, 8, FallingEdge)  # no further result may follow

    async def finish(self) -> None:
        await self.drain()
        self.check()

    def check(self) -> None:
        """Check everything that must hold after a drain: results, order, tags, flags and all compared nodes."""
        assert not self.errors, f"{len(self.errors)} errors, the first: {self.errors[0]}"
        board = self.scoreboard
        assert not board.mismatching_bits, f"{board.mismatching_bits} bits differ\n{board.report()}"
        assert board.compared or not (board.nodes and self.results), "the scoreboard compared nothing"
        functional_coverage.keep()

    async def _watch(self) -> None:
        """Sample admissions, departures and nodes once per clock. The stream rules are checked by tb/axi/rules."""
        dut = self.dut
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

    async def unknown_while_idle(self) -> None:
        """Drive X on the input data while tvalid is low, until the driver's next beat. Start this as a task."""
        dut = self.dut
        while True:
            await FallingEdge(dut.clk)
            if dut.s_axis_tvalid.value == 0:
                for line in (dut.s_axis_tdata, dut.s_axis_tuser):
                    line.value = LogicArray("X" * len(line))

    def _admit(self) -> None:
        target = len(self.admitted)
        self.admitted.append(self.clock)
        self.due.append(target)
        self.gaps.append(self.gap)
        self.gap = False
        if target >= len(self.words):
            self.errors.append(f"target {target} was admitted and never sent")
        else:
            self.scoreboard.in_clock[self.ran] = target

    def _leave(self, data: str, user: str) -> None:
        if "x" in (data + user).lower() or "z" in (data + user).lower():
            self.errors.append(f"X on a valid beat in clock {self.clock}: tdata {data} tuser {user}")
            return
        words = tuple(unpack([int(data, 2)], self.slot, len(self.path.results))[0].tolist())
        flags, tag = int(user, 2) >> self.tag_width, int(user, 2) & ((1 << self.tag_width) - 1)
        if not self.due:
            self.errors.append(f"a result with tag {tag} in clock {self.clock} without a target")
            return
        target = self.due.pop(0)
        self.results.append((words, tag, flags, self.clock))
        kinds = functional_coverage.kinds_of(self.words[target].tolist(), words, flags, self.width)
        name, late = (self.path.name, self.lost) if self.path.side else (self.path.rtl, False)
        functional_coverage.sample(kinds, name, self.gaps[target], self.held, late)
        self.lost = self.held = False
        self.latencies.append(self.clock - self.admitted[target])
        if (words, tag, flags) != (model := self.expected[target]):
            self.errors.append(f"target {target}: RTL {(words, tag, flags)}, model {model}, in clock {self.clock}")


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


@cocotb.test()
async def run_targets(dut):
    """Run jobs of targets without stalls, with a reset before each job: the cocotb side of ``tb/sim/simulate.py``.

    IK_FOLDER names a folder. Its file ``jobs`` is a pickle of each job's target words and the joints' limits. This
    writes the files ``runs``, a pickled list of :class:`Run`, and ``progress``, the number of results so far.
    """
    folder = Path(os.environ["IK_FOLDER"])
    jobs, limits = pickle.loads((folder / "jobs").read_bytes())
    bench = Pipeline(dut, limits=limits)
    board, runs = bench.scoreboard, []

    async def count():
        while True:
            await ClockCycles(dut.clk, 100, FallingEdge)
            (folder / "progress").write_text(str(len(bench.results)))

    cocotb.start_soon(count())
    for words in jobs:
        await bench.reset()
        first, bits, since = len(bench.results), board.mismatching_bits, len(bench.admitted)
        board.differences.clear()
        bench.send(words)
        await bench.drain()
        results, _, flags, clocks = zip(*bench.results[first:], strict=True)
        total, bits = clocks[-1] - bench.admitted[-len(clocks)] + 1, board.mismatching_bits - bits
        message = board.report(since=since) or None
        runs.append(Run(np.array(results), np.array(flags), bench.latencies[first], total, bits, message))
    # A node mismatch is a result of the run; only a broken stream fails it.
    streams = [e for e in bench.errors if ": RTL " not in e]
    assert not streams, f"{len(streams)} errors, the first: {streams[0]}"
    (folder / "runs").write_bytes(pickle.dumps(runs))
