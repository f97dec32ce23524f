# SPDX-License-Identifier: Apache-2.0
"""Table 4, word lengths, figures 6 and 7: counting rules; pages and pictures are current and match the design."""

import re
from xml.etree import ElementTree

import pytest
import sympy

from model.bounds.tolerances import REGULAR_DISTANCE
from model.dataflow import fixed
from model.dataflow.formats import Format
from model.dataflow.nodes import Dataflow
from model.io.scoring import singular_distance
from model.io.words import RESULT_FIELDS, to_words
from model.reference.cga import symbol
from scripts.console import InputError
from scripts.generate import flow
from scripts.generate.flow import WIDTH
from scripts.generate.render import read_table
from scripts.paper import __main__ as paper
from scripts.paper import figures, wordlengths
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


def proofs(page):
    """Return the proved columns of the page by node."""
    return {row[0]: row[1:4] for row in read_table(page, "node name")}


def test_proofs_of_the_page_are_up_to_date():
    assert proofs(wordlengths.PAGE) == wordlengths.proved_cells(), "run `make paper ONLY=wordlengths`"


def test_regular_poses_are_regular_and_fit():
    poses = wordlengths.regular_poses(500, 2)
    assert singular_distance(poses).min() >= REGULAR_DISTANCE
    for width in (16, 32):
        words, _ = to_words(poses, width, 0)
        assert abs(words).max() <= 1 << (width - 1)
        assert wordlengths.errors_of(width, poses).max() < 2.0 ** (9 - width)


@pytest.mark.slow
def test_command_writes_the_page(tmp_path, monkeypatch):
    """Every observed range of a reduced run lies within the proved range."""
    reduced = {"PAGE": tmp_path / "page.md", "TARGETS": 20000, "REGULAR_POSES": 200, "WIDTHS": range(31, 33)}
    for name, value in reduced.items():
        monkeypatch.setattr(wordlengths, name, value)
    assert wordlengths.write() == 0
    assert proofs(tmp_path / "page.md") == wordlengths.proved_cells()


@pytest.mark.parametrize("part", ["wordlengths", "operations"])
def test_an_operand_with_too_few_fraction_bits_is_named(part, monkeypatch, command):
    monkeypatch.setattr(Dataflow, "word", lambda self, i: Format(self.width, self.width + 9, "W + 9"))
    monkeypatch.setattr(fixed, "dataflow", fixed.dataflow.__wrapped__)  # without its cache
    status, _, (error,) = command(paper.main, "--only", part)
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
    shown = flow.cone(fixed.nodes("paper", WIDTH), "p_e_x")
    arrows = {(o, node.name) for node in shown.values() for o in flow.operands(node)}
    assert set(re.findall(r'^  "(\w+)" -> "(\w+)"', graph, re.M)) == arrows
    assert re.findall(r'^  "(\w+)" \[label=.*', graph, re.M) == list(shown)
    assert len(list(ElementTree.fromstring(drawn["schedule_p_e_x.svg"]).iter(f"{SVG}g"))) == len(shown)


@pytest.mark.parametrize(("datapath", "width"), [("lean", 32), ("lean", 18), ("paper", 32)])
def test_longest_path_takes_the_whole_latency(datapath, width):
    nodes = fixed.nodes(datapath, width)
    path = flow.longest_path(nodes)
    assert path[0].kind == "input" and path[0].time == 0 and path[-1].name in RESULT_FIELDS
    assert path[-1].time == max(n.time for n in nodes.values())
    for before, after in zip(path, path[1:], strict=False):
        assert before.time == flow.start(after, width), after.name


def test_without_graphviz_one_line(monkeypatch):
    monkeypatch.setattr(figures.shutil, "which", lambda name: None)
    with pytest.raises(InputError, match="dot is missing"):
        figures.svg("digraph {}")
