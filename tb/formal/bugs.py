# SPDX-License-Identifier: Apache-2.0
"""Seeded bugs: a proof must fail on the bug seeded for it.

A key of :data:`BUGS` is a proof's name or a prefix of it; the longest matching key applies. ``Bug.fails`` is the
property or question that must have a counterexample; proofs about gates ignore ``Bug.fails``.
"""

from tb.sim.seeded_bugs import Bug

LAP = "rtl/fold/ik_fold_lap.v"
CREDITS = "rtl/lib/ik_credit_fifo.v"
JOB = "rtl/axi/ik_axi_job.v"


def _valid(file: str, line: str = "valid", clocks: str = "T_OUT") -> Bug:
    return Bug("valid a clock early", file, f"= {line}[{clocks}-1]", f"= {line}[{clocks}-2]", "valid_comes_out")


BUGS: dict[str, Bug] = {
    "fifo": Bug("reads the neighbour's word", "rtl/lib/ik_fifo.v",
        "mem[rd_ptr[LOG2-1:0]]", "mem[rd_ptr[LOG2-1:0] ^ 1'b1]", "in_order"),
    "axis": Bug("admits without a free slot", CREDITS, "!rst && (credits != 0)", "!rst", "within_places"),
    "handshake": Bug("tready depends on the receiver", CREDITS,
        "(credits != 0);", "(credits != 0 || m_ready);", "independent"),
    "valid_lean": _valid("rtl/lean/ik_lean.v"),
    "valid_paper": _valid("rtl/paper/ik_paper.v"),
    "valid_arm": _valid("rtl/lean/ik_lean_arm.v", "valid_after", "T_AFTER"),
    "fold": Bug("offered before it is complete", LAP,
        "if (go && last_result && writing)", "if (go && last_input && writing)", "answer_whole"),
    "handshake_fold": Bug("tready depends on the receiver", LAP,
        "= go && current", "= (go || m_ready) && current", "independent"),
    "choose": Bug("the elbow bit of the wrist", "rtl/ik_choose.v",
        "max(wrist_pair_0, step_5_1_late)", "max(wrist_pair_0, step_5_0_late)", "wrists"),
    "div_row": Bug("adds d + 1", "rtl/lib/ik_div_row.v", "bit_in, 1'b0}", "bit_in, 1'b1}", "identity"),
    "root_row": Bug("subtracts 4 root only", "rtl/lib/ik_root_row.v", "{~ge}}, 2'b01}", "{~ge}}, 2'b00}", "identity"),
    "div": Bug("loses the quotient bit", "rtl/lib/ik_div_digit.v", "{word, q_bit}", "{word, 1'b0}", "result_"),
    "root": Bug("loses the root's bit", "rtl/lib/ik_root_digit.v", "{word, q_bit}", "{word, 1'b0}", "result_"),
    "axi_read": Bug("a ninth burst", "rtl/axi/ik_axi_read.v", "!bursts[LOG2_BURSTS] && free", "free", "within_promise"),
    "axi_write": Bug("counts a failed burst", "rtl/axi/ik_axi_write.v",
        "m_axi_bvalid && !bad && !error", "m_axi_bvalid && !error", "written_is_answered"),
    "axi_result": Bug("wlast in every record", "rtl/axi/ik_axi_result.v",
        "ends && beat", "1'b1 && beat", "last_of_burst"),
    "axi_regs": Bug("reads continue while stalled", "rtl/axi/ik_axi_regs.v",
        "raddr_held && !s_axi_rvalid;", "raddr_held;", "r_stable"),
    "axi_job": Bug("overlap ignored", JOB, ": overlap ? 4'd5 : 4'd0", ": 4'd0", "areas_apart"),
    "axi_whole": Bug("ends before the writes", JOB, "if (read_idle && write_idle)", "if (read_idle)", "quiet"),
    "axi_whole_fold": Bug("keeps an earlier job's targets", "rtl/axi/ik_axi_records.v",
        "rst || clear),\n          .wr_en", "rst),\n          .wr_en", "emptied"),
    "axi_gates": Bug("wlast depends on ready", "rtl/axi/ik_axi_result.v",
        "ends && beat == LAST_BEAT", "ends && m_axi_wready", "independent"),
    "floors": Bug("remainder up to the divisor", "tb/formal/ik_div_digit.vh",
        "R < g_row[k].divisor_q", "R <= g_row[k].divisor_q", "divider: last"),
    "rsqrt": Bug("u of the next mantissa", "rtl/lib/ik_quadratic.v", ".N(3)) u_u_0", ".N(2)) u_u_0", "hl, factors"),
}  # fmt: skip
