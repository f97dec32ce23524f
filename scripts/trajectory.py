# SPDX-License-Identifier: Apache-2.0
"""Options of commands that run the core, and the targets of --trajectory as words; all input is checked here."""

import os
import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import SimpleNamespace

import click
import numpy as np
from numpy.typing import ArrayLike

from model.dataflow import fixed
from model.dataflow.datapaths import ARM, DATAPATHS, DEFAULT
from model.dataflow.nodes import Limits
from model.io import trajectories
from model.io.files import read_csv
from model.io.words import DEFAULT_D1, DEFAULT_D2, Targets, angle_doubt, to_words
from model.motion import arms
from model.motion import clip as clips
from model.motion.clip import SIDES, TORSO, Clip, Motion
from model.motion.hands import limit_words
from model.motion.pose import NAMED_AXES, elbow_jumps, hanging, soft_reach, swivel, to_z
from scripts.console import POSITIVE, Finite, InputError, core_options, option, point, reference_axis, swivel_angle
from tb.sim.env import CORES

MOST_DATAPATHS = 3  # number of datapaths that a command can compare


@dataclass(frozen=True)
class Prepared:
    """A trajectory ready to run: its targets and their words (N, 6); scale: metres in a clip's unit of length; notes:
    warnings, each one line; limits: of the joints of hand poses, words."""

    targets: Targets
    words: np.ndarray
    exponent: int
    clip: Clip | None = None
    moves: tuple[Motion, ...] = ()
    twist: str = "clip"
    scale: float = 1.0
    notes: tuple[str, ...] = ()
    robot: arms.Arm | None = None
    limits: Limits | None = None

    def core_words(self, width: int) -> np.ndarray:
        """Return the words (N, 6) of the wrist targets; of hand poses those that the hand's section computes."""
        return self.words if self.targets.hand is None else fixed.of_hands(self.words[:, :-1], width)[0]


def trajectory_options(
    out: str, written: str, *, datapath: str | None = DEFAULT, most: int = 1, core: bool = True
) -> list[click.Option]:
    """Return the options of a command that runs trajectories.

    out: default of --out; written: files there, for its help; datapath: the default, None if it depends on the
    trajectory (`datapaths`); most: number of names that --datapath takes; core: True if the command has the core's
    options.
    """
    trajectory = (
        "a built-in trajectory (see --list), all of wrist targets, a CSV file with a header (x,y,z and optionally phi "
        "in rad, d1, d2; any unit of length; for hands qw,qx,qy,qz, tool, branch), or a BVH motion-capture clip"
    )
    cores = "dividers and roots of the paper datapath: behavioural, or rows for synthesis; the results are the same"
    axis = (
        "reference axis of swivel angles in the frame of the targets: z, -z, x, ... or a vector such as 0.3,1,0; no "
        "wrist may come near its line, in either direction; torso: outward and up from a clip's torso  "
        "[default: z; for a clip: torso]"
    )
    joints = (
        "clip: shoulder, elbow and wrist joints, if not recognized by name, such as LeftArm,LeftForeArm,LeftHand; six "
        "for both sides, left first"
    )
    up = "clip: up axis of clip.glb and report  [default: from the feet to the head]"
    twist = "clip: rotation of each bone about itself, from the clip or from the core  [default: clip]"
    scale = "clip: unit of length; clip.glb is in metres  [default: auto, from the arm lengths]"
    row = "for rows of a CSV file without that column"
    phi = (
        "swivel angle; CSV file: for rows without that column (default: the elbow hangs down); clip: clip, its own "
        "angles (default), constant, the mean of each arm, or one number"
    )
    pole = "point the elbow at X,Y,Z (CSV file: from the shoulder; clip: world) or at a clip's joint; overrides phi"
    soft = "outer fraction of the reach, 0 to 1, in which CSV or clip targets are pulled in smoothly"
    robot = "arm with its lengths, tool and joint limits; hand poses are poses of its tip in its base frame"
    link = "of a URDF file, if its chain is not the only one"
    bar = (
        "largest permitted hand error / reach (default: the table in model/bounds/tolerances.py, which has none for "
        "the paper datapath near singular poses or below 32 bits)"
    )
    about = f"folder for {written}, created if missing"
    return [
        option("--trajectory", trajectory, os.path.expanduser, default=trajectories.DEFAULT, metavar="NAME|all|FILE"),
        option("--out", about, Path, default=out, metavar="DIR"),
        *(core_options(datapath=datapath, most=most) if core else ()),
        *([option("--cores", cores, click.Choice(CORES), default=CORES[0])] if core else ()),
        option("--axis", axis, reference_axis, metavar="AXIS"),
        option("--arm", "clip: sides to run  [default: both]", click.Choice(["both", *SIDES])),
        option("--limb", "clip: limbs to run  [default: arms]", click.Choice([*clips.LIMBS])),
        option("--joints", joints, lambda text: text.split(","), metavar="UPPER,FORE,HAND"),
        option("--up", up, click.Choice(NAMED_AXES)),
        option("--twist", twist, click.Choice(clips.TWISTS)),
        option("--scale", scale, click.Choice([*clips.UNITS, "auto"])),
        option("--d1", f"upper arm, {row}  [default: {DEFAULT_D1}]", POSITIVE, metavar="LENGTH"),
        option("--d2", f"forearm, {row}  [default: {DEFAULT_D2}]", POSITIVE, metavar="LENGTH"),
        option("--phi", phi, swivel_angle, metavar="RAD|clip|constant"),
        option("--pole", pole, point, metavar="X,Y,Z|JOINT"),
        option("--soft", soft, Finite(0, 1), metavar="FRACTION"),
        option("--robot", robot, os.path.expanduser, metavar="|".join((*arms.ROBOTS, "FILE.urdf"))),
        option("--base", f"first link {link}", metavar="LINK"),
        option("--tip", f"last link {link}", metavar="LINK"),
        option("--bar", bar, POSITIVE, metavar="ERROR"),
    ]


