# SPDX-License-Identifier: Apache-2.0
"""Run trajectories through the core and write an HTML report (`make report`).

Writes OUT/report.html: the arm (for a clip, the whole body) posed by the core's quaternions, figures 1 to 5 of the
paper, joint angles, every target's error, tolerance and predicted error, the score, and the pipeline over time.
The page is self-contained (report.html, .css and the scripts of this folder, and the data as JSON) and opens from disk
without network. It links to the result files, which are written to OUT as by `scripts.run`. With several datapaths,
the page shows their results side by side, and the result files of each datapath are in a folder such as OUT/lean.
If a trajectory fails, the page is written with a notice.

The entities of figures 1 to 5 are computed in double precision from the core's input words, not from its results. For
a clip, every bone is drawn in every frame; the core poses the arms. The page draws with z up, so the clip's axes are
permuted cyclically until the up axis is z. Points are integers in a small unit, relative to the root, so that a page
of 3000 frames has only a few megabytes.
"""

import html
import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from model.io import flags as flag_bits
from model.io import trajectories
from model.io.scoring import Score
from model.io.words import JOINTS, from_words
from model.motion.arms import GOAL
from model.motion.clip import Clip, Motion, outward_and_up, rest_up
from model.motion.swivels import feasible_swivel
from model.reference import cga, geometry
from model.reference.cga import e3
from model.reference.equations import swivel_normal
from model.reference.kinematics import conjugate, rotate
from scripts import trajectory
from scripts.console import MOST_DATAPATHS, Options, command, trajectory_options
from scripts.generate.render import TEMPLATES
from scripts.score_tables import figures, verdict
from scripts.trajectory import Prepared, quaternions
from tb.sim.simulate import Run

HERE = Path(__file__).parent
SCRIPTS = ("arm", "figure", "paper", "plots", "report")  # scripts of the page in dependency order
DIGITS = 7  # significant digits of the numbers in the page
MOST_ROWS = 12  # largest number of rows that jump which the table lists
MOST_ARMS = 4  # arms of different lengths that are drawn together; with more, only the moving arm is drawn
NEAR = 1e-4  # largest geometric error / reach at which an entity near a singular pose is still drawn
STEPS = 4000  # units per diagonal of the figure's bounding box; a unit is smaller than a pixel
BODY, UPPER, FORE, HEAD = range(4)  # body parts; a node carries the part of the bone that ends there


def _numbers(array: np.ndarray, digits: int = DIGITS) -> Any:
    """Convert an array to nested lists of numbers rounded to `digits` significant digits."""
    return np.vectorize(lambda number: float(f"{number:.{digits}g}"), otypes=[float])(array).tolist()


def trajectory_data(item: Prepared, done: Sequence[tuple[Run, Score]]) -> dict[str, Any]:
    """Return the page's data for one trajectory: lists over its targets, lengths in the user's unit.

    The results of the first datapath are at the top level; results of others are in "beside", under the same names.
    """
    targets, width = item.targets, done[0][1].width
    # Decode the input words, so that the swivel plane is the one passed to the core.
    asked = from_words(item.core_words(width), 0, width, targets.name)
    about = trajectories.describe(targets.name) if targets.path is None else f"Targets of {Path(targets.path).name}."
    lengths = np.column_stack((targets.d1, targets.d2))
    arms = np.unique(lengths, axis=0, return_inverse=True)[1].reshape(-1)
    arms = (arms if arms.max() < MOST_ARMS else 0 * arms).tolist()
    if item.clip:
        limbs = " and ".join(", ".join(f"{m.limb.side} {m.limb.kind}" for m in item.moves).rsplit(", ", 1))
        frames = len(targets) // len(item.moves)
        about = (
            f"{Path(targets.path).name}: {frames} frames at {1 / item.clip.period:.6g} Hz; {limbs} by the "
            f"core{', with their hands' * (targets.hand is not None)}, the rest of the body as in the clip."
        )
        arms = np.tile(np.arange(len(item.moves)), frames).tolist()
    wrist = targets.position if targets.hand is None else targets.points_from_core(targets.core_wrist)
    first, *others = (_run_data(item, ran, result) for ran, result in done)
    return {
        "name": targets.name,
        "about": about,
        "target": _numbers(wrist),
        "phi": _numbers(targets.phi),
        "lengths": _numbers(lengths),
        "arm": arms,
        "normal": _numbers(targets.points_from_core(swivel_normal(asked.x, asked.y, asked.z, asked.phi))),
        "paper": entities(item, width),
        "hands": hand_data(item, *done[0]) if targets.hand is not None else None,
        **first,
        "beside": others,
    }


