# SPDX-License-Identifier: Apache-2.0
"""Bench of ``ik_axis`` and ``ik_arm``: clock, reset, driver, monitor, and a scoreboard for all nodes.

``ik_axis_bytes`` and ``ik_arm_bytes`` use the same bench, without comparing nodes. Tests build on :class:`Pipeline`;
test_plain.py shows a bench without it. All sampling is done at the falling edge of the clock, when inputs and registers
have settled in both simulators.
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
from model.io.words import pack, unpack
from tb.core import functional_coverage
from tb.sim.job import KEPT, Difference, Run, answer, limits_port, report, usual_limits, usual_words
from tb.sim.timeout import timed_test


class Scoreboard:
    """Scoreboard that compares every named node of every target with the model, in the clock where the node is valid.

    ``handle_of(node)`` returns the signal of a node. Call ``expect`` with the model's answers to targets, in order of
    admission. When a target is admitted, set ``in_clock[clock] = target``. Call ``sample`` once per clock.
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
            node = answer.nodes[name]
            mask = (1 << node.format.width) - 1
            values += [int(v) & mask for v in node.value.tolist()]

    def sample(self, clock: int, now: int) -> None:
        """Compare all valid nodes. ``clock`` counts clocks without a stall; ``now`` counts all clocks, for messages."""
        for time, pairs in self.by_time.items():
            target = self.in_clock.get(clock - time)
            if target is None:
                continue
            for node, handle in pairs:
                bits = str(handle.value)  # as text: X or Z is a difference, not an error of the bench
                expected = format(self.expected[node.name][target], f"0{node.format.width}b")
                self.compared += 1
                if bits != expected:
                    difference = Difference(node, target, now, bits, expected)
                    self.mismatching_bits += difference.bits()
                    if len(self.differences) < KEPT:
                        self.differences.append(difference)


class Driver:
    """Driver that sends targets with incrementing tags, and computes the model's answers.

    ``bench`` is a :class:`Pipeline`. ``words`` holds all queued targets in order, and ``expected`` the words, tag and
    flags of each result. The scoreboard gets the model's node values.
    """

    def __init__(self, bench, scoreboard: Scoreboard) -> None:
        self.bench, self.scoreboard = bench, scoreboard
        dut, path = bench.dut, bench.path
        bus = AxiStreamBus.from_prefix(dut, "s_axis")
        self.source = AxiStreamSource(bus, dut.clk, dut.rst, byte_lanes=1, reset_active_level=True)
        self.words = np.zeros((0, len(path.inputs) + bool(path.side)), dtype=np.int64)
        self.expected: list[tuple[tuple[int, ...], int, int]] = []

    def send(self, words: np.ndarray) -> None:
        """Queue targets, with rows as in :mod:`tb.sim.job`. The padding bits above each word are random."""
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
        """Forget all queued targets except the first ``kept``."""
        self.words = self.words[:kept]
        del self.expected[kept:]
        for values in self.scoreboard.expected.values():
            del values[kept:]

    async def unknown_while_idle(self) -> None:
        """Drive X on the input data whenever tvalid is low. The driver's next beat replaces X. Start this as a task."""
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


