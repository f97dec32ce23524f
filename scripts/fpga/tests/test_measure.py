# SPDX-License-Identifier: Apache-2.0
"""Tests of scripts/fpga without its tools: reports, wrapper, register packing, figures and page."""

import json
import pickle
import re

import pytest

from scripts.fpga import measure as fpga
from scripts.fpga import pack, page, report, runs
from scripts.fpga.wrapper import HEADER, wrapper
from tb.sim.sources import closure

DATA = json.loads(fpga.FIGURES.read_text())

STAT = {
    "modules": {
        "\\ik_top": {
            "num_cells_by_type": {
                "LUT2": 3,
                "INV": 1,
                "MUXCY": 4,
                "FDRE": 2,
                "$paramod\\ik_delay\\W=s32'00000000000000000000000000001000": 2,
                "$paramod$0a1b\\ik_mul3": 1,
            },
        },
        "$paramod\\ik_delay\\W=s32'00000000000000000000000000001000": {"num_cells_by_type": {"SRL16E": 8, "FDRE": 1}},
        "$paramod$0a1b\\ik_mul3": {
            "num_cells_by_type": {
                "LUT4": 10,
                "MULT18X18": 3,
                "XORCY": 9,
                "MUXF5": 2,
                "$scopeinfo": 5,
                "$paramod\\ik_delay\\W=s32'00000000000000000000000000001000": 1,
            },
        },
    },
}


def test_cells_of_the_modules_inside_are_counted():
    assert report.counted(STAT, "xc2vp") == {
        "LUT": 3 + 1 + 10 + 3 * 8,
        "shift": 24,
        "FF": 2 + 3,
        "carry": 4,
        "MUXF": 2,
        "multipliers": 3,
        "RAM": 0,
    }


def test_modules_have_their_own_cells_only_and_sections_all_inside():
    modules = report.by_module(STAT, "xc2vp")
    assert modules["ik_delay"]["instances"] == 3 and modules["ik_delay"]["shift"] == 24
    assert modules["ik_mul3"]["LUT"] == 10 and modules["ik_top"]["LUT"] == 4
    assert sum(m["LUT"] for m in modules.values()) == report.counted(STAT, "xc2vp")["LUT"]
    sections = report.by_section(STAT, "xc2vp")
    assert sections["ik_mul3"]["LUT"] == 18 and sections["ik_delay"]["LUT"] == 16 and sections["itself"]["LUT"] == 4


def test_a_carry_cell_of_ecp5_is_two_luts():
    stat = {"modules": {"\\ik_top": {"num_cells_by_type": {"CCU2C": 5, "LUT4": 7, "PFUMX": 2, "TRELLIS_FF": 3}}}}
    assert report.counted(stat, "ecp5")["LUT"] == 17


def test_an_unknown_cell_is_named():
    with pytest.raises(report.ToolError, match="SRLC32E_X"):
        report.counted({"modules": {"\\t": {"num_cells_by_type": {"SRLC32E_X": 1}}}}, "xc2vp")


REPORT = {
    "fmax": {"clk": {"achieved": 98.64851379394531, "constraint": 200}},
    "utilization": {
        "MULT18X18D": {"available": 156, "used": 149}, "TRELLIS_FF": {"available": 83640, "used": 15033},
        "DCCA": {"available": 56, "used": 1},
    },
    "critical_paths": [
        {"from": "posedge clk", "to": "<async>", "path": []},
        {
            "from": "posedge clk", "to": "posedge clk",
            "path": [
                {"type": "clk-to-q", "delay": 4.263, "from": {"cell": "dut.u_q.rom.0.0"},
                 "to": {"cell": "dut.u_q.rom.0.0"}},
                {"type": "routing", "delay": 1.948, "from": {"cell": "dut.u_q.rom.0.0"},
                 "to": {"cell": "dut.u_q.bend_2_TRELLIS_FF_Q_DI_MULT18X18D_P19"}},
                {"type": "logic", "delay": 3.066, "from": {"cell": "dut.u_q.bend_2_TRELLIS_FF_Q_DI_MULT18X18D_P19"},
                 "to": {"cell": "dut.u_q.bend_2_TRELLIS_FF_Q_DI_MULT18X18D_P19"}},
                {"type": "routing", "delay": 0.86, "from": {"cell": "dut.u_q.bend_2_TRELLIS_FF_Q_DI_MULT18X18D_P19"},
                 "to": {"cell": "dut.u_q.bend_2_TRELLIS_FF_Q_8"}},
                {"type": "setup", "delay": 0, "from": {"cell": "dut.u_q.bend_2_TRELLIS_FF_Q_8"},
                 "to": {"cell": "dut.u_q.bend_2_TRELLIS_FF_Q_8"}},
            ],
        },
    ],
}  # fmt: skip
"""nextpnr's report for the lean datapath at 18 bits, shortened."""


