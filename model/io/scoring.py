# SPDX-License-Identifier: Apache-2.0
"""Scores of a trajectory run through the core: errors, and whether they meet the tolerances.

* hand: compared with the user's target, so quantisation of the target counts as an error; forward kinematics gives the
  wrist from the core's quaternions or, for a hand pose, the hand's point and orientation from the joints
* angles and elbow point: compared with double precision at the core's input words
* hand of an unreachable target: compared with the hand of the clamped pose, reported separately

Lengths are scaled by the power of two from `words.scale_exponent` before they are squared, so the unit of length does
not matter.  Tolerances come from `model.bounds.tolerances`, unless the user requests an accuracy.
"""

import csv
import dataclasses
import io
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..bounds import tolerances
from ..dataflow import fixed
from ..dataflow.arm import outside
from ..dataflow.datapaths import MODELS
from ..dataflow.nodes import Limits
from ..reference.equations import solve_clamped
from ..reference.joints import reached
from ..reference.kinematics import angle_between, continuous, forward, rotate
from ..reference.lean_equations import solve_lean
from . import flags as flag_bits
from .words import FIELDS, JOINTS, RESULT_FIELDS, WRIST_FIELDS, Targets, from_words, limit_words, result_values


def singular_distances(targets: Targets) -> dict[str, np.ndarray]:
    """Return a dict: singularity of equations (10)-(18) -> distance (N,) of each target's pose from it, in rad.

    For wrist or elbow on the z axis the distance is the angle from the nearer half of the axis. For theta_3 and theta_4
    (elbow) it is the distance of the half angle from 0 or pi/2, where a square root in (14) or (17) is 0. Raises
    ValueError if a target in reach has lengths outside `equations.LENGTH_RANGE`.
    """
    pose = solve_clamped(targets.x, targets.y, targets.z, targets.phi, targets.d1, targets.d2)
    wrist = np.arctan2(np.hypot(targets.x, targets.y), np.abs(targets.z))
    elbow = np.arctan2(np.hypot(pose["p_e_x"], pose["p_e_y"]), np.abs(pose["p_e_z"]))
    # By (18), qs_w : qs_k = -q3_k : q3_scalar; with q12_k = 0 as well, the elbow is on the z axis.
    shoulder_half = np.arctan2(np.abs(pose["qs_w"]), np.abs(pose["qs_k"]))
    elbow_half = np.arctan2(np.abs(pose["qe_i"]), np.abs(pose["qe_w"]))
    return {
        "wrist on the z axis": wrist,
        "elbow on the z axis": elbow,
        "theta_3 = 0": shoulder_half,
        "theta_3 = pi": np.pi / 2 - shoulder_half,
        "closed elbow": elbow_half,
        "straight arm": np.pi / 2 - elbow_half,
    }


def singular_distance(targets: Targets) -> np.ndarray:
    """Return the distance (N,), rad, of each pose from the nearest singular pose; 0 for an unreachable target."""
    return np.min(list(singular_distances(targets).values()), axis=0)


def hand_errors(answers: np.ndarray, targets: Targets) -> np.ndarray:
    """Return the hand errors / reach (N,) of results (N, 6) in double precision."""
    _, wrist = forward(answers[:, :4], answers[:, 4:], targets.d1, targets.d2)
    return np.linalg.norm(wrist - targets.position, axis=1) / targets.reach


def model_errors(words: np.ndarray, width: int, datapath: str) -> tuple[np.ndarray, float]:
    """Solve reachable targets, words (N, 6), with the bit-true model of a datapath. Return the hand errors / reach (N,)
    and the largest difference (rad) of the shoulder's or elbow's rotation from double precision."""
    values = result_values(fixed.run(words, width, datapath).results, width)
    asked = from_words(words, 0, width, "words")
    pose = solve_lean(asked.x, asked.y, asked.z, asked.phi, asked.d1, asked.d2)
    exact = np.column_stack([pose[name] for name in RESULT_FIELDS])
    elbow = angle_between(_whole(values[:, 4:]), _whole(exact[:, 4:]))
    return hand_errors(values, asked), max(angle_between(values[:, :4], exact[:, :4]).max(), elbow.max())


def _whole(q: np.ndarray) -> np.ndarray:
    """Return quaternions (N, 4), given all four components or only the first two; the last two are then 0."""
    return np.pad(q, ((0, 0), (0, 4 - q.shape[1])))


