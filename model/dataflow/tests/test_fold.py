# SPDX-License-Identifier: Apache-2.0
"""Program of the fold datapath: one for all word lengths, no conflicts, and a place for every node."""

from dataclasses import replace

import pytest

from model.dataflow import fixed
from model.dataflow.datapaths import CONFIGURATIONS
from model.dataflow.fold.lowering import lower
from model.dataflow.fold.program import ConflictError, encode, program, schedule
from model.dataflow.fold.shown import shown
from model.dataflow.fold.steps import WRITE


@pytest.mark.parametrize("width", CONFIGURATIONS["fold"].widths)
def test_the_program_is_the_same_at_every_word_length(width):
    one, other = program(width)[1], program(24)[1]
    assert [one.word(clock) for clock in range(one.period)] == [other.word(clock) for clock in range(other.period)]


def test_steps_in_the_clocks_of_another_step_are_refused():
    """Two steps that need a field or a place in one clock; a step of another clock that does not conflict shows as
    wrong nodes in the RTL (`tb/core/test_every_target.py`)."""
    (_, groups), found = lower(24), schedule()
    first, *others = found.starts
    for other in others[::7]:
        with pytest.raises(ConflictError, match="twice|lives|no place"):
            encode(groups, replace(found, starts=found.starts | {other: found.starts[first]}))


def test_every_node_is_shown_before_the_result_leaves():
    lowering, made = program(24)
    last = max(placed.at + WRITE for placed in made.steps if placed.step.result)
    found = shown(lowering, made)
    assert list(found) == list(fixed.run([[0] * 6], 24, "lean").bits.nodes)
    assert max(of.time for of in found.values()) == last + 1
    assert fixed.latency("fold", 24) == last + 1 - max(made.loads.values())
    without = replace(made, steps=[placed for placed in made.steps if placed.step.name != "az_tilt_sq"])
    with pytest.raises(LookupError, match="shows no az_tilt_sq"):
        shown(lowering, without)
