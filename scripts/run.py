# SPDX-License-Identifier: Apache-2.0
"""Run trajectories through the core in a simulator and score them: what `make run` does.

    python -m scripts.run [--trajectory NAME|all|FILE.csv] [--out DIR] [--sim icarus|verilator] ...

Writes OUT/results.csv (for `all`: OUT/<trajectory>/results.csv) and OUT/score.json, and prints a table.
Exit status: 0 if every trajectory passes, 1 if one fails or the simulation breaks off, 2 for input that
cannot be used (one line on stderr, nothing written), 130 after Ctrl-C, 143 after SIGTERM, 129 after SIGHUP.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pybvh

from model.bounds.predict import hand_bar
from model.motion import clip as clips
from model.motion import gltf
from model.motion.axes import to_z
from model.motion.clip import SIDES, TORSO, Clip, Motion
from model.motion.pose import hanging
from model.targets import trajectories
from model.targets.files import read_csv, write_atomically
from model.targets.scoring import Score, score, write_results_csv, write_results_npz, write_score_json
from model.targets.words import DEFAULT_D1, DEFAULT_D2, Targets, result_values, to_words
from scripts.console import (
    InputError,
    Parser,
    accuracy,
    arm_length,
    command,
    folder_name,
    output,
    progress,
    reference_axis,
    show,
    swivel_angle,
    whole_file,
    writing,
)
from scripts.tables import table_of_many, table_of_one, verdict
from scripts.waves import write_save_file
from tb.sim.env import CORES
from tb.sim.simulate import LONG, Job, Run, simulate

ALL = "all"

EVERY = 5
"""Seconds between lines of progress where there is no terminal."""

@dataclass(frozen=True)
class Prepared:
    """A trajectory that is ready to run: its targets and the words (N, 6) that `to_words` made of them."""

    targets: Targets
    words: np.ndarray
    exponent: int
    clip: Clip | None = None
    moves: tuple[Motion, ...] = ()


# -- the command line ------------------------------------------------------------------------------


def parser_of(
    command: str, description: str, *, out: str, written: str,
    passes: str = "all trajectories pass", fails: str = "one fails",
) -> Parser:  # fmt: skip
    """The parser of a command that runs trajectories, with the options that all of them have.

    out: the default of --out; written: what is written there, for its help; passes, fails: as of `Parser`.
    """
    parser = Parser(command, description, passes=passes, fails=fails)
    about = (
        "a built-in trajectory (see --list), all of them, a CSV file with a header: x,y,z and optionally phi (rad), "
        "d1, d2, in any unit of length, or a BVH clip of motion capture (default: %(default)s)"
    )
    parser.add_argument("--trajectory", default=trajectories.DEFAULT, metavar="NAME|all|FILE", help=about)
    about = f"folder for {written}, made if need be (default: %(default)s)"
    parser.add_argument("--out", type=folder_name, default=Path(out), metavar="DIR", help=about)
    parser.core()
    parser.choice(
        "--cores", "cores", CORES, CORES[0],
        "the dividers and roots, which only the paper datapath has: behavioural, or made of rows for synthesis; "
        "the results are the same (default: %(default)s)",
    )  # fmt: skip
    about = (
        "reference axis, from which swivel angles count: z, -z, x, .. or a vector such as 0.3,1,0, in the frame of the "
        "targets; it should point where no wrist goes; torso, of a clip: outward and up (default: z; of a clip: torso)"
    )
    parser.add_argument("--axis", type=reference_axis, metavar="AXIS", help=about)
    parser.choice("--arm", "arm", ("both", *SIDES), None, "of a clip: which arms (default: both)")
    about = "of a clip: the joints where upper arm, forearm and hand begin, for names that are not known"
    parser.add_argument("--joints", type=lambda text: text.split(","), metavar="UPPER,FORE,HAND", help=about)
    only_csv = "only with a CSV file, for rows of a file without that column"
    for option, kind, unit, what, default in (
        ("--d1", arm_length, "LENGTH", "upper arm", DEFAULT_D1),
        ("--d2", arm_length, "LENGTH", "forearm", DEFAULT_D2),
    ):
        parser.add_argument(option, type=kind, metavar=unit, help=f"{what}, {only_csv} (default: {default})")
    about = (
        "swivel angle: of rows of a CSV file without that column (default: the elbow hangs down); of a clip: its own, "
        "the mean of its own, or one number (default: clip)"
    )
    parser.add_argument("--phi", type=swivel_angle, metavar="RAD|clip|constant", help=about)
    about = (
        "accuracy asked for: the largest hand error / reach of any target (default: the table of "
        "model/bounds/tolerances.py, which asks nothing of the paper datapath near singular poses or below 32 bits)"
    )
    parser.add_argument("--bar", type=accuracy, metavar="ERROR", help=about)
    return parser


def _parser() -> Parser:
    about = "Run trajectories through the core in a simulator and score them."
    parser = parser_of("run", about, out="build/run", written="results.csv and score.json")
    parser.add_argument("--waves", action="store_true", help="also write OUT/waves.vcd and a GTKWave save file")
    parser.add_argument("--list", action="store_true", help="list the built-in trajectories and stop")
    return parser


# -- input and output, checked before anything is simulated ----------------------------------------


BUILT_IN, CSV, CLIP = "built-in trajectory", "CSV file", "BVH clip"

GOES_WITH = {"d1": (CSV,), "d2": (CSV,), "phi": (CSV, CLIP), "arm": (CLIP,), "joints": (CLIP,)}
"""Options that not every kind of trajectory takes."""

OF_CLIPS = (("axis", TORSO), ("phi", "clip"), ("phi", "constant"))


def _kind(name: str) -> str:
    """What --trajectory names. Raises InputError."""
    if name == ALL or name in trajectories.TRAJECTORIES:
        return BUILT_IN
    if name.lower().endswith(".bvh"):
        return CLIP
    if name.lower().endswith(".csv") or os.sep in name or os.path.exists(name):
        return CSV
    valid = ", ".join((ALL, *trajectories.TRAJECTORIES))
    raise InputError(f"argument --trajectory: unknown trajectory {name!r}; valid: {valid}, a CSV file or a BVH clip")


def _load(arguments: argparse.Namespace) -> list[Prepared]:
    """The targets that --trajectory asks for, and their words of --width bits. Raises InputError or TargetError."""
    name, width, axis = arguments.trajectory, arguments.width, arguments.axis or "z"
    kind = _kind(name)
    for option, kinds in GOES_WITH.items():
        if getattr(arguments, option) is not None and kind not in kinds:
            goes = " or a ".join(kinds)
            raise InputError(f"argument --{option}: goes with a {goes}, not with a {kind} ({name})")
    if kind == CLIP:
        return [_of_clip(arguments)]
    for option, word in OF_CLIPS:
        if getattr(arguments, option) == word:
            raise InputError(f"argument --{option}: {word} goes with a {CLIP}, not with a {kind} ({name})")
    if kind == CSV:
        phi = hanging(axis) if arguments.phi is None else arguments.phi
        found = [read_csv(name, d1=arguments.d1, d2=arguments.d2, phi=phi)]
    else:
        found = [trajectories.make(each) for each in (trajectories.TRAJECTORIES if name == ALL else [name])]
    frame = None if axis == "z" else to_z(axis)
    return [Prepared(each, *to_words(each, width)) for each in (replace(one, frame=frame) for one in found)]


def _of_clip(arguments: argparse.Namespace) -> Prepared:
    """The arms of a clip as one stream. Raises TargetError."""
    clip = clips.read(Path(arguments.trajectory))
    arms = clips.arms(clip, arguments.arm or "both", arguments.joints)
    moves = tuple(clips.motion(clip, arm, arguments.axis or TORSO) for arm in arms)
    own = {"clip": lambda move: move.phi, "constant": lambda move: move.typical_phi}
    phi = [own.get(arguments.phi or "clip", lambda move: arguments.phi)(move) for move in moves]
    targets = clips.targets(clip, moves, phi, arguments.width)
    return Prepared(targets, *to_words(targets, arguments.width), clip, moves)


def prepare(arguments: argparse.Namespace) -> list[Prepared]:
    """The trajectories of --trajectory as words of --width bits. Raises InputError or TargetError."""
    prepared = _load(arguments)
    for item in prepared:
        for doubt in doubts(item.targets):
            print(f"warning: {item.targets.path}: {doubt}", file=sys.stderr)
    return prepared


def doubts(targets: Targets) -> Iterator[str]:
    """What looks like another unit than is meant, a line each."""
    if targets.path is None:  # ours are meant
        return
    distance = np.linalg.norm(targets.position, axis=1)
    out = int(np.count_nonzero((distance > targets.reach) | (distance < np.abs(targets.d1 - targets.d2))))
    if 2 * out > len(targets):
        arms = f"an arm of {targets.d1[0]:g} + {targets.d2[0]:g}{targets.arm_note}"
        yield (
            f"{out} of {len(targets)} targets are out of reach of {arms}; "
            "are x, y, z, d1 and d2 in one unit of length? D1= and D2= give another arm"
        )
    turns = float(np.abs(targets.phi).max())
    if turns > 2 * np.pi:
        yield f"phi goes as far as {turns:g}; it is in radians, are these degrees?"


def result_paths(out: Path, prepared: Sequence[Prepared]) -> list[Path]:
    """Where `write_results` writes the results.csv of each trajectory."""
    many = len(prepared) > 1
    return [out / item.targets.name / "results.csv" if many else out / "results.csv" for item in prepared]


def written(out: Path, prepared: Sequence[Prepared]) -> list[Path]:
    """All that `write_results` writes."""
    tables = result_paths(out, prepared)
    clip = [out / f"clip.{kind}" for kind in CLIP_KINDS if prepared[0].clip]
    return [*tables, *(path.with_suffix(".npz") for path in tables), *clip, out / "score.json"]


# -- the run ---------------------------------------------------------------------------------------


def run_and_score(
    arguments: argparse.Namespace, prepared: Sequence[Prepared], waves: Path | None = None, predict: bool = True
) -> list[tuple[Run, Score]]:
    """Run all trajectories in one simulation and score them, in their order, beside the errors that are predicted
    if `predict` says so. Raises SimulationError."""
    jobs = [Job(name=item.targets.name, words=item.words) for item in prepared]
    total = sum(len(job.words) for job in jobs)
    with progress(f"{arguments.sim}, {total} targets", total, every=EVERY) as meter:
        meter(0, "compiling and starting")
        runs = simulate(
            jobs,
            simulator=arguments.sim,
            datapath=arguments.datapath,
            width=arguments.width,
            waves=waves,
            progress=lambda done, _: meter(done),
            cores=arguments.cores,
        )
    scores = [
        score(
            item.targets, item.words, item.exponent, run.results, run.flags,
            width=arguments.width, datapath=arguments.datapath, simulator=arguments.sim,
            latency_cycles=run.latency_cycles, total_cycles=run.total_cycles,
            bit_mismatches=run.bit_mismatches, first_mismatch=run.first_mismatch,
            predicted=hand_bar(item.words, arguments.width, arguments.datapath) if predict else None,
            bar=arguments.bar,
        )
        for item, run in zip(prepared, runs, strict=True)
    ]  # fmt: skip
    return list(zip(runs, scores, strict=True))


def elbow_errors(item: Prepared, result: Score) -> np.ndarray:
    """How far the elbows are from those of the clip, (N,), in parts of the reach."""
    elbow = np.stack([move.elbow for move in item.moves], axis=1).reshape(-1, 3)
    ours = np.ldexp(result.each.elbow, -result.scale_exponent)
    return np.linalg.norm(ours - elbow, axis=1) / item.targets.reach


CLIP_KINDS = ("bvh", "glb")


def turned(item: Prepared, ran: Run, width: int) -> pybvh.Bvh:
    """The clip with its arms turned by the core's quaternions."""
    values = result_values(ran.results, width)
    qs, qe = item.targets.from_core(values[:, :4]), np.pad(values[:, 4:], ((0, 0), (0, 2)))
    arms = len(item.moves)
    return clips.turned(item.clip, [(move, qs[n::arms], qe[n::arms]) for n, move in enumerate(item.moves)])