@dataclass(frozen=True, eq=False)
class Hand:
    """Hands of N poses, by forward kinematics of the core's joints.

    * point (N, 3): scaled lengths, in the user's frame
    * joints (N, 7): rad; over_limit (N, 7): True for a joint outside its limits
    * orientation_error (N,): rad
    """

    point: np.ndarray
    joints: np.ndarray
    over_limit: np.ndarray
    orientation_error: np.ndarray


@dataclass(frozen=True, eq=False)
class PerTarget:
    """Points and errors of each target.  Points (N, 3) are scaled lengths in the user's frame; errors (N,) are angles
    in rad, or distances relative to the reach, which includes the tool.

    `judged_error` is `hand_error`; for an unreachable target (`clamped`) it is the distance of the core's hand from
    the hand of the clamped pose.
    """

    elbow: np.ndarray
    wrist: np.ndarray
    clamped: np.ndarray
    hand_error: np.ndarray
    judged_error: np.ndarray
    predicted: np.ndarray | None
    shoulder_angle_error: np.ndarray
    elbow_angle_error: np.ndarray
    hand: Hand | None = None


@dataclass(frozen=True, eq=False)
class Score:
    """Scores of one trajectory; all but `per_target` are stored in score.json under the same names.

    * `*_max`, `*_rms`: over reachable targets, None if there are none; exceptions: norm and orientation errors are over
      all targets, `clamped_error_max` is over unreachable targets
    * `*_tolerance`: largest permitted error of the worst target, None without a tolerance; `hand_error_over_tolerance`:
      largest ratio of a hand error to its tolerance
    * `hand_error_target`: target with the largest error; `hand_error_pose`: distance of that pose from a singular one
    * `outcome`: verdict (pass, warn or FAIL), largest error and its tolerance as text; `failures` is empty exactly if
      `passed`; the verdict is warn if a target out of reach is missed by more than the tolerance
    * `over_limit`: number of targets with a joint outside its limits; None for wrists, as is `orientation_error_*`
    """

    trajectory: str
    datapath: str
    width: int
    simulator: str
    targets: int
    bit_mismatches: int
    hand_error_max: float | None
    hand_error_rms: float | None
    hand_error_tolerance: float | None
    hand_error_predicted: float | None
    hand_error_over_tolerance: float | None
    hand_error_target: int | None
    hand_error_pose: str | None
    orientation_error_max: float | None
    orientation_error_tolerance: float | None
    angle_error_max: float | None
    shoulder_angle_error_max: float | None
    elbow_angle_error_max: float | None
    elbow_point_error_max: float | None
    norm_error_max: float
    clamped_error_max: float | None
    clamped_error_tolerance: float | None
    singular_distance_min: float
    latency_cycles: int | None
    total_cycles: int | None
    results_per_cycle: float | None
    flagged: int
    over_limit: int | None
    scale_exponent: int
    passed: bool
    outcome: str
    failures: tuple[str, ...]
    per_target: PerTarget


