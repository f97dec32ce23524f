# SPDX-License-Identifier: Apache-2.0
"""Load the targets of --trajectory, run them through the core, score the results and write the result files.

All input is checked here. The command-line options are in :mod:`scripts.console`.
"""

import os
import sys
import warnings
from collections.abc import Iterable, Iterator, Sequence
from contextlib import AbstractContextManager as ContextManager
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from model.bounds.predict import predicted_error
from model.dataflow import fixed
from model.dataflow.datapaths import DATAPATHS, DEFAULT
from model.dataflow.nodes import Limits
from model.io import trajectories
from model.io import words as core
from model.io.files import EULER, Place, read_csv
from model.io.flags import ARM_FLAG_BITS
from model.io.scoring import Score, score, score_json, tables
from model.io.words import ARM_FIELDS, RESULT_FIELDS, Targets, angle_doubt, result_values, to_words
from model.motion import arms, gltf
from model.motion import clip as clips
from model.motion.clip import TORSO, Clip, Motion
from model.motion.path import JointPath
from model.motion.pose import hanging, soft_reach, swivel
from model.motion.swivels import elbow_jumps
from model.reference import joints
from model.reference.kinematics import to_z
from scripts.console import InputError, Options, choose_simulator, output, progress
from scripts.robots import Speeds, planned, times
from tb.sim.simulate import Run, simulate

SCORES = "score.json"
JUMPS = 5  # rows named in warnings
STRAIGHT = 1.001  # distance / reach up to which a target is no sign of a wrong unit; a clip's straight arms exceed 1
APART = 0.01  # rad between planned joints and the core's, which splits two joints otherwise where th2 or th6 is 0


@dataclass(frozen=True)
class Prepared:
    """Trajectory that is ready to run.

    * words (N, 6), for hand poses (N, 12): input words of the targets; exponent: lengths are scaled by 2^exponent
    * clip, moves, twist: the clip, the motions of its limbs, and --twist; scale: the clip's unit of length in metres
    * notes: warnings, each one line
    * robot, path, limits: the arm of --robot, its planned path, and the lowest and highest word of each joint
    * seconds (N,): time of each row of a robot's path, or None
    * references (N, 7): words of the planned joints, if the core is to choose the branch
    """

    targets: Targets
    words: np.ndarray
    exponent: int
    clip: Clip | None = None
    moves: tuple[Motion, ...] = ()
    twist: str = "clip"
    scale: float = 1.0
    notes: tuple[str, ...] = ()
    robot: arms.Arm | None = None
    path: JointPath | None = None
    limits: Limits | None = None
    seconds: np.ndarray | None = None
    references: np.ndarray | None = None

    def core_words(self, width: int) -> np.ndarray:
        """Return the input words (N, 6) of the core. For hand poses, `ik_arm` computes them from its inputs."""
        return self.words if self.targets.hand is None else fixed.of_hands(self.words[:, :-1], width)[0]


def datapaths(arguments: Options, prepared: Sequence[Prepared]) -> dict[str, Path]:
    """Return a dict: datapath to run -> folder of its results. Without --datapath, the paper's scenario runs on all of
    DATAPATHS, other wrist targets on ``lean``. Hand poses run on the datapath's whole arm. Raises InputError for hand
    poses on ``paper``, which has no whole arm."""
    scenario = arguments.trajectory == trajectories.DEFAULT
    chosen = arguments.datapath or (list(DATAPATHS) if scenario else [DEFAULT])
    chosen = [chosen] if isinstance(chosen, str) else chosen
    if prepared[0].targets.hand is not None:
        if "paper" in chosen and "datapath" in arguments.given:
            raise InputError("argument --datapath: paper has no joints of a whole arm; hand poses run on lean or fold")
        chosen = [WHOLE_ARM[name] for name in chosen if name in WHOLE_ARM]
    return {name: arguments.out / name for name in chosen} if len(chosen) > 1 else {chosen[0]: arguments.out}


WHOLE_ARM = {"lean": "arm", "fold": "fold_arm"}  # datapath of wrist targets -> the one of hand poses

