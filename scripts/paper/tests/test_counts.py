# SPDX-License-Identifier: Apache-2.0
"""Table 4, figures 6 and 7: counting rules; pages and pictures are current and match the design."""

import re
from xml.etree import ElementTree

import pytest
import sympy

from model.dataflow.nodes import Domain, Format
from model.io.words import RESULT_FIELDS
from model.reference.cga import symbol
from scripts.console import InputError
from scripts.generate import flow
from scripts.generate.flow import design
from scripts.paper import __main__ as paper
from scripts.paper import figures
from scripts.paper import operations as table4
from scripts.paper.operations import PRINTED, Ops, count

a, b, c = sympy.symbols("a b c", real=True)


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


def test_substituting_19_changes_no_value():
    plain, with_19 = table4.printed_lines(), table4.lines_with_19()
    sums = {}
    for m in "123":
        minus, plus = symbol(f"pp_{m}4"), symbol(f"pp_{m}5")
        sums |= {symbol(f"pp_{m}_plus"): plus + minus, symbol(f"pp_{m}_minus"): plus - minus}
    for name in PRINTED["(13)"]:
        assert sympy.simplify(with_19[name].doit().subs(sums) - plain[name].doit()) == 0, name


def test_page_is_up_to_date():
    assert table4.PAGE.read_text() == table4.page(), "run `make paper ONLY=operations`"


def test_an_operand_with_too_few_fraction_bits_is_named(monkeypatch, command):
    monkeypatch.setattr(Domain, "word", lambda self, i: Format(self.width, self.width + 9, "W + 9"))
    status, _, (error,) = command(paper.main, "--only", "operations")
    assert status == 1 and re.match(r"\w+: \d+ fraction bits, .* only \d+$", error), error


SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def drawn():
    return figures.figures()


def test_figures_and_page_are_up_to_date(drawn):
    """A picture of a graph has the graph's digest."""
    for name, text in drawn.items():
        shown, digest = (figures.SHOWN / name).read_text("utf-8"), f"<!-- of the graph {figures.digest(text)} -->\n"
        assert shown == text or shown.startswith(digest), "run `make paper ONLY=figures`"
    assert figures.PAGE.read_text("utf-8") == figures.render("figures"), "run `make paper ONLY=figures`"
    assert sorted(path.name for path in figures.SHOWN.iterdir()) == sorted(drawn)


def test_every_node_and_operand_is_drawn(drawn):
    graph = drawn["graph_p_e_x.svg"]
    shown = flow.cone(design("paper"), "p_e_x")
    arrows = {(o, node.name) for node in shown.values() for o in flow.operands(node)}
    assert set(re.findall(r'^  "(\w+)" -> "(\w+)"', graph, re.M)) == arrows
    assert re.findall(r'^  "(\w+)" \[label=.*', graph, re.M) == list(shown)
    assert len(list(ElementTree.fromstring(drawn["schedule_p_e_x.svg"]).iter(f"{SVG}g"))) == len(shown)


@pytest.mark.parametrize(("datapath", "width"), [("lean", 32), ("lean", 18), ("paper", 32)])
def test_longest_path_takes_the_whole_latency(datapath, width):
    nodes = design(datapath, width)
    path = flow.longest_path(nodes)
    assert path[0].op == "input" and path[0].time == 0 and path[-1].name in RESULT_FIELDS
    assert path[-1].time == max(n.time for n in nodes.values())
    for before, after in zip(path, path[1:], strict=False):
        assert before.time == flow.start(after, width), after.name


def test_without_graphviz_one_line(monkeypatch):
    monkeypatch.setattr(figures.shutil, "which", lambda name: None)
    with pytest.raises(InputError, match="dot is missing"):
        figures.svg("digraph {}")
