# SPDX-License-Identifier: Apache-2.0
"""Tests of reports, wrapper, figures and page. A small design, mapped to each family, is simulated beside its RTL."""

import pickle
import re
from pathlib import Path

import numpy as np
import pytest

from model.io.stimuli import arm_targets
from model.io.words import pack
from scripts.fpga import __main__ as fpga
from scripts.fpga import designs, netlist, runs, simulation
from tb.sim.sources import closure

DELAY = "$paramod\\ik_delay\\W=s32'00000000000000000000000000001000"
MUL3 = {"LUT4": 10, "MULT18X18": 3, "XORCY": 9, "MUXF5": 2, "$scopeinfo": 5, DELAY: 1}
TOP = {"LUT2": 3, "INV": 1, "MUXCY": 4, "FDRE": 2, DELAY: 2, "$paramod$0a1b\\ik_mul3": 1}


def stat(modules):
    """Imitate the output of Yosys' `stat -json`. ``modules``: module -> number of cells by type."""
    return {"modules": {name: {"num_cells_by_type": cells} for name, cells in modules.items()}}


def test_a_section_has_all_cells_inside():
    modules = {"\\ik_top": TOP, DELAY: {"SRL16E": 8, "FDRE": 1}, "$paramod$0a1b\\ik_mul3": MUL3}
    total = (3 + 1 + 10 + 3 * 8, 24, 2 + 3, 4, 2, 3, 0)
    assert netlist.counted(stat(modules), "xc2vp") == dict(zip(netlist.KINDS, total, strict=True))
    sections = netlist.by_section(stat(modules), "xc2vp")
    assert sections["ik_mul3"]["LUT"] == 18 and sections["ik_delay"]["LUT"] == 16 and sections["itself"]["LUT"] == 4


@pytest.mark.parametrize(
    ("family", "cells", "kinds"),
    [
        ("ecp5", {"CCU2C": 5, "LUT4": 7, "PFUMX": 2, "TRELLIS_FF": 3}, (17, 0, 3, 5, 2, 0, 0)),
        ("up5k", {"SB_LUT4": 5, "SB_CARRY": 2, "SB_DFFESR": 3, "SB_MAC16": 4}, (5, 0, 3, 2, 0, 4, 0)),
        ("gowin", {"LUT2": 5, "ALU": 2, "DFFE": 3, "SPX9": 1, "MUX2_LUT5": 6}, (7, 0, 3, 2, 6, 0, 1)),
    ],
)
def test_cells_are_counted_by_kind(family, cells, kinds):
    assert netlist.counted(stat({"\\t": cells}), family) == dict(zip(netlist.KINDS, kinds, strict=True))
    cells["SRLC32E_X"] = 1
    with pytest.raises(netlist.ToolError, match="SRLC32E_X"):
        netlist.counted(stat({"\\t": cells}), family)


def test_clock_and_critical_path_of_a_report():
    """Read a shortened nextpnr report of the lean datapath at W = 18."""
    rom, product = "dut.u_q.rom.0.0", "dut.u_q.bend_2_TRELLIS_FF_Q_DI_MULT18X18D_P19"
    flop = "dut.u_q.bend_2_TRELLIS_FF_Q_8"
    steps = [("clk-to-q", 4.263, rom, rom), ("routing", 1.948, rom, product), ("logic", 3.066, product, product)]
    steps += [("routing", 0.86, product, flop), ("setup", 0, flop, flop)]
    path = [{"type": kind, "delay": ns, "from": {"cell": a}, "to": {"cell": b}} for kind, ns, a, b in steps]
    report = {
        "fmax": {"clk": {"achieved": 98.64851379394531}},
        "utilization": {"MULT18X18D": {"used": 149}, "TRELLIS_FF": {"used": 15033}, "DCCA": {"used": 1}},
        "critical_paths": [
            {"from": "posedge clk", "to": "<async>", "path": []},
            {"from": "posedge clk", "to": "posedge clk", "path": path},
        ],
    }
    ends = {"from": "u_q.rom.0.0", "to": "u_q.bend_2", "through": ["DP16KD", "MULT18X18D"]}
    assert netlist.placed(report) == {
        "mhz": 98.6,
        "used": {"MULT18X18D": 149, "TRELLIS_FF": 15033},
        "path": {**ends, "ns": 10.14, "routing_ns": 2.81},
    }
    quick = {**report, "fmax": {"clk": {"achieved": 400.0}}}
    assert netlist.placed(quick)["mhz"] == round(1000 / netlist.MULTIPLIER_NS, 1), "the limit of a multiplier"


