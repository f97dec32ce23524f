# SPDX-License-Identifier: Apache-2.0
"""Test `make run`: files, tables, failures and clips with the fake simulator; scores with the RTL."""

import csv
import json
import re
from functools import cache
from pathlib import Path

import numpy as np
import pygltflib
import pytest

from model.bounds import tolerances
from model.dataflow.datapaths import DATAPATHS
from model.io import trajectories
from model.io.words import JOINTS
from model.motion import clip as clips
from model.motion.pose import soft_reach, solve
from model.motion.tests import figure
from model.reference.joints import reached
from model.reference.kinematics import angle_between, multiply, rotate
from scripts import console, run
from scripts.fpga.designs import clock, load
from scripts.generate import pages
from tb.sim import simulate
from tb.sim.env import cores
from tb.sim.env import simulator as simulator_of_tests


def scores(path="build/run/score.json"):
    return json.loads(Path(path).read_text(encoding="utf-8"))


def test_the_scenario_of_the_paper_runs_on_both_datapaths(cli, simulator, files):
    status, out, err = cli()
    assert (status, err) == (0, [])
    names = [f"build/run/{d}/results.{kind}" for d in ("lean", "paper") for kind in ("csv", "npz")]
    assert files() == [*names, "build/run/score.json"] and out[-5:] == [f"wrote {name}" for name in files()]
    for call, score, datapath in zip(simulator.calls, scores(), ("lean", "paper"), strict=True):
        assert (call["datapath"], [len(job) for job in call["jobs"]]) == (datapath, [100])
        assert (score["datapath"], score["targets"], score["passed"]) == (datapath, 100, True)
    table = {line[:41].strip(): line[41:].split() for line in out if line.startswith(" ")}
    assert table["latency (clocks)"] == ["~550", "44", "44"]
    assert table["until the last (us)"] == ["6", f"{144 / clock(load(), 'lean', 32):.2f}", "-"]


def test_options_reach_the_simulator(cli, simulator, files):
    words = "--sim verilator --width 24 --cores digit --out o --trajectory circle --waves"
    status, out, err = cli(*words.split())
    assert (status, err) == (0, [])
    (call,) = simulator.calls
    assert call.items() >= {"simulator": "verilator", "datapath": "lean", "width": 24, "cores": "digit"}.items()
    names = ["aligned.gtkw", "aligned.vcd", "results.csv", "results.npz", "score.json", "waves.gtkw", "waves.vcd"]
    assert files() == [f"o/{name}" for name in names]
    assert sorted(line for line in out if line.startswith("wrote ")) == [f"wrote {name}" for name in files()]


@pytest.mark.parametrize(
    ("words", "there", "simulator_used", "said"),
    [
        ("", True, "verilator", "by Verilator"),
        ("", False, "icarus", "could not be installed"),
        ("--sim verilator", False, "verilator", "by Verilator"),
        ("--sim icarus", True, "icarus", ""),
        ("--waves", True, "icarus", ""),
    ],
)
def test_many_targets_are_simulated_by_verilator(cli, simulator, monkeypatch, words, there, simulator_used, said):
    """Verilator is chosen if neither --sim nor --waves is given. A line on stderr names the simulator."""
    monkeypatch.setattr(console, "LONG", 100)
    monkeypatch.setattr(console, "installed", lambda need: there)
    status, _, err = cli("--trajectory", "circle", *words.split())
    assert (status, scores()[0]["simulator"], simulator.calls[0]["simulator"]) == (0, *[simulator_used] * 2)
    assert [line[:26] for line in err] == ["100 targets are simulated "] * bool(said) and said in "".join(err)


def test_all_trajectories_have_a_line_and_a_file_each(cli, simulator, files):
    status, out, err = cli("--trajectory", "all", "--waves")
    names, hands = list(trajectories.TRAJECTORIES), list(trajectories.HANDS)
    assert (status, err, len(simulator.calls)) == (0, [], 1)
    written = [f"build/run/{name}/results.{kind}" for name in names for kind in ("csv", "npz")]
    assert files() == sorted([*written, "build/run/score.json", "build/run/waves.gtkw", "build/run/waves.vcd"])
    assert [score["trajectory"] for score in scores()] == names
    ends = [(words[0], words[-1]) for line in out if (words := line.split()) and words[0] in names]
    assert ends == [(name, "warn" if name == "out_of_reach" else "pass") for name in names]
    assert "13 of 14 pass, 1 with targets out of reach" in "\n".join(out)
    assert [line.split()[0] for line in cli("--list")[1]] == names + hands


