# SPDX-License-Identifier: Apache-2.0
"""Test that the native harness gives the same results and messages as cocotb, also for a broken core."""

import numpy as np
import pytest

from model.dataflow import fixed
from model.io.stimuli import mixed
from tb.sim import native_run
from tb.sim.env import simulator
from tb.sim.job import SimulationError
from tb.sim.seeded_bugs import Bug, copy_rtl
from tb.sim.simulate import simulate

WIDTH = 18
QUICK = 16  # the shortest word length of ik_axis

pytestmark = [pytest.mark.sim, pytest.mark.slow]


if simulator() == "verilator":

    @pytest.fixture(scope="module")
    def program():
        return native_run.program("lean", WIDTH)

    def spoiled(words, change):
        """Return frames, each with targets and their answer; ``change`` has altered the first answer."""
        frames = list(native_run.answered(words, WIDTH, "lean"))
        change(frames[0][1])
        return frames

    LATENCY = fixed.latency("lean", QUICK)

    def broken(folder, bug, ways=(False, True)):
        """Return the runs of an RTL copy with a bug, one for each of ``ways``: with cocotb (False), natively (True)."""
        jobs = [np.random.default_rng(4).integers(-4, 4, (200, 6))]
        core = {"simulator": "verilator", "datapath": "lean", "width": QUICK, "name": f"native-{bug.what}"}
        core["root"] = copy_rtl(folder, bug)
        return [simulate(jobs, **core, native=native)[0] for native in ways]

    def test_both_ways_give_the_same(monkeypatch):
        """Run several jobs, one of them longer than a frame."""
        monkeypatch.setattr(native_run, "FRAME", 100)
        jobs = [mixed(count, WIDTH, seed=count) for count in (1, 60, 330)]
        core = {"simulator": "verilator", "datapath": "lean", "width": WIDTH}
        for cocotb, native in zip(*(simulate(jobs, **core, native=way) for way in (False, True)), strict=True):
            for ours, theirs in zip(vars(native).values(), vars(cocotb).values(), strict=True):
                assert np.array_equal(ours, theirs)

    def test_a_difference_is_told_in_the_same_words(tmp_path):
        bug = Bug("sign", "rtl/lean/ik_lean_turn.v", "c_plus <= cc - ss;", "c_plus <= cc + ss;")
        cocotb, native = broken(tmp_path, bug)
        assert cocotb.bit_mismatches == native.bit_mismatches > 0
        assert "turn.c_plus" in cocotb.first_mismatch
        assert native.first_mismatch == cocotb.first_mismatch
        assert (native.results == cocotb.results).all() and (native.flags == cocotb.flags).all()

    @pytest.mark.parametrize("name", ["x_sq", "u_x", "clamp", "qs_k"])
    def test_every_bit_of_a_node_counts(program, name):
        words = mixed(100, WIDTH, seed=2)
        node = fixed.run(words, WIDTH, "lean").nodes[name]
        for bit in {0, node.format.width - 1}:

            def change(answer, bit=bit):
                value = answer.nodes[name].value.astype(object)
                value[57] = int(value[57]) ^ (1 << bit)
                answer.nodes[name].value = value

            run = native_run.compare(program, spoiled(words, change), WIDTH, "lean")
            assert run.bit_mismatches == 1
            assert run.first_mismatch.startswith(f"first difference: {node.section}.{name} ")
            assert " of target 57 at clock " in run.first_mismatch

    def test_results_and_flags_at_the_port_count(program):
        """Check that wrong results or flags are reported even if all nodes are right, as with a broken FIFO."""
        changes = [lambda answer: np.bitwise_xor.at(answer.results, (3, 5), 1)]
        changes += [lambda answer: np.bitwise_xor.at(answer.flags, 3, 32)]
        for change in changes:
            with pytest.raises(SimulationError, match="target 3: its nodes are right, its result or flags are not"):
                native_run.compare(program, spoiled(mixed(100, WIDTH, seed=2), change), WIDTH, "lean")

    @pytest.mark.parametrize(
        ("module", "right", "wrong", "message"),
        [
            ("ik_axis", "core_tag, core", "core_tag ^ (core_tag == 9), core", "target 9: the result has tag 8"),
            ("lib/ik_credit_fifo", "!rst && (credits != 0)", "!rst && (credits == 0)", "no result for 20000 clocks"),
            (
                "lib/ik_fifo",
                "(wr_ptr == rd_ptr)",
                "(wr_ptr == rd_ptr) || (rd_ptr == 9 && wr_ptr == 10)",
                f"target 9: {LATENCY + 1} clocks, the first took {LATENCY}",
            ),
        ],
    )
    def test_a_broken_stream(tmp_path, module, right, wrong, message):
        name = message.partition(":")[0].replace(" ", "_")
        with pytest.raises(SimulationError, match=message):
            broken(tmp_path, Bug(name, f"rtl/{module}.v", right, wrong), ways=[True])
