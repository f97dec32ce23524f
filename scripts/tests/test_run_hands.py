# SPDX-License-Identifier: Apache-2.0
"""Test `make run` with hand poses and with robots."""

import re
from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pytest

from model.dataflow.datapaths import MODELS
from model.io import trajectories
from model.io.files import format_csv
from model.io.flags import ARM_FLAG_BITS, OVER_BIT
from model.io.words import JOINTS, limit_words
from model.motion.arms import ROBOTS, Arm
from model.motion.pose import solve
from model.motion.tests.test_arms import CHAINS, urdf
from model.motion.tests.test_pose import poses
from model.reference.kinematics import angle_between, parse_axis
from scripts import run, trajectory
from scripts.robots import planned
from scripts.tests.test_run import scores, table


def write_poses(points, hands, **columns):
    """Write hand poses to t.csv. columns: further column -> its values (N,)."""
    names = ["x", "y", "z", "qw", "qx", "qy", "qz", *columns]
    cells = np.column_stack([points, hands, *columns.values()])
    Path("t.csv").write_text("\n".join([",".join(names), *(",".join(map(repr, row)) for row in cells.tolist())]))


@pytest.mark.parametrize(("width", "axis"), [(32, "z"), (18, "0,-1,1")])
def test_hand_poses_of_a_file(cli, simulator, width, axis):
    """Check that `solve` gives the same joints, and that results.csv can be read as a file of the same poses."""
    tool, branch = np.linspace(0.0, 0.2, 40), np.arange(40) % 8
    points, q, phi = poses(40, tool=tool[:, None])
    write_poses(points, q, phi=phi, tool=tool, branch=branch)
    words = "--trajectory", "t.csv", "--out", "o", f"--axis={axis}", "--width", str(width)
    assert cli(*words)[0] == 0
    (call,) = simulator.calls
    assert (call["datapath"], call["limits"]) == ("arm", [(-(1 << width - 1), (1 << width - 1) - 1)] * 7)
    pose = solve(points, phi, axis=parse_axis(axis), width=width, hand=q, tool=tool, branch=branch)
    np.testing.assert_array_equal(table(*JOINTS), pose.joints)
    arrays, first = np.load("o/results.npz"), Path("o/results.csv").read_bytes()
    np.testing.assert_allclose(table("elbow_x", "elbow_y", "elbow_z"), pose.elbow, atol=1e-15)
    np.testing.assert_allclose(np.abs((arrays["qw"] * pose.qw).sum(axis=1)), 1, atol=2.0 ** (6 - width))
    (result,) = scores("o/score.json")
    reached = (np.linalg.norm(pose.hand - points, axis=1) / (0.6 + tool)).max()
    assert 0 < result["hand_error_max"] < max(2 * reached, 3 * 2.0 ** (2 - width)) < result["hand_error_tolerance"]
    assert 0 < result["orientation_error_max"] < result["orientation_error_tolerance"] and result["over_limit"] == 0
    Path("t.csv").write_bytes(first)
    assert cli(*words)[0] == 0 and Path("o/results.csv").read_bytes() == first


