# SPDX-License-Identifier: Apache-2.0
"""Tests of the comparison with the C in long double, for the bit-true model and for wrong results."""

import shutil

import numpy as np
import pytest

from model.bounds import tolerances
from model.dataflow import fixed
from model.io.flags import expected_flags
from scripts import soak
from tb.core.random_targets import chunk, judge
from tb.sim.simulate import Run

pytestmark = pytest.mark.skipif(not shutil.which("cc"), reason="no C compiler")


class Model:
    """The bit-true model as core, plus `over`."""

    datapath = "lean"

    def __init__(self, width, over=0):
        self.width, self.over = width, over

    def run(self, words):
        answer = fixed.run(words, self.width, self.datapath)
        results = answer.results + self.over
        return Run(results, answer.flags, 0, 0, 0, None), results, answer.flags


@pytest.mark.parametrize("width", [16, 18, 24, 32])
def test_the_model_agrees(width):
    """The difference is little more than half an LSB; counts of parts of a set of targets add up."""
    words = chunk(0, width, 3)[:4000]
    parts = [judge(Model(width), part, range(2000), soak.opinions) for part in np.split(words, 2)]
    found = parts[0][0] + parts[1][0]
    assert not parts[0][1] and not parts[1][1]
    (lean_n, lean), (paper_n, paper) = found.apart.values()
    assert (expected_flags(words, width) == 0).sum() == lean_n > 2000 and 500 < paper_n < lean_n
    assert 0.45 * 2.0 ** (2 - width) < paper <= lean < min(tolerances.lean(width) / 3, 3 * 2.0 ** (2 - width))


@pytest.mark.parametrize("field", range(6))
def test_a_wrong_field_is_found_by_both_sets_of_equations(field):
    words = chunk(0, 24, 3)[:500]
    failures = judge(Model(24, np.where(np.arange(6) == field, 6, 0)), words, range(500), soak.opinions)[1]
    lines = [line for failure in failures for line in failure.lines]
    assert all(any(f"{name} equations: a result differs" in line for line in lines) for name in soak.EQUATIONS)


def test_a_missing_answer_is_a_failure():
    words = chunk(0, 24, 3)[:500]

    def silent(words, width):
        return [soak.Opinion("silent", np.full(words.shape, np.nan), np.ones(len(words), bool))]

    failures = judge(Model(24), words, range(500), silent)[1]
    assert any("silent: a result differs by inf" in line for failure in failures for line in failure.lines)


def test_unequal_arms_are_not_compared_with_the_papers_equations():
    """Regression: a soak found a difference at a forearm of 1 LSB, far from every singular pose."""
    unequal = 1209551299, 91371512, 458362240, -1772665960, 1296710854, 1
    words = np.array([unequal, (5 << 24, 0, 0, 0, 1 << 26, 1 << 25)])
    lean, paper = soak.opinions(words, 32)
    assert list(lean.asked) == [True, True] and list(paper.asked) == [False, True]


@pytest.mark.skipif(np.finfo(np.longdouble).nmant < 63, reason="long double is double here")
def test_a_difference_of_squares_that_needs_64_bits():
    words = np.array([[(1 << 30) - 1, 1, 1, 0, 1 << 29, 1 << 29]])
    (lean, _) = soak.opinions(words, 32)
    x, y, z, _, d1, d2 = map(int, words[0])
    exact = np.sqrt((d1 + d2) ** 2 - (x * x + y * y + z * z)) / 2**30
    assert lean.answers[0, 4] == pytest.approx(exact, rel=1e-15)
