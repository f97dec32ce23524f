# SPDX-License-Identifier: Apache-2.0
"""What is proved of streams, dividers and roots: the .sby files, what their properties say, bugs that break them."""

from __future__ import annotations

from tb.formal.axi_proofs import AXI_PROOFS
from tb.formal.fold_proofs import FOLD_PROOFS
from tb.formal.proof import HANDSHAKE_SAYS, Proof
from tb.sim.seeded_bugs import Bug

FIFO = "rtl/lib/ik_fifo.v"
AXIS = "rtl/ik_axis.v"
DIV_ROW = "rtl/lib/ik_div_row.v"
ROOT_ROW = "rtl/lib/ik_root_row.v"
DIV = "rtl/lib/ik_div_digit.v"
ROOT_DIGIT = "rtl/lib/ik_root_digit.v"


FIFO_SAYS = {
    "low_after_reset": "valid is low in the clock after a reset",
    "stable": "a word that is offered and not taken stays, valid and unchanged",
    "in_order": "the n-th word that leaves is the n-th written, for any n: none lost, doubled or reordered",
    "nothing_invented": "no word is offered while none is inside",
    "within_places": "never more words in memory and output register than places, by the FIFO's own pointers",
    "read_apart": "no word is written and read in one clock: what a memory gives then does not matter",
    "no_deadlock": "with a word inside, one is offered at the latest one clock later, whatever the receiver does",
}
FIFO_BUGS = (
    Bug("valid survives a reset", FIFO, "      m_valid <= 1'b0;\n", "", "low_after_reset"),
    Bug("output register loads while stalled", FIFO, "if (load) m_data", "m_data", "stable"),
    Bug("reads the neighbour's word", FIFO, "mem[rd_ptr[LOG2-1:0]]", "mem[rd_ptr[LOG2-1:0] ^ 1'b1]", "in_order"),
    Bug("offers the last word again", FIFO, "m_valid <= !empty", "m_valid <= !empty || m_valid", "nothing_invented"),
    Bug("waits for ready before it offers", FIFO, "load = !m_valid || m_ready", "load = m_ready", "no_deadlock"),
    Bug("loses a word that comes as one is taken", FIFO,
        "if (wr_en) wr_ptr", "if (wr_en && !load) wr_ptr", "somewhere"),
    Bug("read pointer runs on while stalled", FIFO,
        "if (!empty) rd_ptr", "if (!empty && m_ready) rd_ptr", "count_left"),
    Bug("a word keeps its place as it is offered", FIFO,
        "if (!empty) rd_ptr", "if (!empty && m_valid) rd_ptr", "within_places"),
    Bug("reads what is not there yet", FIFO, "wire empty = (wr_ptr == rd_ptr)", "wire empty = 1'b0", "read_apart"),
)  # fmt: skip

AXIS_SAYS = {
    "low_after_reset": "tvalid is low in the clock after a reset",
    "stable": "a result that is offered and not taken stays, valid and unchanged, tag and flags included",
    "in_order": "the n-th result that leaves belongs to the n-th target since the reset and has its tag, for any n: "
    "none lost, doubled or reordered",
    "nothing_invented": "nothing is offered while nothing is inside",
    "within_places": "never more inside than places: in the pipeline, as its rows hold them, in the FIFO's memory by "
    "its own pointers, and in its output register",
    "ready_when_places": "tready is high exactly when a place is free, and low in a reset: it waits for nobody",
    "offered_in_time": "no deadlock: with anything inside, a result is offered at the latest T+1 clocks later, "
    "even if tready stays low",
    "ready_in_time": "no deadlock: with a ready receiver, tready comes back at the latest T+2 clocks later",
    "full_rate": "with a receiver that has never stalled, tready is high: a target in every clock",
}
AXIS_BUGS = (
    Bug("FIFO is not reset", FIFO, "      m_valid <= 1'b0;\n", "", "low_after_reset"),
    Bug("output register loads while stalled", FIFO, "if (load) m_data", "m_data", "stable"),
    Bug("reads the neighbour's result", FIFO, "mem[rd_ptr[LOG2-1:0]]", "mem[rd_ptr[LOG2-1:0] ^ 1'b1]", "in_order"),
    Bug("stores the tag of the target that enters", AXIS,
        "core_tag, core_data}),", "s_axis_tuser, core_data}),", "kept_in_memory"),
    Bug("offers the last result again", FIFO, "m_valid <= !empty", "m_valid <= !empty || m_valid", "nothing_invented"),
    Bug("admits without a place", AXIS, "!rst && (credits != 0)", "!rst", "within_places"),
    Bug("a result keeps its place as it is offered", FIFO,
        "if (!empty) rd_ptr", "if (!empty && m_valid) rd_ptr", "within_places"),
    Bug("credit comes back with ready alone", AXIS,
        "leave = m_axis_tvalid && m_axis_tready", "leave = m_axis_tready", "credits_are_free_places"),
    Bug("one credit too many", AXIS,
        "{1'b1, {LOG2{1'b0}}};", "{1'b1, {(LOG2-1){1'b0}}, 1'b1};", "credits_are_free_places"),
    Bug("last place is never used", AXIS, "(credits != 0)", "(credits > 1)", "ready_when_places"),
    Bug("valid waits for ready", FIFO, "load = !m_valid || m_ready", "load = m_ready", "offered_in_time"),
    Bug("last credit does not come back", AXIS,
        "leave && !admit)", "leave && !admit && credits != 0)", "ready_in_time"),
    Bug("half of the places", AXIS,
        "datapath_latency(DATAPATH, W, TILE) + 3);", "datapath_latency(DATAPATH, W, TILE) + 3) - 1;", "full_rate"),
)  # fmt: skip
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