class Monitor:
    """Monitor of a core: compares each result with the driver's expectation, and lets the scoreboard compare nodes.

    ``bench`` is a :class:`Pipeline`. ``results`` holds the (words, tag, flags, clock) of each output beat, in order.
    ``latencies`` holds the clocks from admission to result. ``errors`` holds a message for each difference.
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


class Pipeline:
    """Bench of one ``ik_axis`` or ``ik_arm``. ``limits`` are the joints' limits, by default :func:`.usual_limits`.

    With ``nodes`` every node is compared, otherwise results only.
    """

    def __init__(self, dut, nodes: bool = True, limits: Limits | None = None) -> None:
        self.dut = dut
        self.width, self.tag_width = int(dut.W.value), int(dut.TAG_W.value)
        self.slot = -(-self.width // 8) * 8 if dut._name.endswith("_bytes") else self.width  # bits of a word in tdata
        top = "ik_arm" if hasattr(dut, "limits") else "ik_axis"
        self.path = path = next(
            path
            for path in MODELS.values()
            if path.top == top and all(int(getattr(dut, key).value) == value for key, value in path.parameters.items())
        )
        self.datapath = path.name
        self.period = path.lap(self.width)
        ports = dut.s_axis_tdata, dut.s_axis_tuser, dut.m_axis_tdata, dut.m_axis_tuser
        data = [len(words) * self.slot for words in (path.inputs, path.results)]
        sizes = [data[0], self.tag_width + len(path.side), data[1], self.tag_width + path.flag_bits]
        assert [len(port) for port in ports] == sizes
        self.limits = limits or usual_limits(self.datapath, self.width)
        if path.side:
            dut.limits.value = limits_port(self.limits, self.width)
        logging.getLogger(f"cocotb.{dut._name}").setLevel(logging.WARNING)  # hides the drivers' banners
        Clock(dut.clk, 10, unit="ns").start(start_high=False)
        dut.rst.value = 1
        compared = fixed.nodes(self.datapath, self.width).values() if nodes else ()
        self.scoreboard = Scoreboard(lambda node: getattr(self.module(node), node.name), compared)
        self.driver = Driver(self, self.scoreboard)
        self.sink = AxiStreamSink(
            AxiStreamBus.from_prefix(dut, "m_axis"), dut.clk, dut.rst, byte_lanes=1, reset_active_level=True
        )
        self.monitor = Monitor(self, self.driver, self.scoreboard)
        cocotb.start_soon(self.monitor.run())

    @property
    def core(self):
        """The instance of the datapath, without the stream logic."""
        return getattr(self.dut, f"g_{self.path.rtl}").u_core

    def module(self, node: Node):
        """Return the module instance that contains a node."""
        return reduce(getattr, filter(None, self.path.instance(node).split(".")), self.core)

    async def reset(self, clocks: int = 4) -> None:
        """Assert reset for ``clocks`` clocks. Core, drivers and scoreboard drop all targets in flight."""
        await RisingEdge(self.dut.clk)
        self.dut.rst.value = 1
        self.driver.source.clear()
        await ClockCycles(self.dut.clk, clocks)
        self.sink.clear()
        self.driver.forget(len(self.monitor.admitted))  # also the targets that were never admitted
        self.dut.rst.value = 0
        # A beat queued at the rising edge is driven at once in one simulator and a clock later in the other.
        await FallingEdge(self.dut.clk)

    def mixed(self, count: int, seed: int) -> np.ndarray:
        """Return shuffled targets of every kind, as in a job of :mod:`tb.sim.job`."""
        return usual_words(self.datapath, count, self.width, seed)

    async def drain(self) -> None:
        """Wait for all results; fail after 20000 clocks without a result."""
        monitor, announced = self.monitor, self.driver.words
        seen, since = len(monitor.results), monitor.clock
        while len(monitor.admitted) < len(announced) or monitor.due:
            await FallingEdge(self.dut.clk)
            if len(monitor.results) != seen:
                seen, since = len(monitor.results), monitor.clock
            assert monitor.clock - since < 20000, (
                f"no result for {monitor.clock - since} clocks: {len(announced)} targets announced, "
                f"{len(monitor.admitted)} admitted, {len(monitor.results)} results"
            )
        await ClockCycles(self.dut.clk, 8, FallingEdge)  # no further result may follow

    def check(self) -> None:
        """Check everything that must hold after a drain: results, order, tags, flags and all compared nodes."""
        errors, board = self.monitor.errors, self.scoreboard
        assert not errors, f"{len(errors)} errors, the first: {errors[0]}"
        first = report(board.differences, board.nodes)
        assert not board.mismatching_bits, f"{board.mismatching_bits} bits differ\n{first}"
        assert board.compared or not (board.nodes and self.monitor.results), "the scoreboard compared nothing"
        functional_coverage.keep()


@timed_test(1e6)
async def run_targets(dut):
    """Run jobs of targets without stalls, with a reset before each job, for :func:`tb.sim.simulate.simulate`.

    IK_FOLDER names a folder. Its file ``jobs`` is a pickled pair: each job's target words, and the joint limits. The
    test writes the files ``runs``, a pickled list of :class:`Run`, and ``progress``, the number of results so far.
    """
    folder = Path(os.environ["IK_FOLDER"])
    jobs, limits = pickle.loads((folder / "jobs").read_bytes())
    bench = Pipeline(dut, limits=limits)
    monitor, board, runs = bench.monitor, bench.scoreboard, []

    async def count():
        while True:
            await ClockCycles(dut.clk, 100, FallingEdge)
            (folder / "progress").write_text(str(len(monitor.results)))

    cocotb.start_soon(count())
    for words in jobs:
        await bench.reset()
        first, since, board.mismatching_bits = len(monitor.results), len(monitor.admitted), 0
        board.differences.clear()
        bench.driver.send(words)
        await bench.drain()
        results, _, flags, clocks = zip(*monitor.results[first:], strict=True)
        cycles = monitor.latencies[first], clocks[-1] - monitor.admitted[-len(clocks)] + 1
        message = report(board.differences, board.nodes, since) or None
        runs.append(Run(np.array(results), np.array(flags), *cycles, board.mismatching_bits, message))
    # A node mismatch is a result of the run; only a broken stream fails it.
    streams = [e for e in monitor.errors if ": RTL " not in e]
    assert not streams, f"{len(streams)} errors, the first: {streams[0]}"
    (folder / "runs").write_bytes(pickle.dumps(runs))
