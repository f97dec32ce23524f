# SPDX-License-Identifier: Apache-2.0
"""docs/wordlengths.md and its picture are up to date, and the command says what is not."""

import re
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

from model import predict, ranges
from model.scoring import REGULAR_DISTANCE, singular_distance
from scripts import wordlengths


@pytest.fixture(scope="module")
def text():
    return wordlengths.PAGE.read_text(encoding="utf-8")


def test_proofs_of_the_page_are_up_to_date(text):
    assert wordlengths.stale(text) == [], "run `make wordlengths`"


def test_first_targets_lie_inside_what_the_page_says(text):
    seed = int(re.search(r"--seed (\d+)", text)[1])
    assert int(re.search(r"--targets (\d+)", text)[1]) >= 1_000_000
    observed = wordlengths.monte_carlo(wordlengths.CHUNK, wordlengths.WIDTH, seed)
    assert wordlengths.disagreeing(text, observed) == []


def test_a_changed_proof_and_a_changed_range_are_named(text):
    assert any(line.startswith("k_e:") for line in wordlengths.stale(text.replace("| triangle |", "| guess |")))
    row = next(line for line in text.splitlines() if line.startswith("| s_j |"))
    cells = row.split(" | ")
    cells[7] = "0 .. 0.001"
    observed = wordlengths.monte_carlo(1000, wordlengths.WIDTH, 1)
    assert [w[:4] for w in wordlengths.disagreeing(text.replace(row, " | ".join(cells)), observed)] == ["s_j:"]


def test_curve_of_the_page_is_up_to_date(text):
    seed = int(re.search(r"--seed (\d+)", text)[1])
    poses = wordlengths.regular_poses(wordlengths.REGULAR_POSES, seed)
    for width in (16, 32):
        error = wordlengths.hand_errors(width, poses)
        figures = (np.median(error), np.quantile(error, 0.99), error.max())
        shown = [float(v) for v in re.search(rf"^\| {width} \| (.*) \|$", text, re.M)[1].split(" | ")]
        assert shown == pytest.approx(figures, rel=0.06)


def test_regular_poses_are_regular_and_fit():
    poses = wordlengths.regular_poses(500, 2)
    assert singular_distance(poses).min() >= REGULAR_DISTANCE
    for width in (16, 32):
        words = wordlengths.words_of(poses, width)
        assert abs(words).max() <= 1 << (width - 1)
        assert wordlengths.hand_errors(width, poses).max() < 2.0 ** (9 - width)


def test_shares_add_up_and_name_rounded_nodes():
    moved = wordlengths.sensitivities(24, 1, 50)
    nodes = {name: proof.node for name, proof in ranges.proved(24).items()}
    parts = wordlengths.shares(moved, nodes)
    assert sum(parts.values()) == pytest.approx(1)
    assert list(parts.values()) == sorted(parts.values(), reverse=True)
    assert all(nodes[n].error != (0.0, 0.0) for n in parts) and set(parts) == set(moved)
    assert all(median >= worst for median, worst in wordlengths.spare_bits(moved, nodes).values())


def test_predicted_share_explains_the_measured_error():
    """The rms of the hand's error at regular poses is what the sensitivities add up to, within a factor of 2."""
    width = 24
    moved = wordlengths.sensitivities(width, 1, 300)
    nodes = {name: proof.node for name, proof in ranges.proved(width).items()}
    variance = sum((e * (nodes[n].error[1] - nodes[n].error[0])) ** 2 / 12 for n, e in moved.items())
    error = wordlengths.hand_errors(width, wordlengths.regular_poses(300, 1))
    ratio = np.median(error) / np.median(np.sqrt(variance))
    assert 0.4 < ratio < 2.5, ratio
    assert set(moved) == {n.name for n in predict.rounded_nodes(wordlengths.fixed.run(np.ones((1, 6), int), 24).bits)}


def test_picture_is_the_same_every_time_and_well_formed():
    errors = {w: (2.0**-w, 2.0 ** (1 - w), 2.0 ** (3 - w)) for w in range(16, 33)}
    parts = {f"node_{k}": 1 / (k + 2) for k in range(15)}
    first = wordlengths.plot(errors, parts)
    assert first == wordlengths.plot(errors, parts)
    assert b"<dc:date>" not in first
    ElementTree.fromstring(first)
    ElementTree.fromstring(wordlengths.PLOT.read_bytes())


@pytest.mark.parametrize("argument", [["--targets", "0"], ["--seed", "-1"], ["--targets", "many"]])
def test_bad_arguments_are_refused(argument, capsys):
    with pytest.raises(SystemExit) as stop:
        wordlengths.main(argument)
    assert stop.value.code == 2
    assert argument[0] in capsys.readouterr().err


def test_command_writes_the_page_and_check_finds_it_stale(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(wordlengths, "ROOT", tmp_path)
    monkeypatch.setattr(wordlengths, "PAGE", tmp_path / "page.md")
    monkeypatch.setattr(wordlengths, "PLOT", tmp_path / "plot.svg")
    monkeypatch.setattr(wordlengths, "REGULAR_POSES", 200)
    monkeypatch.setattr(wordlengths, "SENSITIVITY_POSES", 20)
    monkeypatch.setattr(wordlengths, "WIDTHS", range(31, 33))
    assert wordlengths.main(["--targets", "20000"]) == 0
    assert "seed 1, 20000 targets" in capsys.readouterr().out
    assert wordlengths.main(["--check"]) == 0
    page = tmp_path / "page.md"
    page.write_text(page.read_text().replace("| triangle |", "| guess |"))
    assert wordlengths.main(["--check"]) == 1
    assert "k_e" in capsys.readouterr().err
