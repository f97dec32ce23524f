# SPDX-License-Identifier: Apache-2.0
"""Word lengths: the page's proofs are current, regular poses are regular."""

import re

import pytest

from model.bounds import ranges
from model.bounds.tolerances import REGULAR_DISTANCE
from model.dataflow.nodes import Domain, Format
from model.io.scoring import singular_distance
from model.io.words import to_words
from scripts.generate.render import read_table
from scripts.paper import __main__ as paper
from scripts.paper import wordlengths


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
    monkeypatch.setattr(Domain, "word", lambda self, i: Format(self.width, self.width + 9, "W + 9"))
    monkeypatch.setattr(ranges, "analyse", ranges.analyse.__wrapped__)  # without its cache
    status, _, (error,) = command(paper.main, "--only", part)
    assert status == 1 and re.match(r"\w+: \d+ fraction bits, .* only \d+$", error), error
