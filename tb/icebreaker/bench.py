# SPDX-License-Identifier: Apache-2.0
"""The top of examples/icebreaker at its pins: every answer equals the bit-true model's; what is no target has none."""

from __future__ import annotations

import binascii
import logging
import os

import cocotb
import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge, Timer
from cocotbext.uart import UartSink, UartSource

from examples.icebreaker.frames import ANSWER_BYTES, TARGET, WIDTH, Answers, frame
from model.dataflow import fixed
from model.dataflow.datapaths import FOLD16
from model.io.stimuli import mixed

PERIOD = 40
"""Of the clock (ns)."""
BIT = int(os.environ.get("IK_BIT", "6"))
"""Clocks of a bit."""
BAUD = 1e9 / (PERIOD * BIT)
QUIET = 512
"""Clocks of a pause that ends a frame."""
PARAMETERS = {"CLOCK": 10**9 // PERIOD, "BAUD": int(BAUD), "LOG2_QUIET": QUIET.bit_length() - 1}
BYTE = 10 * BIT
"""Clocks of a byte."""
TARGETS = int(os.environ.get("IK_TARGETS", "40"))


class Board:
    """The board's pins, out of reset. stop_bits: between bytes to it; skew: of its sender's clock."""

    def __init__(self, dut, stop_bits: int = 2, skew: float = 0.0):
        for name in ("RX", "TX"):
            logging.getLogger(f"cocotb.{dut._name}.{name}").setLevel(logging.WARNING)
        self.dut = dut
        cocotb.start_soon(Clock(dut.CLK, PERIOD, "ns").start())
        self.source = UartSource(dut.RX, baud=BAUD * (1 + skew), stop_bits=stop_bits)
        self.sink = UartSink(dut.TX, baud=BAUD)
        self.answers = Answers()

    async def clocks(self, count: int) -> None:
        await ClockCycles(self.dut.CLK, count)

    async def press(self) -> None:
        """The button, and a moment to come out of reset; what was on the line is gone."""
        self.dut.BTN_N.value = 0
        await self.clocks(30)
        self.dut.BTN_N.value = 1
        await self.clocks(100)
        await self.clocks(BYTE)
        self.sink.clear()

    async def send(self, some: bytes) -> None:
        await self.source.write(some)
        await self.source.wait()
        await self.clocks(2)

    async def heard(self, count: int, most: int = 0) -> list[tuple[int, int, list[int]]]:
        """What comes until ``count`` answers are there, and none later, or for ``most`` clocks more."""
        found: list = []
        for _ in range((most or (count + 1) * (ANSWER_BYTES + 3) * BYTE) // BYTE):
            await self.clocks(BYTE)
            found += self.answers(bytes(self.sink.read_nowait()))
            if len(found) == count and not most:
                break
        return found

    async def nothing(self) -> None:
        """No byte comes, for as long as an answer would take."""
        await self.clocks((ANSWER_BYTES + 3) * BYTE)
        assert self.sink.empty() and int(self.dut.TX.value) == 1

    def lit(self) -> str:
        """The LEDs that are: green, red, both or none."""
        return "".join(name for name in "GR" if not int(getattr(self.dut, f"LED{name}_N").value))


def targets(count: int, seed: int = 1) -> tuple[np.ndarray, list[tuple[int, int, list[int]]]]:
    """Words (N, 6) of targets of all kinds, and the answers to them with tags that count up from 7 past 255."""
    words = mixed(count, WIDTH, seed)
    model = fixed.run(words, WIDTH, FOLD16.name)
    flags, results = np.asarray(model.flags).tolist(), model.results.tolist()
    return words, [((k + 7) % 256, flag, result) for k, (flag, result) in enumerate(zip(flags, results, strict=True))]


def frames(words: np.ndarray, answers: list) -> list[bytes]:
    return [frame(tag, row) for row, (tag, _, _) in zip(words, answers, strict=True)]


async def board(dut, **options) -> Board:
    made = Board(dut, **options)
    await made.press()
    return made


async def still_works(at: Board, seed: int = 5) -> None:
    """A target is answered, and the red LED is off from then on."""
    words, expected = targets(1, seed)
    await at.send(frames(words, expected)[0])
    assert await at.heard(1) == expected
    assert at.lit() == "G"


@cocotb.test()
async def out_of_reset(dut):
    """Nothing until the PLL has locked; then the green LED, and nothing is said before a target comes."""
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


@cocotb.test()
@cocotb.parametrize(skew=(-0.03, 0.0, 0.03))
async def every_bit(dut, skew):
    """As many targets as one likes without a pause, at two stop bits, from a sender whose clock is not ours."""
    at = await board(dut, skew=skew)
    words, expected = targets(TARGETS, seed=int(100 * skew) + 3)
    at.source.write_nowait(b"".join(frames(words, expected)))
    assert await at.heard(TARGETS) == expected
    assert at.lit() == "G"
    await at.nothing()


@cocotb.test()
async def answer_at_once(dut):
    """A target alone is answered within the datapath's latency and a few clocks; the line goes on without a gap."""
    at = await board(dut)
    words, expected = targets(1)
    cocotb.start_soon(at.source.write(frames(words, expected)[0]))
    await at.clocks(22 * (BYTE + BIT) - 3 * BIT)
    assert at.sink.empty() and int(dut.TX.value) == 1
    await FallingEdge(dut.TX)
    await at.clocks(2)
    assert at.source.idle()
    await at.clocks(ANSWER_BYTES * BYTE)
    assert at.answers(bytes(at.sink.read_nowait())) == expected


@cocotb.test()
async def wrong_bits(dut):
    """A wrong bit in any byte: no answer, and the red LED unless it was the first byte, which makes it no frame. Nor is
    half a check enough."""
    at = await board(dut)
    words, expected = targets(22, seed=9)
    sent = frames(words, expected)
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


@cocotb.test()
async def cut_frames(dut):
    """A frame that stops is given up after a pause, however short it is; bytes between frames are passed over."""
    at = await board(dut)
    words, expected = targets(1, seed=11)
    (sent,) = frames(words, expected)
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
    for part in (sent[:9], sent[9:]):  # a pause that is short enough
        await at.send(part)
        await at.clocks(QUIET - 2 * BYTE)
    assert await at.heard(1) == expected


@cocotb.test()
async def noise(dut):
    """A low level of less than half a bit is no start bit, neither at rest nor within a frame."""
    at = await board(dut)
    words, expected = targets(1, seed=12)
    (sent,) = frames(words, expected)

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


@cocotb.test()
async def no_stop_bit(dut):
    """A byte without stop bit ends its frame at once, and begins none."""
    at = await board(dut)
    words, expected = targets(1, seed=13)
    (sent,) = frames(words, expected)

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


@cocotb.test()
async def button(dut):
    """The button ends all at once: a frame that comes, a target in the core, an answer that goes, the red LED."""
    at = await board(dut)
    words, expected = targets(2, seed=14)
    first, second = frames(words, expected)
    for pause in (0, 40, 6 * BYTE):  # in the core, in an answer
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


async def lights(led) -> None:
    await FallingEdge(led)


@cocotb.test()
async def more_than_it_can_take(dut):
    """At one stop bit targets come faster than answers go: those for which there is no room are dropped whole, and
    those that are answered are right."""
    at = await board(dut, stop_bits=1)
    words, expected = targets(120, seed=15)
    at.source.write_nowait(b"".join(frames(words, expected)))
    red = cocotb.start_soon(lights(dut.LEDR_N))
    found = await at.heard(0, most=121 * ANSWER_BYTES * BYTE)
    assert 60 < len(found) < 120
    assert found == [answer for answer in expected if answer in found]
    assert red.done()
    await still_works(at)