def score(
    targets: Targets,
    words: np.ndarray,
    exponent: int,
    run: Any,
    *,
    width: int,
    datapath: str,
    simulator: str,
    predicted: np.ndarray | None,
    tolerance: float | None = None,
    placed: tuple[np.ndarray, ...] | None = None,
    limits: Limits | None = None,
    strict: bool = False,
) -> Score:
    """Score the core's results.

    * targets: N of them, in the user's units; words, exponent: output of `words.to_words`
    * run: the core's output, with the attributes of `tb.sim.job.Run`
    * predicted (N,): largest hand error / reach that rounding can cause; None if not computed
    * tolerance: permitted hand error / reach, requested by the user; by default from `model.bounds.tolerances`
    * placed: elbows and wrists (N, 3) to score, relative to the shoulder, in the user's units; for hand poses, which
      must have no tool, also orientations (N, 4); by default all are computed by forward kinematics
    * limits: joint limits of hand poses, in words; none by default; strict: True to fail on a joint outside them

    Raises ValueError for arrays whose shapes do not match, and for a prediction that is not positive and finite.
    """
    count, path = len(targets), MODELS[datapath]
    shapes: dict[str, tuple[int, ...]] = {"words": (count, len(path.inputs) + bool(path.side))}
    shapes |= {"results": (count, len(path.results)), "flags": (count,), "predicted": (count,)}
    for name, array in {"words": words, "results": run.results, "flags": run.flags, "predicted": predicted}.items():
        if array is not None and np.shape(array) != shapes[name]:
            raise ValueError(f"{targets.name}: {name} has shape {np.shape(array)}, not {shapes[name]}")
    if predicted is not None and not (np.isfinite(predicted) & (np.asarray(predicted) > 0)).all():
        raise ValueError(f"{targets.name}: the predicted hand error is not positive and finite")

    value = dict(zip(path.results, np.asarray(run.results).T, strict=True))
    core, expected = fixed.of_hands(words[:, :-1], width) if path.side else (words, np.zeros(count, dtype=np.int64))
    asked = from_words(core, 0, width, targets.name)  # in scaled lengths, as everything below
    d1, d2 = np.ldexp(targets.d1, exponent), np.ldexp(targets.d2, exponent)
    reach = d1 + d2
    pose = solve_clamped(asked.x, asked.y, asked.z, asked.phi, asked.d1, asked.d2)
    parts = RESULT_FIELDS[:4], RESULT_FIELDS[4:], ("p_e_x", "p_e_y", "p_e_z")
    pose_qs, pose_qe, pose_elbow = (np.column_stack([pose[name] for name in names]) for names in parts)
    values = result_values(np.column_stack([value[name] for name in RESULT_FIELDS]), width)
    qs, qe = values[:, :4], values[:, 4:]

    elbow, wrist = forward(qs, qe, d1, d2)
    if placed is not None:
        elbow, wrist = (np.ldexp(targets.points_to_core(points), exponent) for points in placed[:2])
    _, pose_wrist = forward(pose_qs, pose_qe, asked.d1, asked.d2)
    end, nearest, size, table, of_hand, turn_tolerance = wrist, pose_wrist, reach, None, None, None
    if path.side:
        of_hand = _hand(targets, exponent, value, width, limits)
        if placed is not None:
            turn = angle_between(placed[2], targets.hand)
            of_hand = dataclasses.replace(of_hand, point=wrist, orientation_error=turn)
        tool, end = np.ldexp(targets.tool, exponent), of_hand.point
        size, nearest = reach + np.linalg.norm(tool, axis=1), pose_wrist + rotate(targets.core_hand, tool)
        table, turn_tolerance = tolerances.pose(words, width, np.ldexp(np.linalg.norm(tool[:, :2], axis=1), width - 2))
        table = np.ldexp(table, 2 - width) / size
        expected = expected | (of_hand.over_limit << flag_bits.OVER_BIT + np.arange(len(JOINTS))).sum(axis=1)
    hand_error = np.linalg.norm(end - np.ldexp(targets.core_position, exponent), axis=1) / size
    clamped_error = np.linalg.norm(end - nearest, axis=1) / size
    elbow_error = np.linalg.norm(elbow - pose_elbow, axis=1) / reach
    shoulder_angle = angle_between(qs, pose_qs)
    elbow_angle = angle_between(_whole(qe), _whole(pose_qe))
    qs_norm, qe_norm = (np.abs((q**2).sum(axis=1) - 1) for q in (qs, qe))

    expected = expected | flag_bits.expected_flags(core, width)
    clamped = (expected & (flag_bits.UNREACHABLE | flag_bits.SATURATED)) != 0
    reachable = ~clamped
    distances = singular_distances(asked)
    distance = np.min(list(distances.values()), axis=0)
    if tolerance is None and not path.side:
        tolerance = tolerances.hand(width, datapath, regular=bool((distance >= tolerances.REGULAR_DISTANCE).all()))
    permitted = table if tolerance is None else np.full(count, tolerance)
    worst = int(np.argmax(np.where(reachable, hand_error, -1.0))) if reachable.any() else None
    nearest_singular = "" if worst is None else min(distances, key=lambda what: distances[what][worst])
    norm_tolerance = tolerances.norm(width, datapath)

    mismatch = f"{run.bit_mismatches} bits differ from the bit-true model", run.first_mismatch
    failures = [
        *(["; ".join(filter(None, mismatch))] if run.bit_mismatches else []),
        *_flag_failures(np.asarray(run.flags), expected),
        *_large_errors("hand error", hand_error, permitted, reachable),
        *_large_errors("error of the clamped hand", clamped_error, permitted, clamped),
        *(_large_errors("orientation error", of_hand.orientation_error, turn_tolerance) if of_hand else ()),
        *_large_errors("abs(norm^2-1) of Qs", qs_norm, norm_tolerance),
        *_large_errors("abs(norm^2-1) of Qe", qe_norm, norm_tolerance),
    ]
    over = [*_over_limits(of_hand.over_limit)] if of_hand and strict else []
    missed = clamped & (hand_error > (0.0 if permitted is None else permitted))
    largest, furthest = _max(hand_error, reachable), _max(clamped_error, clamped)
    judged, at = np.where(clamped, clamped_error, hand_error), targets.points_from_core
    if of_hand:
        of_hand = dataclasses.replace(of_hand, point=at(of_hand.point))
    return Score(
        trajectory=targets.name,
        datapath=datapath,
        width=width,
        simulator=simulator,
        targets=count,
        bit_mismatches=int(run.bit_mismatches),
        hand_error_max=largest,
        hand_error_rms=float(np.sqrt(np.mean(hand_error[reachable] ** 2))) if reachable.any() else None,
        hand_error_tolerance=None if permitted is None or worst is None else float(permitted[worst]),
        hand_error_predicted=None if predicted is None else _max(predicted, reachable),
        hand_error_over_tolerance=None if permitted is None else _max(hand_error / permitted, reachable),
        hand_error_target=worst,
        hand_error_pose=None if worst is None else f"{distance[worst]:.3f} rad from singular: {nearest_singular}",
        orientation_error_max=float(of_hand.orientation_error.max()) if of_hand else None,
        orientation_error_tolerance=turn_tolerance,
        angle_error_max=_max(np.maximum(shoulder_angle, elbow_angle), reachable),
        shoulder_angle_error_max=_max(shoulder_angle, reachable),
        elbow_angle_error_max=_max(elbow_angle, reachable),
        elbow_point_error_max=_max(elbow_error, reachable),
        norm_error_max=float(np.max([qs_norm, qe_norm])),
        clamped_error_max=furthest,
        clamped_error_tolerance=None if permitted is None else _max(permitted, clamped & (clamped_error == furthest)),
        singular_distance_min=float(distance.min()),
        latency_cycles=run.latency_cycles,
        total_cycles=run.total_cycles,
        # Throughput from the first result to the last, both counted.
        results_per_cycle=None if run.total_cycles is None else count / (run.total_cycles - run.latency_cycles),
        flagged=int(np.count_nonzero(run.flags & (1 << flag_bits.OVER_BIT) - 1)),
        over_limit=int(of_hand.over_limit.any(axis=1).sum()) if of_hand else None,
        scale_exponent=int(exponent),
        passed=not failures + over,
        outcome=f"FAIL: {over[0]}" if over and not failures else _outcome(not failures, permitted, judged, missed),
        failures=(*failures, *over),
        per_target=PerTarget(
            at(elbow), at(wrist), clamped, hand_error, judged, predicted, shoulder_angle, elbow_angle, of_hand
        ),
    )


