# SPDX-License-Identifier: Apache-2.0
"""Test the report without a browser: its data against scores, clips and geometry, and its files and command line.

The bit-true model replaces the simulator. browser_test_report.py tests the opened page.
"""

import csv
import html
import json
import re
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from model.bounds import tolerances
from model.io import trajectories
from model.io.files import format_csv
from model.io.words import JOINTS
from model.motion import clip as clips
from model.motion.arms import ROBOTS
from model.motion.tests import figure
from model.reference.kinematics import angle_between, conjugate, forward, rotate
from scripts import run
from scripts.report import __main__ as report
from tb.sim.env import ROOT

PAGE = Path("build/report/report.html")


@pytest.fixture
def cli(simulator, command):
    return partial(command, report.main)


def data_in(path, key="trajectories"):
    """Return entry `key` of a page's data. As in a browser, the data end at the first `</script`."""
    text = Path(path).read_text(encoding="utf-8")
    (content,) = re.findall(r'<script type="application/json" id="data">(.*?)</script', text, re.S)
    return json.loads(content)[key]


@pytest.fixture
def shown(cli):
    """Return a function that writes a page and returns the data of its only trajectory."""

    def shown(*options):
        assert cli(*options)[0] == 0
        (one,) = data_in(PAGE)
        return one

    return shown


def test_data_agree_with_the_score(cli, command, simulator):
    """Plots have the maxima in score.json. Elbow and wrist follow from the quaternions and lie in the swivel plane."""
    assert cli("--trajectory", "all") == (0, [f"wrote {PAGE}"], [])
    assert len(simulator.calls) == 1 and PAGE.stat().st_size < 2_000_000
    command(run.main, "--trajectory", "all", "--datapath", "lean")
    scores = json.loads(Path("build/run/score.json").read_text())
    for shown, score in zip(data_in(PAGE), scores, strict=True):
        assert shown["name"] == score["trajectory"]
        clamped = np.array(shown["clamped"])
        in_reach = {"hand": "hand_error_max", "predicted": "hand_error_predicted"}
        in_reach |= {f"{joint}Angle": f"{joint}_angle_error_max" for joint in ("shoulder", "elbow")}
        cases = [(key, ~clamped, figure_of) for key, figure_of in in_reach.items()]
        for key, where, figure_of in [*cases, ("hand", clamped, "clamped_error_max")]:
            most = np.array(shown[key])[where].max() if where.any() else None
            assert most == (score[figure_of] and pytest.approx(score[figure_of], rel=1e-6)), (shown["name"], figure_of)
        same = {"tolerance": "hand_error_tolerance", "outcome": "outcome", "cycles": "total_cycles"}
        assert {key: shown[key] for key in same} == {key: score[figure_of] for key, figure_of in same.items()}
        joints = forward(shown["qs"], shown["qe"], *np.transpose(shown["lengths"]))
        np.testing.assert_allclose(joints, (shown["elbow"], shown["wrist"]), atol=1e-6)
        for point in ("elbow", "wrist"):
            assert np.abs((np.array(shown["normal"]) * shown[point]).sum(axis=1)).max() < 1e-5, (shown["name"], point)
        assert shown["name"] != "out_of_reach" or clamped.sum() == 48 and {*shown["flags"]} == {"too_far", "-"}


def test_several_datapaths(cli, command, simulator):
    """Each datapath has its own simulation and results; its files equal those that `make run` writes."""

    def spoil(run):
        if simulator.calls[-1]["datapath"] == "paper":
            run.results[30, 1] += 2**14

    simulator.spoil = spoil
    status, _, errors = cli("--datapath", "lean,paper")
    assert status == 1 and len(errors) == 1 and errors[0].startswith("report, paper datapath: reach fails: ")
    (first,) = data_in(PAGE)
    (second,) = first["beside"]
    assert (first["tolerance"], second["tolerance"]) == (tolerances.LEAN[32], tolerances.REGULAR)
    assert (first["passed"], second["passed"]) == (True, False)
    off = np.abs(np.array(second["wrist"]) - first["wrist"]).max(axis=1)
    assert np.flatnonzero(off > 1e-6).tolist() == [30]
    for datapath in ("lean", "paper"):
        command(run.main, "--datapath", datapath, "--out", datapath)
        assert (PAGE.parent / datapath / "results.csv").read_bytes() == Path(datapath, "results.csv").read_bytes()
    names = [f"{datapath}/results.{kind}" for datapath in ("lean", "paper") for kind in ("csv", "npz")]
    assert data_in(PAGE, "files") == {"reach": names, "": ["score.json"]}