def test_columns_axis_and_length_unit_of_a_file(cli):
    """Check that results.csv has the file's frame, unit of length and other columns."""
    text = "\ufefft;X;y;Z;d2;note\r\n0,5;0,3;0,1;0,2;0,4;first\r\n\r\n1,0;0,3;0,1;-0,2;0,4;\r\n"
    Path("t.CSV").write_text(text, encoding="utf-8", newline="")
    assert cli("--trajectory", "t.CSV", "--axis=0.3,1,0", "--phi=-1e-1", "--d1", "0.5", "--d2", "9")[::2] == (0, [])
    rows = list(csv.DictReader(Path("build/run/results.csv").open(encoding="utf-8")))
    assert [(row["t"], row["note"]) for row in rows] == [("0,5", "first"), ("1,0", "")]
    assert {(row["phi"], row["d1"], row["d2"]) for row in rows} == {("-0.1", "0.5", "0.4")}
    pose = solve([(0.3, 0.1, 0.2), (0.3, 0.1, -0.2)], -0.1, d1=0.5, d2=0.4, axis=(0.3, 1, 0), width=32)
    np.testing.assert_allclose([[float(row[f"elbow_{axis}"]) for axis in "xyz"] for row in rows], pose.elbow)
    np.testing.assert_allclose([[float(row[f"qs_{unit}"]) for unit in "wijk"] for row in rows], pose.qs)


def test_quaternions_of_a_file_are_continuous_for_each_arm(cli):
    paths = np.linspace([(-0.3, 0.3, 0.2), (-0.1, -0.3, 0)], [(-0.2, 0.3, -0.4), (0.2, -0.2, -0.4)], 20)
    lines = [f"{x},{y},{z},{n % 2}" for n, (x, y, z) in enumerate(paths.reshape(-1, 3))]
    Path("t.csv").write_text("\n".join(["x,y,z,Arm", *lines]), encoding="utf-8")
    assert cli("--trajectory", "t.csv", "--axis=0,-1,1")[::2] == (0, [])
    results = np.load("build/run/results.npz")
    assert (np.sum(results["qs"][2:] * results["qs"][:-2], axis=1) > 0.9).all()
    np.testing.assert_allclose(results["phi"], 0.75 * np.pi, rtol=0, atol=1e-8)  # the elbow hangs


@pytest.mark.parametrize(
    ("content", "warning"),
    [
        ("x,y,z\n5,1,2\n0.1,0,0.3\n3,0,0\n", "2 of 3 targets are out of reach of an arm of 0.33 + 0.27 "),
        ("x,y,z,roll,pitch,yaw\n.3,.1,.2,0,90,1\n", "pitch reaches 90; its unit is the radian"),
        ("x,y,z,phi\n.3,.1,.2,90\n", "phi reaches 90; its unit is the radian"),
        ("x,y,z\n-.01,.001,.4\n.01,.001,.4\n", "the elbow jumps at row 3, because the wrist passes close to "),
        ("x,y,z,arm\n-.01,0,.4,L\n.3,.1,0,R\n.01,.001,.4,L\n", "the elbow jumps at row 4, because "),
    ],
)
def test_doubts_give_a_warning(cli, content, warning):
    Path("t.csv").write_text(content, encoding="utf-8")
    status, _, err = cli("--trajectory", "t.csv")
    assert (status, len(err)) == (0, 1) and err[0].startswith(f"warning: t.csv: {warning}")


def test_failures_name_trajectory_tolerance_and_node(cli, simulator):
    def spoil(*runs):
        run = dict(zip(trajectories.TRAJECTORIES, runs, strict=True))
        run["circle"].results[30, 0] += 2**20
        run["figure_eight"].bit_mismatches, run["figure_eight"].first_mismatch = 5, "target 3, node c4"

    simulator.spoil = spoil
    status, out, err = cli("--trajectory", "all")
    assert status == 1 and err[0].startswith("run: circle fails: hand error ")
    assert "at target 30 is " in err[0] and "times its tolerance 2e-08" in err[0]
    assert err[-1] == "run: figure_eight fails: 5 bits differ from the bit-true model; target 3, node c4"
    assert [score["trajectory"] for score in scores() if not score["passed"]] == ["circle", "figure_eight"]
    assert sum("FAIL" in line for line in out) == 2


