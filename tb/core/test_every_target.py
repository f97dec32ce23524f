# SPDX-License-Identifier: Apache-2.0
"""The whole lean pipeline over every input there is, with words of 3 bits: all 2^18 targets, all results and flags."""

import itertools
import shutil
import subprocess

import numpy as np
import pytest

from model.dataflow import fixed
from tb.sim.env import ROOT, environment, simulator
from tb.sim.native import build
from tb.sim.simulate import Job, simulate

WIDTH = 3
HARNESS = ROOT / "tb" / "core" / "every_target.cpp"


@pytest.fixture(scope="module")
def words():
    """Target number n has the input bits n: x in the lowest."""
    signed = np.concatenate([np.arange(1 << (WIDTH - 1)), np.arange(-(1 << (WIDTH - 1)), 0)])
    return np.array(list(itertools.product(signed, repeat=6)))[:, ::-1]


@pytest.fixture(scope="module")
def answers(words, tmp_path_factory):
    """The file that the harness reads."""
    answer = fixed.run(words, WIDTH, "lean")
    packed = answer.flags.astype(np.int64) << (6 * WIDTH)
    for k in range(6):
        packed |= (answer.results[:, k] & ((1 << WIDTH) - 1)) << (k * WIDTH)
    path = tmp_path_factory.mktemp("every") / "answers"
    packed.astype("<u4").tofile(path)
    return path


def run(program, answers):
    command = [program, str(WIDTH), str(answers)]
    return subprocess.run(command, env=environment(), capture_output=True, text=True, check=False)


@pytest.mark.sim
@pytest.mark.slow
def test_every_node_of_some_targets(words):
    """What the results do not show: every node, of targets from all over."""
    some = np.random.default_rng(1).permutation(words)[:1500]
    (ran,) = simulate([Job("some", some)], simulator=simulator(), datapath="lean", width=WIDTH)
    assert ran.bit_mismatches == 0, ran.first_mismatch


if simulator() == "verilator":

    @pytest.mark.sim
    @pytest.mark.slow
    def test_every_target(answers):
        done = run(build("ik_lean", HARNESS, {"W": WIDTH}), answers)
        assert done.returncode == 0, done.stdout + done.stderr
        assert done.stdout.split() == [str(1 << (6 * WIDTH)), "0"]

    @pytest.mark.sim
    @pytest.mark.slow
    def test_a_wrong_pipeline_is_found(answers, tmp_path):
        shutil.copytree(ROOT / "rtl", tmp_path / "rtl")
        module = tmp_path / "rtl" / "lean" / "ik_lean_guard.v"
        right, wrong = "fold     <= (too_near || shoulder_far) && !bad_far", "fold     <= (too_near || shoulder_far)"
        text = module.read_text()
        assert right in text
        module.write_text(text.replace(right, wrong))
        done = run(build("ik_lean", HARNESS, {"W": WIDTH}, root=tmp_path, name="wrong"), answers)
        assert done.returncode == 1
        targets, failures = map(int, done.stdout.split())
        assert targets == 1 << (6 * WIDTH) and 0 < failures < targets
