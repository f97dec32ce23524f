# SPDX-License-Identifier: Apache-2.0
"""Expected flags from exact integers; built-in trajectories: their properties, and the example files."""

from pathlib import Path

import numpy as np
import pytest

from model.bounds.tolerances import REGULAR_DISTANCE
from model.io import trajectories
from model.io.files import format_csv, read_csv
from model.io.flags import AT_SHOULDER, BAD_LENGTH, ON_AXIS, TOO_FAR, TOO_NEAR, expected_flags
from model.io.scoring import singular_distance
from model.io.stimuli import extremes, mixed
from model.io.words import to_words

EXAMPLES = Path(__file__).parents[3] / "examples"
NAMES = list(trajectories.TRAJECTORIES)


@pytest.mark.parametrize("name", NAMES)
def test_trajectory(name):
    """Targets are in reach, and off singular poses where the fixed bar holds; hands move at most 5 cm (8 % of the
    reach) per step and change their step by less than 2 cm."""
    targets = trajectories.make(name)
    assert targets.name == name and len(targets) == 100
    for width in (16, 32):
        flags = set(expected_flags(to_words(targets, width)[0], width).tolist())
        assert flags == ({0, TOO_FAR} if name == "out_of_reach" else {0})
    assert (singular_distance(targets).min() >= REGULAR_DISTANCE) == (name in trajectories.REGULAR)
    arms = 2 if name == "two_arms" else 1
    for arm in range(arms):
        step = np.diff(targets.position[arm::arms], axis=0)
        assert np.linalg.norm(step, axis=1).max() < 0.05
        assert np.linalg.norm(np.diff(step, axis=0), axis=1).max() < 0.02
        assert np.abs(np.diff(targets.phi[arm::arms])).max() < 0.25


def test_poses_approached_on_purpose():
    made = {name: trajectories.make(name) for name in NAMES}
    distance = {name: np.linalg.norm(item.position, axis=1) / item.reach for name, item in made.items()}
    assert 0.995 < distance["punch"].max() < 1
    inner = (0.33 - 0.27) / 0.6
    assert inner < distance["fold_in"].min() < inner + 0.01
    assert distance["out_of_reach"].max() > 1.2
    assert distance["out_of_reach"][[0, -1]].max() < 0.8
    overhead = made["overhead"]
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
    trajectories.main(["reach"])
    assert capsys.readouterr().out == format_csv(trajectories.make("reach"))


LONG, SHORT = 2**30 + 1, 2**30 - 3
LIMITS = [  # squares in double precision do not distinguish these
    (LONG + SHORT, 0, 0, 0, LONG, SHORT),
    (LONG + SHORT + 1, 0, 0, 0, LONG, SHORT),
    (LONG + SHORT, 1, 0, 0, LONG, SHORT),
    (LONG - SHORT, 0, 0, 0, LONG, SHORT),
    (LONG - SHORT - 1, 0, 0, 0, LONG, SHORT),
]
FLAGS = [0, TOO_FAR, TOO_FAR, 0, TOO_NEAR]


def in_python_integers(x, y, z, phi, d1, d2) -> int:
    """Return the flags of one target, independently of :mod:`model.io.flags`."""
    flags = ON_AXIS * (x == y == 0) | AT_SHOULDER * (x == y == z == 0)
    if d1 <= 0 or d2 <= 0:
        return flags | BAD_LENGTH
    squared = x * x + y * y + z * z
    return flags | TOO_FAR * (squared > (d1 + d2) ** 2) | TOO_NEAR * (squared < (d1 - d2) ** 2)


@pytest.mark.parametrize("width", [16, 31, 32])
def test_expected_flags(width):
    words = np.concatenate([mixed(4000, width, seed=1), extremes(4000, width, seed=2)])
    assert expected_flags(words, width).tolist() == [in_python_integers(*row) for row in words.tolist()]
    with pytest.raises(ValueError, match=f"{width} bits"):
        expected_flags(np.full((1, 6), 2 ** (width - 1)), width)
    assert expected_flags(np.array(LIMITS), 32).tolist() == [in_python_integers(*row) for row in LIMITS] == FLAGS
