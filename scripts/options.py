# SPDX-License-Identifier: Apache-2.0
"""Options of commands that run trajectories through the core."""

import os
from pathlib import Path

import click

from model.dataflow.datapaths import DEFAULT
from model.io import trajectories
from model.io.words import DEFAULT_D1, DEFAULT_D2
from model.motion import arms
from model.motion import clip as clips
from model.motion.clip import SIDES
from model.motion.pose import NAMED_AXES
from scripts.console import POSITIVE, Finite, core_options, option, point, reference_axis, swivel_angle
from tb.sim.env import CORES

MOST_DATAPATHS = 3  # largest number of datapaths that a command compares


def trajectory_options(
    out: str, written: str, *, datapath: str | None = DEFAULT, most: int = 1, core: bool = True
) -> list[click.Option]:
    """Return the options of a command that runs trajectories.

    out: default of --out. written: names of the files there, for the help. datapath: default of --datapath, None if it
    depends on the trajectory. most: largest number of names that --datapath takes. core: return the core's options too.
    """
    trajectory = (
        "a built-in trajectory (see --list), all of wrist targets, a CSV file with a header (x,y,z and optionally phi "
        "in rad, d1, d2; any unit of length; for hands qw,qx,qy,qz or roll,pitch,yaw in rad, tool, branch), or a BVH "
        "motion-capture clip"
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
    plan = "choose branch and swivel angle of hand poses along the whole path, or of each row alone  [default: path]"
    limits = "rows with a joint outside the limits of ROBOT: fail the run, or report them  [default: fail]"
    rate = "rows per second of a ROBOT's path, for the speeds of its joints; without it: by a column t (seconds)"
    link = "of a URDF file, if its chain is not the only one"
    tolerance = (
        "largest permitted hand error / reach (default: the table in model/bounds/tolerances.py, which has none for "
        "the paper datapath near singular poses or below 32 bits)"
    )
    return [
        option("--trajectory", trajectory, os.path.expanduser, default=trajectories.DEFAULT, metavar="NAME|all|FILE"),
        option("--out", f"folder for {written}, created if missing", Path, default=out, metavar="DIR"),
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
        option("--plan", plan, click.Choice(["path", "rows"])),
        option("--rate", rate, POSITIVE, metavar="HZ"),
        option("--limits", limits, click.Choice(["fail", "report"])),
        option("--base", f"first link {link}", metavar="LINK"),
        option("--tip", f"last link {link}", metavar="LINK"),
        option("--tolerance", tolerance, POSITIVE, metavar="ERROR"),
    ]