def test_hands_of_a_robot(shown):
    """Points, orientations, joints and limits are right. The arcs contain exactly the swivel angles at which no joint
    exceeds its limits."""
    poses = trajectories.make("pick_and_place")
    poses = replace(poses, phi=np.linspace(-3, 3, 100), others=poses.others | {"branch": ["0"] * 100})
    Path("t.csv").write_text(format_csv(poses))
    data = shown("--trajectory", "t.csv", "--robot", "iiwa14", "--limits", "report", "--rate", "50")
    assert sum(row[0].startswith("largest speed of A") for row in data["figures"]) == 7
    hands, arm, run = data["hands"], ROBOTS["iiwa14"], np.load(PAGE.parent / "results.npz")
    results = list(csv.DictReader((PAGE.parent / "results.csv").open(encoding="utf-8")))
    np.testing.assert_allclose(hands["goal"], poses.position - arm.base, atol=1e-6)
    np.testing.assert_allclose(hands["point"], hands["goal"], atol=1e-6)
    assert angle_between(np.array(hands["turn"]), poses.hand).max() < 1e-4
    along = np.array(hands["point"]) - data["wrist"]
    np.testing.assert_allclose(along, rotate(np.array(hands["turn"]), arm.tool), atol=1e-5)
    degrees = np.degrees(np.column_stack([run[name] for name in hands["names"]]))
    np.testing.assert_allclose(hands["joints"], degrees, rtol=1e-4)
    np.testing.assert_allclose(hands["limits"], np.degrees(arm.limits), rtol=1e-4)
    over = np.array(hands["over"])
    assert (over[:, None] >> np.arange(7) & 1 == run["over_limit"]).all() and 20 < np.count_nonzero(over) < 80
    assert hands["free"] == [arcs[0] for arcs in hands["arcs"]]
    branch, turns = np.arange(100) % 8, np.random.default_rng(2).uniform(-np.pi, np.pi, 100)
    outside = arm.solve(poses.position, poses.hand, turns, branch).over_limit.any(axis=1)
    for n, (own, turn_of) in enumerate(zip(hands["arcs"], np.degrees(turns)[:, None] + (0, 360), strict=True)):
        inside = any(low < one < high for low, high in own[branch[n]] for one in turn_of)
        assert inside != outside[n], n
    step = np.array([float(row["step"]) for row in results])
    np.testing.assert_allclose(np.array(hands["steps"], dtype=float), step, rtol=1e-3)
    jumps = np.flatnonzero(~(step <= hands["most"])).tolist()
    assert hands["jumps"] == jumps and 20 < len(jumps)
    shown_jumps = [row[1] for row in data["figures"] if row[0] == "rows that jump or have no joints"]
    assert shown_jumps == [", ".join(str(n + 2) for n in jumps[:12]) + f" and {len(jumps) - 12} more"]
    np.testing.assert_array_equal(hands["error"], [float(f"{error:.3g}") for error in run["orientation_error"]])


@pytest.mark.parametrize(("datapaths", "names"), [("lean", ["arm"]), ("lean,fold", ["arm", "fold_arm"])])
def test_hands_on_the_datapaths(shown, simulator, datapaths, names):
    """Hand poses run on the whole arm of each datapath. Joints have the robot's names and are within its limits."""
    data = shown("--trajectory", "pick_and_place", "--datapath", datapaths, "--rate", "10")
    runs = [data, *data["beside"]]
    assert [run["datapath"] for run in runs] == names
    assert [call["datapath"] for call in simulator.calls] == [name.replace("arm", "choose") for name in names]
    assert all(run["passed"] and run["figures"][-1][0].startswith("largest speed of A7") for run in runs)
    assert data["hands"]["names"] == list(ROBOTS["iiwa14"].names) and not any(data["hands"]["over"])


def test_hands_without_a_robot(shown):
    """Joints are th1 to th7 and have no limits; a clip's hands are part of the drawn figure."""
    figure.write(Path("t.bvh"), frames=9)
    for name in ("writing", "t.bvh"):
        data = shown("--trajectory", name)
        assert data["hands"]["names"] == list(JOINTS) and data["hands"]["limits"] == [[None, None]] * 7
        assert (data["hands"]["free"], data["predicted"]) == (None, None)
        assert ("point" in data["hands"]) == (name == "writing")
    assert shown("--trajectory", "circle")["hands"] is None