@pytest.mark.parametrize("robot", ["human", "t.urdf"])
def test_poses_of_a_robot(cli, simulator, robot):
    """Check that the computed joints put the robot's tip at the given pose. Without phi in the file, all joints must be
    within the limits, which these poses permit; with phi, rows outside the limits fail the run."""
    path = urdf(Path("t.urdf"), CHAINS["reversed"], limits=[(-0.5, 5.6), *[(-2.0, 2.0)] * 5, None])
    arm = ROBOTS.get(robot) or Arm.from_urdf(path)
    low, high = arm.limits.T
    th = np.random.default_rng(3).uniform(np.maximum(low, -2), np.minimum(high, 2), (60, 7))
    points, q = arm.forward(th)
    for phi in ({}, {"phi": np.linspace(-3, 3, 60)}):
        write_poses(points, q, **phi)
        words = "--trajectory", "t.csv", "--out", "o", "--robot", robot
        assert cli(*words, "--limits", "report")[0] == 0
        joints, over = table(*arm.names), table("over_limit")[:, 0].astype(int)
        tips, turned = arm.forward(joints)
        assert np.linalg.norm(tips - points, axis=1).max() < 3e-8 and angle_between(turned, q).max() < 2.1e-8
        outside = ((joints < low - 1e-8) | (joints > high + 1e-8)) @ (1 << np.arange(7))
        np.testing.assert_array_equal(over, outside)
        assert 0 < np.count_nonzero(over) < 60 if phi else not over.any()
        path = arm.path(points, q, **phi)
        np.testing.assert_array_equal(over == 0, np.isfinite(path.joints[:, 0]))
        np.testing.assert_array_equal(table("branch")[:, 0][over == 0], path.branch[over == 0])
        np.testing.assert_allclose(table("step")[over == 0, 0], path.step[over == 0])
        status, _, err = cli(*words)
        assert status == bool(phi) and (not phi or re.search(r"fails: joints outside their limits in \d+ of", err[-1]))
        expected = arm.solve(points, q, table("phi")[:, 0])
        np.testing.assert_allclose(table("elbow_x", "elbow_y", "elbow_z"), expected.elbow, atol=1e-7)
        np.testing.assert_allclose(np.load("o/results.npz")[arm.names[0]], joints[:, 0])
        assert simulator.calls[-1]["limits"] == limit_words(arm.bounds, 32)
        assert scores("o/score.json")[0]["over_limit"] == np.count_nonzero(over)
    write_poses(3 * points, q, phi=np.zeros(60))  # some are out of reach: poses are the nearest
    assert cli("--trajectory", "t.csv", "--out", "o", "--robot", robot, "--limits", "report")[0] == 0
    assert scores("o/score.json")[0]["flagged"] > 5


def test_an_unsuitable_urdf_file(cli):
    urdf(Path("t.urdf"), CHAINS["bent"])
    message = "run: argument --robot: links are bent: the joints of ik_arm are along or across its bones"
    assert cli("--trajectory", "pick_and_place", "--robot", "t.urdf")[::2] == (2, [message])


def test_a_nearly_exact_robot(cli):
    """Check that the core solves the nearest exact arm, and that a warning gives its distance from the given robot."""
    arm = ROBOTS["rm75"]
    points, q = arm.forward(np.linspace((0.1, -0.5, 0.3, 1.2, 0.1, 0.8, 0), (0.9, -0.2, 0.1, 0.9, 0.3, 1.1, 0.5), 30))
    write_poses(points, q)
    status, _, err = cli("--trajectory", "t.csv", "--robot", "rm75", "--out", "o")
    assert (status, len(err)) == (0, 1) and "the core solves the nearest exact arm, and its joints are not" in err[0]
    distance = float(re.search(r"is off by up to (\S+) and", err[0])[1])
    tips, _ = arm.forward(table(*arm.names))
    assert 1e-7 < np.linalg.norm(tips - points, axis=1).max() <= distance < 5e-6
    with pytest.raises(ValueError, match="only arms whose axes meet exactly"):
        planned(arm, trajectories.make("pick_and_place"))