CHOOSING = {"arm": "choose", "fold_arm": "fold_choose"}
"""Datapath of hand poses -> the same datapath with the choice of a branch."""

BUILT_IN, CSV, CLIP = "built-in trajectory", "CSV file", "BVH clip"

GOES_WITH = dict.fromkeys(("d1", "d2"), (CSV,)) | dict.fromkeys(("phi", "pole", "soft"), (CSV, CLIP))
GOES_WITH |= dict.fromkeys(("robot", "plan", "limits", "rate"), (CSV, BUILT_IN))
GOES_WITH |= dict.fromkeys(("arm", "limb", "joints", "up", "twist", "scale"), (CLIP,))
"""Option -> the kinds of trajectories to which it applies."""


def _kind(name: str) -> str:
    """Return BUILT_IN, CSV or CLIP, the kind of a trajectory. Raises InputError for an unknown name."""
    names = "all", *trajectories.TRAJECTORIES, *trajectories.HANDS
    if name in names:
        return BUILT_IN
    if name.lower().endswith(".bvh"):
        return CLIP
    if name.lower().endswith(".csv") or os.sep in name or os.path.exists(name):
        return CSV
    valid = f"{', '.join(names)}, a CSV file or a BVH clip"
    raise InputError(f"argument --trajectory: unknown trajectory {name!r}; valid: {valid}")


def _load(arguments: Options) -> list[Prepared]:
    """Load the trajectories that --trajectory selects. Raises InputError or TargetError."""
    name, width, axis = arguments.trajectory, arguments.width, arguments.axis or "z"
    kind = _kind(name)
    usual = trajectories.ROBOTS.get(name)
    arguments.robot = arguments.robot or usual
    for option, kinds in GOES_WITH.items():
        if getattr(arguments, option) is not None and kind not in kinds:
            goes = " or a ".join(kinds)
            raise InputError(f"argument --{option}: applies to a {goes}, not to a {kind} ({name})")
    for one, other in (("pole", "phi"), *(("robot", name) for name in ("axis", "d1", "d2"))):
        if getattr(arguments, one) is not None and getattr(arguments, other) is not None:
            raise InputError(f"--{one} and --{other} exclude each other")
    if kind == CLIP:
        return [_of_clip(arguments)]
    words = {"axis": axis if axis == TORSO else None, "phi": arguments.phi, "pole": arguments.pole}
    for option, word in words.items():
        if isinstance(word, str):
            raise InputError(f"argument --{option}: {word!r} applies to a {CLIP}, not to a {kind} ({name})")
    robot = _robot(arguments)
    if arguments.rate is not None and not robot:
        raise InputError("argument --rate: applies to the joints of --robot")
    notes = (f"the poses are for ROBOT={usual}",) if arguments.robot != usual and usual else ()
    if kind == CSV:
        phi = (None if robot else hanging(axis)) if arguments.phi is None else arguments.phi
        loaded = [read_csv(name, d1=arguments.d1, d2=arguments.d2, phi=phi)]
        if arguments.pole is not None and (loaded[0].phi != phi).any() and not np.isnan(loaded[0].phi).any():
            notes = ("POLE= overrides the column phi",)
    else:
        loaded = [trajectories.make(one) for one in (trajectories.TRAJECTORIES if name == "all" else [name])]
    loaded = [replace(one, frame=None if axis == "z" else to_z(axis)) for one in loaded]
    if loaded[0].hand is not None:
        return [_of_hands(arguments, loaded[0], robot, notes)]
    if robot:
        raise InputError(
            f"argument --robot: {name} has no orientations of a hand, such as columns qw,qx,qy,qz or roll,pitch,yaw"
        )
    turned = (_guided(one, arguments.pole, arguments.soft) for one in loaded)
    return [Prepared(one, *to_words(one, width), notes=notes) for one in turned]


