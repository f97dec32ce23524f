# SPDX-License-Identifier: Apache-2.0
"""docs/generated/compare.md and its picture are up to date, and what they are made of is right."""

import re
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

from model.bounds import tolerances
from model.dataflow import fixed
from model.io.flags import AT_SHOULDER, UNREACHABLE, expected_flags
from model.io.stimuli import REGIONS, SINGULAR, at_distance, region
from model.io.words import result_values
from model.reference.kinematics import forward
from scripts import compare
from scripts.pages import comparison
from scripts.pages.tables import differing

pytestmark = pytest.mark.cost(60)


@pytest.fixture(scope="module")
def text():
    return comparison.PAGE.read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def measured(text):
    return comparison.Measured.now(*asked(text))


def asked(text):
    targets, seed = (int(v) for v in re.search(r"--targets (\d+) --seed (\d+)", text).groups())
    return targets, seed


@pytest.mark.slow
def test_the_page_is_up_to_date(text, measured):
    fresh = comparison.page(measured, *asked(text))
    assert differing(text, fresh) == [], "run `make compare`"
    (wrong,) = differing(text.replace("| divisions | 11 |", "| divisions | 12 |"), fresh)
    assert "divisions" in wrong


@pytest.mark.slow
def test_lean_is_below_its_tolerances(measured):
    for width, regions in measured.lean.items():
        for name, errors in regions.items():
            assert errors.hand.max() <= tolerances.lean(width), f"{name}, W = {width}"
    for errors in [*measured.lean[32].values(), *sum(measured.near["lean"].values(), [])]:
        assert max(errors.shoulder.max(), errors.elbow.max()) < comparison.ANGLE


@pytest.mark.slow
def test_both_have_the_same_targets_and_lean_is_better(measured):
    for name in REGIONS:
        paper, lean = (measured.same[path][name] for path in comparison.PATHS)
        assert len(paper.hand) == len(lean.hand)
        assert np.median(lean.hand) < np.median(paper.hand) and lean.hand.max() < paper.hand.max(), name


def test_errors_are_of_the_words():
    """The hand's error by its definition, for one target."""
    words = region("near the z axis", 5, 24, 3)
    errors = comparison.Errors.of(words, 24, "lean")
    value = result_values(fixed.run(words, 24, "lean").results, 24)
    for n, (x, y, z, _, d1, d2) in enumerate(words.tolist()):
        _, wrist = forward(value[n : n + 1, :4], value[n : n + 1, 4:], d1, d2)
        assert errors.hand[n] == pytest.approx(np.linalg.norm(wrist[0] - (x, y, z)) / (d1 + d2), rel=1e-9)


def test_operations_are_those_of_the_dataflow():
    """Table 4's kinds; the lean dataflow has no division and seven reciprocal roots."""
    paper, lean = (comparison.operations(path) for path in comparison.PATHS)
    assert (paper["divisions"], paper["square roots"], paper["reciprocal square roots"]) == (11, 8, 0)
    assert (lean["divisions"], lean["square roots"], lean["reciprocal square roots"]) == (0, 0, 7)
    assert lean["multiplications"] < paper["multiplications"] / 1.9
    assert lean["additions"] < paper["additions"]


def test_latency_is_that_of_the_schedule():
    assert comparison.batch_clocks("lean", 44) == 144 and comparison.batch_clocks("fold", 99) == 8812
    for path in comparison.PATHS:
        for width in (16, 32):
            bits = fixed.run(region("anywhere", 3, width, 1), width, path).bits
            last = max(bits.nodes[name].time for name in ("qs_w", "qs_i", "qs_j", "qs_k", "qe_w", "qe_i"))
            assert fixed.latency(path, width) == last + fixed.FIFO_CLOCKS


@pytest.mark.parametrize("width", (16, 32))
@pytest.mark.parametrize("name", REGIONS)
def test_regions_are_in_reach_and_where_they_say(name, width):
    words = region(name, 1000, width, 2)
    assert words.shape == (1000, 6)
    assert not (expected_flags(words, width) & UNREACHABLE).any()
    assert (words == region(name, 1000, width, 2)).all() and (words != region(name, 1000, width, 3)).any()
    x, y, z, _, d1, d2 = words.T.astype(float)
    distance, ratio = np.sqrt(x**2 + y**2 + z**2), np.maximum(d1, d2) / np.minimum(d1, d2)
    lsb = 3 / np.maximum(distance, 1)
    if "the z axis" in name and "elbow" not in name:
        assert (np.hypot(x, y) <= (0.11 + lsb) * np.maximum(np.abs(z), 1) + 1).all()
        assert (z > 0).any() and (z < 0).any()
    if "stretch" in name:
        # Short arms have no closer targets than an lsb.
        assert ((d1 + d2 - distance) / (d1 + d2) <= 0.12 + 3 / (d1 + d2)).all()
    if "fold" in name:
        assert (distance - np.abs(d1 - d2) <= 0.12 * distance + 2).all()
    if name == "unequal arms":
        big = np.minimum(d1, d2) > 20
        assert (ratio[big] > 4.7).all() and (ratio[big] < 21).all()
    if name == "most unequal arms":
        assert ratio.max() > 2.0 ** (width - 5) and np.median(ratio) > 20
    if name == "short arms":
        assert (d1 + d2 <= 185).all()


@pytest.mark.parametrize("kind", SINGULAR)
@pytest.mark.parametrize("distance", (1e-1, 1e-4, 1e-8))
def test_targets_at_a_distance_are_there(kind, distance):
    words = at_distance(kind, distance, 300, 32, 4)
    assert not (expected_flags(words, 32) & (UNREACHABLE | AT_SHOULDER)).all()
    x, y, z, _, d1, d2 = words.T.astype(np.longdouble)
    p, reach = np.sqrt(x**2 + y**2 + z**2), d1 + d2
    found = {
        "the z axis": np.hypot(x, y) / np.maximum(np.abs(z), 1), "full stretch": (reach - p) / reach,
        "full fold": (p - np.abs(d1 - d2)) / reach, "the shoulder": p / reach,
    }[kind]  # fmt: skip
    lsb = 3 / reach.min()
    assert (found <= 4.5 * distance + lsb).all() and np.median(found) >= distance / 4 - lsb


@pytest.mark.slow
def test_picture_is_the_same_every_time_and_well_formed(measured):
    first = comparison.plot(measured.near)
    assert first == comparison.plot(measured.near)
    assert b"<dc:date>" not in first
    ElementTree.fromstring(first)
    ElementTree.fromstring(comparison.PLOT.read_bytes())


@pytest.mark.slow
def test_command_writes_the_page(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(compare, "PAGE", tmp_path / "page.md")
    monkeypatch.setattr(compare, "PLOT", tmp_path / "plot.svg")
    monkeypatch.setattr(comparison, "WIDTHS", (16, 18, 24, 27, 32))
    monkeypatch.setattr(comparison, "AT_DISTANCE", 20)
    assert compare.main(["--targets", "50"]) == 0
    assert "seed 1, 50 targets" in capsys.readouterr().out
    assert differing((tmp_path / "page.md").read_text(), comparison.page(comparison.Measured.now(50, 1), 50, 1)) == []
