# SPDX-License-Identifier: Apache-2.0
"""The mutants that the first benches of a campaign did not notice: the one that did still does."""

import pytest

from tb.mutation.killers import killers_of
from tb.mutation.mutant import EQUIVALENT, hard, reasons
from tb.sim.env import ROOT, simulator
from tb.sim.mutants import copy_rtl

BUILT = hard() if simulator() == "icarus" else []


def test_the_lists_are_of_the_present_verilog():
    """A line that is gone leaves no reason, and no mutant, behind."""
    for mutant in hard():
        assert mutant.text() != (ROOT / mutant.file).read_text()
        assert mutant.killer in [killer.name for killer in killers_of(mutant.file)], mutant
    for file, old, new in reasons():
        assert old != new and old in " ".join((ROOT / file).read_text().split()), f"{file}: {old!r}: {EQUIVALENT.name}"
    assert all(reasons().values())


@pytest.mark.sim
@pytest.mark.slow
@pytest.mark.cost(100)
@pytest.mark.parametrize("mutant", BUILT, ids=lambda mutant: f"{mutant.file.rpartition('/')[2]}-{mutant.new[:40]}")
def test_a_hard_mutant_is_noticed(mutant, tmp_path):
    notices = next(killer for killer in killers_of(mutant.file) if killer.name == mutant.killer)
    place = copy_rtl(tmp_path)
    (place / mutant.file).write_text(mutant.text())
    notices.elaborated(place)
    assert notices.ran(place, 300)[0]
