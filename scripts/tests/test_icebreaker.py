# SPDX-License-Identifier: Apache-2.0
"""Test examples/icebreaker at its pins, and the host script: with a simulated board, it writes the same files as
`make run`, and it reports faults of the board."""

import binascii
import json
import re
import sys

import numpy as np
import pytest

from examples.icebreaker import host
from examples.icebreaker.frames import ANSWER
from model.dataflow import fixed
from scripts import run
from tb.icebreaker.bench import run as simulated
from tb.sim.env import ROOT

HOST = [sys.executable, "-m", "examples.icebreaker.host", "PORT"]


def csv(place, targets):
    """Write few.csv with the first targets of examples/reach.csv; return its path."""
    lines = (ROOT / "examples" / "reach.csv").read_text().splitlines()
    (place / "few.csv").write_text("\n".join(lines[: targets + 1]) + "\n")
    return str(place / "few.csv")


@pytest.mark.sim
@pytest.mark.slow
@pytest.mark.cost(15)
@pytest.mark.usefixtures("simulator")
def test_the_results_of_the_model_although_bytes_are_lost(tmp_path, command):
    """Lose one byte of a middle target, of the last target, and of two answers."""
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


class Board:
    """Serial port with a model of the board; `spoil(n, answer)` returns the bytes to send as the n-th answer."""

    def __init__(self, spoil):
        self.spoil, self.count, self.waiting = spoil, 0, b""

    @property
    def in_waiting(self):
        return len(self.waiting)

    def write(self, target):
        answer = fixed.run(np.array([words_in(target[2:])]), 24, "fold16")
        self.waiting += self.spoil(self.count, answered(target[1], int(answer.flags[0]), answer.results[0]))
        self.count += 1

    def read(self, count):
        content, self.waiting = self.waiting[:count], self.waiting[count:]
        return content

    def close(self):
        pass


def words_in(content):
    return [int.from_bytes(content[3 * k : 3 * k + 3], "little", signed=True) for k in range(6)]


def answered(tag, flags, results):
    """Return an answer's frame: start byte, tag, flags, result words, checksum."""
    payload = bytes([tag, flags]) + b"".join(int(word).to_bytes(3, "little", signed=True) for word in results)
    return ANSWER + payload + binascii.crc_hqx(payload, 0xFFFF).to_bytes(2, "big")


@pytest.fixture
def send(command, tmp_path, monkeypatch):
    """Return a function send(spoil) that runs the host script with three targets on Board(spoil)."""

    def send(spoil):
        monkeypatch.setattr(host.serial, "Serial", lambda *_, **__: Board(spoil))
        return command(host.main, "PORT", "--trajectory", csv(tmp_path, 3), "--timeout", "0.1")

    return send


def test_a_late_answer_is_no_other_target(send):
    """Delay the answers to the first transmission until the targets are sent again."""
    held = []

    def spoil(n, answer):
        if n < 3:
            held.append(answer)
            return b""
        return held.pop(0) + answer

    status, out, err = send(spoil)
    assert (status, err) == (0, []) and ", 3 sent again" in out[-3]


def test_a_wrong_bit(send):
    def spoil(n, answer):
        payload = bytearray(answer[1:-2])
        payload[4] ^= 3 * (n == 1)
        return answered(payload[0], payload[1], words_in(payload[2:]))

    status, _, err = send(spoil)
    assert status == 1
    assert err[0] == "icebreaker: few fails: 2 bits differ from the bit-true model; first: target 1"


def test_a_board_that_does_not_answer(send):
    def noise(n, answer):
        return answer[:9] + b"?" + answer[10:]

    assert send(noise) == (1, [], ["icebreaker: PORT does not answer target 0, sent 4 times"])


FEW = "out_of_reset|skew=0.0|answer_at_once|noise|no_stop_bit|button"


@pytest.mark.sim
@pytest.mark.parametrize(
    ("tests", "arm"),
    [
        pytest.param(FEW, 0, marks=[pytest.mark.slow, pytest.mark.cost(6)]),
        pytest.param(f"^(?!.*({FEW}|program))", 0, marks=pytest.mark.release),
        pytest.param("skew=0.0$|answer_at_once", 1, marks=[pytest.mark.slow, pytest.mark.cost(15)]),
    ],
    ids=["few", "more", "hand poses"],
)
def test_at_the_pins(tests, arm):
    simulated(tests, arm)