def test_clock_and_critical_path_of_a_report():
    assert report.placed(REPORT) == {
        "mhz": 98.6,
        "used": {"MULT18X18D": 149, "TRELLIS_FF": 15033},
        "path": {
            "from": "u_q.rom.0.0",
            "to": "u_q.bend_2",
            "through": ["DP16KD", "MULT18X18D"],
            "ns": 10.14,
            "routing_ns": 2.81,
        },
    }


def test_no_clock_is_quoted_that_a_multiplier_could_not_keep():
    quick = {**REPORT, "fmax": {"clk": {"achieved": 400.0}}}
    assert report.placed(quick)["mhz"] == round(1000 / report.MULTIPLIER_NS, 1)


def flop(d, q, clk=2, **parameters):
    return {
        "type": "TRELLIS_FF",
        "parameters": {"CEMUX": "1 ", "CLKMUX": "CLK", "REGSET": "RESET", **parameters},
        "port_directions": {"CLK": "input", "DI": "input", "LSR": "input", "Q": "output"},
        "connections": {"CLK": [clk], "DI": [d], "LSR": ["0"], "Q": [q]},
    }


def product(a, b, p):
    ports = {"A0": a, "A1": "0", "B0": b, "B1": b, "P0": p}
    return {
        "type": "MULT18X18D",
        "parameters": {},
        "port_directions": {k: "output" if k[0] == "P" else "input" for k in ports},
        "connections": {k: [net] for k, net in ports.items()},
    }


def netlist(**cells):
    return {"cells": cells, "ports": {"out": {"direction": "output", "bits": [31]}}}


def test_registers_around_a_multiplier_go_into_it():
    design = netlist(a=flop(10, 20), b=flop(11, 21), m=product(20, 21, 30), p=flop(30, 31))
    assert pack.pack_registers(design) == {"multipliers": 1, "input": 1, "output": 1, "flip_flops": 3}
    assert list(design["cells"]) == ["m"]
    nets = design["cells"]["m"]["connections"]
    assert (nets["A0"], nets["A1"], nets["B0"], nets["B1"], nets["P0"], nets["CLK0"]) == (
        [10],
        ["0"],
        [11],
        [11],
        [31],
        [2],
    )
    assert design["cells"]["m"]["parameters"]["REG_INPUTA_CLK"] == "CLK0"


def test_a_register_that_others_read_stays():
    lut = {"type": "LUT4", "parameters": {}, "port_directions": {"A": "input"}, "connections": {"A": [20]}}
    design = netlist(a=flop(10, 20), b=flop(11, 21), m=product(20, 21, 30), p=flop(30, 31), lut=lut)
    assert pack.pack_registers(design)["flip_flops"] == 2
    assert set(design["cells"]) == {"a", "m", "lut"}


def test_what_is_no_plain_register_stays():
    """A reset to 1, another clock, or a product that logic reads directly prevents packing."""
    set_flop = flop(11, 21, REGSET="SET")
    design = netlist(a=flop(10, 20), b=set_flop, m=product(20, 21, 30), p=flop(30, 31))
    counts = pack.pack_registers(design)
    assert (counts["input"], counts["output"]) == (0, 1)
    design = netlist(a=flop(10, 20), b=flop(11, 21, clk=3), m=product(20, 21, 30), p=flop(30, 31))
    assert pack.pack_registers(design)["input"] == 0
    lut = {"type": "LUT4", "parameters": {}, "port_directions": {"A": "input"}, "connections": {"A": [30]}}
    design = netlist(a=flop(10, 20), b=flop(11, 21), m=product(20, 21, 30), p=flop(30, 31), lut=lut)
    assert pack.pack_registers(design)["output"] == 0


