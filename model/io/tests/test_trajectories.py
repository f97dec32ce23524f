# SPDX-License-Identifier: Apache-2.0
"""Built-in trajectories: the properties each promises, and the example files made from them."""

from pathlib import Path

import numpy as np
import pytest

from model.bounds.tolerances import REGULAR_DISTANCE
from model.io import trajectories
from model.io.files import format_csv, read_csv
from model.io.flags import TOO_FAR, expected_flags
from model.io.scoring import singular_distance
from model.io.words import FIELDS, to_words

EXAMPLES = Path(__file__).parents[3] / "examples"
NAMES = list(trajectories.TRAJECTORIES)


def relative_distance(targets):
    """Return |p| / (d1+d2)."""
    return np.linalg.norm(targets.position, axis=1) / targets.reach


@pytest.mark.parametrize("name", NAMES)
def test_name_and_length(name):
    targets = trajectories.make(name)
    assert targets.name == name
    assert len(targets) == 100
    assert all(np.isfinite(getattr(targets, field)).all() for field in FIELDS)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("width", [16, 32])
def test_only_out_of_reach_leaves_the_reach(name, width):
    words, _ = to_words(trajectories.make(name), width)
    flags = set(expected_flags(words, width).tolist())
    assert flags == ({0, TOO_FAR} if name == "out_of_reach" else {0})


@pytest.mark.parametrize("name", NAMES)
def test_distance_from_singular_poses(name):
    """Trajectories with the fixed bar keep away from singular poses; the others approach one."""
    least = singular_distance(trajectories.make(name)).min()
    assert (least >= REGULAR_DISTANCE) == (name in trajectories.REGULAR), f"{name}: {least:.3f} rad"


@pytest.mark.parametrize("name", NAMES)
def test_motion_is_smooth(name):
    """Hands move at most 5 cm (8 % of the reach) per step and change their step by less than 2 cm."""
    targets = trajectories.make(name)
    arms = 2 if name == "two_arms" else 1
    for arm in range(arms):
        step = np.diff(targets.position[arm::arms], axis=0)
        assert np.linalg.norm(step, axis=1).max() < 0.05
        assert np.linalg.norm(np.diff(step, axis=0), axis=1).max() < 0.02
        assert np.abs(np.diff(targets.phi[arm::arms])).max() < 0.25


def test_poses_approached_on_purpose():
    distance = {name: relative_distance(trajectories.make(name)) for name in NAMES}
    assert 0.995 < distance["punch"].max() < 1
    inner = (0.33 - 0.27) / 0.6
    assert inner < distance["fold_in"].min() < inner + 0.01
    assert distance["out_of_reach"].max() > 1.2
    assert distance["out_of_reach"][[0, -1]].max() < 0.8
    overhead = trajectories.make("overhead")
    assert np.hypot(overhead.x, overhead.y).min() < 0.02 < overhead.z.max()
    assert overhead.x[0] > 0.2 and overhead.x[-1] < -0.2


@pytest.mark.parametrize("name", trajectories.EXAMPLES)
def test_example_files_are_up_to_date(name):
    path = EXAMPLES / f"{name}.csv"
    made = format_csv(trajectories.make(name))
    command = f"python -m model.io.trajectories {name} > examples/{name}.csv"
    assert path.read_text(encoding="utf-8") == made, f"run: {command}"
    assert format_csv(read_csv(path)) == made


def test_command_line(capsys):
    assert trajectories.main(["reach"]) == 0
    assert capsys.readouterr().out == format_csv(trajectories.make("reach"))
    assert trajectories.main([]) == 0
    assert [line.split()[0] for line in capsys.readouterr().out.splitlines()] == NAMES
    assert trajectories.main(["nothing"]) == 2
    assert "usage" in capsys.readouterr().err
