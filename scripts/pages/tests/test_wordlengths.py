# SPDX-License-Identifier: Apache-2.0
"""docs/generated/wordlengths.md and its picture are up to date, and the command says what is not."""

import re
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

from model.bounds import predict, ranges
from model.bounds.tolerances import REGULAR_DISTANCE
from model.dataflow.nodes import Domain, Format
from model.io import monte_carlo
from model.io.scoring import singular_distance
from scripts.pages import opcounts, wordlengths
from scripts.pages.tables import differing


@pytest.fixture(scope="module")
def text():
    return wordlengths.PAGE.read_text(encoding="utf-8")


def test_proofs_of_the_page_are_up_to_date(text):
    assert wordlengths.stale(text) == [], "run `make wordlengths`"


@pytest.mark.slow
@pytest.mark.cost(110)
def test_the_page_made_anew_is_the_same(text):
    targets, seed = (int(v) for v in re.search(r"--targets (\d+) --seed (\d+)", text).groups())
    assert targets >= 1_000_000
    assert differing(text, wordlengths.page(wordlengths.Measured.now(targets, seed), targets, seed)) == []


def test_a_changed_proof_and_a_changed_figure_are_named(text):
    assert any(line.startswith("k_e:") for line in wordlengths.stale(text.replace("| triangle |", "| guess |")))
    assert wordlengths.stale(text.replace("p_w| = d2 <= 1", "p_w| = d2 <= 2"))
    row = next(line for line in text.splitlines() if line.startswith("| s_j |"))
    for k in range(1, 12):
        cells = row.split(" | ")
        cells[k] = re.sub(r"[1-9]", lambda m: str(10 - int(m[0])), cells[k]).replace("5", "8")
        changed = text.replace(row, " | ".join(cells))
        assert changed == text or len(differing(text, changed)) == 1, cells[k]
    assert differing(text, text + "more\n") == [
        f"the page has {len(text.splitlines())} lines, just made {len(text.splitlines()) + 1}"
    ]
    assert differing(text, text.replace("| inf_pp | (13) | 2", "| inf_pp | (13) | 3"))
    assert differing(text, text) == []


def test_regular_poses_are_regular_and_fit():
    poses = monte_carlo.regular_poses(500, 2)
    assert singular_distance(poses).min() >= REGULAR_DISTANCE
    for width in (16, 32):
        words = monte_carlo.words_of(poses, width)
        assert abs(words).max() <= 1 << (width - 1)
        assert monte_carlo.hand_errors(width, poses).max() < 2.0 ** (9 - width)


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
    error = monte_carlo.hand_errors(width, monte_carlo.regular_poses(300, 1))
    ratio = np.median(error) / np.median(np.sqrt(variance))
    assert 0.4 < ratio < 2.5, ratio
    assert set(moved) == {n.name for n in predict.rounded_nodes(wordlengths.fixed.run(np.ones((1, 6), int), 24).bits)}


def test_picture_is_the_same_every_time_and_well_formed():
    errors = {w: tuple(2.0 ** (k - w) for k in (0, 1, 3, 2, np.inf if w == 16 else 5)) for w in range(16, 33)}
    parts = {f"node_{k}": 1 / (k + 2) for k in range(15)}
    first = wordlengths.plot(errors, parts)
    assert first == wordlengths.plot(errors, parts)
    assert b"<dc:date>" not in first
    ElementTree.fromstring(first)
    ElementTree.fromstring(wordlengths.PLOT.read_bytes())


@pytest.mark.slow
def test_command_writes_the_page(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(wordlengths, "PAGE", tmp_path / "page.md")
    monkeypatch.setattr(wordlengths, "PLOT", tmp_path / "plot.svg")
    monkeypatch.setattr(wordlengths, "REGULAR_POSES", 200)
    monkeypatch.setattr(wordlengths, "SENSITIVITY_POSES", 20)
    monkeypatch.setattr(wordlengths, "WIDTHS", range(31, 33))
    assert wordlengths.main(["--targets", "20000"]) == 0
    assert "seed 1, 20000 targets" in capsys.readouterr().out
    text = (tmp_path / "page.md").read_text()
    assert wordlengths.stale(text) == []
    assert differing(text, wordlengths.page(wordlengths.Measured.now(20000, 1), 20000, 1)) == []


@pytest.mark.parametrize("script", [wordlengths, opcounts])
def test_a_format_without_digits_for_it_is_named(script, monkeypatch, capsys):
    """A node finer than its operands stops everything, with one line."""
    finer = lambda self, i: Format(self.width, self.width + 9, "W + 9")  # noqa: E731
    monkeypatch.setattr(Domain, "word", finer)
    monkeypatch.setattr(script, "analytic_cells" if script is wordlengths else "rtl_counts", dict)
    monkeypatch.setattr("sys.argv", ["command"])
    assert script.main() == 1
    error = capsys.readouterr().err
    assert re.match(r"\w+: \d+ fraction bits, .* only \d+\n$", error), error