def hand_data(item: Prepared, ran: Run, result: Score) -> dict[str, Any]:
    """Return the page's data for hand poses. Angles are in degrees unless rad is stated.

    * names, joints (N, 7), limits (7, 2): of the robot or, without a robot, of th1 to th7; a missing limit is None
    * over (N,): mask of joints outside their limits, bit 0 for the first joint; error (N,): orientation error in rad
    * arcs (N, 8): for each branch, intervals of the swivel angle in which all joints are within their limits
    * branch (N,): the target's branch; free (N,): the arcs of this branch
    * steps (N,): largest step (rad) of a joint from the previous row, None without joints; jumps: numbers of the rows
      that jump or have no joints; most: largest permitted step (rad)
    * without a robot, free is None, and arcs, branch, steps, jumps and most are absent
    * goal, point, turn (not for clips): requested point, reached point (both from the shoulder), reached orientation
    """
    targets, robot, hand = item.targets, item.robot, result.per_target.hand
    assert hand
    hands: dict[str, Any] = {"names": JOINTS, "joints": hand.joints, "limits": [(None, None)] * 7, "free": None}
    if robot:
        arcs = [_arcs(item, np.full(len(targets), branch)) for branch in range(8)]
        hands |= {"names": robot.names, "joints": robot.positions(hand.joints), "arcs": [*zip(*arcs, strict=True)]}
        hands["branch"] = np.broadcast_to(targets.branch, len(targets)).tolist()
        hands["free"] = [own[branch] for own, branch in zip(hands["arcs"], hands["branch"], strict=True)]
        steps = item.path.step
        hands["steps"] = np.where(np.isfinite(steps), _numbers(steps, 4), None).tolist()
        hands |= {"jumps": sorted(item.path.jumps), "most": GOAL}
        limits = np.degrees(robot.limits)
        hands["limits"] = np.where(np.isfinite(limits), _numbers(limits, 5), None).tolist()
    if item.clip is None:
        goal = targets.position - targets.origin
        point, turn = np.ldexp(hand.point, -item.exponent), trajectory.by_joints(item, ran, result.width)[2]
        hands |= {"goal": _numbers(goal), "point": _numbers(point), "turn": _numbers(turn, 5)}
    over = (hand.over_limit << np.arange(7)).sum(axis=1).tolist()
    errors = _numbers(hand.orientation_error, 3)
    return hands | {"joints": _numbers(np.degrees(hands["joints"]), 5), "over": over, "error": errors}


def _arcs(item: Prepared, branch: np.ndarray) -> list[Any]:
    """Return each target's intervals of swivel angle (degrees) in which `branch` (N,) has no joint beyond a limit."""
    targets = item.targets
    lengths = targets.d1, targets.d2, 0.0
    swivels = feasible_swivel(targets.core_wrist, targets.core_hand, *lengths, item.robot.bounds, branch)
    finite = (interval[np.isfinite(interval).all(axis=1)] for interval in swivels.intervals)
    return [_numbers(np.degrees(interval), 4) for interval in finite]


def step_figures(item: Prepared) -> list[tuple[str, ...]]:
    """Return rows for the page's table: largest step of a joint (rad); list of targets that jump or have no joints."""
    if not item.path:
        return []
    kind, names = ("targets", range(len(item.targets))) if item.targets.rows is None else ("rows", item.targets.rows)
    listed = [str(names[n]) for n in sorted(item.path.jumps)]
    more = f" and {len(listed) - MOST_ROWS} more" if len(listed) > MOST_ROWS else ""
    jumps = ", ".join(listed[:MOST_ROWS]) + more or "none"
    step = f"largest step of a joint, goal {GOAL} (rad)", f"{item.path.largest:.3g}"
    return [step, (f"{kind} that jump or have no joints", jumps)]


