# SPDX-License-Identifier: Apache-2.0
"""Tests of examples/icebreaker at its pins, and of its host script: with the simulated board it writes the files of
`make run`; faults of the board are reported."""

import binascii
import json
import os
import pty
import re
import sys
import threading
import time
import tty

import numpy as np
import pytest

from examples.icebreaker import host
from examples.icebreaker.frames import ANSWER
from model.dataflow import fixed
from scripts import run, trajectory
from tb.icebreaker.bench import run as simulated
from tb.sim.env import ROOT

HOST = [sys.executable, "-m", "examples.icebreaker.host", "PORT"]


def csv(place, targets):
    """Write a CSV with the first targets of an example."""
    lines = (ROOT / "examples" / "reach.csv").read_text().splitlines()
    (place / "few.csv").write_text("\n".join(lines[: targets + 1]) + "\n")
    return str(place / "few.csv")


@pytest.mark.sim
@pytest.mark.cost(15)
@pytest.mark.usefixtures("simulator")
def test_the_results_of_the_model_although_bytes_are_lost(tmp_path, command):
    """A byte of a middle and of the last target is lost, and of two answers."""
    trajectory, lost = csv(tmp_path, 12), [[22 * 5 + 3, 22 * 11 + 21], [0, 23 * 6 + 22]]
    core = ["--datapath", "fold16", "--width", "24", "--out", "run"]
    assert command(run.main, "--trajectory", trajectory, *core)[0] == 0
    program = [*HOST, "--trajectory", trajectory, "--out", str(tmp_path / "board"), "--timeout", "4"]
    variables = {"IK_PROGRAM": json.dumps(program), "IK_LOST": json.dumps(lost), "IK_SAID": str(tmp_path / "printed")}
    simulated("program", **variables)
    assert int(re.search(r", (\d+) sent again\n", (tmp_path / "printed").read_text())[1]) >= 4
    for name in ("results.csv", "results.npz"):
        assert (tmp_path / "board" / name).read_bytes() == (tmp_path / "run" / name).read_bytes()
    (score,) = json.loads((tmp_path / "board" / "score.json").read_text())
    assert score["passed"] and score["simulator"] == "icebreaker" and score["latency_cycles"] is None


class Board(threading.Thread):
    """Model of the board at the other end of a pseudo-terminal; `spoil(n, answer)` returns the bytes to send as the
    n-th answer."""

    def __init__(self, spoil=lambda n, answer: answer):
        super().__init__(daemon=True)
        self.ours, self.theirs = pty.openpty()
        tty.setraw(self.theirs)
        self.port, self.spoil, self.count = os.ttyname(self.theirs), spoil, 0
        self.start()

    def run(self):
        had = b""
        while True:
            try:
                had += os.read(self.ours, 4096)
            except OSError:
                return
            frames, had = [had[k : k + 22] for k in range(0, len(had) - 21, 22)], had[len(had) // 22 * 22 :]
            answers = frames and fixed.run(np.array([words_in(one[2:]) for one in frames]), 24, "fold16")
            for k, one in enumerate(frames):
                answer = self.spoil(self.count, answered(one[1], int(answers.flags[k]), answers.results[k]))
                self.count += 1
                if answer is None:
                    os.close(self.ours)
                    os.close(self.theirs)
                    return
                os.write(self.ours, answer)


def words_in(some):
    return [int.from_bytes(some[3 * k : 3 * k + 3], "little", signed=True) for k in range(6)]


def answered(tag, flags, results):
    """Return the bytes of an answer: a frame with its own start byte and the flags behind the tag."""
    payload = bytes([tag, flags]) + b"".join(int(word).to_bytes(3, "little", signed=True) for word in results)
    return ANSWER + payload + binascii.crc_hqx(payload, 0xFFFF).to_bytes(2, "big")


@pytest.fixture
def few(tmp_path):
    return csv(tmp_path, 3)


def test_all_trajectories(command, files, monkeypatch):
    monkeypatch.setattr(trajectory, "hand_bar", lambda words, *_: np.ones(len(words)))
    status, out, err = command(host.main, Board().port, "--trajectory", "all", "--timeout", "5")
    assert (status, err) == (0, []) and any(", 0 sent again" in line for line in out)
    assert sum(name.endswith("results.csv") for name in files()) == len(run.trajectories.TRAJECTORIES)
    assert not [line for line in out if "latency" in line]


def test_a_late_answer_is_no_other_target(command, few):
    """Answers to the first transmission arrive after the retransmission."""
    held = []

    def spoil(n, answer):
        if n < 3:
            held.append(answer)
            return b""
        return held.pop(0) + answer

    status, out, err = command(host.main, Board(spoil).port, "--trajectory", few, "--timeout", "0.2")
    assert (status, err) == (0, []) and ", 3 sent again" in out[-3]


def test_a_wrong_bit(command, few):
    def spoil(n, answer):
        payload = bytearray(answer[1:-2])
        payload[4] ^= 3 * (n == 1)
        return answered(payload[0], payload[1], words_in(payload[2:]))

    status, _, err = command(host.main, Board(spoil).port, "--trajectory", few)
    assert status == 1
    assert err[0] == "icebreaker: few fails: 2 bits differ from the bit-true model; first: target 1"


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda n, answer: answer[:9] + b"?" + answer[10:], "{} does not answer target 0, sent 4 times"),
        (lambda n, answer: None, "lost {}: "),
    ],
    ids=["noisy", "gone"],
)
def test_a_board_that_does_not_answer(command, few, files, spoil, message):
    board = Board(spoil)
    before = files()
    status, out, err = command(host.main, board.port, "--trajectory", few, "--timeout", "0.1")
    assert (status, out, len(err)) == (1, [], 1)
    assert err[0].startswith(f"icebreaker: {message.format(board.port)}")
    assert files() == before


def test_a_board_that_talks(command, few):
    class Talking(Board):
        def run(self):
            while True:
                os.write(self.ours, b"hello ")
                time.sleep(0.005)

    port = Talking().port
    status, _, err = command(host.main, port, "--trajectory", few, "--timeout", "0.2")
    assert (status, err) == (1, [f"icebreaker: {port} sends unrequested data: is it the right board?"])


FEW = "out_of_reset|skew=0.0|answer_at_once|noise|no_stop_bit|button"


@pytest.mark.sim
@pytest.mark.parametrize(
    "tests",
    [
        pytest.param(FEW, marks=pytest.mark.cost(6)),
        pytest.param(f"^(?!.*({FEW}|program))", marks=pytest.mark.release),
    ],
    ids=["few", "more"],
)
def test_at_the_pins(tests):
    simulated(tests)


@pytest.mark.sim
@pytest.mark.cost(15)
def test_hand_poses_at_the_pins():
    simulated("skew=0.0$|answer_at_once", 1)
