# SPDX-License-Identifier: Apache-2.0
"""Figure of a clip in the report: bones match the clip, arms match the core's results."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

from model.motion import clip as clips
from model.motion.tests import figure
from scripts import run
from scripts.report import page as report
from scripts.report.figure import FORE, STEPS, UPPER, place
from scripts.tests.test_run import FakeSimulator

SHARED = Path(__file__).parents[3].parent / "shared" / "mocap"
FRAMES = 40


@pytest.fixture
def simulator(monkeypatch):
    fake = FakeSimulator()
    monkeypatch.setattr(run, "simulate", fake.simulate)
    monkeypatch.setattr(run, "hand_bar", lambda words, width, datapath: np.full(len(words), 2.0 ** (8 - width)))
    return fake


@pytest.fixture
def shown(simulator, command):
    """Write the page of a clip and return its data."""

    def shown(*options, status=0, path="t.bvh"):
        got = command(report.main, "--trajectory", str(path), "--out", "o", *options)
        assert got[0] == status, got
        page = Path("o/report.html").read_text(encoding="utf-8")
        (found,) = re.findall(r'<script type="application/json" id="data">(.*?)</script', page, re.S)
        (one,) = json.loads(found)["trajectories"]
        return one

    return shown


def points(clip):
    """Return nodes (F, K, 3) and the clip's elbows and wrists (F, 2 A, 3) in the page's frame and the clip's unit."""
    nodes, own = (np.array(clip[key], dtype=float).reshape(len(clip[key]), -1, 3) for key in ("nodes", "own"))
    root = nodes[:, :1].copy()
    nodes[:, 1:] += root
    return nodes * clip["unit"], (own + root) * clip["unit"]


FORWARD = {"x": ("y", (1, 0, 0)), "y": ("y", (0, 0, -1)), "z": ("z", (0, 1, 0))}
"""`up` argument of a test figure -> its up axis and facing direction in the clip."""


@pytest.mark.parametrize("up", ["x", "y", "z"])
@pytest.mark.parametrize("phi", ["clip", "1.5"])
def test_the_figure_is_that_of_the_turned_clip(shown, up, phi):
    mine = clips.read(figure.write(Path("t.bvh").absolute(), up=up, frames=FRAMES))
    data = shown("--phi", phi)
    clip = data["clip"]
    nodes, own = points(clip)
    turn = np.array(clip["place"])
    np.testing.assert_allclose(turn @ turn.T, np.eye(3), atol=1e-15)
    assert np.linalg.det(turn) == pytest.approx(1) and turn[2]["xyz".index(FORWARD[up][0])] == 1
    turned = clips.read(Path("o/clip.bvh"))
    index = [turned.bvh.node_index[name] for name in turned.bvh.joint_names]
    assert clip["parents"][0] == -1 and len(clip["parents"]) == len(turned.bvh.nodes) == nodes.shape[1]
    np.testing.assert_allclose(nodes[:, index], turned.positions @ turn.T, atol=2 * clip["unit"])
    for n, (arm, names) in enumerate(zip(clips.arms(mine), clip["arms"], strict=True)):
        assert names["side"] == arm.side
        for k, part in enumerate(("fore", "hand")):
            joint = getattr(arm, part)
            np.testing.assert_allclose(own[:, 2 * n + k], mine.positions[:, joint] @ turn.T, atol=2 * clip["unit"])
            core = np.array(data["elbow" if part == "fore" else "wrist"])[n::2] @ turn.T
            np.testing.assert_allclose(nodes[:, names[part]] - nodes[:, names["upper"]], core, atol=3 * clip["unit"])
        assert clip["parts"][names["fore"]] == UPPER and clip["parts"][names["hand"]] == FORE
    assert sorted(clip["parts"]).count(UPPER) == 2 and clip["parts"].count(FORE) == 2
    moved = np.linalg.norm(own[:, 0] - nodes[:, clip["arms"][0]["fore"]], axis=1).max()
    assert moved > 0.1 if phi == "1.5" else moved < 3 * clip["unit"]
    error = np.array(data["elbowError"])
    assert error.shape == (2 * FRAMES,) and (error.max() > 0.1) == (phi == "1.5")


def test_rate_bounds_and_order(shown):
    figure.write(Path("t.bvh"), frames=FRAMES)
    data = shown()
    clip = data["clip"]
    assert clip["rate"] == pytest.approx(120, rel=1e-4)
    assert data["about"].startswith("t.bvh: 40 frames at 120 Hz; left and right arm by the core, the rest of the body")
    assert data["arm"] == [0, 1] * FRAMES and len(data["angles"]) == 2 * FRAMES
    nodes, own = points(clip)
    assert nodes[..., 2].min() == pytest.approx(clip["floor"], abs=2 * clip["unit"])
    centre = nodes[:, :1].copy()
    assert clip["middle"] is None, "this figure climbs"
    far = np.linalg.norm(np.concatenate((nodes, own), axis=1) - centre, axis=2).max()
    assert far == pytest.approx(clip["radius"], abs=2 * clip["unit"])
    size = np.linalg.norm(np.ptp(nodes, axis=1), axis=1).max()
    assert clip["unit"] * STEPS == pytest.approx(size, rel=0.01)