def turned_clip(item: Prepared, ran: Run, width: int) -> dict[str, bytes]:
    """The same as the contents of files of CLIP_KINDS."""
    bvh = turned(item, ran, width)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "clip.bvh"
        bvh.write(path)
        return {"bvh": path.read_bytes(), "glb": gltf.animated(bvh, item.targets.name)}


def write_results(out: Path, prepared: Sequence[Prepared], done: Sequence[tuple[Run, Score]]) -> None:
    """Write results.csv and results.npz of every trajectory, score.json, and of a clip the clip again."""
    with writing():
        for path, item, (ran, result) in zip(result_paths(out, prepared), prepared, done, strict=True):
            targets = item.targets
            if item.clip:
                targets = replace(targets, others=targets.others | {"elbow_error": elbow_errors(item, result).tolist()})
                for kind, content in turned_clip(item, ran, result.width).items():
                    write_atomically(path.with_name(f"clip.{kind}"), content)
            write_results_csv(path, targets, ran.results, ran.flags, result)
            write_results_npz(path.with_suffix(".npz"), targets, ran.results, ran.flags, result)
        write_score_json(out / "score.json", [result for _, result in done])


def _run(arguments: argparse.Namespace) -> int:
    """Load, simulate, score, write and print; the exit status 0 or 1. Raises what `exit_status` reports."""
    width, out = arguments.width, arguments.out
    prepared = prepare(arguments)
    many = len(prepared) > 1
    waves = (out / "waves.vcd").absolute() if arguments.waves else None
    # A prediction takes longer than everything else of a long file.
    predict = sum(len(item.words) for item in prepared) < LONG
    with output(out, written(out, prepared)), whole_file(waves) if waves else nullcontext() as unfinished:
        done = run_and_score(arguments, prepared, unfinished, predict)
        write_results(out, prepared, done)

    runs, scores = zip(*done, strict=True)
    show(table_of_many(scores) if many else table_of_one(scores[0], runs[0].flags))
    count = f" ({len(prepared)} files)" if many else ""
    tables = [f"{out / '*' / name if many else out / name}{count}" for name in ("results.csv", "results.npz")]
    told = [*tables, *(path for path in written(out, prepared) if path.suffix not in (".csv", ".npz"))]
    if waves:
        save_file = waves.with_suffix(".gtkw")
        write_save_file(waves, scores[0].datapath, width, save_file)
        told += [out / waves.name, out / save_file.name]
    for path in told:
        print(f"wrote {path}")
    return verdict("run", scores)


@command("run")
def main(arguments: Sequence[str] | None) -> int:
    """Run the command line; the exit status."""
    parsed = _parser().parse_args(arguments)
    if parsed.list:
        for name in trajectories.TRAJECTORIES:
            print(f"{name:14} {trajectories.describe(name)}")
        return 0
    return _run(parsed)


if __name__ == "__main__":
    sys.exit(main())
