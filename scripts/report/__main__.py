# SPDX-License-Identifier: Apache-2.0
"""Run trajectories through the core and write an HTML report (`make report`).

    python -m scripts.report [--trajectory NAME|all|FILE.csv] [--out DIR] [--datapath NAME[,NAME]] ...

Writes OUT/report.html: the arm (for a clip, the whole figure) posed by the core's quaternions, figures 1 to 5 of the
paper, joint angles, the error of every target with its tolerance and prediction, the score, the pipeline over time.
The page is self-contained (report.html, .css and the scripts of this folder, and the data as JSON) and opens from disk
without network. It links to result files like those of `scripts.run`, which are written to OUT. The page shows several
datapaths side by side; the files of each are then in a folder such as OUT/lean.
If a trajectory fails, the page is written with a notice.
"""

import html
import json
import sys
from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from model.io import flags as flag_bits
from model.io import trajectories
from model.io.scoring import Score
from model.io.words import JOINTS, from_words
from model.motion.arms import GOAL
from model.motion.swivels import feasible_swivel
from model.reference.equations import swivel_normal
from scripts import trajectory
from scripts.console import MOST_DATAPATHS, command, trajectory_options
from scripts.generate.render import TEMPLATES
from scripts.report.figure import figure_data, joint_angles, packed
from scripts.score_tables import figures, verdict
from scripts.trajectory import Prepared
from tb.sim.simulate import Run

HERE = Path(__file__).parent
SCRIPTS = ("arm", "figure", "paper", "plots", "report")
"""Scripts of the page in dependency order."""

DIGITS = 7
"""Significant digits of the numbers in the page."""

MOST_ROWS = 12
"""Largest number of rows that jump which the table lists."""

MOST_ARMS = 4
"""Largest number of arms of different lengths that are drawn together; with more, only the moving arm is drawn."""


def _numbers(array: np.ndarray, digits: int = DIGITS) -> Any:
    """Convert an array to nested lists of numbers rounded to `digits` significant digits."""
    if array.ndim:
        return [_numbers(row, digits) for row in array]
    return float(f"{array:.{digits}g}")


def trajectory_data(item: Prepared, done: Sequence[tuple[Run, Score]]) -> dict[str, Any]:
    """Return the page's data for one trajectory: lists over its targets, lengths in the user's unit.

    The results of the first datapath are at the top level, the others' results in "beside", under the same names.
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
        "paper": packed(item, width),
        "hands": hand_data(item, *done[0]) if targets.hand is not None else None,
        **first,
        "beside": others,
    }


def hand_data(item: Prepared, ran: Run, result: Score) -> dict[str, Any]:
    """Return the page's data of hand poses. Angles are in degrees.

    * names, joints (N, 7), limits (7, 2): those of the robot, or else of th1 to th7; a missing limit is None
    * over: bits of the joints outside their limits, bit 0 for the first joint; error: orientation error in rad
    * arcs (N, 8): for each branch, intervals of the swivel angle for which all joints are within their limits; free
      (N,): of the target's branch; branch (N,); None or absent without a robot
    * steps (N,): largest step of a joint from the row before, rad, None without joints; jumps: numbers of the rows that
      jump or have no joints; most: the goal, rad
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
        goal = targets.position - (0.0 if targets.origin is None else targets.origin)
        point, turn = np.ldexp(hand.point, -item.exponent), trajectory.by_joints(item, ran, result.width)[2]
        hands |= {"goal": _numbers(goal), "point": _numbers(point), "turn": _numbers(turn, 5)}
    over = (hand.over_limit << np.arange(7)).sum(axis=1).tolist()
    errors = _numbers(hand.orientation_error, 3)
    return hands | {"joints": _numbers(np.degrees(hands["joints"]), 5), "over": over, "error": errors}


def _arcs(item: Prepared, branch: np.ndarray) -> list[Any]:
    """Return for each target the intervals of the swivel angle, degrees, for which a branch is within the limits."""
    targets = item.targets
    lengths = targets.d1, targets.d2, 0.0
    swivels = feasible_swivel(targets.core_wrist, targets.core_hand, *lengths, item.robot.bounds, branch)
    finite = (interval[np.isfinite(interval).all(axis=1)] for interval in swivels.intervals)
    return [_numbers(np.degrees(interval), 4) for interval in finite]


def step_figures(item: Prepared) -> list[tuple[str, ...]]:
    """Return rows of the table of figures: largest step of a joint, and the rows that jump or have no joints."""
    if not item.path:
        return []
    kind, names = ("targets", range(len(item.targets))) if item.targets.rows is None else ("rows", item.targets.rows)
    listed = [str(names[n]) for n in sorted(item.path.jumps)]
    more = f" and {len(listed) - MOST_ROWS} more" if len(listed) > MOST_ROWS else ""
    jumps = ", ".join(listed[:MOST_ROWS]) + more or "none"
    step = f"largest step of a joint, goal {GOAL} (rad)", f"{item.path.largest:.3g}"
    return [step, (f"{kind} that jump or have no joints", jumps)]


def _run_data(item: Prepared, ran: Run, result: Score) -> dict[str, Any]:
    """Return the page's data of one datapath's results for a trajectory."""
    width, scores = result.width, result.per_target
    qs, qe = trajectory.quaternions(item, ran, width)
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


def _links(out: Path, folders: Sequence[Path], prepared: Sequence[Prepared]) -> dict[str, list[str]]:
    """Return the files to link to, by trajectory name; "" has the files of all trajectories. folders: one per
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
    """Return the HTML page. links: the files to link to, as returned by `_links`."""
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
    "Run trajectories through the core in a simulator and write a page that shows them.",
    trajectory_options("build/report", "report.html", most=MOST_DATAPATHS),
    passes="all trajectories pass",
    fails="one fails",
)
def main(parsed: SimpleNamespace) -> int:
    path = parsed.out / "report.html"
    prepared = trajectory.prepare(parsed)
    folders = trajectory.datapaths(parsed, prepared)
    with trajectory.outputs(parsed.out, folders.values(), prepared, path) as files:
        done = [
            trajectory.score_runs(parsed, datapath, prepared, trajectory.simulated(parsed, datapath, prepared))
            for datapath in folders
        ]
        shown = [trajectory_data(item, scored) for item, *scored in zip(prepared, *done, strict=True)]
        links = _links(parsed.out, list(folders.values()), prepared)
        text = page(shown, links, names=list(folders), width=parsed.width, simulator=parsed.sim)
        files(path).write_bytes(text.encode())
        trajectory.write_results(files, parsed.out, folders.values(), prepared, done)
    print(f"wrote {path}")
    return verdict("report", [result for ran in done for _, result in ran])


if __name__ == "__main__":
    sys.exit(main())
