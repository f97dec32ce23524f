# SPDX-License-Identifier: Apache-2.0
"""Table 4: counting rules, elaborated RTL against the dataflow, and the page."""

import shutil

import pytest
import sympy

from model.dataflow.paper import paper
from model.reference.printed import PRINTED, symbol
from scripts.fpga.designs import load
from scripts.generate.flow import operations
from scripts.paper import operations as table4
from scripts.paper.operations import Ops, count
from tb.sim.env import ROOT
from tb.sim.sources import LIST

a, b, c = sympy.symbols("a b c", real=True)


@pytest.fixture(scope="module")
def rtl():
    return table4.rtl_counts()


def altered_rtl(folder, *edits):
    """Return a copy of the RTL's root with edits (path, old, new)."""
    shutil.copytree(ROOT / "rtl", folder / "rtl")
    for path, old, new in edits:
        text = (folder / path).read_text()
        assert text.count(old) == 1
        (folder / path).write_text(text.replace(old, new))
    return folder


WITHOUT_A_SUM = ("rtl/paper/ik_to_elbow.v", "{1'b0, d_e_q} + {1'b0, abs_z}", "{1'b0, d_e_q} ^ {1'b0, abs_z}")


@pytest.mark.parametrize(
    ("expression", "ops"),
    [
        (a + b - c, Ops(add=2)),
        (-a, Ops()),
        (-2 * a * b, Ops(mul=1, scale=1)),
        (a**2, Ops(mul=1)),
        (a**3, Ops(mul=2)),
        (a**4, Ops(mul=2)),
        (a / b, Ops(div=1)),
        (a / (b * c), Ops(mul=1, div=1)),
        (1 / b, Ops(div=1)),
        (b**-2, Ops(mul=1, div=1)),
        (a / sympy.sqrt(b), Ops(root=1, div=1)),
        (1 / sympy.sqrt(b), Ops(root=1, div=1)),
        (a / 2, Ops(scale=1)),
        (sympy.cos(a / 2) * b, Ops(mul=1, trig=1)),
        (sympy.Mul(a, 1 / sympy.Abs(a), evaluate=False), Ops(div=1)),
    ],
)
def test_rules(expression, ops):
    assert count(expression) == ops


def test_an_operation_without_a_rule_is_refused():
    with pytest.raises(ValueError, match="exp"):
        count(sympy.exp(a))
    with pytest.raises(ValueError, match="1/3"):
        count(a ** sympy.Rational(1, 3))


def test_printed_lines_by_hand():
    """(10) and (18) match counts by hand; roots match table 4."""
    assert table4.total(PRINTED["(10)"].values()) == Ops(add=2, mul=3, root=1)
    assert table4.total(PRINTED["(18)"].values()) == Ops(add=2, mul=6)
    assert table4.total(table4.printed_lines().values()).root == table4.UNOPTIMIZED.root


def test_substituting_19_changes_no_value():
    """(13) with (19) substituted equals (13); PP_m^+ and PP_m^- are the printed lines without their factor 2."""
    plain, with_19 = table4.printed_lines(), table4.lines_with_19()
    # The factor 2 printed in (19) belongs to a PP scaled by 2.
    halves = {symbol(n): e.doit() / 2 for n, e in PRINTED["(19)"].items()}
    pair = {symbol(n): e.doit() for n, e in PRINTED["(12)"].items()}
    for name in ("inf_pp", "tmp1", "p_e_x", "p_e_y", "p_e_z"):
        new, old = with_19[name].subs(halves | pair), plain[name].doit().subs(pair)
        names = sorted(old.free_symbols | new.free_symbols, key=str)
        for seed in (3, 5):
            point = {s: sympy.Rational(k * k + seed, 7) for k, s in enumerate(names)}
            assert new.subs(point) == old.subs(point), name


def test_rtl_has_the_operations_of_the_dataflow(rtl):
    assert table4.differences(rtl, operations(paper)) == []


def test_a_changed_dataflow_is_found(rtl):
    def more(d, target):
        paper(d, target)
        d.at("elbow_q")
        d.mul("extra", d.nodes["c4"], d.nodes["c4"], d.word(1))
        d.op("extra_sum", ("extra", "c4"), d.word(1), "mux", lambda p, q: (p + q) >> 1)

    found = table4.differences(rtl, operations(more))
    assert found == [
        "section elbow_q: 4 ik_mul in the RTL, 5 in model/dataflow/paper.py",
        "section elbow_q: 7 additions in the RTL, 8 in model/dataflow/paper.py",
    ]


def test_a_changed_rtl_is_found(tmp_path):
    root, digit = altered_rtl(tmp_path, WITHOUT_A_SUM), {"top": "ik_paper", "DIGIT": 1}
    found = table4.differences(table4.rtl_counts(root), operations(paper))
    assert found == ["section to_elbow: 3 additions in the RTL, 4 in model/dataflow/paper.py"]
    before = table4.operators(table4.elaborate(**digit))
    assert before["mul"] == load()["runs"]["paper-W32-DIGIT1-xc2vp"]["cells"]["multipliers"]
    assert before - table4.operators(table4.elaborate(root, **digit)) == {"add": 1}


def test_a_module_without_a_rule_is_named(tmp_path):
    instance = ("rtl/paper/ik_elbow_q.v", "endmodule", "ik_new u_new (.clk(clk));\nendmodule")
    root = altered_rtl(tmp_path, (LIST, "lib/ik_norm.v", "lib/ik_norm.v\nlib/ik_new.v"), instance)
    (root / "rtl/lib/ik_new.v").write_text("module ik_new(input wire clk);\nendmodule\n")
    with pytest.raises(RuntimeError, match="no rule for the module ik_new of instance u_new"):
        table4.rtl_counts(root)


@pytest.mark.parametrize(
    ("top", "expected"), [("ik_div_row", {"add": 1}), ("ik_lzc", {"add": 3}), ("ik_exact", {"add": 2, "mul": 4})]
)
def test_operators_at_once(top, expected):
    """An operator assigned to several words counts once; tables and indices count none; every row counts."""
    assert table4.operators(table4.elaborate(top=top)) == expected


def test_page_is_up_to_date(rtl):
    assert table4.PAGE.read_text() == table4.page(rtl), "run `make paper ONLY=operations`"