def test_two_multipliers_in_a_row_share_no_register():
    """The register between them is packed into one of them only."""
    design = netlist(
        a=flop(10, 20), b=flop(11, 21), m=product(20, 21, 30), p=flop(30, 22), n=product(22, 22, 40), q=flop(40, 31)
    )
    pack.pack_registers(design)
    m, n = (design["cells"][k]["connections"] for k in "mn")
    between = ["p"] if "p" in design["cells"] else []
    registers = len(between)
    registers += "REG_OUTPUT_CLK" in design["cells"]["m"]["parameters"]
    registers += "REG_INPUTA_CLK" in design["cells"]["n"]["parameters"]
    assert registers == 1
    assert n["A0"] == (design["cells"]["p"]["connections"]["Q"] if between else m["P0"])


@pytest.mark.parametrize("module", ["ik_lean", "ik_paper", "ik_axis", "ik_mul3", *page.SECTIONS["lean"]])
def test_wrapper_connects_every_port(module):
    text = closure(module)[0].read_text()
    made = wrapper(text, {"W": 18})
    header = re.sub(r"//[^\n]*", "", HEADER.search(text)[3])
    for name in re.findall(r"(\w+)\s*(?:,|$)", header, re.M):
        assert f".{name}({name})" in made
    if re.search(r"integer W\b", made):
        assert "W = 18" in made
    assert made.count("input wire") == 3 and made.count("output wire") == 1


def test_page_is_made_from_the_figures():
    assert fpga.PAGE.read_text() == page.page(DATA), "run `python -m scripts.fpga --page`"


def test_page_says_which_sources_it_was_measured_at():
    text = fpga.PAGE.read_text()
    assert all(design["rtl"] in text and design["commit"] in text for design in DATA["designs"].values())