def _hand(targets: Targets, exponent: int, value: dict[str, np.ndarray], width: int, limits: Limits | None) -> Hand:
    """Return the hands by forward kinematics of the joints that the core returned; points are in the core's frame."""
    words = np.array([value[name] for name in JOINTS])
    th, ends = words * (2 * np.pi / 2**width), zip(words, limits or limit_words(None, width), strict=True)
    over = np.array([outside(word, low=low, high=high, width=width) for word, (low, high) in ends])
    d1, d2, tool = (np.ldexp(length, exponent) for length in (targets.d1, targets.d2, targets.tool))
    point, q = reached(th, d1, d2, tool)
    return Hand(point, th.T, over.T, angle_between(q, targets.core_hand))


def _max(values: np.ndarray, where: np.ndarray) -> float | None:
    return float(values[where].max()) if where.any() else None


def _outcome(passed: bool, tolerance: np.ndarray | None, errors: np.ndarray, missed: np.ndarray) -> str:
    """Return a line of text with the verdict, the number of ``missed`` (N,) targets, the largest error and its
    tolerance."""
    n, count = errors.argmax(), np.count_nonzero(missed)
    verdict = "FAIL" if not passed else "warn" if count else "pass"
    error = f"error {errors[n]:.1e} of the reach"
    if count:
        error = f"{count} of {len(missed)} targets out of reach, solved by the nearest pose; {error}"
    if tolerance is None:
        bits = "bits, flags and norms are right" if passed else "bits, flags or norms are wrong"
        return f"{verdict}: {bits}; {error}, no tolerance"
    rest = "" if passed or errors[n] > tolerance[n] else ", but bits, flags or norms are wrong"
    return f"{verdict}: {error}, tolerance {tolerance[n]:.3g}{rest}"


def _over_limits(over: np.ndarray) -> Iterator[str]:
    """If any of ``over`` (N, 7) is True, yield a message with the number of such rows and the first of them."""
    if len(rows := np.flatnonzero(over.any(axis=1))):
        which = ", ".join(JOINTS[joint] for joint in np.flatnonzero(over[rows[0]]))
        yield f"joints outside their limits in {len(rows)} of {len(over)} targets; first: target {rows[0]}, {which}"