def test_the_core_chooses_the_planned_branch(cli, simulator):
    """Check that the core's joints are the planned joints, even with th6 = 0, where the split into th5 and th7 is free,
    and that targets with other joints or another branch are counted."""
    arm, words = ROBOTS["iiwa14"], ("--trajectory", "t.csv", "--out", "o", "--robot", "iiwa14")
    tilt = np.linspace(-0.3, 0.3, 31)
    still = 0 * tilt
    points, q = arm.forward(np.column_stack((still, 0.7 + tilt, still, tilt - 1.4, still, tilt, 0.3 - tilt)))
    write_poses(points, q, phi=still)
    status, _, err = cli(*words)
    path = arm.path(points, q, phi=0)
    np.testing.assert_allclose(table(*arm.names), path.joints, atol=1e-6)
    assert (status, err, simulator.calls[0]["datapath"]) == (0, [], "choose")
    assert (table("branch").T == path.branch).all()

    def spoil(run):
        run.flags[3:5] ^= 1 << ARM_FLAG_BITS
        run.results[15, 0] += 1 << 25

    simulator.spoil = spoil
    _, _, err = cli(*words)
    assert "warning: t: the core chooses another branch than the planner for 2 of 31 targets" in err
    assert "warning: t: joints differ from the planned ones in 1 of 31 targets; first: target 15" in err
    write_poses(points, q, phi=still, branch=path.branch)
    cli(*words)
    assert simulator.calls[-1]["datapath"] == "arm"


SLOW = np.array((0.4, 0.7, -0.3, 1.1, 0.2, 0.6, 0.5)) * np.linspace(1, -1, 40)[:, None]
"""Joints of a smooth path (40, 7)."""


def test_speeds_of_joints(cli):
    """Check largest speeds and warnings in three cases: a column t in two paths with alternating rows, RATE=, and a
    robot without limits."""
    arm, label, seconds = ROBOTS["lwr4"], np.tile((1, 2), 20), np.cumsum(np.linspace(0.01, 0.1, 20)).repeat(2)
    words = "--trajectory", "t.csv", "--out", "o", "--robot", "lwr4"
    write_poses(*arm.forward(SLOW.reshape(2, 20, 7).swapaxes(0, 1).reshape(40, 7)), path=label, T=seconds)
    for more, times in ((), seconds), (("--rate", "10"), np.arange(20).repeat(2) / 10):
        status, out, err = cli(*words, *more)
        moved = np.diff(table(*arm.names).reshape(20, 2, 7), axis=0)
        expected = np.abs(moved) / np.diff(times.reshape(20, 2, 1), axis=0)
        shown = re.findall(r"largest speed of (\S+), limit (\S+) \(rad/s\) +(\S+)", "\n".join(out))
        names, limits, largest = zip(*shown, strict=True)
        assert (names, limits) == (arm.names, tuple(f"{limit:.4g}" for limit in arm.velocities))
        np.testing.assert_allclose(np.array(largest, float), expected.max(axis=(0, 1)), rtol=6e-3)
        above = np.count_nonzero(expected > arm.velocities, axis=(0, 1))
        listed = {name: int(count) for name, count in re.findall(r"(\w+) in (\d+) rows, up to", err[0] if err else "")}
        assert listed == {name: count for name, count in zip(arm.names, above.tolist(), strict=True) if count}
        assert status == 0 and len(err) == bool(listed) == (not more)
    write_poses(*ROBOTS["iiwa14"].forward(SLOW), t=np.arange(40) / 1e3)
    status, out, err = cli(*words[:-1], "iiwa14")
    assert (status, err) == (0, []) and sum("largest speed of A" in line and "limit" not in line for line in out) == 7


def test_lengths_and_poses_of_another_robot(cli):
    write_poses([(0.3, 0.1, 0.5)], [(1, 0, 0, 0)], d1=[0.42], tool=[0.2])
    hint = "warning: t.csv: ROBOT= overrides tool of the file"
    assert cli("--trajectory", "t.csv", "--robot", "iiwa14")[2][0] == hint
    hint = "warning: pick_and_place: the poses are for ROBOT=iiwa14"
    assert cli("--trajectory", "pick_and_place", "--robot", "human")[2][0] == hint
    assert cli("--trajectory", "pick_and_place")[2] == []


