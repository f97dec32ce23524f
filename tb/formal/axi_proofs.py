# SPDX-License-Identifier: Apache-2.0
"""What is proved of ik_axi, module by module: the rules of AXI4, bursts inside their areas, the life of a job."""

from __future__ import annotations

from tb.formal.proof import Proof
from tb.sim.seeded_bugs import Bug

TOP = "rtl/ik_axi.v"
READ = "rtl/axi/ik_axi_read.v"
WRITE = "rtl/axi/ik_axi_write.v"
TARGET = "rtl/axi/ik_axi_target.v"
RESULT = "rtl/axi/ik_axi_result.v"
REGS = "rtl/axi/ik_axi_regs.v"
JOB = "rtl/axi/ik_axi_job.v"

STABLE = "what is offered and not taken stays, valid and unchanged"
LOW = "valid is low in the clock after a reset"

READ_SAYS = {
    "low_after_reset": LOW,
    "stable": STABLE,
    "inside_source": "a burst asked for lies inside the source",
    "within_4k": "and does not cross 4 KiB",
    "whole_records": "it is of whole records",
    "within_promise": "never more than 8 bursts are under way",
    "place_for_every_record": "records asked for and in the core are never more than the core has places for",
    "none_when_stopped": "no burst begins behind an error, or while the job is stopped",
    "asked_in_time": "with nothing under way, all places free and records left, a burst is offered two clocks later",
}
READ_BUGS = (
    Bug("AR survives a reset", READ,
        "if (rst) m_axi_arvalid <= 1'b0;\n    else if (ask)", "if (ask)", "low_after_reset"),
    Bug("takes back AR", READ, "else if (m_axi_arready) m_axi_arvalid", "else m_axi_arvalid", "stable"),
    Bug("asks beyond the end", READ, "all_left ? left[N-1:0] : to_edge", "to_edge", "size_is"),
    Bug("asks again for the same", READ,
        "left  <= left - {{(32 - N) {1'b0}}, size};", "left  <= left - 1'b1;", "position"),
    Bug("over an edge", READ, "WHOLE - {1'b0, next[LOG2_BURST-1:0]}", "WHOLE", "offered_to_edge"),
    Bug("a ninth burst", READ, "!bursts[LOG2_BURSTS] && free", "free", "within_promise"),
    Bug("asks without a place", READ, " && free >= {{(P - N) {1'b0}}, size};", ";", "place_for_every_record"),
    Bug("asks on after an error", READ, "!stop && !error &&", "!stop &&", "none_when_stopped"),
    Bug("counts a burst at an edge alone", READ, " || due == {{LOG2_PLACES{1'b0}}, 1'b1});", ");", "counted"),
    Bug("never asks", READ, "sized <= left != 0;", "sized <= 1'b0;", "waits"),
)  # fmt: skip

WRITE_SAYS = {
    "low_after_reset": LOW,
    "stable": STABLE,
    "inside_destination": "a burst announced lies inside the destination",
    "within_4k": "and does not cross 4 KiB",
    "whole_records": "it is of whole records",
    "read_before": "the targets of all its records have been read",
    "within_promise": "never more than 8 bursts wait for their answer",
    "none_when_stopped": "no burst begins while the job is stopped",
    "ends_with_burst": "W ends a burst exactly where AW said that it ends",
    "written_is_answered": "WRITTEN counts the records of bursts that were answered OKAY, up to the first that was not",
    "written_no_more": "and never more than were announced",
    "told_in_time": "a burst that may be announced is offered two clocks later",
}
WRITE_BUGS = (
    Bug("AW survives a reset", WRITE,
        "if (rst) m_axi_awvalid <= 1'b0;\n    else if (tell)", "if (tell)", "low_after_reset"),
    Bug("takes back AW", WRITE, "else if (m_axi_awready) m_axi_awvalid", "else m_axi_awvalid", "stable"),
    Bug("runs ahead of its count", WRITE, "{1'b0}}, got} - {{(P - N) {1'b0}}, told};", "{1'b0}}, got};", "ready_is"),
    Bug("an address too far", WRITE, "m_axi_awaddr <= {next, 5'd0}", "m_axi_awaddr <= {next + 1'b1, 5'd0}", "offered"),
    Bug("over an edge", WRITE, "WHOLE - {1'b0, destination[LOG2_BURST+4:5]}", "WHOLE", "edge_is"),
    Bug("announces what is not read", WRITE, "whole ? to_edge : ready[N-1:0]", "to_edge", "size_is"),
    Bug("a ninth burst", WRITE, " && !bursts[LOG2_BURSTS];", ";", "within_promise"),
    Bug("announces on while stopped", WRITE, "!stop && !bursts", "!bursts", "none_when_stopped"),
    Bug("forgets the last", WRITE, " || to_send == {{LOG2_PLACES{1'b0}}, 1'b1}", "", "ends_with_burst"),
    Bug("counts a failed burst", WRITE,
        "m_axi_bvalid && !bad && !error", "m_axi_bvalid && !error", "written_is_answered"),
    Bug("waits for a whole burst", WRITE, "whole || (ended && ready != 0)", "whole", "waits_sized"),
    Bug("waits for W", WRITE, " && !bursts[LOG2_BURSTS];", " && !bursts[LOG2_BURSTS] && to_send == 0;",
        "told_in_time"),
)  # fmt: skip