@pytest.mark.parametrize("module", dict.fromkeys(design.top for design in designs.DESIGNS))
def test_wrapper_connects_every_port(module):
    text = closure(module)[0].read_text()
    ports = simulation.Ports(text)
    made = ports.wrapper({"W": 18}, "fpga_top")
    names = re.findall(r"^ +(?:input|output) .*?(\w+)(?:,|$)", re.sub(r" *//[^\n]*", "", text), re.M)
    assert names and names == [name for *_, name in ports.all]
    for name in names:
        assert f".{name}({name})" in made
    assert "W = 18" in made or not re.search(r"integer W\b", made)


def test_a_hand_pose_is_shifted_in_and_held():
    """Check that, while ``hold`` is high, the shift register holds the pose above the 11 bits of branch and tag."""
    ports = simulation.Ports(closure("ik_arm")[0].read_text())
    assert "if (!in[4]) in_q" in ports.wrapper({"W": 18}, "fpga_top") and ports.single["input"][3] == "hold"
    pins = ports.stimuli(3000, 18)
    held, poses, shifted = pins >> np.uint64(4) & np.uint64(1), [], 0
    for hold, bit in zip(held.tolist(), (pins & np.uint64(1)).tolist(), strict=True):
        shifted = shifted if hold else shifted << 1 | bit
        if hold:
            poses.append(shifted >> 11 & (1 << 11 * 18) - 1)
    assert list(dict.fromkeys(poses)) == pack(arm_targets(4, 18, 1)[:, :11], 18)


def test_page_is_made_from_the_figures():
    assert designs.PAGE.read_text() == str(fpga.page(designs.load())), "run `python -m scripts.fpga --page`"


def on_farm(work, jobs):
    """Map `work` over `jobs` as a farm does: jobs and results are pickled."""
    return (pickle.loads(pickle.dumps(work(pickle.loads(pickle.dumps(job))))) for job in jobs)


def test_recorded_figures_give_the_same_runs_and_placements(monkeypatch, tmp_path):
    """Replace the tools with the figures in fpga.json; check that a command executes exactly the runs recorded there
    and a repeated command executes none. A run that times out has no figures and is reported."""
    late, ran, recorded = set(), [], designs.load()
    chosen = [design for design in designs.DESIGNS if design.name in recorded["designs"]]
    for name in ("FIGURES", "PAGE"):
        monkeypatch.setattr(designs, name, tmp_path / name)
    for module in (runs, fpga):
        monkeypatch.setattr(module, "version", lambda *_: "1")
    monkeypatch.setattr(fpga, "describe", lambda design: recorded["designs"][design.name])
    assert designs.find("echo", 32).run("xc7").key() != designs.find("memory", 32).run("xc7").key()
    monkeypatch.setattr(runs.Run, "key", lambda run: recorded["runs"][run.title]["key"])

    def done(run):
        ran.append(run.title)
        return None if run.title in late else recorded["runs"][run.title]

    monkeypatch.setattr(fpga, "done", done)
    data = recorded | {"designs": {}, "runs": {}}
    for _ in range(2):
        assert not fpga.measure(data, chosen, on_farm)
        assert data["designs"] == recorded["designs"] and data["runs"] == recorded["runs"]
        assert sorted(ran) == sorted(recorded["runs"])
        data = designs.load()
    late.add("axis-W18-ecp5-place")
    data["runs"]["axis-W18-ecp5-place"]["key"] = "stale"
    assert fpga.measure(data, designs.select(["lean"], [18])) == [*late]
    assert designs.clock(data, "lean", 18) is None