def test_a_tolerance_is_applied(cli):
    status, _, err = cli("--tolerance", "1e-12")
    assert status == 1 and "times its tolerance 1e-12" in err[0]
    assert cli("--tolerance", "1e-4", "--datapath", "paper", "--trajectory", "punch")[0] == 0


def test_an_error_while_files_are_written_leaves_all_as_they_were(cli, simulator, files, monkeypatch):
    words = "--out", "o", "--waves", "--datapath", "lean"
    assert cli(*words)[0] == 0
    before = {path: Path(path).read_bytes() for path in files()}
    write = Path.write_bytes

    def write_bytes(path, content):
        write(path, content[:9])
        if path.name.endswith("score.json"):  # the last one
            raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", write_bytes)
    message = "run: cannot read or write 'o/score.json': No space left on device"
    assert cli(*words, "--trajectory", "circle") == (2, [], [message])
    assert {path: Path(path).read_bytes() for path in files()} == before


@pytest.fixture
def clip_cli(cli):
    """Return a function that runs t.bvh and checks that the written clip is unchanged; with --phi, arms may differ."""

    def run_clip(*options, limit=1e-6):
        answer = cli("--trajectory", "t.bvh", "--out", "o", *options)
        if answer[0] == 0:
            clip, free = clips.read(Path("t.bvh")), []
            for arm in clips.arms(clip) if "--phi" in options else ():
                free += [arm.fore, *(joint for joint in clip.ancestors(arm.fore) if joint >= arm.upper)]
            figure.compare("t.bvh", "o/clip.bvh", free, limit)
        return answer

    return run_clip


def off_plane(pole):
    """Return the largest distance between unit normals of the planes shoulder-wrist-elbow and shoulder-wrist-pole."""
    wrist, elbow = table("x", "y", "z"), table("elbow_x", "elbow_y", "elbow_z")
    normals = np.cross(wrist, elbow), np.cross(wrist, pole)
    one, other = (normal / np.linalg.norm(normal, axis=1)[:, None] for normal in normals)
    return np.abs(one - other).max()


def test_elbows_of_a_file_point_at_the_pole_and_the_reach_is_soft(cli):
    Path("t.csv").write_text("x,y,z,phi\n0.4,0.1,0.1,2\n0,0.6,0,1\n-0.1,0.2,-9,0\n", encoding="utf-8")
    words = "--trajectory", "t.csv", "--out", "o", "--axis=0,-1,1"
    assert cli(*words)[0] == 0
    wrists = table("x", "y", "z")
    warning = "warning: t.csv: POLE= overrides the column phi"
    assert cli(*words, "--pole", "50,-30,90", "--soft", "0.3")[::2] == (0, [warning])
    np.testing.assert_allclose(table("x", "y", "z"), soft_reach(wrists, *table("d1", "d2").T, 0.3), atol=1e-8)
    assert off_plane(np.array([50, -30, 90])) < 1e-5


def test_elbows_of_a_clip_point_at_a_joint(cli):
    clip = clips.read(figure.write(Path("t.bvh").absolute(), frames=3))
    assert cli("--trajectory", "t.bvh", "--out", "o", "--pole", "Hips")[0] == 0
    hips = clip.positions[:, clips.named(clip, "Hips")]
    assert off_plane((hips - clip.positions[:, [arm.upper for arm in clips.arms(clip)]]).reshape(-1, 3)) < 1e-5


def table(*names):
    return np.array([[float(row[name]) for name in names] for row in rows()])


