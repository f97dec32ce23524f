# SPDX-License-Identifier: Apache-2.0
"""Test that table 6's software agrees with the model, that equations.c in long double agrees with the bit-true model,
and that the page has the recorded figures. No test asserts a time."""

import json

import numpy as np
import pytest

from model.bounds import tolerances
from model.dataflow import fixed
from model.io.flags import expected_flags
from model.io.scoring import hand_errors, singular_distance
from model.io.stimuli import random_reachable
from model.io.trajectories import make
from model.io.words import RESULT_FIELDS, from_words, result_values
from model.reference import equations
from model.reference.lean_equations import solve_lean
from scripts.fpga.designs import load
from scripts.paper.table6 import __main__ as table6
from scripts.paper.table6.contenders import REALS, WAYS, Contender, columns, contenders, lean, solver
from tb.core.worst_targets import chunk

needs_cc = pytest.mark.needs("cc")
REACH, RANDOM = make("reach"), from_words(random_reachable(3000, 32, 7), 0, 32, "random")
FEW = from_words(random_reachable(5, 32, 7), 0, 32, "few")
STALE = "the RTL has changed: run `python -m scripts.paper.table6 --hardware`"


def by_model(targets, solve=solve_lean):
    nodes = solve(*columns(targets))
    return np.stack([nodes[name] for name in RESULT_FIELDS], axis=1)


def difference(answers, expected):
    """Return the largest difference between answers and expected answers, (N, 6). Either sign of Qs is accepted:
    rounding decides the sign where k is nearly 0."""
    answers = np.asarray(answers, dtype=float)
    sign = np.sign((answers[:, :4] * expected[:, :4]).sum(axis=1))[:, None]
    return max(np.abs(sign * answers[:, :4] - expected[:, :4]).max(), np.abs(answers[:, 4:] - expected[:, 4:]).max())


@needs_cc
@pytest.mark.parametrize("real", REALS)
@pytest.mark.parametrize("way", WAYS)
def test_c_gives_the_models_answers(way, real):
    """Compare the paper's equations only for regular poses, because the model computes three sums in another form."""
    cases = ("lean", solve_lean, REACH), ("paper", equations.solve, REACH), ("lean", solve_lean, RANDOM)
    for name, solve, targets in cases:
        answers = solver(columns(targets), name, real, way)(2)
        if real == "double" or targets is REACH:
            assert difference(answers, by_model(targets, solve)) < (1e-12 if real == "double" else 2e-5)
        assert hand_errors(answers, targets).max() < 1e-5


def test_single_precision_arrays_stay_single():
    single = lean(np, *(c.astype(np.float32) for c in columns(RANDOM)))
    assert {c.dtype for c in single} == {np.dtype(np.float32)}


INSTALLED = [pytest.mark.release, pytest.mark.needs("table6")]
KEYS = {"numpy": [], "c-arm": [needs_cc], "jax": INSTALLED, "eaik": INSTALLED}


@pytest.mark.parametrize("key", [pytest.param(key, marks=marks) for key, marks in KEYS.items()])
def test_software_reaches_the_hand(key):
    named = [one for one in contenders() if one.key.startswith(key)]
    runnable = [one for one in named if not one.lacks]
    assert runnable and all(one.lacks != "not installed" for one in named)
    for contender in runnable:
        targets = FEW if contender.most else RANDOM
        exact = contender.most is None and "float" not in contender.key
        assert contender.bind(targets)[1]().max() < (1e-12 if exact else 1e-5)


def figures():
    return json.loads(table6.FIGURES.read_text())


def test_the_page_shows_its_figures():
    assert table6.PAGE.read_text() == table6.page(figures(), load()), "run: python -m scripts.paper.table6 --page"


def test_clocks_on_the_page_are_those_of_the_present_core():
    """Check for each path that it adds the same clocks to the datapath's latency in all rows, and none for streams."""
    around = {}
    for row in figures()["hardware"]:
        around.setdefault(row["path"], set()).add(row["first"] - fixed.latency(row["datapath"], row["width"]))
    assert around[table6.STREAMS] == {0} and {len(clocks) for clocks in around.values()} == {1}, STALE


