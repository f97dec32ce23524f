# SPDX-License-Identifier: Apache-2.0
"""Tests that table 6's software agrees with the model, and its page with the figures. No test asserts a time."""

import json

import numpy as np
import pytest

from model.io.scoring import hand_errors
from model.io.stimuli import random_reachable
from model.io.trajectories import make
from model.io.words import RESULT_FIELDS, from_words
from model.reference import equations
from model.reference.lean_equations import solve_lean
from scripts.fpga.designs import load
from scripts.paper.table6 import REALS, WAYS, Solver, columns
from scripts.paper.table6 import __main__ as table6

REACH, RANDOM = make("reach"), from_words(random_reachable(3000, 32, 7), 0, 32, "random")


def by_model(targets, solve=solve_lean):
    nodes = solve(*columns(targets))
    return np.stack([nodes[name] for name in RESULT_FIELDS], axis=1)


def difference(answers, expected):
    """Return the largest difference between answers and expected answers, (N, 6). Either sign of Qs is accepted:
    rounding decides the sign where k is nearly 0."""
    answers = np.asarray(answers, dtype=float)
    sign = np.sign((answers[:, :4] * expected[:, :4]).sum(axis=1))[:, None]
    return max(np.abs(sign * answers[:, :4] - expected[:, :4]).max(), np.abs(answers[:, 4:] - expected[:, 4:]).max())


@pytest.mark.needs("cc")
@pytest.mark.parametrize("real", REALS)
@pytest.mark.parametrize("way", WAYS)
def test_c_gives_the_models_answers(way, real):
    """Compare the paper's equations away from singular poses only: the model computes three sums in another form."""
    cases = ("lean", solve_lean, REACH), ("paper", equations.solve, REACH), ("lean", solve_lean, RANDOM)
    for name, solve, targets in cases:
        answers = Solver(columns(targets), name, real, way)(2)
        if real == "double" or targets is REACH:
            assert difference(answers, by_model(targets, solve)) < (1e-12 if real == "double" else 2e-5)
        assert hand_errors(answers, targets).max() < 1e-5


def figures():
    return json.loads(table6.FIGURES.read_text())


def test_the_page_shows_its_figures():
    assert table6.PAGE.read_text() == table6.page(figures(), load()), "run: python -m scripts.paper.table6 --page"


@pytest.mark.sim
@pytest.mark.slow
@pytest.mark.cost(20)
@pytest.mark.parametrize("path", table6.PATHS)
def test_the_rtl_takes_the_clocks_on_the_page(path):
    kept = next(row for row in figures()["hardware"] if (row["datapath"], row["path"]) == ("lean", path))
    counted = table6.PATHS[path]()
    stale = "the RTL has changed: run `python -m scripts.paper.table6 --hardware`"
    assert counted == {name: kept[name] for name in counted}, stale
    assert 0 < table6.random_error(random_reachable(500, 32, 3)) <= kept["random_error"]


def test_the_command_measures_c_and_keeps_the_dated_rows(command, monkeypatch, tmp_path):
    """The software is a stand-in; targets without an answer are counted and give no error."""
    before = figures()
    for name in ("FIGURES", "PAGE"):
        monkeypatch.setattr(table6, name, tmp_path / name)
    table6.FIGURES.write_text(json.dumps(before))
    monkeypatch.setattr(table6, "TARGETS", 3)
    monkeypatch.setattr(table6, "core", lambda words: before["hardware"])
    monkeypatch.setattr(table6, "nanoseconds", lambda solve, targets: 1.0)
    monkeypatch.setattr(table6, "Solver", lambda columns, *names: lambda: columns)
    monkeypatch.setattr(table6, "hand_errors", lambda columns, targets: np.array([1e-13, np.nan, 1e-15]))
    assert command(table6.main)[0] == 0
    new, old = figures()["software"], before["software"]
    assert [row["key"] for row in new] == [row["key"] for row in old]
    assert {row["random"]["error"] for row in new if "date" not in row} == {1e-13}
    assert {row["random"]["unanswered"] for row in new if "date" not in row} == {1}
    dated = [row for row in new if "date" in row]
    assert dated == [row for row in old if "date" in row] and len(dated) == 7
    assert "| numpy | lean, float, 2026-11-23 |" in table6.PAGE.read_text()
