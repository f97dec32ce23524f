# SPDX-License-Identifier: Apache-2.0
"""Test scoring: compare each number of a score with a known error; check each reason to fail and the result files."""

import csv
import dataclasses
import io
import json
import math
import re

import numpy as np
import pytest

from model.bounds.tolerances import REGULAR
from model.io.files import read_csv
from model.io.flags import AT_SHOULDER, ON_AXIS, TOO_FAR, TOO_NEAR, expected_flags
from model.io.scoring import score, score_json, singular_distance, singular_distances, tables
from model.io.trajectories import make
from model.io.words import FIELDS, RESULT_FIELDS, Targets, from_words, result_values, to_words
from model.reference.equations import solve_clamped
from model.reference.kinematics import about, forward, multiply

ULP = 2.0**-30
SIDE = {"d1": 0.3, "d2": 0.3}  # an arm of equal lengths (m)


class Case:
    """Trajectory and results of an ideal core: double-precision poses rounded to words. Tests corrupt the results."""

    def __init__(self, targets, width=32, predicted=1e-6):
        self.targets, self.width = targets, width
        self.words, self.exponent = to_words(targets, width)
        asked = from_words(self.words, 0, width, targets.name)
        pose = solve_clamped(*(getattr(asked, field) for field in FIELDS))
        exact = np.column_stack([pose[field] for field in RESULT_FIELDS])
        self.results = np.rint(np.ldexp(exact, width - 2)).astype(np.int64)
        self.flags = expected_flags(self.words, width)
        self.predicted = np.full(len(targets), predicted)
        self.latency_cycles, self.total_cycles = 400, 400 + len(targets)
        self.bit_mismatches, self.first_mismatch = 0, None

    def score(self, tolerance=None):
        core = {"width": self.width, "datapath": "paper", "simulator": "icarus", "predicted": self.predicted}
        return score(self.targets, self.words, self.exponent, self, tolerance=tolerance, **core)

    def turn_shoulder(self, n, angle):
        """Turn the core's shoulder at target n by `angle` (rad) about the z axis."""
        turned = multiply(about(2, angle), np.ldexp(self.results[n, :4].astype(float), 2 - self.width))
        self.results[n, :4] = np.rint(np.ldexp(turned, self.width - 2))


@pytest.fixture
def case():
    return Case(make("reach"))


def arm(x, y=0.0, z=0.0, phi=3.0, d1=0.33, d2=0.27):
    return Targets("arm", x, y, z, phi, d1, d2)


@pytest.mark.parametrize(
    ("pose", "distance", "nearest"),
    [
        # Elbow at (0, 0, 0.3): the wrist and both half angles are pi/4 or more away.
        ({"x": 0.3, "z": 0.3, "phi": 0.0, **SIDE}, 0.0, "elbow on the z axis"),
        # Elbow at (0.3, 0, 0), right below the wrist, so theta_4 = pi/2; azimuth 0 and phi = pi give theta_3 = pi/2.
        ({"x": 0.3, "z": 0.3, "phi": np.pi, **SIDE}, np.pi / 4, None),
        # The same pose turned to azimuth 90 - 34.4 degrees: theta_3 / 2 is 0.3 rad from pi/2.
        ({"x": 0.3 * math.sin(0.6), "y": 0.3 * math.cos(0.6), "z": 0.3, "phi": np.pi, **SIDE}, 0.3, "theta_3 = pi"),
        ({"x": 0.4 * math.sin(0.1), "z": -0.4 * math.cos(0.1)}, 0.1, "wrist on the z axis"),
        # Elbow angles of pi - 0.2 and 0.2.
        ({"x": math.sqrt(2 * 0.3**2 * (1 + math.cos(0.2))), "phi": np.pi, **SIDE}, 0.1, "straight arm"),
        ({"x": math.sqrt(2 * 0.3**2 * (1 - math.cos(0.2))), "phi": np.pi / 2, **SIDE}, 0.1, "closed elbow"),
        ({"x": 0.7}, 0.0, "straight arm"),
        ({"x": 0.01}, 0.0, "closed elbow"),
    ],
)
def test_singular_distance(pose, distance, nearest):
    assert singular_distance(arm(**pose)) == pytest.approx([distance], abs=1e-7)
    distances = singular_distances(arm(**pose))
    assert nearest is None or min(distances, key=lambda name: distances[name][0]) == nearest


@pytest.mark.parametrize("name", ["reach", "two_arms", "unequal_arms"])
def test_an_ideal_core_passes(name):
    result = Case(make(name)).score()
    assert result.failures == () and result.passed
    assert result.targets == len(result.per_target.hand_error) == 100
    assert 0 < result.hand_error_rms < result.hand_error_max == result.per_target.hand_error.max()
    for figure in ("hand", "shoulder_angle", "elbow_angle", "elbow_point", "norm"):
        assert 0 < getattr(result, f"{figure}_error_max") < 4 * ULP, figure
    assert result.angle_error_max == max(result.shoulder_angle_error_max, result.elbow_angle_error_max)
    assert result.clamped_error_max is None and result.clamped_error_tolerance is None
    assert result.flagged == 0
    assert result.hand_error_over_tolerance == pytest.approx(result.hand_error_max / REGULAR)
    assert (result.latency_cycles, result.total_cycles, result.results_per_cycle) == (400, 500, 1.0)


