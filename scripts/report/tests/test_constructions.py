# SPDX-License-Identifier: Apache-2.0
"""Figures 1 to 5 in the report: each entity, rotated by the drawn angle, gives the next one."""

import base64
from pathlib import Path

import click
import numpy as np
import pytest

from model.io import trajectories
from model.motion.tests import figure
from scripts.console import parse
from scripts.report.constructions import ANGLES, LENGTHS, NOTHING, STEPS, VECTORS, packed
from scripts.trajectory import prepare, trajectory_options

TURNS = ("folded", "rest", "half", "middle", "yz2", *ANGLES)


def prepared(*options):
    return prepare(parse(click.Command("report", params=trajectory_options(".", "")), "", options))


def unpack(data, targets):
    """Decode the page's data: VECTORS, ANGLES and LENGTHS by name; undefined entities are nan."""
    words = np.frombuffer(base64.b64decode(data["rows"]), "<i2").reshape(len(targets), -1).astype(float)
    words[words == NOTHING] = np.nan
    assert words.shape[1] == 3 * len(VECTORS) + len(ANGLES) + len(LENGTHS) and data["steps"] == STEPS
    found = {name: words[:, 3 * i : 3 * i + 3] / STEPS for i, name in enumerate(data["vectors"])}
    scalars = words[:, 3 * len(VECTORS) :].T / STEPS
    scalars[: len(ANGLES)] *= np.pi
    return found | dict(zip((*data["angles"], *data["lengths"]), scalars, strict=True))


def turn(v, axis, angle):
    """Rotate v about an axis by an angle, right-handed."""
    a, angle = axis / np.linalg.norm(axis, axis=1, keepdims=True), np.broadcast_to(angle, len(v))[:, None]
    along = a * (a * v).sum(axis=1, keepdims=True)
    return v * np.cos(angle) + np.cross(a, v) * np.sin(angle) + along * (1 - np.cos(angle))


def assert_near(a, b, what, limit=3e-4):
    assert np.abs(a - b).max() < limit, what


CASES = [(name, "--axis=z") for name in trajectories.TRAJECTORIES]
CASES += [("circle", axis) for axis in ("--axis=-z", "--axis=x", "--axis=0.3,1,0")]
CASES += [("t.bvh", axis) for axis in ("--axis=torso", "--axis=0.2,1,0.1")]


@pytest.mark.parametrize(("name", "axis"), CASES)
def test_each_figure_leads_to_the_next(name, axis, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    figure.write(Path("t.bvh"), frames=40)
    (item,) = prepared("--trajectory", name, axis)
    targets = item.targets
    e = unpack(packed(item, 32), targets)
    wrist = targets.position / targets.reach[:, None]
    upper, fore = targets.d1 / targets.reach, targets.d2 / targets.reach
    up = np.zeros((len(targets), 3)) + (0, 0, 1)
    assert_near(e["axis"], targets.points_from_core(up), "the reference axis in the frame of the targets")
    assert_near(e["along"], wrist / np.linalg.norm(wrist, axis=1, keepdims=True), "L_sw")
    assert_near(turn(e["vertical"], e["along"], targets.phi), e["swivel"], "figure 1")
    ok = np.isfinite(e["elbow"]).all(axis=1)
    assert ok.sum() == (52 if name == "out_of_reach" else len(targets))
    for missing in ("other", "radius", *TURNS):
        assert (np.isfinite(e[missing]).reshape(len(ok), -1).all(axis=1) == ok).all(), missing
    e = {key: value[ok] for key, value in e.items()}
    wrist, upper, fore = wrist[ok], upper[ok], fore[ok]
    for point in ("elbow", "other"):
        assert_near(np.linalg.norm(e[point], axis=1), upper, "figure 2: on S_2")
        assert_near(np.linalg.norm(e[point] - wrist, axis=1), fore, "figure 2: on S_1")
        assert_near((e[point] * e["swivel"]).sum(axis=1), 0, "figure 2: in the swivel plane")
        assert_near(np.linalg.norm(e[point] - e["centre"], axis=1), e["radius"], "figure 2: on Z_e")
    assert_near(e["elbow"] + e["other"], 2 * e["centre"], "figure 2: opposite each other")
    assert_near(turn(e["folded"] - e["elbow"], e["swivel"], e["theta4"]) + e["elbow"], wrist, "figure 3")
    assert_near(turn(e["axis"] * upper[:, None], e["middle"], np.pi), e["elbow"], "figure 4")
    assert_near(turn(e["rest"], e["middle"], np.pi), e["half"], "figure 4")
    for point in ("elbow", "half"):
        assert_near((e[point] * e["yz2"]).sum(axis=1), 0, "figure 5: in pi_yz2")
    assert_near(turn(e["half"], e["elbow"], e["theta3"]), wrist, "figure 5")


def test_the_elbow_is_that_of_the_core(tmp_path, monkeypatch):
    """The drawn elbow matches the clip's elbow for both arms, including its side of the swivel plane."""
    monkeypatch.chdir(tmp_path)
    figure.write(Path("t.bvh"), frames=40)
    (item,) = prepared("--trajectory", "t.bvh")
    elbow = np.stack([move.elbow for move in item.moves], axis=1).reshape(-1, 3)
    assert_near(unpack(packed(item, 32), item.targets)["elbow"], elbow / item.targets.reach[:, None], "the clip's own")


def test_what_a_target_has_not_got(tmp_path, monkeypatch):
    """Entities are undefined as expected: on the axis, straight, out of reach, at the shoulder, elbow on the axis."""
    monkeypatch.chdir(tmp_path)
    Path("t.csv").write_text("x,y,z,phi\n0,0,0.5,1\n0.6,0,0,1\n0.6,0.6,0,1\n0,0,0,1\n0.27,0,0.33,0\n")
    (item,) = prepared("--trajectory", "t.csv")
    e = unpack(packed(item, 32), item.targets)
    has = {name: np.isfinite(value).reshape(5, -1).all(axis=1).tolist() for name, value in e.items()}
    assert has["swivel"] == [False, True, True, False, True]
    assert has["radius"] == [True, True, False, False, True]
    assert has["elbow"] == has["other"] == [False, True, False, False, True]
    assert all(has[name][:4] == [False, True, False, False] for name in TURNS)
    assert e["radius"][1] < 1e-4


def test_a_page_of_any_unit(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    rows = []
    for unit in (1e-150, 1.0, 1e150):
        lengths = ",".join(str(length * unit) for length in (0.3, 0.1, 0.2, 0.33, 0.27))
        Path("t.csv").write_text(f"x,y,z,d1,d2\n{lengths}\n")
        (item,) = prepared("--trajectory", "t.csv")
        rows.append(unpack(packed(item, 32), item.targets)["elbow"])
    assert_near(rows[0], rows[1], "small")
    assert_near(rows[2], rows[1], "large")
