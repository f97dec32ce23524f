# SPDX-License-Identifier: Apache-2.0
"""What is called equivalent is: changes that make no difference are proved, and those that make one never are."""

import pytest

from tb.formal.tools import missing
from tb.mutation import equivalence
from tb.mutation.equivalence import copied, equivalent
from tb.sim.env import ROOT
from tb.sim.mutants import Bug

pytestmark = pytest.mark.skipif(bool(missing()), reason="no tools of requirements-fpga.lock: `make mutants`")

SAME = [
    Bug("a wider port, cut outside", "rtl/axi/ik_axi_result.v", "[      31:0] index", "[      32:0] index"),
    Bug("a sign of no use", "rtl/fold/ik_fold_count.v", "wire [5:0] term", "wire signed [5:0] term"),
    Bug("a wire with a bit more", "rtl/fold/ik_fold_mul.v", "reg [2*LOW+1:0] ll_2;", "reg [2*LOW+2:0] ll_2;"),
    Bug("a register with a bit more", "rtl/axi/ik_axi_regs.v", "reg [9:0] waddr;", "reg [10:0] waddr;"),
    Bug("an order of no matter", "rtl/fold/ik_fold_word.v", "{t[XW-1], t[XW-1-:2]}", "{t[XW-1-:2], t[XW-1]}"),
    Bug("another formula", "rtl/fold/ik_fold_count.v", "{e[4:0], 1'b0}", "({e[4:0], 1'b0} | 6'd0)"),
]
OTHER = [
    Bug("a bit", "rtl/fold/ik_fold_count.v", "{e[4:0], 1'b0}", "{e[4:0], 1'b1}"),
    Bug("a wire with a bit less", "rtl/fold/ik_fold_count.v", "wire [5:0] term", "wire [4:0] term"),
    Bug("a falling edge", "rtl/fold/ik_fold_flags.v", "always @(posedge clk)", "always @(negedge clk)"),
    Bug("a beginning", "rtl/axi/ik_axi_read.v", "initial m_axi_arvalid = 1'b0", "initial m_axi_arvalid = 1'b1"),
    Bug("no Verilog", "rtl/fold/ik_fold_count.v", "{e[4:0], 1'b0}", "{e[4:0], }"),
]  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("bug", [*SAME, *OTHER], ids=lambda bug: bug.what)
def test_equivalence(bug):
    place = ROOT / "build" / "mutants" / "copies" / bug.what.replace(" ", "_").replace(",", "")
    copied(place)
    file = place / bug.file
    file.write_text(bug.seeded(file.read_text()))
    around = bug.file.startswith("rtl/axi")  # small enough to climb
    assert bool(equivalent(bug.file, place, {}, around)) == (bug in SAME)


@pytest.mark.slow
def test_what_is_around_a_change_is_compared_with_all_in_it(monkeypatch):
    """Of the module itself the modules in it are as they were; of those around it one is not."""
    asked = []
    monkeypatch.setattr(equivalence, "same", lambda module, place, deep: asked.append((module.name, deep)))
    place = ROOT / "build" / "mutants" / "copies" / "around"
    copied(place)
    assert not equivalent("rtl/axi/ik_axi_result.v", place, {})
    assert set(asked) == {("ik_axi_result", False), ("ik_axi_result", True), ("ik_axi", True)}