def test_hand_error_is_measured_at_the_users_target():
    """Check that rounding a target to its word counts as an error, for targets 0.4 ulp from their words."""
    words, exponent = to_words(make("reach"), 16)
    on_grid = from_words(words, exponent, 16, "reach")
    aside = dataclasses.replace(on_grid, x=on_grid.x + 0.4 * 2.0 ** (-14 - exponent))
    case = Case(aside, width=16, predicted=1e-3)
    np.testing.assert_array_equal(case.words, words)
    values = result_values(case.results, 16)
    _, wrist = forward(values[:, :4], values[:, 4:], aside.d1, aside.d2)
    from_aside, from_grid = (np.linalg.norm(wrist - t.position, axis=1) / t.reach for t in (aside, on_grid))
    np.testing.assert_allclose(case.score().per_target.hand_error, from_aside, rtol=1e-9)
    assert np.abs(from_aside - from_grid).max() > 1e-6


def test_a_turned_shoulder_shows_its_angle(case):
    n, angle = 40, 1e-5
    case.turn_shoulder(n, angle)
    result = case.score()
    t = case.targets
    assert result.shoulder_angle_error_max == pytest.approx(angle, rel=1e-3)
    assert result.elbow_angle_error_max < 4 * ULP
    assert result.per_target.hand_error[n] == pytest.approx(angle * math.hypot(t.x[n], t.y[n]) / 0.6, rel=1e-3)
    assert result.per_target.hand_error.argmax() == n
    assert result.hand_error_rms == pytest.approx(result.hand_error_max / 10, rel=1e-2)
    elbow = solve_clamped(*(getattr(t, field)[n] for field in FIELDS))
    off_axis = math.hypot(elbow["p_e_x"][0], elbow["p_e_y"][0])
    assert result.elbow_point_error_max == pytest.approx(angle * off_axis / 0.6, rel=1e-3)
    assert result.passed


def test_signs_and_units_do_not_matter(case):
    before, t = case.score(), case.targets
    case.results[:, :4] *= -1
    case.results[::2, 4:] *= -1
    after = case.score()
    assert (after.hand_error_max, after.angle_error_max) == (before.hand_error_max, before.angle_error_max)
    scaled = Case(Targets("reach", *(2.0**400 * t.position.T), t.phi, 2.0**400 * t.d1, 2.0**400 * t.d2)).score()
    assert scaled.scale_exponent == before.scale_exponent - 400
    np.testing.assert_array_equal(before.per_target.hand_error, scaled.per_target.hand_error)


def stretch(case, columns):
    case.results[60, columns] += np.rint(2e-6 * case.results[60, columns]).astype(np.int64)


@pytest.mark.parametrize(
    ("spoil", "text"),
    [
        (lambda case: setattr(case, "bit_mismatches", 3), "3 bits differ"),
        (lambda case: np.put(case.flags, [3, 5], TOO_NEAR), "target 3 has too_near instead of -"),
        (lambda case: stretch(case, slice(0, 4)), "of Qs"),
        (lambda case: stretch(case, slice(4, 6)), "of Qe"),
        (lambda case: case.turn_shoulder(99, 4e-4), "at target 99 is"),
    ],
)
def test_each_fault_fails_and_is_named(case, spoil, text):
    spoil(case)
    result = case.score()
    assert not result.passed and any(text in failure for failure in result.failures), result.failures


def near_the_axis(*polar, **options):
    """Return a trajectory whose wrists are at polar angles (rad) off the z axis."""
    return Case(arm(0.4 * np.sin(polar), z=0.4 * np.cos(polar)), **options)


def test_tolerance_by_regularity_word_length_and_request(case):
    """Check that at W = 32 the tolerance applies if all targets are 0.2 rad or more from singular poses, and that the
    user's tolerance replaces it; check the text about the worst target's pose."""
    for distance, width, tolerance in ((0.19, 32, None), (0.21, 32, REGULAR), (0.21, 31, None)):
        result = near_the_axis(1.0, distance, width=width).score()
        assert result.passed and result.singular_distance_min == pytest.approx(distance)
        assert result.hand_error_tolerance == tolerance
        assert (result.hand_error_over_tolerance is None) == (tolerance is None)
    case.turn_shoulder(99, 4e-4)
    assert not case.score().passed and case.score(tolerance=1e-3).passed
    near = near_the_axis(1.0, 0.05, 1.2)
    assert not near.score(tolerance=1e-12).passed and near.score(tolerance=1e-6).passed
    near.turn_shoulder(1, 1e-2)
    result = near.score()
    assert (result.hand_error_target, result.hand_error_pose) == (1, "0.050 rad from singular: wrist on the z axis")