def _flag_failures(flags: np.ndarray, expected: np.ndarray) -> Iterator[str]:
    """If any flags are wrong, yield a message that names the first such target."""
    if len(wrong := np.flatnonzero(flags != expected)):
        actual, owed = (flag_bits.names(int(words[wrong[0]])) for words in (flags, expected))
        count = f"{len(wrong)} of {len(flags)} targets"
        yield f"wrong flags in {count}; first: target {wrong[0]} has {actual} instead of {owed}"


def _large_errors(
    what: str, error: np.ndarray, most: float | np.ndarray | None, where: np.ndarray | bool = True
) -> Iterator[str]:
    """If an error exceeds its tolerance ``most``, a number or (N,), yield a message that names the largest one."""
    tolerance = np.broadcast_to(np.inf if most is None else most, error.shape)
    above = where & (error > tolerance)
    if above.any():
        n = int(np.argmax(np.where(above, error, 0.0)))
        times = f"{error[n] / tolerance[n]:.3g} times its tolerance {tolerance[n]:.3g}"
        count = f"{np.count_nonzero(above)} of {len(error)} targets"
        yield f"{what} {error[n]:.3g} at target {n} is {times} ({count} above)"


def tables(targets: Targets, run: Any, result: Score, more: dict[str, np.ndarray] | None = None) -> dict[str, bytes]:
    """Return the contents of results.csv and results.npz by suffix; results.npz has the same data as arrays.

    CSV: one row per target, in input order; lengths are in the user's unit and frame, angles in rad. The last columns
    are the other columns of the target file and those of `more`, name -> (N,). Reading the file returns the same bits.
    docs/targets.md lists columns and arrays.
    """
    value = dict(zip(MODELS[result.datapath].results, result_values(run.results, result.width).T, strict=True))
    qs = targets.from_core(np.column_stack([value[name] for name in RESULT_FIELDS[:4]]))
    value |= dict(zip(RESULT_FIELDS[:4], qs.T, strict=True))
    scores, exponent = result.per_target, result.scale_exponent
    hand, hand_error = scores.hand, scores.hand_error
    elbow, wrist = (np.ldexp(points, -exponent) + targets.origin for points in (scores.elbow, scores.wrist))
    flags = np.asarray(run.flags) & (1 << flag_bits.OVER_BIT) - 1
    columns = {"n": np.arange(len(targets))} | {field: getattr(targets, field) for field in FIELDS}
    columns |= {name: value[name] for name in (*RESULT_FIELDS, *(WRIST_FIELDS if hand else ()))}
    columns |= dict(zip(JOINTS, hand.joints.T, strict=True)) if hand else {}
    columns |= {"flags": flags} | ({"over_limit": np.asarray(run.flags) >> flag_bits.OVER_BIT} if hand else {})
    columns |= {"hand_error": hand_error} | ({"orientation_error": hand.orientation_error} if hand else {})
    columns |= dict(zip(("elbow_x", "elbow_y", "elbow_z"), elbow.T, strict=True))
    cells: dict[str, list] = {name: column.tolist() for name, column in columns.items()}
    cells |= {name: column for name, column in targets.others.items() if name not in cells}
    cells |= {name: column.tolist() for name, column in (more or {}).items()}
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([cells, *zip(*cells.values(), strict=True)])
    arrays: dict[str, Any] = {name: getattr(targets, name) for name in ("phi", "d1", "d2")} | (more or {})
    arrays |= {"points": targets.position, "elbow": elbow, "wrist": wrist, "flags": flags, "hand_error": hand_error}
    quaternions = [RESULT_FIELDS[:4], RESULT_FIELDS[4:], *([WRIST_FIELDS] if hand else [])]
    for name, names in zip(("qs", "qe", "qw"), quaternions, strict=False):
        arrays[name] = continuous(_whole(np.column_stack([value[part] for part in names])), targets.arm)
    if hand:
        arrays |= {"joints": hand.joints, "over_limit": hand.over_limit, "orientation_error": hand.orientation_error}
    data = io.BytesIO()
    np.savez(data, **arrays)
    return {".csv": text.getvalue().encode(), ".npz": data.getvalue()}


def score_json(scores: Sequence[Score]) -> bytes:
    """Return the contents of score.json: a list with one object per trajectory; times and paths are left out."""
    stored = [{name: value for name, value in vars(item).items() if name != "per_target"} for item in scores]
    return (json.dumps(stored, indent=2, allow_nan=False) + "\n").encode()
