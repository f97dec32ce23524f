# SPDX-License-Identifier: Apache-2.0
"""What the C in long double says, and what becomes of a core that says something else."""

import ctypes
import shutil

import numpy as np
import pytest

from model.bounds import tolerances
from model.dataflow import fixed
from model.dataflow.nodes import WIDTHS
from model.io.flags import expected_flags
from scripts import second
from tb.core.random_targets import chunk, judge
from tb.sim.simulate import Run

pytestmark = pytest.mark.skipif(not shutil.which("cc"), reason="no C compiler")


class Model:
    """Answers as the model does, but for what is laid over it."""

    datapath = "lean"

    def __init__(self, width, over=0):
        self.width, self.over = width, over

    def run(self, words):
        answer = fixed.run(words, self.width, self.datapath)
        results = answer.results + self.over
        return Run(results, answer.flags, 0, 0, 0, None), results, answer.flags


@pytest.mark.parametrize("width", WIDTHS)
def test_the_model_agrees(width):
    """To little more than the half ulp of rounding, which is far from its tolerance for long words."""
    words = chunk(0, width, 3)[:4000]
    found, failures, _ = judge(Model(width), words, range(len(words)), second.opinions)
    assert not failures
    (lean_n, lean), (paper_n, paper) = found.apart.values()
    assert (expected_flags(words, width) == 0).sum() == lean_n > 2000 and 500 < paper_n < lean_n
    assert 0.45 * 2.0 ** (2 - width) < paper <= lean < min(tolerances.lean(width) / 3, 3 * 2.0 ** (2 - width))


def test_sets_of_targets_add_up():
    words = chunk(0, 24, 3)[:2000]
    parts = [judge(Model(24), part, range(1000), second.opinions)[0] for part in np.split(words, 2)]
    whole = judge(Model(24), words, range(2000), second.opinions)[0]
    assert (parts[0] + parts[1]).apart == whole.apart


@pytest.mark.parametrize("field", range(6))
def test_a_wrong_result_is_found(field):
    """Of one field, in all targets alike, by both sets of equations."""
    words = chunk(0, 24, 3)[:500]
    over = np.where(np.arange(6) == field, 6, 0)
    failures = judge(Model(24, over), words, range(500), second.opinions)[1]
    said = [line for failure in failures for line in failure.lines]
    for equations in second.EQUATIONS:
        assert any(f"C, long double, {equations} equations: a result differs by" in line for line in said), said


def test_no_answer_is_a_failure():
    words = chunk(0, 24, 3)[:500]

    def silent(words, width):
        return [second.Opinion("nobody", np.full(words.shape, np.nan), np.ones(len(words), bool))]

    failures = judge(Model(24), words, range(500), silent)[1]
    assert any("nobody: a result differs by inf" in line for failure in failures for line in failure.lines)


def test_the_papers_equations_are_not_asked_of_arms_too_unequal():
    """Found by a soak: with a forearm of 1 lsb they say something else, far from every singular pose."""
    unequal = 1209551299, 91371512, 458362240, -1772665960, 1296710854, 1
    words = np.array([unequal, (5 << 24, 0, 0, 0, 1 << 26, 1 << 25)])
    lean, paper = second.opinions(words, 32)
    assert list(lean.asked) == [True, True] and list(paper.asked) == [False, True]


def test_it_is_long_double():
    """Where that is longer than double: a target of which the difference of squares needs 64 bits."""
    if np.finfo(np.longdouble).nmant < 63:
        pytest.skip("long double is double here")
    assert ctypes.sizeof(ctypes.c_longdouble) == np.dtype(np.longdouble).itemsize
    words = np.array([[(1 << 30) - 1, 1, 1, 0, 1 << 29, 1 << 29]])
    (lean, _) = second.opinions(words, 32)
    x, y, z, _, d1, d2 = map(int, words[0])
    exact = np.sqrt((d1 + d2) ** 2 - (x * x + y * y + z * z)) / 2**30
    assert lean.answers[0, 4] == pytest.approx(exact, rel=1e-15)
