# SPDX-License-Identifier: Apache-2.0
"""What is proved of the folded datapath's streams and sequencer, and bugs that break it."""

from __future__ import annotations

from tb.formal.proof import HANDSHAKE_SAYS, Proof
from tb.sim.seeded_bugs import Bug

FOLD = "rtl/fold/ik_fold.v"

FOLD_SAYS = {
    "low_after_reset": "tvalid and tready are low in the clock after a reset",
    "stable": "an answer that is offered and not taken stays, valid and unchanged, tag and flags included",
    "in_order": "the n-th answer that leaves has the tag of the n-th target since the reset, for any n: "
    "none lost, doubled or reordered",
    "nothing_invented": "nothing is offered while nothing is inside",
    "two_at_most": "two targets at most are inside, in the machine or offered",
    "taken_when_offered": "a target is taken only while it is offered",
    "loads_what_is_offered": "words are loaded only from a target that is offered, before it is taken",
    "answer_whole": "an answer is offered when all its six words are written, and they are what the program gave",
    "word_once": "no word of an answer is written twice",
    "step_of_clock": "the step that the machine carries out is that of the program for the clock of its lap",
    "offered_in_time": "no deadlock: with a target inside, an answer is offered within two laps, whatever tready is",
    "ready_in_time": "no deadlock: with a ready receiver, a target is taken within two laps of its offer",
    "full_rate": "with a sender and a receiver that never wait, a target is taken in every PERIOD clocks, exactly",
}
FOLD_BUGS = (
    Bug("valid survives a reset", FOLD,
        "      given         <= 1'b0;\n      m_axis_tvalid <= 1'b0;\n", "      given <= 1'b0;\n", "low_after_reset"),
    Bug("the answer before survives a reset", FOLD, "      previous      <= 1'b0;\n", "", "count"),
    Bug("stops with its registers alone", FOLD, "if (go && giving) begin", "if (giving) begin", "stable"),
    Bug("never stops", FOLD, "go <= !full || (go && !(f_hold && of_hold));", "go <= 1'b1;", "stopped"),
    Bug("stops for good", FOLD, "go <= !full ||", "go <=", "stops"),
    Bug("offers the last answer again", FOLD,
        "else if (m_axis_tready) m", "else if (m_axis_tready && !m_axis_tvalid) m", "nothing_invented"),
    Bug("an answer of a lap without a target", FOLD,
        "if (go && f_last_result && giving)", "if (go && f_last_result)", "nothing_invented"),
    Bug("offered before it is whole", FOLD,
        "if (go && f_last_result && giving)", "if (go && f_last_input && giving)", "answer_whole"),
    Bug("tag of whatever comes", FOLD, "if (s_axis_tready) tag", "if (go) tag", "at_lap"),
    Bug("tag of the next target", FOLD, "if (f_first_result) m_axis", "if (f_last_result) m_axis", "at_next_tag"),
    Bug("word in another's place", FOLD,
        "RESULT_QS_J: m_axis_tdata[2*W", "RESULT_QS_J: m_axis_tdata[3*W", "words_kept"),
    Bug("starts a lap without a target", FOLD,
        "begins ? s_axis_tvalid : c", "begins ? 1'b1 : c", "loads_what_is_offered"),
    Bug("a target in every second lap", FOLD,
        "begins ? s_axis_tvalid : c", "begins ? s_axis_tvalid && !previous : c", "steady_runs"),
    Bug("takes a target in every clock", FOLD, "current && f_last_input;", "current;", "count"),
    Bug("the lap goes on into the next", FOLD, "current <= here && !last;", "current <= here;", "current_in_lap"),
    Bug("waits with an answer on its way", FOLD, "begins && !here && !previous;", "begins && !here;", "quiet"),
    Bug("breaks a lap off with its target", FOLD,
        "f_last_result && previous && !here;", "f_last_result && previous;", "nothing_broken_off"),
    Bug("lap a clock short", FOLD, "&& fetched == END)", "&& fetched == END - 7'd1)", "read_follows"),
    Bug("carries out the step before its clock", FOLD, "<= step_read;", "<= rom[fetched];", "step_of_clock"),
)  # fmt: skip
HANDSHAKE_BUGS = (
    Bug("tready looks at tvalid", FOLD, "go && current && f_last", "go && here && f_last", "independent"),
    Bug("tready looks at the receiver", FOLD, "= go && current", "= (go || m_axis_tready) && current", "independent"),
)  # fmt: skip

FOLD_PROOFS = (
    Proof("fold", "24", "ik_fold", "W=24, the program of all widths", FOLD_SAYS, FOLD_BUGS),
    Proof("handshake", "fold", "ik_axis", "W=32", HANDSHAKE_SAYS, HANDSHAKE_BUGS),
)