def test_a_figure_that_stays_down(shown):
    mine = clips.read(figure.write(Path("t.bvh").absolute(), frames=FRAMES))
    mine.bvh.root_pos = mine.bvh.root_pos * (1, 0.01, 1)
    mine.bvh.write("t.bvh")
    clip = shown()["clip"]
    nodes, own = points(clip)
    assert clip["middle"] == pytest.approx((nodes[..., 2].min() + nodes[..., 2].max()) / 2, abs=2 * clip["unit"])
    centre = np.where([True, True, False], nodes[:, :1], clip["middle"])
    far = np.linalg.norm(np.concatenate((nodes, own), axis=1) - centre, axis=2).max()
    assert far == pytest.approx(clip["radius"], abs=2 * clip["unit"])


def test_a_lone_arm(shown):
    figure.write(Path("t.bvh"), frames=FRAMES)
    data = shown("--arm", "right")
    assert [arm["side"] for arm in data["clip"]["arms"]] == ["right"]
    assert len(data["target"]) == FRAMES and len(data["clip"]["own"][0]) == 6


@pytest.mark.parametrize("up", ["x", "y", "z"])
@pytest.mark.parametrize("sides", ["both", "left", "right"])
def test_it_faces_forward(shown, up, sides):
    """The page's facing direction is the forward axis of a test figure at rest."""
    mine = clips.read(figure.write(Path("t.bvh").absolute(), up=up, frames=FRAMES))
    mine.bvh.joint_angles = np.zeros_like(mine.bvh.joint_angles)
    mine.bvh.write("t.bvh")
    clip = shown("--arm", sides, "--axis", "0.1,0.2,0.3")["clip"]
    expected = np.array(clip["place"]) @ FORWARD[up][1]
    np.testing.assert_allclose((np.cos(clip["facing"]), np.sin(clip["facing"])), expected[:2], atol=1e-3)


def test_a_wrong_word_shows(shown, simulator):
    """A wrong result word moves the figure's arm: the arms come from the core, not from the clip."""
    figure.write(Path("t.bvh"), frames=FRAMES)

    def spoil(runs):
        runs[0].results[21, 1] += 2**28  # of frame 10, the right arm

    simulator.spoil = spoil
    clip = shown(status=1)["clip"]
    nodes, own = points(clip)
    off = [np.linalg.norm(own[:, 2 * n + 1] - nodes[:, arm["hand"]], axis=1) for n, arm in enumerate(clip["arms"])]
    assert np.flatnonzero(off[1] > 0.05).tolist() == [10] and off[0].max() < 0.05


@pytest.mark.parametrize("axis", ["torso", "0.3,1,0"])
def test_joint_angles(shown, axis):
    """Elevation and azimuth match the torso's axes; flexion matches the angle between the bones."""
    mine = clips.read(figure.write(Path("t.bvh").absolute(), up="z", frames=FRAMES))
    data = shown(f"--axis={axis}")
    elbow, wrist, angles = (np.array(data[key]) for key in ("elbow", "wrist", "angles"))
    for n, arm in enumerate(clips.arms(mine)):
        e, w = elbow[n::2], wrist[n::2]
        bend = np.degrees(np.arccos(np.sum(e * (w - e), axis=1) / figure.UPPER / figure.FORE))
        np.testing.assert_allclose(angles[n::2, 3], bend, atol=0.01)
        seen = np.einsum("fij,fi->fj", mine.world[:, arm.torso], e) / figure.UPPER  # x right, y forward, z up
        np.testing.assert_allclose(np.sin(np.radians(angles[n::2, 1])), seen[:, 2], atol=1e-4)
        there = np.hypot(seen[:, 0], seen[:, 1])
        np.testing.assert_allclose(there * np.cos(np.radians(angles[n::2, 0])), seen[:, 1], atol=1e-4)
        np.testing.assert_allclose(there * np.sin(np.radians(angles[n::2, 0])), -seen[:, 0], atol=1e-4)
        np.testing.assert_allclose(np.radians(angles[n::2, 2]), np.array(data["phi"])[n::2], atol=1e-3)


@pytest.mark.parametrize("up", [sign + letter for sign in "+-" for letter in "xyz"])
def test_place(up):
    turn = place(up)
    vector = np.where(np.array(list("xyz")) == up[1], 1.0, 0.0) * (1 if up[0] == "+" else -1)
    np.testing.assert_array_equal(turn @ vector, (0, 0, 1))
    assert np.linalg.det(turn) == pytest.approx(1)


@pytest.mark.slow
@pytest.mark.skipif(not SHARED.is_dir(), reason="clips of motion capture are not beside the checkout")
@pytest.mark.parametrize("name", ["cmu_12_01_walk", "cmu_01_01_jump"])
def test_size_of_real_clips(shown, name):
    shown(path=SHARED / f"{name}.bvh")
    assert Path("o/report.html").stat().st_size < 4_500_000
