# SPDX-License-Identifier: Apache-2.0
"""Proofs of streams, dividers and roots: .sby files and the meaning of their properties."""

from __future__ import annotations

from tb.formal.axi_proofs import AXI_PROOFS
from tb.formal.proof import HANDSHAKE_SAYS, Proof

FIFO_SAYS = {
    "low_after_reset": "valid is low in the clock after a reset",
    "stable": "a word that is offered and not taken stays, valid and unchanged",
    "in_order": "the n-th word that leaves is the n-th written, for any n: none lost, doubled or reordered",
    "nothing_invented": "no word is offered while none is inside",
    "within_places": "never more words in memory and output register than places, by the FIFO's own pointers",
    "read_apart": "no word is written and read in one clock: what a memory gives then does not matter",
    "no_deadlock": "with a word inside, one is offered at the latest one clock later, whatever the receiver does",
}

AXIS_SAYS = {
    "low_after_reset": "tvalid is low in the clock after a reset",
    "stable": "a result that is offered and not taken stays, valid and unchanged, tag and flags included",
    "in_order": "the n-th result that leaves belongs to the n-th target since the reset and has its tag, for any n: "
    "none lost, doubled or reordered",
    "nothing_invented": "nothing is offered while nothing is inside",
    "within_places": "never more inside than places: in the pipeline, as its rows hold them, in the FIFO's memory by "
    "its own pointers, and in its output register",
    "ready_when_places": "tready is high exactly when a place is free, and low in a reset",
    "offered_in_time": "no deadlock: with anything inside, a result is offered at the latest T+1 clocks later, "
    "even if tready stays low",
    "ready_in_time": "no deadlock: with a ready receiver, tready comes back at the latest T+2 clocks later",
    "full_rate": "with a receiver that has never stalled, tready is high: a target in every clock",
}
STORE = [
    "rows_mark$",
    "last_row",
    "count_written",
    "count_left",
    "memory_fits",
    "place_for_every_write",
    "tag_kept",
    "mark_or_stored",
    "stored_was_taken",
    "done_was_taken",
    "done_was_stored",
    "somewhere",
]
AXIS_USES = {
    "within_places": [
        "within_places",
        "counted",
        "credits_are_free_places",
        "nothing_invented",
        "count_written",
        "count_left",
        "memory_fits",
        "flight",
        "last_row",
        "rows_bound$",
        "fifo_part",
        "fifo_fits",
        "place_for_every_write",
    ],
    "counted": ["counted", "credits_are_free_places", "nothing_invented"],
    "somewhere": [
        "somewhere",
        "rows_mark$",
        "last_row",
        "count_written",
        "count_left",
        "memory_fits",
        "ahead",
        "ahead_inside",
        "stored_was_taken",
        "done_was_stored",
        "place_for_every_write",
        "fifo_fits",
    ],
    "rows_bound": ["rows_bound"],
    "rows_counts": ["rows_counts"],
    "rows_below": ["rows_below", "rows_bound"],
    "rows_mark": ["rows_mark"],
    "rows_alone": ["rows_alone", "rows_mark"],
    "kept_in_memory": ["kept_in_memory", *STORE],
    "kept_in_register": ["kept_in_memory", "kept_in_register", *STORE],
}
AXIS_AFTER = {
    "rows_above_if": ["rows_counts", "last_row"],
    "rows_above": ["rows_above_if*"],
    "rows_waiting": ["rows_above", "rows_mark"],
    "not_yet_stored": ["rows_waiting", "mark_or_stored"],
    "in_order": [
        "kept_in_register",
        "not_yet_stored",
        "somewhere",
        "ahead",
        "count_left",
        "fifo_fits",
        "ahead_inside",
        "memory_fits",
        "count_written",
    ],
}


VALID_SAYS = {
    "latency": "T_OUT is the latency that ik_axis counts with",
    "valid_comes_out": "valid comes out T clocks after it went in, unless there was a reset",
    "tag_comes_out": "and its tag with it",
}


DIV_ROW_SAYS = {
    "in_range": "-d <= r < d before the row, -d <= r_next < d behind it",
    "identity": "r_next == 2 r + bit - d where r >= 0, 2 r + bit + d elsewhere",
    "restored": "R = r < 0 ? r + d : r is what a restoring row has: 2 R + bit == q d + R_next, 0 <= R_next < d",
}

ROOT_ROW_SAYS = {
    "in_range": "-(2 root + 1) <= r <= 2 root before the row, and behind it with root_next = 2 root + q",
    "root_fits": "root_next < 2^(K+1)",
    "identity": "r_next == 4 r + pair - (4 root + 1) where r >= 0, 4 r + pair + 4 root + 3 elsewhere",
    "restored": "R = r < 0 ? r + 2 root + 1 : r is what a restoring row has: 0 <= R_next <= 2 root_next and "
    "4 R + pair == q (4 root + 1) + R_next, so 4 (root^2 + R) + pair == root_next^2 + R_next",
}

