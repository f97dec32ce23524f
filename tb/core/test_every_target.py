# SPDX-License-Identifier: Apache-2.0
"""The whole lean pipeline over every input there is, with words of 3 bits: all 2^18 targets, every node."""

import itertools

import numpy as np
import pytest

from model.dataflow import fixed
from tb.sim.env import simulator
from tb.sim.mutants import Bug, copy_rtl
from tb.sim.simulate import Job, simulate

WIDTH = 3


@pytest.fixture(scope="module")
def words():
    """Target number n has the input bits n: x in the lowest."""
    signed = np.concatenate([np.arange(1 << (WIDTH - 1)), np.arange(-(1 << (WIDTH - 1)), 0)])
    return np.array(list(itertools.product(signed, repeat=6)))[:, ::-1]


if simulator() == "icarus":

    @pytest.mark.sim
    @pytest.mark.slow
    def test_some_targets(words):
        """From all over: all of them would take an hour."""
        some = np.random.default_rng(1).permutation(words)[:1500]
        (ran,) = simulate([Job("some", some)], simulator=simulator(), datapath="lean", width=WIDTH)
        assert ran.bit_mismatches == 0, ran.first_mismatch


if simulator() == "verilator":

    @pytest.mark.sim
    @pytest.mark.slow
    def test_every_target(words):
        (ran,) = simulate([Job("every", words)], simulator="verilator", datapath="lean", width=WIDTH)
        assert ran.bit_mismatches == 0, ran.first_mismatch
        answer = fixed.run(words, WIDTH, "lean")
        assert (ran.results == answer.results).all() and (ran.flags == answer.flags).all()
        assert ran.total_cycles == len(words) + ran.latency_cycles

    @pytest.mark.sim
    @pytest.mark.slow
    def test_a_wrong_pipeline_is_found(words, tmp_path):
        wrong = "fold     <= (too_near || at_shoulder_at_too_far)"
        bug = Bug("wrong", "rtl/lean/ik_lean_guard.v", f"{wrong} && !bad_length_at_too_far", wrong)
        core = {"datapath": "lean", "width": WIDTH, "root": copy_rtl(tmp_path, bug), "name": bug.what}
        (ran,) = simulate([Job("every", words)], simulator="verilator", **core)
        assert 0 < ran.bit_mismatches
        assert ran.first_mismatch.startswith("first difference: guard.fold")
