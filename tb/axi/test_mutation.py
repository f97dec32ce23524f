# SPDX-License-Identifier: Apache-2.0
"""Bugs that are put into ``ik_axi`` are caught, each by the test that is there for it."""

import pytest

from tb.axi.instances import echoing
from tb.axi.test_ik_axi import MODULES
from tb.sim.env import ROOT, simulator
from tb.sim.mutants import Bug
from tb.sim.runner import simulate

TOP, READ, WRITE = "rtl/ik_axi.v", "rtl/axi/ik_axi_read.v", "rtl/axi/ik_axi_write.v"
TARGET, RESULT = "rtl/axi/ik_axi_target.v", "rtl/axi/ik_axi_result.v"
JOB, REGS = "rtl/axi/ik_axi_job.v", "rtl/axi/ik_axi_regs.v"

BUGS = [  # fails: the tests that have to notice
    Bug("reads over an edge", READ, "WHOLE - {1'b0, next[LOG2_BURST-1:0]}", "WHOLE", "pages"),
    Bug("asks without a place", READ, " && free >= {{(P - N) {1'b0}}, size};", ";", "nobody_answers/shut=w"),
    Bug("asks for a ninth burst", READ, "!bursts[LOG2_BURSTS] && free", "free", "nobody_answers/shut=r"),
    Bug("gives no place back", READ, "free - asked + {{LOG2_PLACES{1'b0}}, leave}", "free - asked", "long_job"),
    Bug("solves what was not read", READ, "last && !bad && !error", "last && !error", "error_on_read"),
    Bug("asks on after an error", READ, "!stop && !error &&", "!stop &&", "error_on_read"),
    Bug("forgets the beat", READ, "error_beat   <= at", "error_beat   <= 3'd0", "error_on_read"),
    Bug("takes DECERR for SLVERR", READ, "error_decode <= m_axi_rresp[0]", "error_decode <= 1'b0", "error_on_read"),
    Bug("takes back AR", READ, "else if (m_axi_arready) m_axi_arvalid", "else m_axi_arvalid", "stalled=ar"),
    Bug("last beats stall", READ, "(left == 0 || error || stop)", "(error || stop)", "one_record"),
    Bug("announces what is not read", WRITE, "whole || (ended && ready != 0)", "ready != 0", "edges_of_bursts"),
    Bug("writes over an edge", WRITE, "WHOLE - {1'b0, destination[LOG2_BURST+4:5]}", "WHOLE", "pages"),
    Bug("does not say wlast", WRITE, " || to_send == {{LOG2_PLACES{1'b0}}, 1'b1}", "", "edges_of_bursts"),
    Bug("counts behind an error", WRITE, "m_axi_bvalid && !bad && !error", "m_axi_bvalid && !bad", "error_on_write"),
    Bug("writes on after an error", JOB, "aborted || write_error", "aborted", "error_on_write"),
    Bug("takes a B for a whole burst", WRITE, "answer_whole ? answer_edge : to_answer[N-1:0]", "WHOLE", "one_record"),
    Bug("asks for a ninth answer", WRITE, " && !bursts[LOG2_BURSTS];", ";", "nobody_answers/shut=b"),
    Bug("takes back AW", WRITE, "else if (m_axi_awready) m_axi_awvalid", "else m_axi_awvalid", "stalled=aw"),
    Bug("ends before the answers", WRITE, "bursts == 0 && (stop", "(stop", "counters"),
    Bug("data change while stalled", RESULT, "m_axi_wvalid && m_axi_wready;", "m_axi_wvalid;", "stalled=w"),
    Bug("no saturation", TARGET, "(i != PHI) && up[W-1]", "1'b0 && up[W-1]", "pages"),
    Bug("an angle saturates", TARGET, "(i != PHI) && up[W-1]", "up[W-1]", "pages"),
    Bug("no rounding", TARGET, "record[32*i+31-W]", "1'b0", "pages"),
    Bug("index runs on", TOP, "if (go) index", "if (rst) index", "many_jobs$"),
    Bug("neighbours overlap", JOB, "source_e < destination_end", "source_e <= destination_end", "neighbours"),
    Bug("overlap is not seen", JOB, "refused = crooked[0]", "refused = 1'b0 ? 4'd0 : overlap ? 4'd0 : crooked[0]",
        "refused_areas"),
    Bug("the last byte is beyond", JOB, "destination_end > limit", "destination_end >= limit", "neighbours"),
    Bug("upper half is not looked at", JOB, "past            <= high | ", "past            <= ", "refused_areas"),
    Bug("no records are an error", JOB, "if (job_count != 0) code <= refused", "code <= refused", "no_records"),
    Bug("a start is not refused", JOB, "start && !soft_reset && busy && !rst", "1'b0", "start_while_busy"),
    Bug("asks on after a soft reset", JOB, "state != RUN || aborted", "aborted", "soft_reset"),
    Bug("does not wait at a soft reset", JOB,
        "if (read_idle && write_idle)", "if (aborted || (read_idle && write_idle))", "soft_reset"),
    Bug("an error behind a soft reset", JOB,
        "if (aborted || soft_reset) code", "if (aborted && soft_reset) code", "soft_reset_behind_an_error"),
    Bug("another protection", TOP, "m_axi_arprot} = {1'b0, SIZE, 2'b01, 4'b0011, 3'b000}",
        "m_axi_arprot} = {1'b0, SIZE, 2'b01, 4'b0011, 3'b010}", "one_record"),
    Bug("results of an aborted job", JOB, "clear = state == ENDS", "clear = 1'b0", "soft_reset"),
    Bug("says done of an aborted job", JOB,
        "done       <= code == 0 && !aborted", "done       <= code == 0", "soft_reset"),
    Bug("counts no stalls", JOB, "write_stalls <= write_stalls + 32'd1", "write_stalls <= write_stalls", "counters"),
    Bug("no strobes", REGS, "strobes[i] ? data[8*i+:8]", "1'b1 ? data[8*i+:8]", "strobes"),
    Bug("a pulse without its strobe", REGS, "waddr == A_CONTROL && wstrb[0]", "waddr == A_CONTROL", "strobes"),
    Bug("erases other bits", REGS, "wstrb[0]) ? wdata[2:0]", "wstrb[0]) ? 3'd7", "pulses"),
    Bug("irq without enable", REGS, "(irq_status & irq_enable) != 0", "irq_status != 0", "pulses"),
    Bug("a write too much is OKAY", REGS, "default: s_axi_bresp <= SLVERR", "default: ", "every_field"),
    Bug("two words change places", REGS, "A_ERROR_LO: s_axi_rdata <= error_address[31:0]",
        "A_ERROR_LO: s_axi_rdata <= error_address[63:32]", "error_on_read"),
    Bug("takes back a response", REGS, "else if (s_axi_bready) s_axi_bvalid", "else s_axi_bvalid", "nothing_there"),
]  # fmt: skip
QUICK = ("asks without a place", "asks on after a soft reset")
SMALL_BURSTS = ("asks for a ninth burst", "asks for a ninth answer")
"""Places are as many as eight whole bursts of the default size."""


def test_bugs_can_be_seeded():
    for bug in BUGS:
        assert bug.seeded((ROOT / bug.file).read_text())


@pytest.mark.sim
@pytest.mark.skipif(simulator() != "icarus", reason="the same tests; Icarus builds them in a second")
@pytest.mark.parametrize(
    "bug",
    [b if b.what in QUICK else pytest.param(b, marks=[pytest.mark.slow, pytest.mark.cost(8)]) for b in BUGS],
    ids=lambda b: b.what.replace(" ", "_"),
)
def test_bug_is_caught(bug, tmp_path):
    env = {"IK_AXI_CORE": "echo", "IK_AXI_JOBS": "80", "IK_AXI_FAULTS": "12", "COCOTB_TEST_FILTER": bug.fails}
    parameters = {"W": 18, "LOG2_BURST": 1 if bug.what in SMALL_BURSTS else 3}
    echo = {**echoing(tmp_path, bug), "name": f"bug{BUGS.index(bug)}"}
    with pytest.raises(SystemExit, match=r"^FAILED \d+ tests"):
        simulate("ik_axi", MODULES, parameters=parameters, env=env, seed=1, **echo)
