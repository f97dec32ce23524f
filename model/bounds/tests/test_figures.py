# SPDX-License-Identifier: Apache-2.0
"""No table, core or datapath is less accurate than figures.json says, nor much better: then the file is old.

Model and RTL are made from the same tables and formats, so that a worse one leaves them equal; it shows here.
"""

import json

import pytest

from model.bounds.tests import figures

RECORDED = json.loads(figures.FILE.read_text(encoding="utf-8"))
GROUPS = figures.groups()

WORSE = {"proved": 1.0, "max": 1.1, "rms": 1.02, "median": 1.02}
"""How many times its figure an error may be.  Always the same targets are measured, and a bit fewer in one of many
words makes an rms a few percent worse; the largest error is that of a single target."""

BETTER = {"proved": 0.98, "max": 0.0, "rms": 0.9, "median": 0.9}
"""At least; less is said of a single target."""


def test_every_group_has_its_figures():
    assert list(RECORDED) == list(GROUPS)


@pytest.mark.parametrize("name", GROUPS)
def test_figures(name):
    present, recorded = GROUPS[name](), RECORDED[name]
    assert list(present) == list(recorded), "other figures than in the file"
    for what, figure in present.items():
        ratio = figure / recorded[what]
        kind = what.split()[-1]
        message = f"{name}: {what} is {figure:.4g}, {ratio:.3f} times the {recorded[what]:.4g} recorded"
        assert BETTER[kind] <= ratio <= WORSE[kind], message