def rows():
    with Path("o/results.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_both_arms(clip_cli, files):
    clip = clips.read(figure.write(Path("t.bvh").absolute(), frames=40))
    status, out, err = clip_cli("--axis=0.3,1,0")
    assert (status, err) == (0, [])
    names = ["clip.bvh", "clip.glb", "results.csv", "results.npz", "score.json"]
    assert files() == [*(f"o/{name}" for name in names), "t.bvh"]
    assert sorted(out[-5:]) == [f"wrote o/{name}" for name in names]
    table = rows()
    assert [(row["frame"], row["arm"]) for row in table] == [(str(n), arm) for n in range(40) for arm in clips.SIDES]
    for k, arm in enumerate(clips.arms(clip)):  # in the clip's frame
        elbow = clip.positions[:, arm.fore] - clip.positions[:, arm.upper]
        ours = np.array([[float(row[f"elbow_{letter}"]) for letter in "xyz"] for row in table[k::2]])
        error = np.linalg.norm(ours - elbow, axis=1) / (figure.UPPER + figure.FORE)
        np.testing.assert_allclose([float(row["elbow_error"]) for row in table[k::2]], error, atol=1e-12)
        assert np.median(error) < 1e-8


def test_constant_angle_is_the_mean_of_the_clip(clip_cli):
    clip = clips.read(figure.write(Path("t.bvh").absolute()))
    assert clip_cli("--phi", "constant")[0] == 0
    means = {arm.side: clips.motion(clip, arm).typical_phi for arm in clips.arms(clip)}
    assert {(row["arm"], float(row["phi"])) for row in rows()} == set(means.items())
    assert max(float(row["hand_error"]) for row in rows()) < 1e-6
    assert clip_cli("--phi", "0.5", "--arm", "left")[0] == 0
    assert {(row["arm"], row["phi"]) for row in rows()} == {("left", "0.5")}


def test_a_clip_with_more_channels_and_equal_names(clip_cli):
    """Test legs, equal names and position channels in all joints. A wrong frame count gives one warning."""
    path = figure.write(Path("t.bvh").absolute(), frames=9, rich=True, two_legs=True)
    text = path.read_text().replace("LeftShoulder", "Collar").replace("RightShoulder", "Collar")
    path.write_text(text.replace("Frames: 9", "Frames: 7"))
    status, _, err = clip_cli("--up=-y", "--scale", "cm", "--limb", "all", "--arm", "left")
    assert status == 0 and [line.partition(": ")[0] for line in err] == ["warning"]
    assert {row["arm"] for row in rows()} == {"left", "left leg"}
    assert max(float(row["elbow_error"]) for row in rows()) < 1e-6
    file = pygltflib.GLTF2().load("o/clip.glb")
    hips = next(node for node in file.nodes if node.name == "Hips")
    assert hips.translation == pytest.approx((0.005, 0.09, 0), abs=1e-9), "metres"
    assert abs(file.nodes[file.scenes[0].nodes[0]].rotation[2]) == 1, "upside down"


def test_the_score_of_a_clip_is_that_of_the_written_file(clip_cli, monkeypatch):
    figure.write(Path("t.bvh").absolute(), frames=9)
    turned = clips.turned

    def one_arm(clip, moves, twist):
        return turned(clip, [(move, np.roll(qs, 1, axis=0), *rest) for move, qs, *rest in moves], twist)

    monkeypatch.setattr(clips, "turned", one_arm)
    status, out, _ = clip_cli("--phi", "1")
    assert status == 1 and float(scores(Path("o/score.json"))[0]["hand_error_max"]) > 0.01


def test_hands_of_a_clip(clip_cli, simulator):
    """Check that written hands agree with the seven angles and are scored against the original clip's hands."""
    clip = clips.read(figure.write(Path("t.bvh").absolute(), frames=9))
    assert clip_cli("--phi", "1")[0] == 0
    assert (simulator.calls[0]["datapath"], simulator.calls[0]["limits"]) == ("arm", [(-(2**31), 2**31 - 1)] * 7)
    again, wanted, joints = clips.read(Path("o/clip.bvh")), table("qw", "qx", "qy", "qz"), table(*JOINTS)
    for k, (arm, other) in enumerate(zip(clips.arms(clip), clips.arms(again), strict=True)):
        hands, move = clips.hands(clip, arm), clips.motion(clip, arm)
        np.testing.assert_array_equal(wanted[k::2], hands)
        turn = angle_between(clips.hands(again, other), hands)
        np.testing.assert_allclose(table("orientation_error")[k::2, 0], turn, atol=1e-15)
        _, q = reached(joints[k::2].T, move.d1, move.d2, np.zeros((9, 3)))
        assert 0 < turn.max() < 2e-8 and angle_between(multiply(move.frame, hands), q).max() < 2e-8
        bone = clip.positions[:, arm.hand + 1] - clip.positions[:, arm.hand]
        np.testing.assert_allclose(rotate(hands, (0, 0, 0.5)), bone, atol=1e-6)
    simulator.spoil = lambda run: np.add.at(run.results[:, JOINTS.index("th6")], 4, 2**10)
    status, _, err = clip_cli()
    assert status == 1 and err[0].startswith("run: t fails: orientation error 1.5e-06 at target 4 ")


def test_options_of_a_clip(clip_cli, simulator):
    """Test --joints with unusual names, --twist core, and --datapath, which runs wrists without hands."""
    figure.write(Path("t.bvh").absolute(), "own", frames=9)
    words = "--arm", "right", "--joints", ",".join(figure.joints("own", "right")[1:])
    assert clip_cli(*words, "--datapath", "lean")[0] == 0
    assert {row["arm"] for row in rows()} == {"right"} and "th1" not in rows()[0]
    assert simulator.calls[0]["datapath"] == "lean"
    with pytest.raises(AssertionError, match="br"):
        clip_cli(*words, "--twist", "core")
    assert "choose one limb" in clip_cli(*words, "--limb", "all")[2][0]


def test_a_straight_arm_stays_straight(clip_cli):
    """Check that rounding does not bend the arms in the T pose, a clip's usual first frame."""
    clip = clips.read(figure.write(Path("t.bvh").absolute()))
    clip.table[:] = 0
    Path("t.bvh").write_bytes(clip.content())
    assert clip_cli("--width", "18", limit=1e-4)[::2] == (0, [])
    table = rows()
    assert {row["flags"] for row in table} == {"1"}, "asked to reach a little further than it can"
    assert max(float(row["elbow_error"]) for row in table) < 2e-5
    assert json.loads(Path("o/score.json").read_text())[0]["passed"]


def run_in(datapath, out, sim="icarus", trajectory="all"):
    """Run all trajectories, or one, through the RTL; return a dict: trajectory -> its score."""
    arguments = ["--trajectory", trajectory, "--datapath", datapath, "--out", str(out)]
    arguments += ["--sim", sim, "--cores", cores()]
    assert run.main(arguments) == 0
    return {score["trajectory"]: score for score in scores(out / "score.json")}


if simulator_of_tests() == "icarus":

    @pytest.fixture(scope="module")
    def outcome(tmp_path_factory):
        """Return a function that runs all trajectories on a datapath, once, and returns their scores."""
        return cache(lambda datapath: run_in(datapath, tmp_path_factory.mktemp(datapath)))

    @pytest.mark.sim
    @pytest.mark.cost(60)
    def test_every_trajectory_passes(outcome):
        passed = outcome("lean")
        assert list(passed) == list(trajectories.TRAJECTORIES)
        assert len({score["latency_cycles"] for score in passed.values()}) == 1
        for name, score in passed.items():
            assert (score["targets"], score["bit_mismatches"], score["results_per_cycle"]) == (100, 0, 1.0), name
            assert score["total_cycles"] == score["latency_cycles"] + 100, name
            assert score["hand_error_max"] <= score["hand_error_predicted"], name
            assert score["hand_error_tolerance"] == tolerances.LEAN[32], name

    @pytest.mark.sim
    @pytest.mark.slow
    def test_the_page_of_scores_is_up_to_date(outcome):
        page = pages.scores_page({name: list(outcome(name).values()) for name in DATAPATHS})
        heading = "## By region"  # sines of another processor may round the figures there differently
        (old, old_regions), (new, new_regions) = (text.split(heading) for text in (pages.SCORES.read_text(), page))
        number = re.compile(r"-?\b\d+\.?\d*(?:e[-+]?\d+)?\b")
        assert old == new and number.sub("0", old_regions) == number.sub("0", new_regions), "run `make docs`"
        figures, fresh = ([float(v) for v in number.findall(text)] for text in (old_regions, new_regions))
        assert figures == pytest.approx(fresh, rel=0.06), "run `make docs`"

else:

    @pytest.mark.sim
    @pytest.mark.parametrize("datapath", ["lean", pytest.param("paper", marks=pytest.mark.slow)])
    def test_icarus_and_the_native_harness_write_the_same_files(datapath, tmp_path, monkeypatch):
        """Set LONG to 0, so that even short files use Verilator's native harness."""
        monkeypatch.setattr(simulate, "LONG", 0)
        score, other = (run_in(datapath, tmp_path / sim, sim, "out_of_reach") for sim in ("icarus", "verilator"))
        assert score["out_of_reach"] == other["out_of_reach"] | {"simulator": "icarus"}
        one, other = ((tmp_path / sim / "results.csv").read_bytes() for sim in ("icarus", "verilator"))
        assert one == other