HANDSHAKE_BUGS = (
    Bug("tready looks at tvalid", AXIS, "!rst && (credits", "!rst && s_axis_tvalid && (credits", "independent"),
    Bug("tready looks at the receiver", AXIS, "(credits != 0);", "(credits != 0 || m_axis_tready);", "independent"),
)  # fmt: skip

VALID_SAYS = {
    "latency": "T_OUT is the latency that ik_axis counts with",
    "valid_comes_out": "valid comes out T clocks after it went in, unless there was a reset",
    "tag_comes_out": "and its tag with it",
}


def valid_bugs(core: str) -> tuple[Bug, ...]:
    """Of ik_lean.v or ik_paper.v."""
    return (
        Bug("valid a clock early", core, "= valid[T_OUT-1]", "= valid[T_OUT-2]", "valid_comes_out"),
        Bug("reset forgets the newest alone", core, "valid <= {T_OUT{1'b0}};", "valid <= valid << 1;", "valid_line"),
        Bug("tag of the next target", core, ".d(in_tag)", ".d(in_tag + 1'b1)", "tag_line"),
    )  # fmt: skip


DIV_ROW_SAYS = {
    "in_range": "-d <= r < d before the row, -d <= r_next < d behind it",
    "identity": "r_next == 2 r + bit - d where r >= 0, 2 r + bit + d elsewhere",
    "restored": "R = r < 0 ? r + d : r is what a restoring row has: 2 R + bit == q d + R_next, 0 <= R_next < d",
}
DIV_ROW_BUGS = (
    Bug("never adds", DIV_ROW, "{(W + 2) {~ge}}", "{(W + 2) {1'b0}}", "in_range"),
    Bug("adds d + 1", DIV_ROW, "bit_in, 1'b0}", "bit_in, 1'b1}", "identity"),
    Bug("quotient bit inverted", DIV_ROW, "{1'b1, r,", "{1'b0, r,", "restored"),
)  # fmt: skip

ROOT_ROW_SAYS = {
    "in_range": "-(2 root + 1) <= r <= 2 root before the row, and behind it with root_next = 2 root + q",
    "root_fits": "root_next < 2^(K+1)",
    "identity": "r_next == 4 r + pair - (4 root + 1) where r >= 0, 4 r + pair + 4 root + 3 elsewhere",
    "restored": "R = r < 0 ? r + 2 root + 1 : r is what a restoring row has: 0 <= R_next <= 2 root_next and "
    "4 R + pair == q (4 root + 1) + R_next, so 4 (root^2 + R) + pair == root_next^2 + R_next",
}
ROOT_ROW_BUGS = (
    Bug("never adds", ROOT_ROW, "{(K + 1) {~ge}}", "{(K + 1) {1'b0}}", "in_range"),
    Bug("root_next takes r < 0 for 1", ROOT_ROW, "{1'b1, r,", "{1'b0, r,", "restored"),
    Bug("subtracts 4 root alone", ROOT_ROW, "{~ge}}, 2'b01}", "{~ge}}, 2'b00}", "identity"),
)  # fmt: skip

