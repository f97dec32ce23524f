# SPDX-License-Identifier: Apache-2.0
"""Tests that the program on file computes the dataflow, and that the checker detects wrong programs."""

from dataclasses import replace

import pytest

from model.dataflow import fixed
from model.dataflow.datapaths import CONFIGURATIONS
from model.dataflow.fold import timing
from model.dataflow.fold.check import WrongProgramError, check
from model.dataflow.fold.layout import Layout
from model.dataflow.fold.program import FIELDS, ConflictError, encode, program, schedule
from model.dataflow.fold.shown import shown
from model.dataflow.fold.steps import lower

WIDTHS = CONFIGURATIONS["fold"].widths
GROUPS = lower(Layout(24))[1]


def words(made) -> list[int]:
    return [made.word(clock) for clock in range(made.period)]


@pytest.mark.parametrize("width", WIDTHS)
def test_the_program_computes_the_dataflow(width):
    """The program is the same at every word length."""
    _, made = program(width)
    check(words(made), lower(Layout(width))[1])
    assert words(made) == words(program(24)[1])


@pytest.mark.slow
@pytest.mark.cost(26)
def test_every_field_matters():
    """Change each nonzero field of each clock: the checker must fail, except for a few changes without effect, such as
    an addend that is 0 anyway."""
    right, at, unnoticed = words(program(24)[1]), 0, []
    for name, bits in FIELDS.items():
        for clock, word in enumerate(right):
            value = word >> at & (1 << bits) - 1
            if value:
                wrong = list(right)
                wrong[clock] ^= 1 << at if bits > 1 else value << at
                try:
                    check(wrong, GROUPS)
                    unnoticed.append((name, clock))
                except (WrongProgramError, IndexError, KeyError, AssertionError):  # some have no such code or place
                    pass
        at += bits
    assert len(unnoticed) <= 6, unnoticed


@pytest.mark.parametrize("step", ["d2", "x_n", "u_x", "cos_a", "wi_c", "w_q"])
@pytest.mark.parametrize("early", [1, 6, -40])
def test_a_step_in_another_clock_is_refused(step, early):
    """The encoder rejects it where two steps need a field or a place; otherwise the checker does."""
    moved = replace(schedule(), starts=schedule().starts | {step: schedule().starts[step] - early})
    with pytest.raises((ConflictError, WrongProgramError)):
        check(words(encode(GROUPS, moved)), GROUPS)


def test_a_place_that_is_still_wanted(monkeypatch):
    """Two live words share one place."""
    made = program(24)[1]
    other = {**made.places, "inv_law": made.places["root_far"]}
    monkeypatch.setattr("model.dataflow.fold.program.allocate", lambda *_: other)
    with pytest.raises(WrongProgramError, match="the program computes another"):
        check(words(encode(GROUPS, schedule())), GROUPS)


def test_every_node_is_shown_before_the_result_leaves():
    lowering, made = program(24)
    last = max(placed.at + timing.WRITE for placed in made.steps if placed.step.result)
    found = shown(lowering, made)
    assert list(found) == list(fixed.run([[0] * 6], 24, "lean").bits.nodes)
    assert max(of.time for of in found.values()) == last + 1
    assert fixed.latency("fold", 24) == last + 1 - max(made.loads.values())


def test_a_node_that_is_nowhere_is_named():
    lowering, made = program(24)
    without = replace(made, steps=[placed for placed in made.steps if placed.step.name != "az_tilt_sq"])
    with pytest.raises(LookupError, match="shows no az_tilt_sq"):
        shown(lowering, without)