ROWS_SAY = {
    "in_range_": "the remainder of every row is in range",
    "identity_": "ghost + remainder == the operand's bits so far, for every row",
    "to_come_": "sign, divisor and flags arrive with the row they belong to",
    "result_": "the word of every row holds the operand's bits to come and the result's bits so far",
}
# A row needs only a few properties of the row before it.
ROW = ["in_range_", "identity_", "to_come_", "result_"]
DIV_FIRST = ["first_flags", "first_divisor", "first_remainder", "first_word", "first_copies"]
DIV_SAYS = {
    **ROWS_SAY,
    "first_flags": "overflow is exactly d <= 0 or a quotient of more than ROWS bits",
    "sign_and_bound": "q and ovf, LAT clocks behind n and d: Q, ~Q for a negative dividend, or the bound",
}

ROOT_SAYS = {
    **ROWS_SAY,
    "radicand": "M is n 2^SH where n >= 0",
    "output_root": "q and neg, LAT clocks behind n: Q, or the bound, or 0 for a negative radicand",
}

FOLD_SAYS = {
    "low_after_reset": "tvalid and tready are low in the clock after a reset",
    "stable": "a result that is offered and not taken stays, valid and unchanged, tag and flags included",
    "in_order": "the n-th result that leaves has the tag of the n-th target since the reset, for any n: "
    "none lost, doubled or reordered",
    "nothing_invented": "nothing is offered while nothing is inside",
    "two_at_most": "at most two targets are inside, in the datapath or offered",
    "taken_when_offered": "a target is taken only while it is offered",
    "loads_what_is_offered": "words are loaded only from a target that is offered, before it is taken",
    "answer_whole": "a result is offered when all its six words are written, and they are those of the program",
    "word_once": "no word of a result is written twice",
    "step_of_clock": "the current step is the program's step for the clock of the lap",
    "offered_in_time": "no deadlock: with a target inside, a result is offered within two laps, whatever tready is",
    "ready_in_time": "no deadlock: with a ready receiver, a target is taken within two laps of its offer",
    "full_rate": "with a sender and a receiver that never wait, a target is taken in every PERIOD clocks, exactly",
}


def fifo(places: int) -> Proof:
    return Proof("fifo", str(places), "ik_fifo", f"208-bit words, {places} places", FIFO_SAYS)


def axis(datapath: str, stages: int, places: int) -> tuple[Proof, Proof, Proof]:
    """Return the proofs of the stream top, its handshake, and the latency of the real pipeline."""
    width = f"W=32, {datapath}: {stages} stages, {places} places"
    return (
        Proof("axis", datapath, "ik_axis", width, AXIS_SAYS, AXIS_USES, AXIS_AFTER),
        Proof("handshake", datapath, "ik_axis", "W=32", HANDSHAKE_SAYS),
        Proof("valid", datapath, f"ik_{datapath}", f"W=32, {stages} stages", VALID_SAYS),
    )


AXIS_256 = Proof("axis", "256", "ik_axis", "W=22, paper: 248 stages, 256 places", AXIS_SAYS, AXIS_USES, AXIS_AFTER)
"""The largest word length of the paper's datapath with 256 FIFO places."""


def div(width: int, shift: int) -> Proof:
    said = f"NW={width}, SH={shift}, QW=32, LAT=34, DW=32"
    uses = {name: [*ROW, *DIV_FIRST] for name in ROW}
    return Proof("div", f"{width}_{shift}", "ik_div_digit", said, DIV_SAYS, uses)


def root(width: int, shift: int) -> Proof:
    said = f"NW={width}, SH={shift}, QW=32, LAT=32"
    return Proof("root", f"{width}_{shift}", "ik_root_digit", said, ROOT_SAYS, dict.fromkeys(ROW, ROW))


PROOFS = (
    fifo(64),
    fifo(512),
    *axis("lean", 42, 64),
    *axis("paper", 318, 512),
    AXIS_256,
    Proof("div_row", "31", "ik_div_row", "31-bit divisor", DIV_ROW_SAYS),
    *(Proof("root_row", k, "ik_root_row", f"{k}-bit root so far", ROOT_ROW_SAYS) for k in ("15", "30")),
    *(div(width, shift) for width, shift in ((32, 29), (32, 30), (40, 22), (40, 23))),
    *(root(width, shift) for width, shift in ((32, 30), (32, 31), (33, 29))),
    Proof("fold", "24", "ik_fold", "W=24, the program of all widths", FOLD_SAYS),
    Proof("handshake", "fold", "ik_axis", "W=32", HANDSHAKE_SAYS),
    *AXI_PROOFS,
)
"""All proofs; a test compares the numbers with .sby files, model and latencies of the RTL."""