def test_arms_and_units_of_a_file(shown):
    """Up to four arms are drawn; coordinates are in the file's unit; entities of the paper's figures have no unit."""
    for count, arms in ((4, [0, 1, 2, 3]), (5, [0] * 5)):
        Path("t.csv").write_text("x,y,z,d1\n" + "".join(f"0.2,0.1,0.1,{0.3 + k / 100}\n" for k in range(count)))
        assert shown("--trajectory", "t.csv")["arm"] == arms
    rows = []
    for unit in (1e-9, 1.0, 1e3, 1e150):
        Path("t.csv").write_text(f"x,y,z,d1,d2\n{0.3 * unit},{0.1 * unit},{0.2 * unit},{0.33 * unit},{0.27 * unit}\n")
        data = shown("--trajectory", "t.csv")
        np.testing.assert_allclose(data["wrist"], np.array([[0.3, 0.1, 0.2]]) * unit, rtol=1e-5)
        rows.append(np.concatenate([values.ravel() for values in numbers(data["paper"]).values()]))
        np.testing.assert_allclose(rows[-1], rows[0], atol=3e-4)


def test_the_page_is_self_contained_and_reproducible(cli, shown, tmp_path):
    """Markup in a name is shown as text; the page contains no local path; the same run writes the same bytes."""
    name = """<!--<script>&"'{{links}}{{x}}\u2028.csv"""
    Path(name).write_text("x,y,z\n0.3,0.1,-0.2\n")
    assert shown("--trajectory", str(tmp_path / name))["name"] == name[:-4]
    text = PAGE.read_text(encoding="utf-8")
    assert f"<title>CGA-IK: {html.escape(name[:-4])}</title>" in text
    assert text.count("<script") == 2 and text.count("</script>") == 2 and "<!--" not in text
    assert str(ROOT) not in text and str(tmp_path) not in text
    assert cli("--trajectory", name)[0] == 0 and PAGE.read_text(encoding="utf-8") == text


@pytest.mark.parametrize(("up", "phi", "still"), [("x", "clip", False), ("y", "1.5", True), ("z", "clip", True)])
def test_the_figure_is_that_of_the_turned_clip(shown, up, phi, still):
    mine = clips.read(figure.write(Path("t.bvh").absolute(), up=up, frames=40))
    height = 2 if up == "z" else 1
    if still:  # it neither climbs nor flies
        mine.table[:, height] *= 0.01
        Path("t.bvh").write_bytes(mine.content())
        mine = clips.read(Path("t.bvh").absolute())
    data = shown("--trajectory", "t.bvh", "--phi", phi)
    clip = data["clip"]
    turn, unit = np.array(clip["place"]), clip["unit"]
    nodes, limbs = (unit * np.reshape(clip[key], (40, -1, 3)) for key in ("nodes", "own"))
    root = nodes[:, :1].copy()
    nodes[:, 1:], limbs = nodes[:, 1:] + root, limbs + root
    assert np.linalg.det(turn) == pytest.approx(1) and turn[2][height] == 1
    turned = clips.read(PAGE.parent / "clip.bvh")
    np.testing.assert_allclose(nodes, turned.positions @ turn.T, atol=2 * unit)
    for n, (arm, names) in enumerate(zip(clips.arms(mine), clip["arms"], strict=True)):
        for k, (part, point) in enumerate((("fore", "elbow"), ("hand", "wrist"))):
            theirs = mine.positions[:, getattr(arm, part)] @ turn.T
            np.testing.assert_allclose(limbs[:, 2 * n + k], theirs, atol=2 * unit)
            core = np.array(data[point])[n::2] @ turn.T
            np.testing.assert_allclose(nodes[:, names[part]] - nodes[:, names["upper"]], core, atol=3 * unit)
        assert clip["parts"][names["fore"]] == report.UPPER and clip["parts"][names["hand"]] == report.FORE
    assert clip["parts"].count(report.UPPER) == 2 and clip["parts"].count(report.FORE) == 2
    moved = np.linalg.norm(limbs[:, 0] - nodes[:, clip["arms"][0]["fore"]], axis=1).max()
    assert moved > 0.1 if phi == "1.5" else moved < 3 * unit
    assert (np.array(data["elbowError"]).max() > 0.1) == (phi == "1.5")

    assert clip["rate"] == pytest.approx(120, rel=1e-4) and data["arm"] == [0, 1] * 40
    low, high = nodes[..., 2].min(), nodes[..., 2].max()
    centre, middle = nodes[:, :1].copy(), (low + high) / 2 if still else None
    if still:
        centre[..., 2] = middle
    far = np.linalg.norm(np.concatenate((nodes, limbs), axis=1) - centre, axis=2).max()
    for key, expected in (("floor", low), ("middle", middle), ("radius", far)):
        assert clip[key] == (expected and pytest.approx(expected, abs=2 * unit)), key


