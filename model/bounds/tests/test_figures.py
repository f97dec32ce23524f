# SPDX-License-Identifier: Apache-2.0
"""Tests that no table, module or datapath is less accurate than figures.json, nor much better: then the file is old.

Model and RTL are built from the same tables and formats, so a worse table leaves them equal; it is detected here.
"""

import json

import pytest

from model.bounds.tests import figures

RECORDED = json.loads(figures.FILE.read_text(encoding="utf-8"))
GROUPS = figures.groups()

WORSE = {"proved": 1.0, "max": 1.1, "rms": 1.02, "median": 1.02}
"""Largest permitted ratio of a figure to its record.  The targets are always the same; a bit fewer in one of many
words increases an rms by a few percent; the largest error depends on a single target."""

BETTER = {"proved": 0.98, "max": 0.0, "rms": 0.9, "median": 0.9}
"""Smallest permitted ratio; the largest error, of a single target, has none."""


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