def _run_data(item: Prepared, ran: Run, result: Score) -> dict[str, Any]:
    """Return the page's data for one datapath's results on a trajectory."""
    width, scores = result.width, result.per_target
    qs, qe = quaternions(item, ran, width)
    tolerance, moving = result.hand_error_tolerance, trajectory.speeds_of(item, result)
    of_clip = {}
    if item.clip:
        of_clip = {"clip": figure_data(item, ran, width), "elbowError": _numbers(trajectory.elbow_errors(item, result))}
    return of_clip | {
        "datapath": result.datapath,
        "angles": _numbers(joint_angles(item, ran, width), 5),
        "elbow": _numbers(np.ldexp(scores.elbow, -item.exponent)),
        "wrist": _numbers(np.ldexp(scores.wrist, -item.exponent)),
        "qs": _numbers(qs),
        "qe": _numbers(qe[:, :2]),
        "flags": [flag_bits.names(int(bits)) for bits in ran.flags],
        "clamped": scores.clamped.tolist(),
        "hand": _numbers(scores.judged_error),
        "predicted": None if scores.predicted is None else _numbers(scores.predicted),
        "tolerance": result.clamped_error_tolerance if tolerance is None else tolerance,
        "shoulderAngle": _numbers(scores.shoulder_angle_error),
        "elbowAngle": _numbers(scores.elbow_angle_error),
        "latency": result.latency_cycles,
        "cycles": result.total_cycles,
        "figures": [*figures(result, ran.flags), *step_figures(item), *moving.figures()],
        "passed": result.passed,
        "outcome": result.outcome,
        "failures": result.failures,
    }


def entities(item: Prepared, width: int) -> list[dict[str, list[Any]]]:
    """Return the page's entities by name: vectors (N, 3) in the user's frame, angles (N,) in rad, and lengths (N,).

    Points and lengths are relative to the reach; directions are unit vectors. An undefined number is None.
    """
    asked = from_words(item.core_words(width), 0, width, item.targets.name)
    lengths = [values / asked.reach for values in (asked.x, asked.y, asked.z, asked.d1, asked.d2)]
    d1, d2 = lengths[3:]
    with np.errstate(divide="ignore", invalid="ignore"):
        solution = geometry.solve(*lengths[:3], asked.phi, d1, d2)
        P_w, Q_s, Q_e, Q_12 = (solution[name] for name in ("P_w", "Q_s", "Q_e", "Q_12"))
        # The rest pose after the rotation about the elbow, before the rotation about the shoulder.
        rest = cga.rotate(Q_e, e3 * cga.scalar(-d2)) + e3 * cga.scalar(d1)
        coordinates = {
            "axis": (0 * d1, 0 * d1, 0 * d1 + 1),  # L_z
            "along": cga.direction(solution["L_sw"]),
            "vertical": cga.direction(geometry.swivel_plane(P_w, 0 * d1)[2]),  # normal of the swivel plane at phi = 0
            "swivel": cga.direction(solution["pi_swivel"]),
            "centre": cga.euclidean_coordinates(cga.centre(solution["Z_e"])),
            "elbow": cga.euclidean_coordinates(solution["P_e"]),
            "other": cga.euclidean_coordinates(geometry.elbow_point(-solution["PP"])),
            # The wrist before the rotation by Q_e, by Q_12 and by Q_3.
            "folded": cga.euclidean_coordinates(cga.rotate(Q_s, cga.point(0 * d1, 0 * d1, d1 - d2))),
            "rest": _vector(rest),
            "half": _vector(cga.rotate(Q_12, rest)),
            "middle": cga.direction(solution["L_m"]),
            "yz2": cga.direction(solution["pi_yz2"]),
        }
        vectors = {name: np.column_stack(np.broadcast_arrays(*values)) for name, values in coordinates.items()}
        q3_w, _, _, q3_k = cga.quaternion_coefficients(solution["Q_3"])
        angles = {"theta4": np.arccos(np.clip(solution["c4"], -1, 1)), "theta3": 2 * np.arctan2(q3_k, q3_w)}
        radius = cga.radius(solution["Z_e"])
        wrist = np.column_stack(_vector(cga.rotate(Q_s, rest)))
        met = np.abs(np.linalg.norm(vectors["elbow"], axis=1) - d1) < NEAR
        home = met & (np.linalg.norm(wrist - np.column_stack(lengths[:3]), axis=1) < NEAR)
    radius[met & np.isnan(radius)] = 0.0  # arm straight within roundoff
    for name in ("elbow", "other"):
        vectors[name][~met] = np.nan
    turns = (vectors[name] for name in ("folded", "rest", "half", "middle", "yz2"))
    for values in (*turns, *angles.values()):
        values[~home] = np.nan
    shown = {name: item.targets.points_from_core(values) for name, values in vectors.items()}
    return [
        {name: np.where(np.isfinite(values), np.round(values, 4), None).tolist() for name, values in named.items()}
        for named in (shown, angles, {"radius": radius})
    ]