def datapaths(arguments: SimpleNamespace, prepared: Sequence[Prepared]) -> dict[str, Path]:
    """Return the datapaths to run, each with the folder of its results. Without --datapath both dataflows run on the
    paper's scenario, arm on hand poses, and lean on anything else. Raises InputError."""
    scenario = arguments.trajectory == trajectories.DEFAULT
    chosen = arguments.datapath or (list(DATAPATHS) if scenario else [DEFAULT])
    chosen = [chosen] if isinstance(chosen, str) else chosen
    if prepared[0].targets.hand is not None:
        if "datapath" in arguments.given:
            raise InputError(f"argument --datapath: applies to wrist targets; hand poses always run on {ARM.name}")
        chosen = [ARM.name]
    return {each: arguments.out / each for each in chosen} if len(chosen) > 1 else {chosen[0]: arguments.out}


BUILT_IN, CSV, CLIP = "built-in trajectory", "CSV file", "BVH clip"

GOES_WITH = dict.fromkeys(("d1", "d2"), (CSV,)) | dict.fromkeys(("phi", "pole", "soft"), (CSV, CLIP))
GOES_WITH |= dict.fromkeys(("robot",), (CSV, BUILT_IN))
GOES_WITH |= dict.fromkeys(("arm", "limb", "joints", "up", "twist", "scale"), (CLIP,))
"""Options that only some kinds of trajectories take."""

OF_CLIPS = (("axis", TORSO), ("phi", "clip"), ("phi", "constant"))


def _kind(name: str) -> str:
    """Return the kind of --trajectory. Raises InputError."""
    if name in ("all", *trajectories.TRAJECTORIES, *trajectories.HANDS):
        return BUILT_IN
    if name.lower().endswith(".bvh"):
        return CLIP
    if name.lower().endswith(".csv") or os.sep in name or os.path.exists(name):
        return CSV
    valid = ", ".join(("all", *trajectories.TRAJECTORIES, *trajectories.HANDS))
    raise InputError(f"argument --trajectory: unknown trajectory {name!r}; valid: {valid}, a CSV file or a BVH clip")