def test_wrong_angles_and_flags_fail(cli, simulator):
    def spoil(run):
        for target, (name, ulps) in enumerate({"th1": 2**12, "th7": 2**14}.items()):
            run.results[target, MODELS["arm"].results.index(name)] += ulps
        run.flags[3] += 2 << OVER_BIT

    simulator.spoil = spoil
    status, _, err = cli("--trajectory", "pick_and_place")
    messages = "hand error .* at target 0 ", "orientation error .* at target 1 ", "wrong flags in 1 .* 3 has over_2 "
    assert status == 1 and len(err) == 3
    for message in messages:
        assert any(re.match(f"run: pick_and_place fails: {message}", line) for line in err), err


@pytest.mark.parametrize("name", trajectories.HANDS)
def test_built_in_hands(cli, name):
    """Check that the poses are within reach and limits, and have the same results when read from a file."""
    targets = trajectories.make(name)
    Path("t.csv").write_text(format_csv(targets))
    robot = ["--robot", trajectories.ROBOTS[name]] if name in trajectories.ROBOTS else []
    results = []
    for words in ([name], ["t.csv", *robot]):
        assert cli("--out", "o", "--trajectory", *words)[::2] == (0, [])
        assert not table("flags", "over_limit").any()
        results.append(Path("o/results.csv").read_bytes())
    assert results[0] == results[1]


@pytest.mark.cost(10)
def test_a_robot_in_the_rtl(command, tmp_path):
    """Check in Icarus that the ports get the robot's limits, which more than half of the poses exceed."""
    tight = urdf(tmp_path / "t.urdf", CHAINS["reversed"], limits=[(-0.2, 0.1)] * 7)
    points, q = Arm.from_urdf(tight).forward(np.random.default_rng(1).uniform(-0.2, 0.1, (9, 7)))
    write_poses(points, q, phi=np.linspace(-3, 3, 9), branch=np.zeros(9))
    words = "--trajectory", "t.csv", "--robot", str(tight), "--out", "o", "--width", "18", "--sim", "icarus"
    words += "--limits", "report"
    assert command(run.main, *words)[0] == 0
    (result,) = scores("o/score.json")
    assert (result["targets"], result["bit_mismatches"], result["passed"]) == (9, 0, True) and result["over_limit"] > 4


def test_progress_of_a_plan(cli, monkeypatch):
    """Check that progress counts rows and swivel angles while the paths of a file are planned."""
    calls = []

    def meter(name, total):
        return nullcontext(lambda *done: calls.append((name, total, *done)))

    monkeypatch.setattr(trajectory, "progress", meter)
    write_poses(*ROBOTS["iiwa14"].forward(SLOW), path=np.repeat((1, 2), 20))
    assert cli("--trajectory", "t.csv", "--robot", "iiwa14")[::2] == (0, [])
    planned = [("planning 40 rows", 40, n, "16 swivel angles") for n in (8, 12, 16, 20, 28, 32, 36, 40)]
    assert calls[: len(planned)] == planned


def test_rows_alone_name_their_jumps(cli):
    """Check that PLAN=rows plans each row alone, and that warnings name the rows that therefore jump."""
    arm = ROBOTS["iiwa14"]
    write_poses(*arm.forward(SLOW))
    words = "--trajectory", "t.csv", "--out", "o", "--robot", "iiwa14"
    assert cli(*words)[::2] == (0, [])
    assert table("step").max() <= 0.2
    assert scores("o/score.json")[0]["outcome"].startswith("pass: ")
    status, _, err = cli(*words, "--plan", "rows")
    warning = f"warn: targets that jump or have no joints: {np.count_nonzero(table('step') > 0.2)}; outside limits: 0"
    assert scores("o/score.json")[0]["outcome"].startswith(f"{warning}; error ")
    at = table(*arm.names)
    moved = np.abs(np.diff(at, axis=0)).max(axis=1)
    assert status == 0 and moved.max() > 0.2
    np.testing.assert_allclose(table("step")[1:, 0], moved, atol=1e-6)
    assert re.match(rf"warning: t.csv: row {2 + 1 + np.flatnonzero(moved > 0.2)[0]}: a joint moves by ", err[0])
