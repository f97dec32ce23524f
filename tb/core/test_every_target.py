# SPDX-License-Identifier: Apache-2.0
"""All 2^18 targets of 3-bit words, every node: all inputs of the lean pipeline, the top bits of the folded datapath."""

import itertools

import numpy as np
import pytest

from model.dataflow import fixed
from tb.sim.env import simulator
from tb.sim.simulate import Job, simulate

WIDTH = 3
FOLDED = 20
"""Shortest word length of the folded datapath."""


@pytest.fixture(scope="module")
def words():
    """Return all targets; target number n has the input bits of n, with x lowest."""
    signed = np.concatenate([np.arange(1 << (WIDTH - 1)), np.arange(-(1 << (WIDTH - 1)), 0)])
    return np.array(list(itertools.product(signed, repeat=6)))[:, ::-1]


if simulator() == "verilator":

    @pytest.mark.sim
    def test_every_target(words):
        (ran,) = simulate([Job("every", words)], simulator="verilator", datapath="lean", width=WIDTH)
        assert ran.bit_mismatches == 0, ran.first_mismatch
        answer = fixed.run(words, WIDTH, "lean")
        assert (ran.results == answer.results).all() and (ran.flags == answer.flags).all()
        assert ran.total_cycles == len(words) + ran.latency_cycles

    @pytest.mark.sim
    @pytest.mark.slow
    @pytest.mark.cost(20)
    def test_every_folded_target(words):
        words = words << FOLDED - WIDTH
        (ran,) = simulate([Job("every", words)], simulator="verilator", datapath="fold", width=FOLDED)
        assert ran.bit_mismatches == 0, ran.first_mismatch
        answer = fixed.run(words, FOLDED, "fold")
        assert (ran.results == answer.results).all() and (ran.flags == answer.flags).all()