@pytest.mark.sim
@pytest.mark.slow
@pytest.mark.cost(20)
@pytest.mark.parametrize("path", table6.PATHS)
def test_the_rtl_takes_the_clocks_on_the_page(path):
    kept = next(row for row in figures()["hardware"] if (row["datapath"], row["path"]) == ("lean", path))
    counted = table6.PATHS[path]()
    assert counted == {name: kept[name] for name in counted}, STALE
    assert 0 < table6.random_error(random_reachable(500, 32, 3)) <= kept["random_error"]


def test_missing_software_has_a_row_and_a_target_without_an_answer_no_error(monkeypatch):
    monkeypatch.setattr(table6, "seconds", lambda again: 1e-6)
    row = table6.row(Contender("x", "X", "some solver", lambda targets: None, "not installed"), REACH, RANDOM)
    assert row == {"key": "x", "group": "X", "name": "some solver", "lacks": "not installed"}
    kept = figures()
    kept["software"].append(row)
    assert "| X | some solver | not installed | - | - | - | - | - |" in table6.page(kept, load())
    errors = np.array([1e-13, np.nan, 1e-15])
    row = table6.row(Contender("y", "Y", "another", lambda targets: (None, lambda: errors)), REACH, FEW)
    assert (row["random"]["error"], row["random"]["unanswered"]) == (1e-13, 1)


def test_the_named_rows_are_dated_and_kept_without_their_software(command, monkeypatch, tmp_path):
    before = figures()
    for name in ("FIGURES", "PAGE"):
        monkeypatch.setattr(table6, name, tmp_path / name)
    monkeypatch.setattr(table6, "TARGETS", 50)
    monkeypatch.setattr(table6, "core", lambda words: before["hardware"])
    table6.FIGURES.write_text(json.dumps(before))
    assert command(table6.main, "--only", "numpy-float")[0] == 0
    (new,) = (new for new, old in zip(figures()["software"], before["software"], strict=True) if new != old)
    assert new["key"] == "numpy-float" and new["random"]["targets"] == 50
    assert figures() | {"software": before["software"]} == before
    assert f"| numpy | lean, float, {new['date']} |" in table6.PAGE.read_text()
    missing = [Contender(name, "X", name, lambda targets: None, "not here") for name in ("numpy-float", "numpy-double")]
    monkeypatch.setattr(table6, "contenders", lambda: missing)
    assert command(table6.main)[0] == 0
    kept, lacks = figures()["software"]
    assert kept == new and "lacks" in lacks


UNEQUAL = 2.0**-24
"""Ratio of lengths below which the paper's equations lose too many of 64 bits, because they add squared lengths."""


def in_long_double(words: np.ndarray, width: int, equations: str) -> np.ndarray:
    """Solve input words (N, 6) in C in long double; return the results (N, 6)."""
    unit = np.longdouble(2) ** (1 - width)
    scale = np.array([2, 2, 2, 4 * np.arctan(np.longdouble(1)), 2, 2]) * unit
    return solver(list((words * scale).T), equations, "long double")().astype(float)


@needs_cc
@pytest.mark.parametrize("width", [16, 32])
@pytest.mark.parametrize("equations", ["lean", "paper"])
def test_the_model_agrees_with_c(width, equations):
    """Bound the largest difference between the bit-true model and C in long double."""
    words = chunk(0, width, 3)
    words = words[expected_flags(words, width) == 0]
    if equations == "paper":
        shorter, longer = np.sort(words[:, 4:].astype(float)).T
        regular = singular_distance(from_words(words, 0, width, "words")) >= tolerances.REGULAR_DISTANCE
        words = words[regular & (shorter >= UNEQUAL * longer)]
    assert len(words) > 3000
    values, ulp = result_values(fixed.run(words, width, "lean").results, width), 2.0 ** (2 - width)
    off = difference(in_long_double(words, width, equations), values)
    assert 0.45 * ulp < off < min(tolerances.LEAN[width] / 3, 4 * ulp)


@needs_cc
@pytest.mark.skipif(np.finfo(np.longdouble).nmant < 63, reason="long double is double here")
def test_a_difference_of_squares_that_needs_64_bits():
    words = np.array([[(1 << 30) - 1, 1, 1, 0, 1 << 29, 1 << 29]])
    x, y, z, _, d1, d2 = map(int, words[0])
    exact = np.sqrt((d1 + d2) ** 2 - (x * x + y * y + z * z)) / 2**30
    assert in_long_double(words, 32, "lean")[0, 4] == pytest.approx(exact, rel=1e-15)