def test_clamped_targets_are_judged_apart():
    case = Case(arm([0.3, 0.7, 0.01], y=[0.1, 0.1, 0.0]))
    assert case.flags.tolist() == [0, TOO_FAR, TOO_NEAR]
    result = case.score()
    assert result.passed and result.flagged == 2
    assert re.match("warn: .*; 2 of 3 targets out of reach, solved by the nearest pose; error ", result.outcome)
    # hand_error is the distance to the target itself; the score uses the nearest reachable point.
    assert result.per_target.hand_error[1] == pytest.approx(math.hypot(0.7, 0.1) / 0.6 - 1, rel=1e-6)
    assert result.per_target.hand_error[2] == pytest.approx(0.05 / 0.6, rel=1e-6)
    assert result.hand_error_max == result.per_target.hand_error[0] < 1e-8
    assert result.clamped_error_max < 1e-8
    assert result.hand_error_tolerance is None and result.clamped_error_tolerance is None

    straight = Case(arm([0.6 + 1e-9])).score(tolerance=1e-8)
    assert straight.flagged == 1 and straight.outcome.startswith("pass: ")

    case.turn_shoulder(1, 1e-3)
    assert case.score().passed
    result = case.score(tolerance=1e-6)
    assert result.hand_error_tolerance == result.clamped_error_tolerance == 1e-6
    assert result.hand_error_max < 1e-8 and result.angle_error_max < 1e-8
    assert result.clamped_error_max == pytest.approx(1e-3, rel=1e-2)
    assert "error of the clamped hand 0.001 at target 1" in result.failures[0]


def test_no_reachable_target_and_targets_at_the_poles():
    result = Case(arm([0.7, 0.8])).score()
    assert result.passed
    for figure in ("hand_error_max", "hand_error_rms", "angle_error_max", "hand_error_target", "hand_error_pose"):
        assert getattr(result, figure) is None
    assert json.loads(score_json([result]))[0]["hand_error_max"] is None
    case = Case(arm([0.0, 0.0, 0.0], z=[0.4, -0.4, 0.0], d2=[0.27, 0.27, 0.33]))
    assert case.flags.tolist() == [ON_AXIS, ON_AXIS, ON_AXIS | AT_SHOULDER]
    assert case.score().passed and case.score().hand_error_max < 1e-8


def test_lost_rows_and_predictions_without_bound_are_refused(case):
    for value in (math.inf, math.nan, 0.0):
        case.predicted[3] = value
        with pytest.raises(ValueError, match="not positive and finite"):
            case.score()
    for name in ("predicted", "flags", "results", "words"):
        setattr(case, name, getattr(case, name)[:-1])
        with pytest.raises(ValueError, match=f"{name} has shape"):
            case.score()


def test_results_file_gives_every_bit_back_and_can_be_read_again(tmp_path):
    """Check also that other columns of the target file are kept, unless a result has the same name."""
    case = Case(make("two_arms"))
    others = {"t": [str(n) for n in range(100)], "na,me": ["x;y"] * 100, "flags": ["?"] * 100}
    case.targets = dataclasses.replace(case.targets, others=others)
    case.flags[2] = ON_AXIS
    result = case.score()
    path, contents = tmp_path / "results.csv", tables(case.targets, case, result)
    path.write_bytes(contents[".csv"])
    with path.open(encoding="utf-8", newline="") as file:
        header, *rows = csv.reader(file)
    fields = "n,x,y,z,phi,d1,d2,qs_w,qs_i,qs_j,qs_k,qe_w,qe_i,flags,hand_error,elbow_x,elbow_y,elbow_z,t,na,me"
    assert ",".join(header) == fields
    points = np.ldexp(result.per_target.elbow, -result.scale_exponent)
    expected = [np.arange(100), *(getattr(case.targets, f) for f in FIELDS), *np.ldexp(case.results, -30).T]
    expected += [case.flags, result.per_target.hand_error, *points.T]
    np.testing.assert_array_equal(np.array([row[:18] for row in rows], dtype=np.float64), np.column_stack(expected))
    assert rows[2][13] == "4" and b"\r" not in path.read_bytes()
    arrays = np.load(io.BytesIO(contents[".npz"]))
    elbow, wrist = forward(arrays["qs"], arrays["qe"], arrays["d1"], arrays["d2"])
    np.testing.assert_allclose(elbow, arrays["elbow"], atol=1e-9)
    np.testing.assert_allclose(wrist, arrays["wrist"], atol=1e-9)
    np.testing.assert_array_equal(arrays["points"], case.targets.position)
    again = read_csv(path)
    assert again.default_arm == () and [again.others[name] for name in ("t", "na,me")] == [*others.values()][:2]
    assert tables(again, case, result)[".csv"] == contents[".csv"]