def test_seeds_are_tried_up_to_the_aim_and_the_fastest_counts(monkeypatch, tmp_path):
    run = designs.find("fold", 24).run("ecp5-12k", "place")
    clocks: list[float | None] = []

    def nextpnr(self, *_):
        if (mhz := clocks.pop(0)) is None:
            raise netlist.LeftOutError("stopped after 40 min, left out")
        return 1, mhz

    monkeypatch.setattr(runs.Run, "_nextpnr", nextpnr)
    monkeypatch.setattr(netlist, "placed", lambda mhz: {"mhz": mhz})
    for kinds, seed in (([95.0, None, 104.0], 3), ([95.0, 98.0, 97.0, 96.0], 2)):
        clocks[:] = kinds
        tried = [mhz for mhz in kinds if mhz]
        assert run.place(tmp_path, {}) == {"place_s": 1, "mhz": max(tried), "seed": seed, "tried": tried}
    clocks[:] = [None] * 4
    with pytest.raises(netlist.LeftOutError, match="no seed"):
        run.place(tmp_path, {})


def test_designs_are_selected_by_datapath_and_word_length():
    selections = (["lean"], [20]), (["fold"], [32]), (["memory"], [])
    names = [[one.name for one in designs.select(*selection)] for selection in selections]
    memory = ["echo-32", "memory-18", "memory-32", "fold_memory-24", "fold_arm_memory-24"]
    assert names == [["lean-20"], ["fold-32"], memory]
    (echo,) = (path for path in designs.find("echo", 32).run("xc7").files() if path.name == "ik_lean.v")
    assert echo.parent.name == "axi", "a stand-in for the datapath"


@pytest.fixture
def figures(monkeypatch, tmp_path):
    """Return a function that synthesizes the small design for a family, without placement, and returns its figures."""
    text = Path(__file__).with_name("ik_small.v").read_text()
    inner = [path for name in ("ik_exact", "ik_delay", "ik_ring", "ik_quadratic") for path in closure(name)]
    small = tmp_path / "ik_small.v"
    monkeypatch.setattr(runs, "BUILD", tmp_path)
    monkeypatch.setattr(runs.Run, "files", lambda _: list(dict.fromkeys([small, *inner])))
    monkeypatch.setattr(runs.Run, "place", lambda *_: {})

    def figures(family, factor="a", square=0):
        words = {"FACTOR": factor, "PRODUCT": str(square), "PART": str(int(family == "ecp5"))}
        small.write_text(re.sub("FACTOR|PRODUCT|PART", lambda name: words[name[0]], text))
        return runs.Run("place" if family == "ecp5" else "synth", family, "ik_small", {}).done()

    return figures


LATER = [pytest.param(family, marks=pytest.mark.release) for family in ("xcup", "xc2vp")]


@pytest.mark.needs("fpga", "verilator")
@pytest.mark.parametrize("family", ["xc7", "ecp5", "up5k", "gowin", *LATER])
def test_a_netlist_equals_the_rtl(figures, family):
    made = figures(family, square=int(family == "up5k"))
    assert made["simulated"]["results"] >= 8000
    if family == "ecp5":
        assert made["packed"].pop("flip_flops") > 200
        assert made["packed"] == {"multipliers": 14, "memory": 2, "input": 11, "output": 11}


@pytest.mark.needs("fpga", "verilator")
@pytest.mark.parametrize(
    ("family", "factor"), [("xc7", "{a[17], a[17:0]}"), pytest.param("up5k", "a", marks=pytest.mark.release)]
)
def test_a_wrong_netlist_is_refused(figures, family, factor):
    """Use two bugs of Yosys 0.70 (docs/integration.md): products are wrong on xc7 if an operand is sign-extended,
    and on iCE40 if a product is followed by two registers."""
    with pytest.raises(netlist.LeftOutError, match="clocks differ from the RTL"):
        figures(family, factor)
