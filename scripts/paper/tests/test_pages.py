# SPDX-License-Identifier: Apache-2.0
"""Tests that the pages of table 4 and of figures 6 and 7 are up to date and match the dataflow."""

import re

import pytest

from model.dataflow import fixed
from model.dataflow.formats import Format
from model.dataflow.nodes import Dataflow
from model.io.words import RESULT_FIELDS
from scripts.generate import flow
from scripts.paper import __main__ as paper


def test_page_is_up_to_date():
    ((path, text),) = paper.operations().items()
    assert path.read_text() == text, "run `make paper ONLY=operations`"


def test_an_operand_with_too_few_fraction_bits_is_named(monkeypatch, command):
    monkeypatch.setattr(fixed, "dataflow", fixed.dataflow.__wrapped__)  # without its cache
    monkeypatch.setattr(Dataflow, "word", lambda self, i: Format(self.width, self.width + 9, "W + 9"))
    status, _, (error,) = command(paper.main, "--only", "operations")
    assert status == 1 and re.match(r"\w+: \d+ fraction bits, .* only \d+$", error), error


def test_figures_and_page_are_up_to_date():
    """Compare texts; of a picture that graphviz draws, compare the digest of its graph."""
    drawn = paper.pictures()
    for name, text in drawn.items():
        shown, digest = (paper.SHOWN / name).read_text("utf-8"), f"<!-- of the graph {paper.digest(text)} -->\n"
        assert shown == text or shown.startswith(digest), "run `make paper ONLY=figures`"
    page = (paper.GENERATED / "figures.md").read_text("utf-8")
    assert page == paper.render("figures"), "run `make paper ONLY=figures`"
    assert sorted(path.name for path in paper.SHOWN.iterdir()) == sorted(drawn)


@pytest.mark.parametrize(("datapath", "width"), [("lean", 32), ("lean", 18), ("paper", 32)])
def test_longest_path_takes_the_whole_latency(datapath, width):
    nodes = fixed.nodes(datapath, width)
    path = flow.longest_path(nodes)
    assert path[0].kind == "input" and path[0].time == 0 and path[-1].name in RESULT_FIELDS
    assert path[-1].time == max(n.time for n in nodes.values())
    for before, after in zip(path, path[1:], strict=False):
        assert before.time == flow.start(after, width), after.name
