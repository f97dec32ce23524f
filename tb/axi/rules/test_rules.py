# SPDX-License-Identifier: Apache-2.0
"""Tests of the AXI monitors: traces that break each rule, the monitors' connections, and seeded bugs in the RTL.

A bug must make the named rule fail at the named port or, if no rule is named, one of the bench's own checks.
"""

import re

import pytest

from tb.axi.instances import echoing
from tb.sim.env import ROOT, simulator
from tb.sim.seeded_bugs import Bug, copy_rtl
from tb.sim.shared import failures, passes
from tb.sim.sources import HEADER, PORT, RULES, TOP, top_of

PORTS = {
    "stream": ("ik_rules_channel", {"N": 8, "STREAM": 1, "STOP": 0}),
    "lite": ("ik_rules_lite", {"STOP": 0}),
    "axi4": ("ik_rules_axi4", {"STOP": 0}),
}

STREAMS, JOBS, FAULTS, REGISTERS = "tb.core.test_streams", "tb.axi.test_ik_axi", "tb.axi.faults", "tb.axi.registers"
FIFO, CREDITS, AXI = "rtl/lib/ik_fifo.v", "rtl/lib/ik_credit_fifo.v", "rtl/ik_axi.v"
READ, WRITE, RESULT, REGS, JOB, TARGET = (
    f"rtl/axi/ik_axi_{part}.v" for part in ("read", "write", "result", "regs", "job", "target")
)
KIND = "m_axi_arprot} = {1'b0, SIZE, 2'b01, 4'b0011, 3'b000}"


def ar(size: str = "SIZE", burst: str = "2'b01", cache: str = "4'b0011") -> tuple[str, str]:
    """Return the Verilog text of the read address channel's constants, and a replacement with wrong constants."""
    return KIND, f"m_axi_arprot}} = {{1'b0, {size}, {burst}, {cache}, 3'b000}}"


BUGS = [  # port and rule, bench, its test, file, text, wrong text
    ("m_axis LOW_AFTER_RESET", STREAMS, "after=full", FIFO, "      m_valid <= 1'b0;\n    end else", "    end else"),
    ("m_axis VALID_KNOWN", STREAMS, "one_result", FIFO, "      wr_ptr  <= {(LOG2 + 1) {1'b0}};\n", ""),
    ("m_axis VALID_STAYS", STREAMS, "bursts/stall=bursts", FIFO, "if (load) begin", "if (load || empty) begin"),
    ("m_axis PAYLOAD_KNOWN", STREAMS, "one_result", FIFO, "if (wr_en) mem", "if (wr_en && wr_ptr[0]) mem"),
    ("s_axis READY_KNOWN", STREAMS, "one_result", CREDITS, "if (rst) credits <= ", "if (1'b0) credits <= "),
    ("s_axi B_AFTER_ADDRESS", REGISTERS, "strobes", REGS, "write = waddr_held && ", "write = "),
    ("s_axi B_AFTER_DATA", REGISTERS, "strobes", REGS, "waddr_held && wdata_held &&", "waddr_held &&"),
    ("s_axi BRESP", REGISTERS, "every_field", REGS, "s_axi_bresp <= OKAY", "s_axi_bresp <= 2'b01"),
    ("s_axi R_AFTER_ADDRESS", REGISTERS, "after_a_reset", REGS, "read = raddr_held &&", "read ="),
    ("s_axi RRESP", REGISTERS, "unmapped_address", REGS, "r_limits ? OKAY : SLVERR", "2'b01"),
    ("m_axi.aw VALID_STAYS", JOBS, "stalled=aw", WRITE, "else if (m_axi_awready) m_axi", "else m_axi"),
    ("m_axi.ar_burst BURST_TYPE", JOBS, "one_record", AXI, *ar(burst="2'b11")),
    ("m_axi.ar_burst BURST_SIZE", JOBS, "one_record", AXI, *ar(size="3'd4")),
    ("m_axi.ar_burst FIXED_LENGTH", JOBS, "pages", AXI, *ar(burst="2'b00")),
    ("m_axi.ar_burst WRAP_LENGTH", JOBS, "pages", AXI, *ar(burst="2'b10")),
    ("m_axi.ar_burst WITHIN_4K", JOBS, "pages", READ, "WHOLE - {1'b0, next[LOG2_BURST-1:0]}", "WHOLE"),
    ("m_axi.ar_burst CACHE", JOBS, "one_record", AXI, *ar(cache="4'b0100")),
    ("m_axi.write WLAST", JOBS, "edges_of_bursts", WRITE, " || to_send == {{LOG2_PLACES{1'b0}}, 1'b1}", ""),
    ("m_axi.write WSTRB", JOBS, "one_record", AXI, "m_axi_awprot} = {1'b0, SIZE", "m_axi_awprot} = {1'b0, 3'd2"),
    # properties of jobs, which the bench itself checks
    ("free_places", JOBS, "blocked_channel/blocked=w", READ, " && free >= {{(P - N) {1'b0}}, size};", ";"),
    ("error_code", FAULTS, "bus_errors", READ, "error_decode <= m_axi_rresp[0]", "error_decode <= 1'b0"),
    ("error_stops_writes", FAULTS, "bus_errors", JOB, "aborted || write_error", "aborted"),
    ("all_answers", JOBS, "counters", WRITE, "bursts == 0 && (stop", "(stop"),
    ("saturation", JOBS, "pages", TARGET, "(i != PHI) && up[W-1]", "1'b0 && up[W-1]"),
    ("overlap_refused", FAULTS, "refused_areas", JOB, "refused = crooked", "refused = overlap ? 4'd0 : crooked"),
    ("reset_drains", FAULTS, "soft_reset", JOB, "(read_idle && write_idle)", "(aborted || read_idle && write_idle)"),
    ("counters", JOBS, "counters", JOB, "write_stalls <= write_stalls + 32'd1", "write_stalls <= write_stalls"),
    ("strobes", REGISTERS, "strobes", REGS, "if (strobes[i]) merged", "merged"),
    ("irq_enable", REGISTERS, "pulses", REGS, "(irq_status & irq_enable) != 0", "irq_status != 0"),
]