@pytest.mark.parametrize("axis", ["torso", "0.3,1,0"])
def test_joint_angles(shown, axis):
    """Compare azimuth and elevation of the upper arm in the torso's frame, and the elbow's flexion, with the bones."""
    mine = clips.read(figure.write(Path("t.bvh").absolute(), up="z", frames=40))
    data = shown("--trajectory", "t.bvh", f"--axis={axis}")
    elbow, wrist, angles = (np.array(data[key]) for key in ("elbow", "wrist", "angles"))
    for n, arm in enumerate(clips.arms(mine)):
        e, w = elbow[n::2], wrist[n::2]
        azimuth, elevation, phi, flexion = np.radians(angles[n::2]).T
        bend = np.arccos(np.sum(e * (w - e), axis=1) / figure.UPPER / figure.FORE)
        np.testing.assert_allclose(flexion, bend, atol=2e-4)
        seen = rotate(conjugate(mine.turn[:, arm.torso]), e) / figure.UPPER  # x right, y forward, z up
        ours = np.stack((-np.cos(elevation) * np.sin(azimuth), np.cos(elevation) * np.cos(azimuth), np.sin(elevation)))
        np.testing.assert_allclose(ours.T, seen, atol=2e-4)
        np.testing.assert_allclose(phi, np.array(data["phi"])[n::2], atol=1e-3)


TURNS = ("folded", "rest", "half", "middle", "yz2", "theta4", "theta3")


def numbers(entities):
    """Return a dict: name of an entity on the page -> vectors (N, 3), or angles or lengths (N,); nan if undefined."""
    return {name: np.array(values, dtype=float) for named in entities for name, values in named.items()}


def turn(v, axis, angle):
    """Rotate v about an axis by an angle, right-handed."""
    unit = axis / np.linalg.norm(axis, axis=1, keepdims=True)
    return Rotation.from_rotvec(np.reshape(angle, (-1, 1)) * unit).apply(v)


def assert_near(a, b, what):
    assert np.abs(a - b).max() < 3e-4, what


@pytest.mark.parametrize(
    ("name", "axis"),
    [("reach", "z"), ("out_of_reach", "z"), ("two_arms", "-z"), ("circle", "0.3,1,0"), ("t.bvh", "torso")],
)
def test_each_figure_leads_to_the_next(shown, name, axis):
    """Each entity, rotated by the drawn angle, gives the next entity; the drawn elbow equals the core's result."""
    figure.write(Path("t.bvh"), frames=40)
    data = shown("--trajectory", name, f"--axis={axis}")
    e, lengths = numbers(data["paper"]), np.array(data["lengths"])
    reach = lengths.sum(axis=1, keepdims=True)
    wrist, (upper, fore) = np.array(data["target"]) / reach, (lengths / reach).T
    assert_near(e["along"], wrist / np.linalg.norm(wrist, axis=1, keepdims=True), "L_sw")
    assert_near(turn(e["vertical"], e["along"], np.array(data["phi"])), e["swivel"], "figure 1")
    ok = np.isfinite(e["elbow"]).all(axis=1)
    assert ok.tolist() == [not clamped for clamped in data["clamped"]]
    for missing in ("other", "radius", *TURNS):
        assert (np.isfinite(e[missing]).reshape(len(ok), -1).all(axis=1) == ok).all(), missing
    e = {key: value[ok] for key, value in e.items()}
    wrist, upper, fore, elbow = wrist[ok], upper[ok], fore[ok], (np.array(data["elbow"]) / reach)[ok]
    assert_near(e["elbow"], elbow, "the core's elbow")
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


def test_entities_are_undefined_at_singular_poses(shown):
    """The targets: wrist on the axis, arm straight, out of reach, wrist at the shoulder, elbow on the axis."""
    Path("t.csv").write_text("x,y,z,phi\n0,0,0.5,1\n0.6,0,0,1\n0.6,0.6,0,1\n0,0,0,1\n0.27,0,0.33,0\n")
    e = numbers(shown("--trajectory", "t.csv")["paper"])
    has = {name: np.isfinite(value).reshape(5, -1).all(axis=1).tolist() for name, value in e.items()}
    assert has["swivel"] == [False, True, True, False, True]
    assert has["radius"] == [True, True, False, False, True]
    assert has["elbow"] == has["other"] == [False, True, False, False, True]
    assert all(has[name][:4] == [False, True, False, False] for name in TURNS)
    assert e["radius"][1] < 1e-4
