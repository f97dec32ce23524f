# SPDX-License-Identifier: Apache-2.0
"""Properties of ik_axi, module by module: the rules of AXI4, bursts inside their areas, the life of a job."""

from __future__ import annotations

from tb.formal.proof import Proof

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

RESULT_SAYS = {
    "low_after_reset": LOW,
    "stable": STABLE,
    "in_order": "the beats of a record are its words, in their order, each once",
    "last_of_burst": "wlast is the last beat of a record that ends a burst",
    "at_once": "a record that is taken is offered in the next clock, whatever the memory does",
    "none_lost": "a record is taken only as the last beat of the one before it goes",
    "allowed_only": "and only when its burst has been announced",
}

REGS_SAYS = {
    "low_after_reset": LOW + ", and so are irq and the pulses",
    "b_stable": "an answer to a write stays until it is taken",
    "r_stable": "and so does one to a read",
    "b_for_a_write": "no answer to a write without its address and its word",
    "r_for_a_read": "none to a read without its address",
    "parameters_stay": "count, source and destination change by a write alone",
    "told_is_kept": "an end reported in a clock is in IRQ_STATUS in the next",
    "kept_until_erased": "and stays until it is erased or reset",
    "start_or_reset": "start and soft reset never come together",
}

JOB_SAYS = {
    "areas_apart": "a job that begins has areas that do not overlap",
    "areas_inside": "inside the address space",
    "areas_aligned": "at multiples of 32 bytes, and records",
    "areas_copied": "they are those that the registers held at its start",
    "stopped_outside": "no burst may begin but while a job runs, nor behind an error on B or a soft reset",
    "runs_to_the_end": "it ends in the clock after the engines are idle, and not before",
    "told_once": "an end is reported once, as done or as an error, when the job is no longer busy",
    "done_or_error": "STATUS has done or error, never both, and error exactly with a code",
    "told_is_so": "and agrees with the reported end",
    "starts": "a start while nothing runs makes busy, and erases the last end",
}

GATES_SAYS = {"independent": "no gates lead from an input of AXI to an output of ik_axi"}

WHOLE_SAYS = {
    "f_go": "assumption of the engines, as the next five: a job starts when nothing is under way",
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
    "never_stuck": "while a job runs, at most one clock passes in which neither memory nor ik_axis has to act",
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


def proof(of: str, module: str, says: dict[str, str], width: str) -> Proof:
    after = WHOLE_AFTER if of == "whole" else {}
    return Proof(f"axi_{of}", "64", module, width, says, after=after)


BUS = "32-bit addresses, 64-bit data, bursts of 8 records"
AXI_PROOFS = (
    proof("read", "ik_axi_read", READ_SAYS, f"{BUS}, 64 places"),
    proof("write", "ik_axi_write", WRITE_SAYS, f"{BUS}, 64 places"),
    proof("result", "ik_axi_result", RESULT_SAYS, "W=32, 64-bit data"),
    proof("regs", "ik_axi_regs", REGS_SAYS, "W=32"),
    proof("job", "ik_axi_job", JOB_SAYS, "32-bit addresses"),
    proof("whole", "ik_axi", WHOLE_SAYS, f"W=32, {BUS}, 64 places"),
    proof("gates", "ik_axi", GATES_SAYS, f"W=32, {BUS}"),
)
