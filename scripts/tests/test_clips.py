# SPDX-License-Identifier: Apache-2.0
"""Tests of `make run` on a motion capture clip: limits and output files."""

import csv
import json
from functools import partial
from pathlib import Path

import numpy as np
import pygltflib
import pytest

from model.motion import clip as clips
from model.motion.tests import figure
from scripts import run
from scripts.tests.test_run import FakeSimulator


@pytest.fixture
def cli(command, monkeypatch):
    monkeypatch.setattr(run, "simulate", FakeSimulator().simulate)
    return partial(command, run.main, "--trajectory", "t.bvh", "--out", "o")


def rows():
    with Path("o/results.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


@pytest.mark.parametrize("axis", ["torso", "y", "0.3,1,0"])
def test_both_arms(cli, files, axis):
    clip = clips.read(figure.write(Path("t.bvh").absolute(), frames=40))
    status, out, err = cli(f"--axis={axis}", "--datapath", "paper")
    assert (status, err) == (0, [])
    names = ["clip.bvh", "clip.glb", "results.csv", "results.npz", "score.json"]
    assert files() == [*(f"o/{name}" for name in names), "t.bvh"]
    assert sorted(out[-5:]) == [f"wrote o/{name}" for name in names]
    table = rows()
    assert [(row["frame"], row["arm"]) for row in table] == [(str(n), arm) for n in range(40) for arm in clips.SIDES]
    assert max(float(row["hand_error"]) for row in table) < 1e-6
    # in the clip's own frame
    for k, arm in enumerate(clips.arms(clip)):
        elbow = clip.positions[:, arm.fore] - clip.positions[:, arm.upper]
        ours = np.array([[float(row[f"elbow_{letter}"]) for letter in "xyz"] for row in table[k::2]])
        error = np.linalg.norm(ours - elbow, axis=1) / (figure.UPPER + figure.FORE)
        np.testing.assert_allclose([float(row["elbow_error"]) for row in table[k::2]], error, atol=1e-12)
        assert np.median(error) < 1e-8
    again = clips.read(Path("o/clip.bvh"))
    np.testing.assert_allclose(again.positions, clip.positions, atol=1e-2)
    assert np.median(np.abs(again.positions - clip.positions)) < 1e-6
    animation = pygltflib.GLTF2().load("o/clip.glb").animations[0]
    assert animation.name == "t" and len(animation.channels) == len(clip.bvh.joint_names) + 1
    arrays = np.load("o/results.npz")
    for side in (0, 1):
        assert (np.sum(arrays["qs"][side::2][1:] * arrays["qs"][side::2][:-1], axis=1) > 0).all()


def test_constant_angle_is_the_mean_of_the_clip(cli):
    clip = clips.read(figure.write(Path("t.bvh").absolute()))
    assert cli("--phi", "constant")[0] == 0
    means = {arm.side: clips.motion(clip, arm).typical_phi for arm in clips.arms(clip)}
    assert {(row["arm"], float(row["phi"])) for row in rows()} == set(means.items())
    assert max(float(row["hand_error"]) for row in rows()) < 1e-6
    assert cli("--phi", "0.5", "--arm", "left")[0] == 0
    assert {(row["arm"], row["phi"]) for row in rows()} == {("left", "0.5")}


def test_an_arm_by_the_names_of_its_joints(cli):
    figure.write(Path("t.bvh"), "own")
    status, _, err = cli()
    assert status == 2 and err[0].startswith("run: t.bvh: no left arm is known by name; JOINTS= names its three of")
    assert cli("--arm", "right", "--joints", ",".join(figure.joints("own", "right")))[0] == 0
    assert {row["arm"] for row in rows()} == {"right"}
    said = "run: t.bvh: joints a,b,c are those of one arm: ARM= says which, left or right"
    assert cli("--joints", "a,b,c")[2] == [said]


def test_a_straight_arm_stays_straight(cli):
    """Rounding must not bend the T pose, with which clips begin."""
    clip = clips.read(figure.write(Path("t.bvh").absolute()))
    clip.bvh.joint_angles = np.zeros_like(clip.bvh.joint_angles)
    clip.bvh.write("t.bvh")
    assert cli("--width", "18")[0] == 0
    table = rows()
    assert {row["flags"] for row in table} == {"1"}, "asked to reach a little further than it can"
    assert max(float(row["elbow_error"]) for row in table) < 2e-5
    assert json.loads(Path("o/score.json").read_text())[0]["passed"]