def _robot(arguments: Options) -> arms.Arm | None:
    """Return the arm that --robot selects, or None. Raises InputError, and OSError for a file that cannot be read."""
    name, ends = arguments.robot, (arguments.base, arguments.tip)
    if name is None or name in arms.ROBOTS:
        if any(ends):
            raise InputError("argument --robot: --base and --tip need a URDF file")
        return arms.ROBOTS.get(name)
    if not name.lower().endswith(".urdf") and not os.path.exists(name):
        raise InputError(f"argument --robot: unknown robot {name!r}; valid: {', '.join(arms.ROBOTS)}, a URDF file")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # _of_hands prints more about an arm that is not exact
            return arms.Arm.from_urdf(name, *ends)
    except ValueError as error:
        raise InputError(f"argument --robot: {error}") from None


def _of_hands(arguments: Options, poses: Targets, robot: arms.Arm | None, notes: tuple[str, ...]) -> Prepared:
    """Prepare a trajectory of hand poses. Raises InputError or TargetError."""
    if arguments.soft is not None:
        raise InputError("argument --soft: applies to wrist targets, not to hand poses")
    targets, of_robot = poses, {}
    if robot:
        if robot.chain:
            robot, distance, turn = robot.nearest()
            text = "the core solves the nearest exact arm, and its joints are not corrected"
            notes = (*notes, f"{text}: the tip is off by up to {distance:.3g} and {turn:.3g} rad")
        seconds = times(poses, arguments.rate)
        try:
            with progress(f"planning {len(poses)} rows", len(poses)) as meter:
                targets, path = planned(robot, poses, arguments.plan == "rows", meter)
        except ValueError as error:
            raise InputError(f"argument --robot: {error}") from None
        names = [name for name in ("d1", "d2") if name not in poses.default_arm] + ["tool"] * ("tool" in poses.others)
        differ = [name for name in names if (getattr(targets, name) != getattr(poses, name)).any()]
        if differ and poses.path is not None:
            notes = (*notes, f"ROBOT= overrides {', '.join(differ)} of the file")
        notes = (*notes, *_jumps(targets, path))
        of_robot = {"robot": robot, "path": path, "seconds": seconds}
        if "branch" not in poses.others:
            of_robot["references"] = core.binary_angles(np.nan_to_num(robot.angles(path.joints)), arguments.width)
    limits = core.limit_words(robot.bounds if robot else None, arguments.width)
    for name, (low, high) in zip(robot.names if robot else (), limits, strict=False):
        if low > high:
            raise InputError(f"argument --robot: the limits of {name} contain no {arguments.width}-bit angle")
    targets = _guided(targets, arguments.pole, None)
    words = to_words(targets, arguments.width)
    return Prepared(targets, *words, notes=notes, limits=limits, **of_robot)


def _jumps(targets: Targets, path: JointPath) -> Iterator[str]:
    """Yield a line for each of the first `JUMPS` rows that jump or have no joints, and a line that counts the rest."""
    for n, text in list(path.jumps.items())[:JUMPS]:
        yield f"{f'row {targets.rows[n]}' if targets.rows is not None else f'target {n}'}: {text}"
    if len(path.jumps) > JUMPS:
        yield f"{len(path.jumps) - JUMPS} more such rows"


def _of_clip(arguments: Options) -> Prepared:
    """Prepare the limbs of a clip as one stream of targets. Raises TargetError."""
    clip = clips.read(Path(arguments.trajectory), arguments.up)
    limbs = clips.arms(clip, arguments.arm or "both", arguments.joints, arguments.limb or "arms")
    moves = tuple(clips.motion(clip, arm, arguments.axis or TORSO) for arm in limbs)
    angle_of = {"clip": lambda move: move.phi, "constant": lambda move: move.typical_phi}
    phi = [angle_of.get(arguments.phi or "clip", lambda move: arguments.phi)(move) for move in moves]
    pole = arguments.pole
    if pole is not None:
        at = clip.positions[:, clips.named(clip, pole)[0]] if isinstance(pole, str) else np.asarray(pole)
        pole = clips.interleaved([at - clip.positions[:, arm.upper] for arm in limbs])
    # Run hand poses, unless --datapath is given: it selects a datapath of wrist targets.
    by_hand = "datapath" not in arguments.given and all(move.hand is not None for move in moves)
    targets = _guided(clips.targets(clip, moves, phi, arguments.width, by_hand), pole, arguments.soft)
    scale = clips.metres(arguments.scale or "auto", float(np.median([move.arm_length for move in moves])))
    words = to_words(targets, arguments.width)
    limits = core.limit_words(None, arguments.width) if by_hand else None
    return Prepared(targets, *words, clip, moves, arguments.twist or "clip", scale, clip.notes, limits=limits)