def _load(arguments: SimpleNamespace) -> list[Prepared]:
    """Return the trajectories of --trajectory. Raises InputError or TargetError."""
    name, width, axis = arguments.trajectory, arguments.width, arguments.axis or "z"
    kind = _kind(name)
    own = trajectories.ROBOTS.get(name)
    arguments.robot = arguments.robot or own
    for given, kinds in GOES_WITH.items():
        if getattr(arguments, given) is not None and kind not in kinds:
            goes = " or a ".join(kinds)
            raise InputError(f"argument --{given}: applies to a {goes}, not to a {kind} ({name})")
    for one, other in (("pole", "phi"), *(("robot", name) for name in ("axis", "d1", "d2"))):
        if getattr(arguments, one) is not None and getattr(arguments, other) is not None:
            raise InputError(f"--{one} and --{other} exclude each other")
    if kind == CLIP:
        return [_of_clip(arguments)]
    if isinstance(arguments.pole, str):
        raise InputError(f"argument --pole: {arguments.pole!r} is not x,y,z; a joint's name applies to a {CLIP}")
    for given, word in OF_CLIPS:
        if getattr(arguments, given) == word:
            raise InputError(f"argument --{given}: {word} applies to a {CLIP}, not to a {kind} ({name})")
    robot = _robot(arguments)
    notes = (f"the poses are for ROBOT={own}",) if arguments.robot != own and own else ()
    if kind == CSV:
        phi = (None if robot else hanging(axis)) if arguments.phi is None else arguments.phi
        found = [read_csv(name, d1=arguments.d1, d2=arguments.d2, phi=phi)]
        if arguments.pole is not None and (found[0].phi != phi).any() and not np.isnan(found[0].phi).any():
            notes = ("POLE= overrides the column phi",)
    else:
        found = [trajectories.make(each) for each in (trajectories.TRAJECTORIES if name == "all" else [name])]
    frame = None if axis == "z" else to_z(axis)
    found = [replace(one, frame=frame) for one in found]
    if found[0].hand is not None:
        return [_of_hands(arguments, found[0], robot, notes)]
    if robot:
        raise InputError(f"argument --robot: {name} has no orientations of a hand, such as columns qw,qx,qy,qz")
    turned = (_guided(one, arguments.pole, arguments.soft) for one in found)
    return [Prepared(each, *to_words(each, width), notes=notes) for each in turned]


def _robot(arguments: SimpleNamespace) -> arms.Arm | None:
    """Return the arm of --robot. Raises InputError, and OSError for a file that cannot be read."""
    name, ends = arguments.robot, (arguments.base, arguments.tip)
    if name is None or name in arms.ROBOTS:
        if any(ends):
            raise InputError("argument --robot: --base and --tip need a URDF file")
        return arms.ROBOTS.get(name)
    if not name.lower().endswith(".urdf") and not os.path.exists(name):
        raise InputError(f"argument --robot: unknown robot {name!r}; valid: {', '.join(arms.ROBOTS)}, a URDF file")
    try:
        return arms.Arm.from_urdf(name, *ends)
    except ValueError as error:
        raise InputError(f"argument --robot: {error}") from None


def _of_hands(arguments: SimpleNamespace, targets: Targets, robot: arms.Arm | None, notes: tuple[str, ...]) -> Prepared:
    """Return hand poses ready to run. Raises InputError or TargetError."""
    if arguments.soft is not None:
        raise InputError("argument --soft: applies to wrist targets, not to hand poses")
    if robot:
        try:
            own, given = robot.targets(targets), targets
        except ValueError as error:
            raise InputError(f"argument --robot: {error}") from None
        differ = [name for name in ("d1", "d2") if name not in given.default_arm]
        differ = [name for name in differ if (getattr(own, name) != getattr(given, name)).any()]
        differ += ["tool"] if "tool" in given.others and (own.tool != given.tool).any() else []
        if differ and given.path is not None:
            notes = (*notes, f"ROBOT= overrides {', '.join(differ)} of the file")
        targets = own
    limits = limit_words(robot.bounds if robot else None, arguments.width)
    for name, (low, high) in zip(robot.names if robot else (), limits, strict=False):
        if low > high:
            raise InputError(f"argument --robot: no word of {arguments.width} bits is within the limits of {name}")
    targets = _guided(targets, arguments.pole, None)
    words = to_words(targets, arguments.width)
    return Prepared(targets, *words, notes=notes, robot=robot, limits=limits)


