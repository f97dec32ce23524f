# SPDX-License-Identifier: Apache-2.0
"""Test that derivations hold, that all pages of `make paper` except table 6 are up to date, and that errors in the
paper, the algebra or the dataflow are found."""

import re
from copy import copy

import pytest

from model.dataflow import fixed
from model.dataflow.formats import Format
from model.dataflow.nodes import Dataflow
from model.io.words import RESULT_FIELDS
from model.reference import cga
from scripts.generate import flow
from scripts.paper import __main__ as main
from scripts.paper.derivation import lean, paper, proofs
from scripts.paper.derivation.proofs import PRINTED, Step, derive, failures


@pytest.mark.slow
@pytest.mark.cost(60)
@pytest.mark.parametrize("name", main.STEPS)
def test_all_statements_hold_and_the_page_is_up_to_date(name):
    steps = derive(main.STEPS[name])
    assert failures(steps) == []
    assert all(step.statements for step in steps.values())
    if name == "derivation":
        every_row = {proofs.name_tex(row) for rows in PRINTED.values() for row in rows}
        assert {row for step in steps.values() for row in step.printed} == every_row
    text = (main.GENERATED / f"{name}.md").read_text(encoding="utf-8")
    assert text == main.derivation_page(name, steps), "run `make paper ONLY=derivation`"


ROWS = [("pp_i", paper.point_pair), ("tmp1", paper.elbow_point), ("c4", lean.elbow_quaternion), ("qs_j", paper.product)]


@pytest.mark.slow
@pytest.mark.parametrize("name, step", ROWS)
def test_a_wrong_factor_in_print_is_found(monkeypatch, name, step):
    rows = next(rows for rows in PRINTED.values() if name in rows)
    monkeypatch.setitem(rows, name, f"3*({rows[name]})/2")
    assert failures(derive([step]))


def doubled(op):
    """Return a copy of an operation with its value doubled."""
    twice = copy(op)
    twice.words = lambda values: 2 * op.words(values)
    return twice


EVALUATED = [node.name for node in lean.NODES.values() if node.frac and node.operands and lean.symbolic(node)]


@pytest.mark.release
@pytest.mark.parametrize("name", EVALUATED)
def test_a_doubled_node_is_found(monkeypatch, name):
    steps = [lean.product, lean.length, lean.directions, lean.elbow_quaternion]
    monkeypatch.setattr(lean.NODES[name], "op", doubled(lean.NODES[name].op))
    assert any(failures(derive([step])) for step in steps)


TURN, HALF_ANGLE, ROTATE = lean.turn, cga.half_angle, cga.rotate
ERRORS = [
    (proofs, "MISPRINTS", {}, [paper.swivel_plane, lean.swivel]),
    *((lean, "HALF", lean.HALF | {branch: lean.HALF[branch][::-1]}, [lean.half, lean.product]) for branch in lean.HALF),
    (lean, "turn", lambda axis, c, s: TURN(axis, c, -s), [lean.factors, lean.product]),
    (cga, "half_angle", lambda cosine: HALF_ANGLE(cosine)[::-1], [paper.elbow_quaternion]),
    (cga, "rotate", lambda q, v: ROTATE(q.reverse(), v), [lean.shoulder, lean.product]),
]


@pytest.mark.slow
@pytest.mark.parametrize(("module", "name", "wrong", "steps"), ERRORS)
def test_an_error_in_the_algebra_is_found(monkeypatch, module, name, wrong, steps):
    monkeypatch.setattr(module, name, wrong)
    for step in steps:
        assert failures(derive([step])), step.__name__


def test_relations_and_roots_count_only_where_they_are_given():
    step = Step()
    c = proofs.symbol("c")
    step.prove("c**2 + s**2 = 1", "sqrt(c**2) = c")
    assert len(step.wrong) == 2
    step.suppose("s**2 = 1 - c**2")
    step.roots = {c: c**2}
    step.prove("c**2 + s**2 = 1", "sqrt(1 - s**2) = c")
    step.refute("c = s", {"c": "3/5"})
    assert len(step.wrong) == 2
    step.prove("vec(c, s) = vec(c, c)")
    step.refute("c**2 + s**2 = 1", {"c": "3/5"})
    assert len(step.wrong) == 4
    with pytest.raises(AssertionError, match="not on a relation"):
        step.refute("c = s", {"c": "3/5", "s": "3/5"})


def test_a_false_statement_fails_the_command_and_leaves_the_pages(monkeypatch, command):
    monkeypatch.setattr(main, "STEPS", {"lean": [lean.product]})
    monkeypatch.setattr(lean.NODES["k_1"], "op", doubled(lean.NODES["k_1"].op))
    monkeypatch.setattr(main, "update", lambda texts: pytest.fail("writes pages"))
    status, _, errors = command(main.main, "--only", "derivation")
    assert status == 1 and "step product: lean = algebra: does not hold" in errors[0]


def test_page_of_operations_is_up_to_date():
    ((path, text),) = main.operations().items()
    assert path.read_text() == text, "run `make paper ONLY=operations`"


def test_an_operand_with_too_few_fraction_bits_is_named(monkeypatch, command):
    monkeypatch.setattr(fixed, "dataflow", fixed.dataflow.__wrapped__)  # without its cache
    monkeypatch.setattr(Dataflow, "word", lambda self, i: Format(self.width, self.width + 9, "W + 9"))
    status, _, (error,) = command(main.main, "--only", "operations")
    assert status == 1 and re.match(r"\w+: \d+ fraction bits, .* only \d+$", error), error


def test_figures_and_page_are_up_to_date():
    """Compare texts; for a picture that graphviz draws, compare the digest of the graph."""
    drawn = main.pictures()
    for name, text in drawn.items():
        shown, digest = (main.SHOWN / name).read_text("utf-8"), f"<!-- of the graph {main.digest_of(text)} -->\n"
        assert shown == text or shown.startswith(digest), "run `make paper ONLY=figures`"
    page = (main.GENERATED / "figures.md").read_text("utf-8")
    assert page == main.render("figures"), "run `make paper ONLY=figures`"
    assert sorted(path.name for path in main.SHOWN.iterdir()) == sorted(drawn)


@pytest.mark.parametrize(("datapath", "width"), [("lean", 32), ("lean", 18), ("paper", 32)])
def test_longest_path_takes_the_whole_latency(datapath, width):
    nodes = fixed.nodes(datapath, width)
    path = flow.longest_path(nodes)
    assert path[0].kind == "input" and path[0].time == 0 and path[-1].name in RESULT_FIELDS
    assert path[-1].time == max(n.time for n in nodes.values())
    for before, after in zip(path, path[1:], strict=False):
        assert before.time == flow.start(after, width), after.name