def _guided(targets: Targets, pole: ArrayLike | None, soft: float | None) -> Targets:
    """Apply `pole` (points relative to the shoulder, (3,) or (N, 3)) and `soft`; None leaves the targets unchanged."""
    if pole is not None:
        poles = targets.points_to_core(np.broadcast_to(pole, (len(targets), 3)))
        targets = replace(targets, phi=swivel((0.0, 0.0, 0.0), poles, targets.core_wrist))
    if soft is not None:
        x, y, z = soft_reach(targets.position, targets.d1, targets.d2, soft).T
        targets = replace(targets, x=x, y=y, z=z)
    return targets


def prepare(arguments: Options) -> list[Prepared]:
    """Load the trajectories, print warnings and choose the simulator. Raises InputError or TargetError."""
    prepared = _load(arguments)
    for item in prepared:
        path = item.targets.path  # None: built-in
        for doubt in (*item.notes, *(doubts(item.targets, item.robot is None) if path is not None else ())):
            print(f"warning: {path or item.targets.name}: {doubt}", file=sys.stderr)
    choose_simulator(arguments, sum(len(item.words) for item in prepared))
    return prepared


def doubts(targets: Targets, free: bool) -> Iterator[str]:
    """Yield warnings about wrong units and elbow jumps. free: the user may set axis and lengths (no --robot)."""
    distance = np.linalg.norm(targets.core_wrist, axis=1)
    out = int(np.count_nonzero((distance > STRAIGHT * targets.reach) | (distance < np.abs(targets.d1 - targets.d2))))
    if 2 * out > len(targets):
        arms = f"an arm of {targets.d1[0]:g} + {targets.d2[0]:g}{targets.arm_note}"
        units = "x, y, z, d1 and d2; D1= and D2= set another arm" if free else "x, y, z and the robot"
        yield f"{out} of {len(targets)} targets are out of reach of {arms}; use one unit of length for {units}"
    turns = {name: np.array(targets.others[name], dtype=float) for name in EULER if name in targets.others}
    yield from filter(None, (angle_doubt(angles, name) for name, angles in {"phi": targets.phi, **turns}.items()))
    rows, axis = elbow_jumps(targets)
    if len(rows) and free:
        kind, names = ("frame", targets.others["frame"]) if targets.rows is None else ("row", targets.rows)
        where = list(dict.fromkeys(str(names[n]) for n in rows))
        more = f" and {len(where) - 3} more" if len(where) > 3 else ""
        at = f"{kind}{'s' * (len(where) > 1)} {', '.join(where[:3])}{more}"
        better = f"AXIS={','.join(f'{part:g}' for part in axis)} is farther from its path"
        yield f"the elbow jumps at {at}, because the wrist passes close to the reference axis; {better}"


def simulated(arguments: Options, datapath: str, prepared: Sequence[Prepared], waves: Path | None = None) -> list[Run]:
    """Run all trajectories through a datapath in one simulation. With `references`, the core chooses the branch nearest
    to the planned joints. Raises SimulationError."""
    total = sum(len(item.words) for item in prepared)
    with progress(f"{arguments.sim}, {datapath} datapath, {total} targets", total) as meter:
        meter(0, "compiling and starting")
        jobs, chooses = [item.words for item in prepared], prepared[0].references is not None
        if chooses:  # robots come alone
            jobs = [np.insert(jobs[0], [len(ARM_FIELDS)] * 7, prepared[0].references, axis=1)]
            datapath = CHOOSING[datapath]
        core = {"simulator": arguments.sim, "datapath": datapath, "width": arguments.width, "cores": arguments.cores}
        core |= {"limits": prepared[0].limits, "waves": waves}
        runs = simulate(jobs, progress=lambda done, _: meter(done), **core)
    if not chooses:
        return runs
    bits = (1 << ARM_FLAG_BITS) - 1
    return [replace(run, flags=run.flags & bits, branch=run.flags >> ARM_FLAG_BITS & 7) for run in runs]


