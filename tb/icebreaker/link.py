# SPDX-License-Identifier: Apache-2.0
"""Program connected to the simulated board: a pseudo-terminal replaces the serial line.

``IK_PROGRAM`` is its command line as JSON, where PORT is replaced by the port's name; ``IK_SAID`` a file for its
output; ``IK_LOST`` two JSON lists of the bytes to drop, by index: to the board and from the board.
"""

import json
import os
import pty
import subprocess
import tty

import cocotb

from tb.icebreaker.bench import BYTE, board
from tb.sim.env import ROOT


def kept(some: bytes, before: int, lost: list[int]) -> bytes:
    return bytes(byte for k, byte in enumerate(some) if before + k not in lost)


@cocotb.test()
async def program(dut):
    """The program exits with status 0."""
    ours, theirs = pty.openpty()
    tty.setraw(theirs)
    os.set_blocking(ours, False)
    at = await board(dut)
    lost_to, lost_from = json.loads(os.environ["IK_LOST"])
    words = [os.ttyname(theirs) if word == "PORT" else word for word in json.loads(os.environ["IK_PROGRAM"])]
    there = back = 0
    # Without the variables that the simulator sets for its embedded Python.
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