def _of_clip(arguments: SimpleNamespace) -> Prepared:
    """Return the arms of a clip as one stream. Raises TargetError."""
    clip = clips.read(Path(arguments.trajectory), arguments.up)
    limbs = clips.arms(clip, arguments.arm or "both", arguments.joints, arguments.limb or "arms")
    moves = tuple(clips.motion(clip, arm, arguments.axis or TORSO) for arm in limbs)
    own = {"clip": lambda move: move.phi, "constant": lambda move: move.typical_phi}
    phi = [own.get(arguments.phi or "clip", lambda move: arguments.phi)(move) for move in moves]
    pole = arguments.pole
    if pole is not None:
        at = clip.positions[:, clips.named(clip, pole)[0]] if isinstance(pole, str) else np.asarray(pole)
        pole = np.stack([at - clip.positions[:, arm.upper] for arm in limbs], axis=1).reshape(-1, 3)
    # Hands go through the whole arm, unless a datapath of wrist targets is given.
    by_hand = "datapath" not in arguments.given and all(move.hand is not None for move in moves)
    targets = _guided(clips.targets(clip, moves, phi, arguments.width, by_hand), pole, arguments.soft)
    scale = clips.metres(arguments.scale or "auto", float(np.median([move.arm_length for move in moves])))
    words = to_words(targets, arguments.width)
    limits = limit_words(None, arguments.width) if by_hand else None
    return Prepared(targets, *words, clip, moves, arguments.twist or "clip", scale, clip.notes, limits=limits)


def _guided(targets: Targets, pole: ArrayLike | None, soft: float | None) -> Targets:
    """Return the targets with swivel angles toward a pole, (3,) or (N, 3) from the shoulder, and with a soft reach."""
    if pole is not None:
        poles = targets.points_to_core(np.broadcast_to(pole, (len(targets), 3)))
        targets = replace(targets, phi=swivel((0.0, 0.0, 0.0), poles, targets.core_wrist))
    if soft is not None:
        x, y, z = soft_reach(targets.position, targets.d1, targets.d2, soft).T
        targets = replace(targets, x=x, y=y, z=z)
    return targets


def prepare(arguments: SimpleNamespace) -> list[Prepared]:
    """Load the trajectories and print warnings. Raises InputError or TargetError."""
    prepared = _load(arguments)
    for item in prepared:
        path = item.targets.path  # None: built-in
        for doubt in (*item.notes, *(doubts(item.targets, item.robot is None) if path is not None else ())):
            print(f"warning: {path or item.targets.name}: {doubt}", file=sys.stderr)
    return prepared


def sources(prepared: Iterable[Prepared]) -> list[Path]:
    """Return the files that the trajectories were read from."""
    return [Path(item.targets.path) for item in prepared if item.targets.path is not None]


def doubts(targets: Targets, free: bool = True) -> Iterator[str]:
    """Yield a warning for each sign of a wrong unit, and for jumps of the elbow; free: axis and lengths are options."""
    distance = np.linalg.norm(targets.core_wrist, axis=1)
    out = int(np.count_nonzero((distance > targets.reach) | (distance < np.abs(targets.d1 - targets.d2))))
    if 2 * out > len(targets):
        arms = f"an arm of {targets.d1[0]:g} + {targets.d2[0]:g}{targets.arm_note}"
        units = "x, y, z, d1 and d2; D1= and D2= set another arm" if free else "x, y, z as the robot has"
        yield f"{out} of {len(targets)} targets are out of reach of {arms}; use one unit of length for {units}"
    if doubt := angle_doubt(targets.phi):
        yield doubt
    rows, axis = elbow_jumps(targets)
    if len(rows) and free:
        kind, names = ("frame", targets.others["frame"]) if targets.rows is None else ("row", targets.rows)
        where = list(dict.fromkeys(str(names[n]) for n in rows))
        more = f" and {len(where) - 3} more" if len(where) > 3 else ""
        at = f"{kind}{'s' * (len(where) > 1)} {', '.join(where[:3])}{more}"
        better = f"AXIS={','.join(f'{part:g}' for part in axis)} is farther from its path"
        yield f"the elbow jumps at {at}, because the wrist passes close to the reference axis; {better}"