QUICK = "m_axi.aw VALID_STAYS"


def case(finding: str, *others: str):
    """Return a test case, marked slow if ``finding`` names a rule, else for releases. ``QUICK`` has no mark."""
    slow = [pytest.mark.slow, pytest.mark.cost(4)]
    marks = [] if finding == QUICK else slow if " " in finding else pytest.mark.release
    return pytest.param(finding, *others, id=finding.replace(" ", "_"), marks=marks)


@pytest.mark.sim
def test_every_rule_fails_its_own_trace():
    passes("rules", toplevel=TOP, module="tb.axi.rules.rules", top=top_of(PORTS))


@pytest.mark.parametrize("file", sorted(RULES.glob("*.vh")), ids=lambda file: file.stem)
def test_a_monitor_has_all_signals_of_its_port(file):
    """Check every connection of a monitor, and that a stream's payload contains all bits of tuser and tdata."""
    modules = {found[1]: found[3] for found in HEADER.finditer((RULES / "ik_rules.v").read_text())}
    top = HEADER.search((ROOT / "rtl" / f"{file.stem}.v").read_text())[3]
    widths = {name: form[1:].partition(":")[0] for _, form, name in PORT.findall(top)}  # text of the highest index
    monitor = re.compile(r"^(ik_rules_\w+)(?: #\((.*?)\n\))? rules_(\w+) \((.*?)\n\);", re.S | re.M)
    monitors = monitor.findall(file.read_text())
    assert len(monitors) == 2
    for module, parameters, port, connections in monitors:
        signals = {name: f"{port}_{name}" for *_, name in PORT.findall(modules[module])} | {"clk": "clk", "rst": "rst"}
        if module == "ik_rules_channel":
            signals |= {"valid": f"{port}_tvalid", "ready": f"{port}_tready"}
            signals["payload"] = f"{{{port}_tuser, {port}_tdata}}"
            bits = re.search(r"\.N +\((.*)\)", parameters)[1]
            size = f"{widths[f'{port}_tdata']} + 1 + {widths[f'{port}_tuser']} + 1"
            assert eval(f"{bits} == {size}", {"W": 24, "TAG_W": 5, "CHOOSE": 1}), f"{port}: payload of {bits} bits"
        assert dict(re.findall(r"\.(\w+) *\((.*)\)", connections)) == signals, port


only_icarus = pytest.mark.skipif(simulator() != "icarus", reason="the same monitors; Icarus builds them in a second")


@pytest.mark.sim
@only_icarus
@pytest.mark.parametrize(("finding", "bench", "test", "file", "old", "new"), [case(*row) for row in BUGS])
def test_seeded_bug_is_detected(finding, bench, test, file, old, new, tmp_path):
    bug = Bug(finding, file, old, new)
    env = {"IK_AXI_CORE": "echo", "IK_AXI_JOBS": "20", "COCOTB_MAX_FAILURES": "1", "COCOTB_TEST_FILTER": test}
    stream = bench == STREAMS
    top, options = ("ik_axis", {"root": copy_rtl(tmp_path, bug)}) if stream else ("ik_axi", echoing(tmp_path, bug))
    options |= {"parameters": {"W": 18}, "name": f"rules-{finding.replace(' ', '-')}"}
    messages = failures(tmp_path / "log", toplevel=top, module=bench, env=env, **options)
    wrong = [message for _, message in messages if message]
    assert wrong, "the tests pass"
    if " " in finding:
        port, rule = finding.split()
        assert re.fullmatch(rf"rule {rule} \([^)]+\) is broken at \S+\.rules_{re.escape(port)}, \d+ ns", wrong[0])


@pytest.mark.sim
@only_icarus
def test_tests_after_a_broken_rule_are_not_run(tmp_path):
    root = copy_rtl(tmp_path, Bug("data changes while it waits", FIFO, "if (load) m_data", "m_data"))
    options = {"toplevel": "ik_axis", "module": STREAMS, "parameters": {"W": 18}, "root": root, "name": "rules-not-run"}
    env = {"COCOTB_TEST_FILTER": "streams.full|ready_before|not_ready"}
    (name, first), *others = failures(tmp_path / "log", env=env, **options)
    assert name == "full"
    assert first.startswith("rule PAYLOAD_STAYS (IHI 0051A 2.2.1) is broken at ik_axis.rules_m_axis, ")
    assert [message for _, message in others] == ["not run: the simulation ended in full"] * 2