RESULT_SAYS = {
    "low_after_reset": LOW,
    "stable": STABLE,
    "in_order": "the beats of a record are its words, in their order, each once",
    "last_of_burst": "wlast is the last beat of a record that ends a burst",
    "at_once": "a record that is taken is offered in the next clock, whatever the memory does",
    "none_lost": "a record is taken only as the last beat of the one before it goes",
    "allowed_only": "and only when its burst has been announced",
}
RESULT_BUGS = (
    Bug("W survives a reset", RESULT,
        "if (rst) m_axi_wvalid <= 1'b0;\n    else if (room)", "if (room)", "low_after_reset"),
    Bug("shifts while stalled", RESULT, "m_axi_wvalid && m_axi_wready;", "m_axi_wvalid;", "stable"),
    Bug("the next record early", RESULT, "gone && beat == LAST_BEAT);", "gone && beat != 3'd0);", "none_lost"),
    Bug("tag before the words", RESULT, "{index, flags_tag, words}", "{index, words, flags_tag}", "in_order"),
    Bug("wlast in every record", RESULT, "ends && beat", "1'b1 && beat", "last_of_burst"),
    Bug("offers a clock late", RESULT, "m_axi_wvalid <= result_valid && allowed", "m_axi_wvalid <= 1'b0", "at_once"),
    Bug("data before their burst", RESULT, "room && allowed;", "room;", "allowed_only"),
)  # fmt: skip

REGS_SAYS = {
    "low_after_reset": LOW + ", and so are irq and the pulses",
    "b_stable": "an answer to a write stays until it is taken",
    "r_stable": "and so does one to a read",
    "b_for_a_write": "no answer to a write without its address and its word",
    "r_for_a_read": "none to a read without its address",
    "parameters_stay": "count, source and destination change by a write alone",
    "told_is_kept": "what has been told in a clock is in IRQ_STATUS in the next",
    "kept_until_erased": "and stays until it is erased or reset",
    "start_or_reset": "start and soft reset never come together",
}
REGS_BUGS = (
    Bug("B survives a reset", REGS,
        "if (rst) s_axi_bvalid <= 1'b0;\n    else if (write)", "if (write)", "low_after_reset"),
    Bug("takes back B", REGS, "else if (s_axi_bready) s_axi_bvalid", "else s_axi_bvalid", "b_stable"),
    Bug("reads on while stalled", REGS, "raddr_held && !s_axi_rvalid;", "raddr_held;", "r_stable"),
    Bug("answers the address alone", REGS, "waddr_held && wdata_held &&", "waddr_held &&", "b_for_a_write"),
    Bug("answers what nobody asked", REGS, "if (rst || read) raddr_held", "if (rst) raddr_held", "counted"),
    Bug("told and erased", REGS, "(irq_status & ~erased) | told", "(irq_status | told) & ~erased", "told_is_kept"),
    Bug("erases by itself", REGS, "(irq_status & ~erased) | told", "told", "kept_until_erased"),
    Bug("start with a reset", REGS, "wdata[0] && !wdata[1]", "wdata[0]", "start_or_reset"),
)  # fmt: skip