def _vector(mv: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return mv.e1, mv.e2, mv.e3


def place(up: str) -> np.ndarray:
    """Return the rotation (3, 3) from a clip's frame with up axis `up`, such as "-y", to the page's frame (z up)."""
    turn = np.roll(np.eye(3), 2 - "xyz".index(up[-1]), axis=0)
    return turn if up[0] != "-" else np.diag((1.0, -1.0, -1.0)) @ turn


def _parts(clip: Clip, moves: tuple[Motion, ...]) -> list[int]:
    """Return, for each node, the body part of the bone that ends there. End sites of joints named *head* are HEAD."""
    parts = [HEAD if node.end and "head" in clip.names[node.parent].lower() else BODY for node in clip.nodes]
    for move in moves:
        arm = move.limb
        for part, joint, high in ((UPPER, arm.fore, arm.upper), (FORE, arm.hand, arm.fore)):
            while joint != high:
                parts[joint] = part
                joint = clip.parents[joint]
    return parts


def _facing(item: Prepared, turn: np.ndarray) -> float:
    """Return the direction that the figure faces in the first frame: the angle about z from x, in rad."""
    first, limbs = item.clip.positions[0], [move.limb for move in item.moves]
    out = [(first[arm.upper] - first[arm.torso]) * (1 if arm.side == "left" else -1) for arm in limbs]
    left = turn @ np.sum(out, axis=0)
    return float(np.arctan2(-left[0], left[1]))  # left x up


def figure_data(item: Prepared, ran: Run, width: int) -> dict[str, Any]:
    """Return the page's data for the body in a clip, in the page's coordinates.

    * nodes: a flat list per frame: the root, then all other nodes relative to the root, as posed by the core
    * own: a flat list per frame: elbow and wrist of each arm as in the clip, relative to the root
    * unit: length represented by 1 in nodes and own; floor: height of the floor
    * middle: height of the view's centre, None if the view follows the root's height; it always follows x and y
    * radius: largest distance of any point from the view's centre
    """
    clip, moves = item.clip, item.moves
    turn = place(clip.up)
    nodes = trajectory.turned(item, ran, width).positions @ turn.T
    root = nodes[:, :1].copy()
    limbs = [move.limb for move in moves]
    joints = [joint for limb in limbs for joint in (limb.fore, limb.hand)]
    clip_arms = clip.positions[:, joints] @ turn.T - root
    low, high = float(nodes[..., 2].min()), float(nodes[..., 2].max())
    size = np.linalg.norm(np.ptp(nodes - root, axis=1), axis=1).max()
    unit = float(f"{size / STEPS:.3g}")
    from_middle = np.concatenate((nodes - root, clip_arms), axis=1)
    # If the figure climbs or flies, the view follows its height.
    middle = (low + high) / 2 if np.ptp(root[..., 2]) < size / 2 else None
    if middle is not None:
        from_middle[..., 2] += root[..., 2] - middle

    def whole(points: np.ndarray) -> list[list[int]]:
        return np.rint(points.reshape(len(points), -1) / unit).astype(int).tolist()

    return {
        "rate": float(f"{1 / clip.period:.6g}"),
        "arms": [{"side": of.label, "upper": of.upper, "fore": of.fore, "hand": of.hand} for of in limbs],
        "parents": clip.parents,
        "parts": _parts(clip, moves),
        "unit": unit,
        "nodes": whole(np.concatenate((root, (nodes - root)[:, 1:]), axis=1)),
        "own": whole(clip_arms),
        "place": turn.tolist(),
        "facing": round(_facing(item, turn), 4),
        "floor": low,
        "middle": middle,
        "radius": float(np.linalg.norm(from_middle, axis=2).max()),
    }


def joint_angles(item: Prepared, ran: Run, width: int) -> np.ndarray:
    """Return angles (N, 4) in degrees: azimuth and elevation of the upper arm, swivel angle, elbow flexion.

    Azimuth is measured from forward (x) to the left, elevation from the horizontal. Both refer to the torso's frame for
    a clip, otherwise to the frame of the targets. Flexion is 0 for a straight arm.
    """
    qs, qe = quaternions(item, ran, width)
    upper = rotate(qs, (0.0, 0.0, 1.0))
    for n, move in enumerate(item.moves):
        frames, arm, up = slice(n, None, len(item.moves)), move.limb, rest_up(item.clip)
        left = (outward_and_up(item.clip, arm) - up) * (1 if arm.side == "left" else -1)
        axes = np.stack((np.cross(left, up), left, up), axis=1)  # of the torso: forward, left, up
        upper[frames] = rotate(conjugate(item.clip.turn[:, arm.torso]), upper[frames]) @ axes
    azimuth = np.arctan2(upper[:, 1], upper[:, 0])
    elevation = np.arcsin(np.clip(upper[:, 2], -1, 1))
    # Qe rotates by 0 if the arm is closed and by pi if the arm is straight.
    flexion = np.pi - 2 * np.arctan2(np.abs(qe[:, 1]), qe[:, 0])
    return np.degrees(np.column_stack((azimuth, elevation, item.targets.phi, flexion)))


def _links(out: Path, folders: Sequence[Path], prepared: Sequence[Prepared]) -> dict[str, list[str]]:
    """Return a dict: trajectory name -> files to link to; "" -> files common to all trajectories. folders: one per
    datapath."""
    names = [item.targets.name for item in prepared]
    links: dict[str, list[str]] = {name: [] for name in (*names, "")}
    for folder in folders:
        tables = dict(zip(trajectory.csv_paths(folder, prepared), names, strict=True))
        for path in trajectory.result_paths(folder, prepared):
            links[tables.get(path.with_suffix(".csv"), "")].append(path.relative_to(out).as_posix())
    return links | {"": [*links[""], trajectory.SCORES]}


def page(
    shown: Sequence[dict[str, Any]], links: dict[str, list[str]], *, names: Sequence[str], width: int, simulator: str
) -> str:
    """Return the HTML page. shown: data of each trajectory. links: result of `_links`. names: datapaths."""
    data = json.dumps({"trajectories": shown, "files": links}, allow_nan=False, separators=(",", ":"))
    *others, last = names
    listed = f"{', '.join(others)} and {last} datapaths" if others else f"{last} datapath"
    return TEMPLATES.from_string((HERE / "report.html").read_text(encoding="utf-8")).render(
        title=html.escape(shown[0]["name"] if len(shown) == 1 else f"{len(shown)} trajectories"),
        run=html.escape(f"{listed}, {width} bits, {simulator}"),
        style=(HERE / "report.css").read_text(encoding="utf-8"),
        script="\n".join((HERE / f"{name}.js").read_text(encoding="utf-8") for name in SCRIPTS),
        data=data.replace("<", "\\u003c"),  # prevents a name from ending the script element
    )


@command(
    "report",
    trajectory_options("build/report", "report.html", most=MOST_DATAPATHS),
    passes="no trajectory fails",
    fails="one fails",
)
def main(parsed: Options) -> int:
    path = parsed.out / "report.html"
    prepared = trajectory.prepare(parsed)
    folders = trajectory.datapaths(parsed, prepared)
    with trajectory.outputs(parsed.out, folders.values(), prepared, path) as files:
        runs = {datapath: trajectory.simulated(parsed, datapath, prepared) for datapath in folders}
        done = [trajectory.score_runs(parsed, datapath, prepared, ran) for datapath, ran in runs.items()]
        shown = [trajectory_data(item, scored) for item, *scored in zip(prepared, *done, strict=True)]
        links = _links(parsed.out, list(folders.values()), prepared)
        text = page(shown, links, names=list(folders), width=parsed.width, simulator=parsed.sim)
        files(path).write_bytes(text.encode())
        trajectory.write_results(files, parsed.out, folders.values(), prepared, done)
    print(f"wrote {path}")
    return verdict("report", [result for ran in done for _, result in ran])


if __name__ == "__main__":
    sys.exit(main())