def test_a_missing_tool_is_one_line_and_status_2(monkeypatch, capsys):
    monkeypatch.setattr(runs.shutil, "which", lambda *_, **__: None)
    assert fpga.main([]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and "make fpga" in said


def test_tools_work_in_their_folder_by_relative_names_only():
    run = fpga.synthesis("lean", 18, "ecp5", "place")
    assert not re.search(r"(^|\s)/", run.script())
    assert "fpga_top.v" in run.extra()


def memory(do, **ports):
    ports = {"CLKA": [2], "CLKB": [2]} | {f"DO{k}": [net] for k, net in do.items()} | ports
    return {
        "type": "DP16KD",
        "parameters": {"REGMODE_A": "NOREG", "REGMODE_B": "NOREG"},
        "port_directions": {k: "output" if k[:2] == "DO" else "input" for k in ports},
        "connections": ports,
    }


def test_registers_behind_a_memory_go_into_it():
    """Packing is port by port: logic reads one output of port B directly, so port B keeps its registers outside."""
    lut = {"type": "LUT4", "parameters": {}, "port_directions": {"A": "input"}, "connections": {"A": [53]}}
    rom = memory({"A0": 50, "A1": 51, "B0": 52, "B1": 53})
    design = netlist(rom=rom, a0=flop(50, 40), a1=flop(51, 41), b0=flop(52, 42), b1=flop(53, 43), lut=lut)
    readers = ("a", 40), ("b", 41), ("c", 42), ("d", 43)
    logic = {k: {**lut, "connections": {"A": [net]}} for k, net in readers}
    design["cells"] |= logic
    assert pack.pack_registers(design) == {"multipliers": 0, "memory": 1, "flip_flops": 2}
    assert not {"a0", "a1"} & set(design["cells"]) and {"b0", "b1"} <= set(design["cells"])
    nets, parameters = (design["cells"]["rom"][k] for k in ("connections", "parameters"))
    assert (nets["DOA0"], nets["DOA1"], nets["DOB0"]) == ([40], [41], [52])
    assert (parameters["REGMODE_A"], parameters["REGMODE_B"]) == ("OUTREG", "NOREG")


def test_a_memory_keeps_a_register_of_another_clock_or_start_outside():
    lut = {"type": "LUT4", "parameters": {}, "port_directions": {"A": "input"}, "connections": {"A": [40]}}
    design = netlist(rom=memory({"A0": 50}, CLKA=[3]), a=flop(50, 40), lut=lut)
    assert pack.pack_registers(design)["flip_flops"] == 0
    design = netlist(rom=memory({"A0": 50}), a=flop(50, 40, REGSET="SET"), lut=lut)
    assert pack.pack_registers(design)["flip_flops"] == 0


@pytest.fixture(params=["here", "farm"])
def begun(request, monkeypatch, tmp_path):
    """Return a measurement, local or on a farm that leaves no local work."""
    monkeypatch.setattr(fpga, "version", lambda *_: "1")  # the tools are not needed
    if request.param == "here":
        return fpga.Measurement(fpga.Figures(tmp_path / "fpga.json"))
    attempts, sent = fpga.attempts, lambda thing: pickle.loads(pickle.dumps(thing))
    monkeypatch.setattr(runs, "BUILD", tmp_path / "build")
    monkeypatch.setattr(runs, "version", lambda *_: "1")
    monkeypatch.setattr(fpga, "attempts", lambda job: pytest.fail(f"{job[0].name} is done here"))
    return fpga.Measurement(
        fpga.Figures(tmp_path / "fpga.json"), lambda work, jobs: (sent(attempts(sent(job))) for job in jobs)
    )


def measured(monkeypatch, begun, clocks):
    """Return fpga.json after placing the lean datapath at 18 bits, with a clock or a time-out for each seed."""

    def done(run):
        if run.kind != "place":
            return {"cells": dict.fromkeys(report.KINDS, 1)}
        if clocks.get(run.seed) is None:
            raise runs.TimeOutError(f"{run.name}: not done after 20 min, left out")
        return {"mhz": clocks[run.seed]}

    monkeypatch.setattr(runs.Run, "done", done)
    monkeypatch.setattr(fpga, "describe", lambda *_: {})
    fpga.measure(begun, ["lean"], [18])
    return begun.figures.data, begun.left_out


def test_the_quickest_of_the_seeds_is_kept(monkeypatch, begun):
    data, left_out = measured(monkeypatch, begun, {1: 170.0, 2: None, 3: 175.0, 4: 171.0})
    run = data["runs"]["lean-W18-ecp5-place"]
    assert (run["mhz"], run["seed"], run["tried"]) == (175.0, 3, [170.0, 175.0, 171.0])
    assert data["designs"]["lean-18"]["placed"] == "whole" and not left_out


def test_no_seed_is_tried_after_the_aim_is_reached(monkeypatch, begun):
    data, _ = measured(monkeypatch, begun, {1: 190.0, 2: 201.0, 3: 210.0})
    assert data["runs"]["lean-W18-ecp5-place"]["tried"] == [190.0, 201.0]


def test_what_is_not_placed_in_time_is_placed_by_module_and_said(monkeypatch, begun):
    data, left_out = measured(monkeypatch, begun, {})
    assert data["designs"]["lean-18"]["placed"] == "by module"
    modules = [page.TOPS["lean"], *page.SECTIONS["lean"]]
    assert [line.split("-")[0] for line in left_out] == [name.removeprefix("ik_") for name in modules]


def test_memory_to_memory_is_measured_around_an_echo_and_whole(monkeypatch, begun, tmp_path):
    ran = []

    def done(run):
        ran.append((run.name, {path.parent.name for path in run.files() if path.name == "ik_lean.v"}))
        held = run.values["W"] == 18 or run.instead
        if run.kind == "place":
            return {"mhz": 170.0 + run.seed}
        return {"cells": dict.fromkeys(report.KINDS, 1 if held else 200)}

    monkeypatch.setattr(runs.Run, "done", done)
    fpga.measure_memory(begun)
    assert begun.left_out == []
    assert {name for name, lean in ran if lean == {"axi"}} == {name for name, _ in ran if "-echo-" in name}
    assert all(lean == {"lean"} for name, lean in ran if "-echo-" not in name)
    rows = page.memory(json.loads((tmp_path / "fpga.json").read_text())).splitlines()[2:]
    assert [row.split(" | ")[0] for row in rows] == [
        "| W = 32, an echo in the place of the datapath",
        "| W = 18, `lean`",
        "| W = 32, `lean`",
    ]
    assert [row.split(" | ")[9] for row in rows] == ["174", "174", "-"]
    assert rows[0].endswith("| 171, 172, 173, 174 |")


def test_a_run_goes_to_another_checkout(monkeypatch, tmp_path):
    """A pickled run uses the sources of the checkout in which it is loaded."""
    sent = pickle.dumps(runs.Run("synth", "ecp5", "ik_axi", {"W": 18}, instead=fpga.ECHO))
    monkeypatch.setattr(runs, "ROOT", tmp_path)
    run = pickle.loads(sent)
    assert run.root == tmp_path and run.instead == (tmp_path / "tb" / "axi" / "ik_lean.v",)
    assert (run.name, run.values) == ("axi-W18-echo-ecp5", {"W": 18})


def test_a_farm_is_not_asked_for_what_is_kept(begun, monkeypatch, tmp_path):
    ran = []
    monkeypatch.setattr(runs.Run, "done", lambda run: ran.append(run.name) or {"mhz": 99.0 + run.seed})
    first = runs.Run("place", "ecp5", "ik_lean", {"W": 18})
    for aim in (101.0, 101.0, 103.0, 103.0):
        begun.ahead([(first, aim)])
    assert [name[-1] for name in ran] == (["1", "2", "1", "2", "3", "4"] if begun.each else [])


def test_a_tool_that_takes_too_long_is_ended(tmp_path):
    with pytest.raises(runs.TimeOutError, match="^some: not done after 0 min, left out$"):
        runs.call(["sleep", "60"], tmp_path, "log", "some", 0.3)


def test_folded_machine_is_measured_on_every_chip(monkeypatch, begun, tmp_path):
    def done(run):
        if run.kind == "place":
            return {"mhz": page.FOLD_MHZ[run.family] - 1.0 + run.seed / 2, "path": {"from": "a", "to": "b"}}
        return {"cells": dict.fromkeys(report.KINDS, run.values["W"])}

    monkeypatch.setattr(runs.Run, "done", done)
    fpga.measure_fold(begun, [])
    assert begun.left_out == []
    rows = [row.split(" | ") for row in page.folded(json.loads((tmp_path / "fpga.json").read_text())).splitlines()[2:]]
    assert [row[0] for row in rows] == [f"| {page.CHIPS[chip][0]}, W = {width}" for chip, _, width in page.FOLD]
    assert [row[5].split()[0] for row in rows] == [str(width) for _, _, width in page.FOLD]
    assert [row[9] for row in rows] == ["33.0"] * 2 + ["100.0"] * 2 + ["-"] * 4  # clock of the second seed


def test_cells_of_small_chips_are_counted():
    stat = {"modules": {"\\t": {"num_cells_by_type": {"SB_LUT4": 5, "SB_CARRY": 2, "SB_DFFESR": 3, "SB_MAC16": 4}}}}
    assert report.counted(stat, "up5k") == {
        "LUT": 5,
        "shift": 0,
        "FF": 3,
        "carry": 2,
        "MUXF": 0,
        "multipliers": 4,
        "RAM": 0,
    }
    stat = {"modules": {"\\t": {"num_cells_by_type": {"LUT2": 5, "ALU": 2, "DFFE": 3, "SPX9": 1, "MUX2_LUT5": 6}}}}
    assert report.counted(stat, "gowin") == {
        "LUT": 7,
        "shift": 0,
        "FF": 3,
        "carry": 2,
        "MUXF": 6,
        "multipliers": 0,
        "RAM": 1,
    }