JOB_SAYS = {
    "areas_apart": "a job that begins has areas that do not overlap",
    "areas_inside": "inside the address space",
    "areas_aligned": "at multiples of 32 bytes, and records",
    "areas_copied": "they are those that the registers held at its start",
    "stopped_outside": "no burst may begin but while a job runs, nor behind an error on B or a soft reset",
    "runs_to_the_end": "it ends in the clock after the engines are idle, and not before",
    "told_once": "an end is told once, as done or as an error, when the job is no longer busy",
    "done_or_error": "STATUS has done or error, never both, and error exactly with a code",
    "told_is_so": "and says what was told",
    "starts": "a start while nothing runs makes busy, and erases the last end",
}
JOB_BUGS = (
    Bug("overlap not looked at", JOB, ": overlap ? 4'd5 : 4'd0", ": 4'd0", "areas_apart"),
    Bug("first half of an overlap", JOB, "source_e < destination_end && destination_e < source_end",
        "source_e < destination_end && destination_e < source_e", "past_is"),
    Bug("end of the source not looked at", JOB, ": past[0] ? 4'd3", "", "areas_inside"),
    Bug("count as bytes", JOB, "{28'd0, job_count, 5'd0}", "{33'd0, job_count}", "ends_are"),
    Bug("alignment not looked at", JOB, "crooked[0] ? 4'd1 : ", "", "areas_aligned"),
    Bug("upper half not looked at", JOB, "past            <= high | ", "past            <= ", "limits_are"),
    Bug("bursts after the end", JOB, "state != RUN || aborted", "aborted", "stopped_outside"),
    Bug("bursts behind an error", JOB, "aborted || write_error", "aborted", "stopped_outside"),
    Bug("ends before the writes", JOB, "if (read_idle && write_idle)", "if (read_idle)", "runs_to_the_end"),
    Bug("done and error", JOB, "done       <= code == 0", "done       <= 1'b1", "done_or_error"),
    Bug("tells an end that was reset", JOB, "told_done  <= code == 0 && !aborted && !soft_reset",
        "told_done  <= code == 0 && !aborted", "told_is_so"),
    Bug("keeps the last code", JOB,
        "            code  <= 4'd0;\n          end\n          if (start",
        "          end\n          if (start", "starts"),
)  # fmt: skip

GATES_SAYS = {"independent": "no gates lead from an input of AXI to an output of ik_axi"}
GATES_BUGS = (
    Bug("ready of AW looks at valid", REGS,
        "!waddr_held && !rst", "!waddr_held && !rst && s_axi_awvalid", "independent"),
    Bug("wlast looks at ready", RESULT, "ends && beat == LAST_BEAT", "ends && m_axi_wready", "independent"),
)

