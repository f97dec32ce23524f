# SPDX-License-Identifier: Apache-2.0
"""Every argument of dividers, roots and reciprocal roots of short words, natively; a bug for one argument is found."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

from model.dataflow.cores import rsqrt
from scripts import exhaustive
from tb.sim.env import ROOT, simulator
from tb.sim.seeded_bugs import Bug, copy_rtl

pytestmark = [pytest.mark.sim, pytest.mark.slow]

SMALL = {case.name: case for case in exhaustive.SMALL}

BUGS = {
    # case: file, what is there, what it becomes, how many arguments show it, and words of the first one's message
    "div_8_0": ("ik_div.v", ".n  (n),", ".n  (n ^ (n == 91 && d == 7)),", 1, "n=91 d=7: q=13 ovf=0 expected, q=12"),
    "div_8_6": ("ik_div.v", ".d  (d_in[DW-1:CUT_D]),", ".d  (d_in | (d_in == 0)),", 4, "d=0: "),
    "root_17": ("ik_root.v", ".n  (n),", ".n  (n ^ (n == 900)),", 1, "n=900: q=2715 neg=0 expected, q=2716 neg=0 seen"),
    "root_17_overflow": ("ik_root.v", ".n  (n),", ".n  (n ^ (n == -5) << 16),", 1, "n=-5: q=0 neg=1 expected, q="),
    "rsqrt_19": (
        "ik_rsqrt.v", "m_0   <= m_next;", "m_0 <= m_next ^ (m_next == 3000000) << 9;", 1,
        "m=3000000: y=309962 or y=309963 expected, y=",
    ),
}  # fmt: skip


EVERY_ANSWER = {
    # every answer is off by a place: case: file, what is there, what it becomes
    "root_17_behavioural": ("ik_root.v", "({negative, floor & ", "({negative, (floor - 1) & "),
    "rsqrt_19": (
        "ik_quadratic.v", ": sum[SUM_FRAC:SUM_FRAC-F];", ": sum[SUM_FRAC:SUM_FRAC-F] ^ 1;",
    ),
}


@pytest.fixture
def pool():
    with ThreadPoolExecutor(2) as made:
        yield made


def test_bugs_change_one_place():
    for file, right, *_ in (*BUGS.values(), *EVERY_ANSWER.values()):
        assert (ROOT / "rtl" / "cores" / file).read_text().count(right) == 1, file
    assert {SMALL[name].module for name in BUGS} == {case.module for case in exhaustive.FULL}


def seeded(name, file, right, wrong, folder):
    """The program of a case in which one text of the RTL is another one."""
    return exhaustive.program(SMALL[name], copy_rtl(folder, Bug("", f"rtl/cores/{file}", right, wrong)), "wrong")


def mantissas(frac):
    """Every argument as a mantissa: below 1/4 its second bit counts as if it were set."""
    m = np.arange(1 << (frac + 3))
    return np.where(m < 1 << frac + 1, m | 1 << frac + 1, m)


def not_faithful(frac, y):
    """How many words y (2^(frac + 3),) are a place or more from 2^frac/(2 sqrt V) for a V that cut off is their m."""
    m = mantissas(frac)
    square = 1 << (3 * frac + 1)
    return int((((y - 1) ** 2 * (m + 1) > square) | ((y + 1) ** 2 * m <= square)).sum())


def not_nearest(frac):
    """Mantissas whose word of the bit-true model is not the one nearest to 2^frac/(2 sqrt m)."""
    m = mantissas(frac)
    y = rsqrt(m, frac)
    four = 1 << (3 * frac + 3)
    return int((((2 * y - 1) ** 2 * m > four) | ((2 * y + 1) ** 2 * m < four)).sum())


if simulator() == "verilator":

    def test_small_cases(pool):
        for case in exhaustive.SMALL:
            result = exhaustive.check(case, exhaustive.program(case), pool)
            assert (result.vectors, result.failures, result.first) == (case.vectors, 0, ""), case.name
            if case.harness == "Rsqrt":
                assert result.not_nearest == not_nearest(case.parameters["F"])
            else:
                assert result.not_nearest == 0

    @pytest.mark.parametrize("clocks", [-1, 1])
    @pytest.mark.parametrize("name", ["div_8_0", "root_17", "rsqrt_19"])
    def test_answers_a_clock_early_or_late_are_wrong(name, clocks):
        case = SMALL[name]
        path = exhaustive.program(case)
        result = exhaustive.piece(replace(case, clocks=case.clocks + clocks), path, 0, 10000)
        assert result.vectors == 10000 and result.failures > 1000

    @pytest.mark.parametrize("name", BUGS)
    def test_bug_is_found(name, pool, tmp_path):
        *bug, failures, message = BUGS[name]
        case = SMALL[name]
        result = exhaustive.check(case, seeded(name, *bug, tmp_path), pool)
        assert (result.vectors, result.failures) == (case.vectors, failures)
        assert message in result.first

    @pytest.mark.parametrize("name", EVERY_ANSWER)
    def test_as_many_failures_as_answers_are_wrong(name, pool, tmp_path):
        """Every root, and those of the reciprocal roots that leave the two words beside the exact value."""
        case = SMALL[name]
        result = exhaustive.check(case, seeded(name, *EVERY_ANSWER[name], tmp_path), pool)
        failures = case.vectors
        if case.harness == "Rsqrt":
            frac = case.parameters["F"]
            failures = not_faithful(frac, rsqrt(np.arange(case.vectors), frac) ^ 1)
            assert case.vectors // 4 < failures < case.vectors
        assert result.failures == failures

    def test_pieces_are_the_whole(pool, monkeypatch):
        """Cut anywhere, each argument comes once: what is counted stays the same."""
        case = SMALL["rsqrt_19"]
        path = exhaustive.program(case)
        whole = exhaustive.check(case, path, pool)
        monkeypatch.setattr(exhaustive, "PIECE", 999_999)
        cut = exhaustive.check(case, path, pool)
        assert (cut.vectors, cut.failures, cut.not_nearest) == (whole.vectors, 0, whole.not_nearest)

    def test_program_refuses_what_makes_no_sense():
        case = SMALL["rsqrt_19"]
        path = exhaustive.program(case)
        for wrong in (replace(case, parameters={}), replace(case, clocks=0), replace(case, bits=63)):
            with pytest.raises(exhaustive.SimulationError, match="rsqrt_19: vectors 0 to 9 broke off \\(2\\)"):
                exhaustive.piece(wrong, path, 0, 10)
