# SPDX-License-Identifier: Apache-2.0
"""Tests of examples/icebreaker at its pins. Answers match the bit-true model, invalid frames get no answer, and a
host program works with the board."""

import binascii
import json
import logging
import os
import pty
import subprocess
import tty
from pathlib import Path

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge, Timer, with_timeout
from cocotbext.uart import UartSink, UartSource

from examples.icebreaker import frames as protocol
from examples.icebreaker.frames import TARGET, WIDTH, Answers, frame
from tb.sim.env import ROOT
from tb.sim.job import answer, limits_port, usual_limits, usual_words
from tb.sim.runner import simulate
from tb.sim.timeout import timed_test

PERIOD = 40  # clock period in ns
BIT = 6  # clocks per bit
BAUD = 1e9 / (PERIOD * BIT)
QUIET = 512  # clocks of silence that end a frame
PARAMETERS = {"CLOCK": 10**9 // PERIOD, "BAUD": int(BAUD), "LOG2_QUIET": QUIET.bit_length() - 1}
BYTE = 10 * BIT  # clocks per byte
FOLDER = ROOT / "examples" / "icebreaker"
PLL = Path(__file__).with_name("SB_PLL40_PAD.v")

LIMITS = "{7{24'h7FFFFF, 24'h800000}}", f"336'h{limits_port(usual_limits('fold_arm16', WIDTH), WIDTH):x}"
"""Verilog text of the top's default joint limits, and of the limits that replace it in tests."""

ARM = bool(getattr(getattr(getattr(cocotb, "top", None), "ARM", None), "value", 0))  # the board solves hand poses
TARGET_BYTES, ANSWER_BYTES = (38, protocol.ARM_ANSWER_BYTES) if ARM else (22, protocol.ANSWER_BYTES)
TARGETS = 4 if ARM else 10


def run(tests: str, arm: int = 0, **env: str) -> None:
    """Run the tests that match ``tests`` on the example with a model of its PLL. Raise SystemExit if one fails."""
    top = "".join(path.read_text(encoding="utf-8") for path in [*sorted(FOLDER.glob("*.v")), PLL])
    if arm:
        top = top.replace(*LIMITS)
    env = {"COCOTB_TEST_FILTER": tests, **env}
    simulate("icebreaker", __name__, top=top, parameters=PARAMETERS | {"ARM": arm}, env=env)


class Board:
    """Pins of the board. The sender uses ``stop_bits`` stop bits; its baud rate has the relative error ``skew``."""

    def __init__(self, dut, stop_bits: int = 2, skew: float = 0.0):
        for name in ("RX", "TX"):
            logging.getLogger(f"cocotb.{dut._name}.{name}").setLevel(logging.WARNING)
        self.dut = dut
        cocotb.start_soon(Clock(dut.CLK, PERIOD, "ns").start())
        self.source = UartSource(dut.RX, baud=BAUD * (1 + skew), stop_bits=stop_bits)
        self.sink = UartSink(dut.TX, baud=BAUD)
        self.answers = Answers(ANSWER_BYTES)

    async def clocks(self, count: int) -> None:
        await ClockCycles(self.dut.CLK, count)

    async def press(self) -> "Board":
        """Press the button, wait until reset has ended, and clear the received bytes. Return the board."""
        self.dut.BTN_N.value = 0
        await self.clocks(30)
        self.dut.BTN_N.value = 1
        await self.clocks(100 + BYTE)
        self.sink.clear()
        return self

    async def send(self, some: bytes) -> None:
        await self.source.write(some)
        await self.source.wait()
        await self.clocks(2)

    async def heard(self, count: int) -> list[tuple[int, int, list[int]]]:
        """Wait for ``count`` answers, at most for the time of ``count`` + 1; return the answers received."""
        answers: list = []
        for _ in range((count + 1) * (ANSWER_BYTES + 3)):
            await self.clocks(BYTE)
            answers += self.answers(bytes(self.sink.read_nowait()))
            if len(answers) == count:
                break
        return answers

    async def nothing(self) -> None:
        """Check that no byte arrives for as long as an answer would take."""
        await self.clocks((ANSWER_BYTES + 3) * BYTE)
        assert self.sink.empty() and int(self.dut.TX.value) == 1

    def lit(self) -> str:
        """Return the lit LEDs: G, R, GR or an empty string."""
        return "".join(name for name in "GR" if not int(getattr(self.dut, f"LED{name}_N").value))


def targets(count: int, seed: int = 1) -> tuple[list[bytes], list[tuple[int, int, list[int]]]]:
    """Return frames of targets of all kinds, and the expected answers. Tags count from 7 and wrap after 255."""
    datapath = "fold_arm16" if ARM else "fold16"
    words = usual_words(datapath, count, WIDTH, seed)
    model = answer(words, WIDTH, datapath)
    tags = [(k + 7) % 256 for k in range(count)]
    answers = zip(tags, model.flags.tolist(), model.results.tolist(), strict=True)
    return list(map(frame, tags, words)), list(answers)


async def still_works(at: Board, seed: int = 5) -> None:
    """Check that a target is answered and that the red LED is off afterwards."""
    (sent,), expected = targets(1, seed)
    await at.send(sent)
    assert await at.heard(1) == expected
    assert at.lit() == "G"


@timed_test()
async def out_of_reset(dut):
    """The green LED is off until the PLL locks, then on; nothing is sent before a target arrives."""
    dut.BTN_N.value = 1
    at = Board(dut)
    await at.clocks(2)
    while not int(dut.u_pll.LOCK.value):
        assert at.lit() in ("", "R") and int(dut.LEDG_N.value) == 1
        await at.clocks(1)
    await at.clocks(40)
    assert at.lit() == "G" and int(dut.TX.value) == 1
    await at.nothing()
    await still_works(at)


@cocotb.parametrize(skew=(-0.03, 0.0, 0.03))
@timed_test()
async def every_bit(dut, skew):
    """Send targets with two stop bits and clock skew. Pause after a hand pose: its answer is longer than its frame."""
    at = await Board(dut, skew=skew).press()
    sent, expected = targets(TARGETS, seed=int(100 * skew) + 3)
    for target in sent:
        at.source.write_nowait(target)
        if ARM:
            await at.clocks(ANSWER_BYTES * BYTE)
    assert await at.heard(TARGETS) == expected
    assert at.lit() == "G"
    await at.nothing()


@timed_test()
async def answer_at_once(dut):
    """A single target is answered after its last byte; the answer has no gaps."""
    at = await Board(dut).press()
    (sent,), expected = targets(1)
    cocotb.start_soon(at.source.write(sent))
    await at.clocks(TARGET_BYTES * (BYTE + BIT) - 3 * BIT)
    assert at.sink.empty() and int(dut.TX.value) == 1
    await FallingEdge(dut.TX)
    await at.clocks(2)
    assert at.source.idle()
    await at.clocks(ANSWER_BYTES * BYTE)
    assert at.answers(bytes(at.sink.read_nowait())) == expected


@timed_test()
async def wrong_bits(dut):
    """A frame with a wrong bit gets no answer and lights the red LED. A wrong first byte starts no frame: the LED stays
    off. A frame is rejected if only one byte of its CRC matches."""
    at = await Board(dut).press()
    sent, _ = targets(22, seed=9)
    wrong = [bytes(byte ^ (at == k) << k % 8 for at, byte in enumerate(one)) for k, one in enumerate(sent)]
    checks = [sent[0][:-2] + check.to_bytes(2, "big") for check in range(1 << 16)]
    left = [binascii.crc_hqx(one[1:], 0xFFFF) for one in checks]
    pairs = list(zip(checks, left, strict=True))
    wrong += [next(one for one, crc in pairs if crc and not crc & half) for half in (0xFF, 0xFF00)]
    for k, one in enumerate(wrong):
        await at.send(one)
        await at.nothing()
        assert at.lit() == ("GR" if k else "G"), f"frame {k}"
        await still_works(at, seed=k)


@timed_test()
async def cut_frames(dut):
    """A truncated frame is dropped after a pause; bytes between frames are ignored."""
    at = await Board(dut).press()
    (sent,), expected = targets(1, seed=11)
    for length in (1, 2, 20, 21):
        await at.send(sent[:length])
        await at.clocks(QUIET - 2 * BYTE)
        assert at.lit() == "G"
        await at.clocks(3 * BYTE)
        assert at.lit() == "GR", f"{length} bytes"
        await still_works(at)
    await at.send(bytes(byte for byte in range(256) if byte != TARGET[0]))
    await at.nothing()
    assert at.lit() == "G"
    for part in (sent[:9], sent[9:]):  # a pause that is too short to end the frame
        await at.send(part)
        await at.clocks(QUIET - 2 * BYTE)
    assert await at.heard(1) == expected


@timed_test()
async def noise(dut):
    """A low pulse shorter than half a bit is no start bit, neither when idle nor within a frame."""
    at = await Board(dut).press()
    (sent,), expected = targets(1, seed=12)

    async def glitch():
        dut.RX.value = 0
        await Timer(PERIOD * (BIT // 2 - 1), "ns")
        dut.RX.value = 1
        await at.clocks(2 * BIT)

    await glitch()
    await at.nothing()
    await at.send(sent[:6])
    await glitch()
    await at.send(sent[6:])
    assert await at.heard(1) == expected
    assert at.lit() == "G"


@timed_test()
async def no_stop_bit(dut):
    """A byte without a stop bit ends its frame at once. As the first byte, it starts no frame."""
    at = await Board(dut).press()
    (sent,), expected = targets(1, seed=13)

    async def cut_off(byte: int):
        for level in (0, *(byte >> k & 1 for k in range(8)), 0):
            dut.RX.value = level
            await at.clocks(BIT)
        dut.RX.value = 1
        await at.clocks(BYTE)

    await at.send(sent[:6])
    await cut_off(sent[6])
    assert at.lit() == "GR"
    await at.send(sent[7:] + sent)
    assert await at.heard(1) == expected
    assert at.lit() == "G"
    await cut_off(TARGET[0])
    await at.send(sent)
    assert await at.heard(1) == expected
    assert at.lit() == "G"


@timed_test()
async def button(dut):
    """The button aborts a frame being received, a target in the core and an answer being sent; the red LED goes off."""
    at = await Board(dut).press()
    (first, second), _ = targets(2, seed=14)
    for pause in (0, 40, 6 * BYTE):  # target in the core, answer being sent
        await at.send(first)
        cocotb.start_soon(at.source.write(second[:10]))
        await at.clocks(pause)
        dut.BTN_N.value = 0
        await at.clocks(5)
        assert at.lit() == "" and int(dut.TX.value) == 1
        await at.source.wait()
        await at.press()
        await at.nothing()
        assert at.lit() == "G"
        await still_works(at)
    await at.send(first[:5])
    await at.clocks(QUIET + BYTE)
    assert at.lit() == "GR"
    await at.press()
    assert at.lit() == "G"


@timed_test()
async def more_than_it_can_take(dut):
    """Targets with one stop bit arrive faster than answers leave. Whole frames are dropped; all answers are right."""
    at = await Board(dut, stop_bits=1).press()
    sent, expected = targets(50, seed=15)
    at.source.write_nowait(b"".join(sent))
    red = cocotb.start_soon(with_timeout(FallingEdge(dut.LEDR_N), 1, "sec"))
    answers = await at.heard(50)
    assert 25 < len(answers) < 50
    assert answers == [answer for answer in expected if answer in answers]
    assert red.done()
    await still_works(at)


def kept(some: bytes, before: int, lost: list[int]) -> bytes:
    return bytes(byte for k, byte in enumerate(some) if before + k not in lost)


@timed_test()
async def program(dut):
    """A host program that uses the board through a pseudo-terminal exits with status 0.

    IK_PROGRAM is its command line as a JSON list, in which the word PORT stands for the terminal. IK_SAID is the file
    for its output. IK_LOST is a JSON list of two lists: indices of bytes to drop on the way to the board, then from it.
    """
    ours, theirs = pty.openpty()
    tty.setraw(theirs)
    os.set_blocking(ours, False)
    at = await Board(dut).press()
    lost_to, lost_from = json.loads(os.environ["IK_LOST"])
    words = [os.ttyname(theirs) if word == "PORT" else word for word in json.loads(os.environ["IK_PROGRAM"])]
    there = back = 0
    # leave out variables that the simulator sets for its embedded Python
    env = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "COCOTB", "GPI"))}
    with (
        open(os.environ["IK_SAID"], "wb") as said,
        subprocess.Popen(words, cwd=ROOT, env=env, stdout=said, stderr=said) as process,
    ):
        while process.poll() is None:
            await at.clocks(BYTE)
            try:
                some = os.read(ours, 64) if at.source.count() < 64 else b""
            except BlockingIOError:
                some = b""
            at.source.write_nowait(kept(some, there, lost_to))
            there += len(some)
            answer = bytes(at.sink.read_nowait())
            os.write(ours, kept(answer, back, lost_from))
            back += len(answer)
    os.close(theirs)
    os.close(ours)
    assert process.returncode == 0