ROWS_SAY = {
    "in_range_": "the remainder of every row is in range",
    "identity_": "ghost + remainder == the operand's bits so far, for every row",
    "to_come_": "sign, divisor and flags arrive with the row they belong to",
    "result_": "the word of every row holds the operand's bits to come and the result's bits so far",
}
# A row needs the row before it, and what it needs of it is little.
ROW = ["in_range_", "identity_", "to_come_", "result_"]
DIV_FIRST = ["first_flags", "first_divisor", "first_remainder", "first_word", "first_copies"]
DIV_SAYS = {
    **ROWS_SAY,
    "first_flags": "overflow is exactly d <= 0 or a quotient of more than ROWS bits",
    "sign_and_bound": "q and ovf, LAT clocks behind n and d: Q, ~Q for a negative dividend, or the bound",
}
DIV_BUGS = (
    Bug("overflow takes d = 0 for good", DIV,
        "(high >= {{(HW - DW + 1) {1'b0}}, d[DW-2:0]})", "(high > {{(HW - DW + 1) {1'b0}}, d[DW-2:0]})", "first_flags"),
    Bug("always subtracts", DIV, "assign ge = word[0];", "assign ge = 1'b1;", "in_range_"),
    Bug("brings the next bit down twice", DIV, "? word[WW-1] : sign", "? word[WW-2] : sign", "identity_"),
    Bug("loses the quotient bit", DIV, "{word, q_bit}", "{word, 1'b0}", "result_"),
    Bug("divisor of the next pair", DIV, "{sign, divisor, r_next,", "{sign, d_1, r_next,", "to_come_"),
    Bug("no bound above", DIV, "| {(QW - 1) {over}}", "| {(QW - 1) {1'b0}}", "out_line"),
    Bug("magnitude without its inversion", DIV, "(n_x << SH) ^ {XW{minus}}", "n_x << SH", "first_word"),
    Bug("ovf leaves at the other end", DIV, ".q  ({ovf, q})", ".q  ({q, ovf})", "sign_and_bound"),
)  # fmt: skip

ROOT_SAYS = {
    **ROWS_SAY,
    "radicand": "M is n 2^SH where n >= 0",
    "output_root": "q and neg, LAT clocks behind n: Q, or the bound, or 0 for a negative radicand",
}
ROOT_BUGS = (
    Bug("takes the pair's bits in the wrong order", ROOT_DIGIT,
        "word[WW-1:WW-2]", "{word[WW-2], word[WW-1]}", "identity_"),
    Bug("always subtracts", ROOT_DIGIT, "assign ge = word[0];", "assign ge = 1'b1;", "in_range_"),
    Bug("loses the root's bit", ROOT_DIGIT, "{word, q_bit}", "{word, 1'b0}", "result_"),
    Bug("negative radicand is not zeroed", ROOT_DIGIT, "& ~{(QW - 1) {minus_out}}", "", "output_root"),
    Bug("shifts one place too few", ROOT_DIGIT, "n[NW-2:0]} << SH", "n[NW-2:0]} << (SH - 1)", "radicand"),
    Bug("forgets that the radicand was negative", ROOT_DIGIT, ".d({minus, |v", ".d({1'b0, |v", "to_come_"),
)  # fmt: skip


def fifo(places: int) -> Proof:
    return Proof("fifo", str(places), "ik_fifo", f"208-bit words, {places} places", FIFO_SAYS, FIFO_BUGS)


def axis(datapath: str, stages: int, places: int) -> tuple[Proof, Proof, Proof]:
    """The stream top, its handshake, and what the abstract pipeline stands in for."""
    width = f"W=32, {datapath}: {stages} stages, {places} places"
    core = valid_bugs(f"rtl/{datapath}/ik_{datapath}.v")
    return (
        Proof("axis", datapath, "ik_axis", width, AXIS_SAYS, AXIS_BUGS, AXIS_USES, AXIS_AFTER),
        Proof("handshake", datapath, "ik_axis", "W=32", HANDSHAKE_SAYS, HANDSHAKE_BUGS),
        Proof("valid", datapath, f"ik_{datapath}", f"W=32, {stages} stages", VALID_SAYS, core),
    )


AXIS_256 = Proof(
    "axis", "256", "ik_axis", "W=22, paper: 248 stages, 256 places", AXIS_SAYS, AXIS_BUGS, AXIS_USES, AXIS_AFTER
)
"""The last word length of the paper's datapath for which so many will do."""


def div(width: int, shift: int) -> Proof:
    said = f"NW={width}, SH={shift}, QW=32, LAT=34, DW=32"
    uses = {name: [*ROW, *DIV_FIRST] for name in ROW}
    return Proof("div", f"{width}_{shift}", "ik_div_digit", said, DIV_SAYS, DIV_BUGS, uses)


def root(width: int, shift: int) -> Proof:
    said = f"NW={width}, SH={shift}, QW=32, LAT=32"
    return Proof("root", f"{width}_{shift}", "ik_root_digit", said, ROOT_SAYS, ROOT_BUGS, dict.fromkeys(ROW, ROW))


PROOFS = (
    fifo(64),
    fifo(512),
    *axis("lean", 42, 64),
    *axis("paper", 318, 512),
    AXIS_256,
    Proof("div_row", "31", "ik_div_row", "31-bit divisor", DIV_ROW_SAYS, DIV_ROW_BUGS),
    *(Proof("root_row", k, "ik_root_row", f"{k}-bit root so far", ROOT_ROW_SAYS, ROOT_ROW_BUGS) for k in ("15", "30")),
    *(div(width, shift) for width, shift in ((32, 29), (32, 30), (40, 22), (40, 23))),
    *(root(width, shift) for width, shift in ((32, 30), (32, 31), (33, 29))),
    *FOLD_PROOFS,
    *AXI_PROOFS,
)
"""The numbers are those of the .sby files; a test holds them against the model and the RTL's latencies."""
