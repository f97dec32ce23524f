# SPDX-License-Identifier: Apache-2.0
"""Bugs that are put into the Verilog of examples/icebreaker are caught, each by the test that is there for it."""

import pytest

from tb.icebreaker.example import run, text
from tb.sim.env import simulator
from tb.sim.mutants import Bug

RX, TX, CRC = "uart_rx.v", "uart_tx.v", "crc16.v"
IN, OUT, TOP = "frame_rx.v", "frame_tx.v", "icebreaker.v"

# Not among them: `bits` of uart_tx without its reset, which has counted to its end before there is an answer.
BUGS = [  # fails: a test of bench.py
    Bug("noise is a start bit", RX, "bits == 4'd10 && level", "1'b0", "noise"),
    Bug("looks at the edge", RX, "BIT - BIT / 2", "BIT - 1", "every_bit"),
    Bug("looks late", RX, "BIT - BIT / 2", "0", "every_bit"),
    Bug("any stop bit", RX, "valid <= level;", "valid <= 1'b1;", "no_stop_bit"),
    Bug("says nothing of a stop bit", RX, "bad   <= !level;", "bad   <= 1'b0;", "no_stop_bit"),
    Bug("highest bit first", RX, "{level, data[7:1]}", "{data[6:0], level}", "every_bit"),
    Bug("a gap between bytes", TX, "(bits == 4'd1 && ended)", "1'b0", "answer_at_once"),
    Bug("no stop bit", TX, "(bits == 4'd1 && ended)", "(bits == 4'd2 && ended)", "every_bit"),
    Bug("reset leaves the line", TX, "shift <= {10{1'b1}};", "", "button"),
    Bug("another CRC", CRC, "16'h1021", "16'h8005", "every_bit"),
    Bug("CRC from zero", IN, "16'hFFFF", "16'h0000", "every_bit"),
    Bug("any check", IN, "crc_next == 16'd0", "1'b1", "wrong_bits"),
    Bug("half the check", IN, "crc_next == 16'd0", "crc_next[15:8] == 8'd0", "wrong_bits"),
    Bug("waits for ever", IN, "begun && (&quiet);", "1'b0;", "cut_frames"),
    Bug("bytes are no reason to wait", IN, "(valid || !begun)", "(!begun)", "cut_frames"),
    Bug("a frame over one that waits", IN, "if (first && !offered)", "if (first)", "more_than_it_can_take"),
    Bug("says nothing of a full house", IN, "(first && offered) || ", "", "more_than_it_can_take"),
    Bug("says nothing of a wrong check", IN, "(ends && !right) || ", "", "wrong_bits"),
    Bug("says nothing of a pause", IN, "(begun && (bad || late));\n    if", "(begun && bad);\n    if", "cut_frames"),
    Bug("goes on after a stop bit", IN, "(begun && (bad || late))) left", "(begun && late)) left", "no_stop_bit"),
    Bug("starts with anything", IN, "&& data == START", "", "cut_frames"),
    Bug("a target twice", IN, "else if (taken) offered", "else if (1'b0) offered", "every_bit"),
    Bug("reset within a frame", IN, "if (rst || (begun", "if ((begun", "button"),
    Bug("reset before it is taken", IN, "    if (rst) begin\n      offered <= 1'b0;", "    if (rst) begin", "button"),
    Bug("START is checked", OUT, "left == ALL[4:0])) crc", "1'b0)) crc", "every_bit"),
    Bug("low byte of the check first", OUT, "crc[15:8] : (left == 1) ? crc[7:0]", "crc[7:0] : (left == 1) ? crc[15:8]",
        "every_bit"),
    Bug("taken too soon", OUT, "offered && left == 0", "offered && left <= 1", "more_than_it_can_take"),
    Bug("reset leaves a frame", OUT, "if (rst) left <= 5'd0;", "", "button"),
    Bug("runs before the PLL", TOP, " || !locked", "", "out_of_reset"),
    Bug("no button", TOP, "!button[1] || ", "", "button"),
    Bug("red for ever", TOP, "(red && !offered)", "red", "wrong_bits"),
    Bug("red for a clock", TOP, "(red && !offered)", "1'b0", "wrong_bits"),
    Bug("red out of reset", TOP, "red <= !rst && ", "red <= ", "button"),
    Bug("tag of another", TOP, "{flags, answer_tag})", "{answer_tag, flags})", "every_bit"),
    Bug("flags behind the words", TOP, ".frame({answer, flags, answer_tag})", ".frame({flags, answer, answer_tag})",
        "every_bit"),
]  # fmt: skip


@pytest.mark.parametrize("bug", BUGS, ids=lambda bug: bug.what)
def test_can_be_seeded(bug):
    assert text(bug) != text()


@pytest.mark.sim
@pytest.mark.slow
@pytest.mark.cost(3)
@pytest.mark.skipif(simulator() != "icarus", reason="the same tests; Icarus builds them in a second")
@pytest.mark.parametrize("bug", BUGS, ids=lambda bug: bug.what)
def test_is_noticed(bug):
    with pytest.raises(SystemExit, match=r"^FAILED \d+ tests"):
        run("tb.icebreaker.bench", bug, COCOTB_TEST_FILTER=f"bench.{bug.fails}", IK_TARGETS="5")