WHOLE_SAYS = {
    "f_go": "what the engines assume of each other, here and in the next five: a job starts when nothing is under way",
    "f_area": "in areas inside the address space",
    "f_got_some": "no more targets are read than the job has and the core has places for, and none behind the last",
    "f_ended": "the last target stays the last",
    "f_leave": "a result leaves only if its target was handed on, and its burst announced",
    "f_answer": "an answer is for a burst whose records are gone",
    "never_refused": "ik_axis never refuses a target",
    "read_inside": "a burst asked for lies inside the source as it was at start",
    "written_inside": "one announced inside the destination",
    "wlast_as_announced": "W has a burst announced, and wlast exactly where AW said that it ends",
    "within_promise": "never more than 8 bursts are under way in a direction",
    "quiet": "outside of a job that runs, nothing is under way",
    "some_in_each_burst": "a burst has a record at least",
    "never_stuck": "while a job runs, at most one clock is nobody's turn: neither the memory's nor that of ik_axis",
}
WHOLE_AFTER = {
    "f_got_some": ["got_is", "read_before", "position", "counts_are", "areas_are", "quiet", "to_write_is",
                   "place_for_every_record", "counted", "offered", "some_in_each", "core_is", "together"],
    "f_answer": ["bus_is", "offered_waits", "together"],
    "read_inside": ["inside_source", "within_4k", "whole_records", "quiet", "bases_are", "counts_are", "areas_are",
                    "together"],
    "written_inside": ["inside_destination", "within_4k", "whole_records", "quiet", "bases_are", "counts_are",
                       "areas_are", "together"],
}  # fmt: skip
WHOLE_BUGS = (
    Bug("ends before the writes", JOB, "if (read_idle && write_idle)", "if (read_idle)", "quiet"),
    Bug("a place comes back too early", TOP, "leave = result_valid && result_ready", "leave = result_valid", "f_leave"),
    Bug("twice as many places as the core has", TOP,
        ".LOG2_PLACES(LOG2_PLACES),\n      .LOG2_BURSTS(LOG2_BURSTS)\n  ) u_read",
        ".LOG2_PLACES(LOG2_PLACES + 1),\n      .LOG2_BURSTS(LOG2_BURSTS)\n  ) u_read", "f_got_some"),
    Bug("a target in every clock", TARGET, "target_valid <= record_valid && !rst;", "target_valid <= !rst;",
        "never_refused"),
    Bug("results of an aborted job", JOB, "clear = state == ENDS", "clear = 1'b0", "emptied"),
    Bug("reads where it should write", TOP,
        ".source       (job_source)", ".source       (job_destination)", "bases_are"),
    Bug("area not checked", JOB, ": past[0] ? 4'd3", "", "areas_inside"),
    Bug("the last target is told early", READ, "(left == 0 && due == 0);\n  assign idle", "(left == 0);\n  assign idle",
        "f_got_some"),
    Bug("wlast without its beat", RESULT, "ends && beat == LAST_BEAT", "ends", "wlast_as_announced"),
    Bug("data before their burst", RESULT, "room && allowed;", "room;", "f_leave"),
    Bug("the end is not told to the writer", TOP, ".ended        (ended),\n      .idle         (write_idle)",
        ".ended        (1'b0),\n      .idle         (write_idle)", "never_stuck"),
    Bug("starts again while it runs", JOB, "go = state == DECIDE", "go = state >= DECIDE", "f_go"),
    Bug("end of the destination not looked at", JOB, ": past[1] ? 4'd4", "", "f_area"),
    Bug("the end is told between two bursts", READ,
        "(left == 0 && due == 0);\n  assign idle", "(due == 0);\n  assign idle", "f_ended"),
    Bug("reads a record too far", READ, "m_axi_araddr <= {next, 5'd0}", "m_axi_araddr <= {next + 1'b1, 5'd0}",
        "read_inside"),
    Bug("writes a record too far", WRITE, "m_axi_awaddr <= {next, 5'd0}", "m_axi_awaddr <= {next + 1'b1, 5'd0}",
        "written_inside"),
    Bug("a ninth burst", WRITE, " && !bursts[LOG2_BURSTS];", ";", "within_promise"),
    Bug("waits for a whole burst", WRITE, "whole || (ended && ready != 0)", "whole", "still_told"),
    Bug("asks for nothing", READ,
        "all_left ? left[N-1:0] : to_edge", "all_left ? {N{1'b0}} : to_edge", "some_in_each_burst"),
)  # fmt: skip


def proof(of: str, module: str, says: dict[str, str], bugs: tuple[Bug, ...], width: str) -> Proof:
    after = WHOLE_AFTER if of == "whole" else {}
    return Proof(f"axi_{of}", "64", module, width, says, bugs, after=after)


BUS = "32-bit addresses, 64-bit data, bursts of 8 records"
AXI_PROOFS = (
    proof("read", "ik_axi_read", READ_SAYS, READ_BUGS, f"{BUS}, 64 places"),
    proof("write", "ik_axi_write", WRITE_SAYS, WRITE_BUGS, f"{BUS}, 64 places"),
    proof("result", "ik_axi_result", RESULT_SAYS, RESULT_BUGS, "W=32, 64-bit data"),
    proof("regs", "ik_axi_regs", REGS_SAYS, REGS_BUGS, "W=32"),
    proof("job", "ik_axi_job", JOB_SAYS, JOB_BUGS, "32-bit addresses"),
    proof("whole", "ik_axi", WHOLE_SAYS, WHOLE_BUGS, f"W=32, {BUS}, 64 places"),
    proof("gates", "ik_axi", GATES_SAYS, GATES_BUGS, f"W=32, {BUS}"),
)