def score_runs(
    arguments: Options, datapath: str, prepared: Sequence[Prepared], runs: Sequence[Run], predict: bool = True
) -> list[tuple[Run, Score]]:
    """Return each run with its score. With `predict`, scores of wrist targets include predicted errors."""
    core = {"width": arguments.width, "datapath": datapath, "simulator": arguments.sim}
    scored = []
    for item, run in zip(prepared, runs, strict=True):
        wrists = item.targets.hand is None
        predicted = predicted_error(item.words, arguments.width, datapath) if predict and wrists else None
        places = placed(item, run, arguments.width) if item.clip else None
        more = {"tolerance": arguments.tolerance, "predicted": predicted, "placed": places, "limits": item.limits}
        more |= {"strict": item.robot is not None and arguments.limits != "report"}
        result = score(item.targets, item.words, item.exponent, run, **core, **more)
        if result.passed and item.path and (item.path.jumps or result.over_limit):  # not a pass without a word
            text = f"targets that jump or have no joints: {len(item.path.jumps)}; outside limits: {result.over_limit}"
            result = replace(result, outcome=f"warn: {text}; {result.outcome[6:]}")
        scored.append((run, result))
    return scored


def elbow_errors(item: Prepared, result: Score) -> np.ndarray:
    """Return the distances (N,) from the core's elbows to the clip's elbows, relative to the reach."""
    elbow = clips.interleaved([move.elbow for move in item.moves])
    ours = np.ldexp(result.per_target.elbow, -result.scale_exponent)
    return np.linalg.norm(ours - elbow, axis=1) / item.targets.reach


def positions(item: Prepared, result: Score) -> np.ndarray:
    """Return the robot's joint positions (N, 7) from the core's angles and the whole turns of the planned path."""
    return item.robot.positions(result.per_target.hand.joints, item.path.joints)


def speeds_of(item: Prepared, result: Score) -> Speeds:
    """Return the speeds of the robot's joints; empty without times or robot. Rows without joints are skipped."""
    if item.seconds is None or not (item.robot and item.path):
        return Speeds()
    at, moves = positions(item, result), [np.zeros((1, 7))]
    for rows in item.targets.paths:
        rows = rows[np.isfinite(item.path.joints[rows, 0])]
        moves.append(np.abs(np.diff(at[rows], axis=0)) / np.diff(item.seconds[rows])[:, None])
    speeds = np.concatenate(moves)
    limits = item.robot.velocities
    limits = np.where(limits > 0, limits, np.inf)  # some files have 0 for an unknown limit
    return Speeds(item.robot.names, speeds.max(axis=0), limits, np.count_nonzero(speeds > limits, axis=0))


def quaternions(item: Prepared, ran: Run, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the results of a run: Qs (N, 4) in the user's frame, and Qe (N, 4)."""
    first = 0 if item.targets.hand is None else len(joints.JOINTS)
    values = result_values(ran.results[:, first : first + len(RESULT_FIELDS)], width)
    return item.targets.from_core(values[:, :4]), np.pad(values[:, 4:], ((0, 0), (0, 2)))


def by_joints(item: Prepared, ran: Run, width: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Compute Qs, Qe and Qh, (N, 4) each, from the seven joint angles of a run. Qs and Qh are in the user's frame."""
    th, targets = ran.results[:, : len(joints.JOINTS)].T * (2 * np.pi / 2**width), item.targets
    qe = np.array((np.sin(th[3] / 2), -np.cos(th[3] / 2), 0 * th[3], 0 * th[3])).T
    _, qh = joints.reached(th, targets.d1, targets.d2, targets.tool)
    return targets.from_core(joints.turned(*th[:3]).T), qe, targets.from_core(qh)


def turned(item: Prepared, ran: Run, width: int) -> Clip:
    """Return the clip with its limbs turned by the core's quaternions or, for hand poses, by the seven angles. The clip
    is parsed from the content of its file, so it includes the rounding of written numbers."""
    turns = (quaternions if item.targets.hand is None else by_joints)(item, ran, width)
    moves = [(move, *(q[n :: len(item.moves)] for q in turns)) for n, move in enumerate(item.moves)]
    content = clips.turned(item.clip, moves, item.twist).content()
    return replace(clips.parse(content, item.clip.path), up=item.clip.up)


def placed(item: Prepared, ran: Run, width: int) -> tuple[np.ndarray, ...]:
    """Return the turned clip's elbows and wrists relative to the shoulders, (N, 3) each, and for hand poses the
    orientations of the hands (N, 4)."""
    clip = turned(item, ran, width)
    at, limbs = clip.positions, [move.limb for move in item.moves]
    upper, fore, hand = ([getattr(limb, name) for limb in limbs] for name in ("upper", "fore", "hand"))
    places = [(at[:, ends] - at[:, upper]).reshape(-1, 3) for ends in (fore, hand)]
    if item.targets.hand is not None:
        places.append(clips.interleaved([clips.hands(clip, limb) for limb in limbs]))
    return tuple(places)


def sources(prepared: Iterable[Prepared]) -> list[Path]:
    """Return the files from which the trajectories were read."""
    return [Path(item.targets.path) for item in prepared if item.targets.path is not None]


def csv_paths(folder: Path, prepared: Sequence[Prepared]) -> list[Path]:
    """Return the path of results.csv for each trajectory."""
    many = len(prepared) > 1
    return [folder / item.targets.name / "results.csv" if many else folder / "results.csv" for item in prepared]


def result_paths(folder: Path, prepared: Sequence[Prepared]) -> list[Path]:
    """Return the paths that `write_results` writes for one datapath."""
    tables = csv_paths(folder, prepared)
    clip = [folder / name for name in ("clip.bvh", "clip.glb") if prepared[0].clip]
    return [*tables, *(path.with_suffix(".npz") for path in tables), *clip]


def outputs(out: Path, folders: Iterable[Path], prepared: Sequence[Prepared], *others: Path) -> ContextManager[Place]:
    """Return the context manager of :func:`output` for `others` and all files that `write_results` writes."""
    paths = [*others, *(path for folder in folders for path in result_paths(folder, prepared)), out / SCORES]
    return output(out, paths, sources(prepared))


Done = Sequence[Sequence[tuple[Run, Score]]]  # for each datapath, the run and the score of each trajectory


def write_results(files: Place, out: Path, folders: Iterable[Path], prepared: Sequence[Prepared], done: Done) -> None:
    """Write the result files of each datapath and one score.json; `files` maps a path to a temporary path to write."""
    for folder, scored in zip(folders, done, strict=True):
        for path, item, (ran, result) in zip(csv_paths(folder, prepared), prepared, scored, strict=True):
            targets = item.targets
            if item.clip:
                errors = {"elbow_error": elbow_errors(item, result).tolist()}
                targets = replace(targets, others=targets.others | errors)
                clip = turned(item, ran, result.width)
                files(path.with_name("clip.bvh")).write_bytes(clip.content())
                files(path.with_name("clip.glb")).write_bytes(gltf.animated(clip, targets.name, item.scale))
            more = {}
            if item.robot:
                at = positions(item, result)
                more = dict(zip(item.robot.names, at.T, strict=True))
                apart = np.flatnonzero(np.abs(at - item.path.joints).max(axis=1) > APART)
                notes, of = [], f"{len(targets)} targets"
                if ran.branch is not None:
                    targets = replace(targets, others=targets.others | {"branch": [*map(str, ran.branch.tolist())]})
                    if count := np.count_nonzero(ran.branch != targets.branch):
                        notes.append(f"the core chooses another branch than the planner for {count} of {of}")
                if count := len(apart):
                    notes.append(f"joints differ from the planned ones in {count} of {of}; first: target {apart[0]}")
                for note in filter(None, (*notes, speeds_of(item, result).doubt())):
                    print(f"warning: {targets.name}: {note}", file=sys.stderr)
            for suffix, content in tables(targets, ran, result, more).items():
                files(path.with_suffix(suffix)).write_bytes(content)
    files(out / SCORES).write_bytes(score_json([result for scored in done for _, result in scored]))
