# SPDX-License-Identifier: Apache-2.0
"""Run trajectories through the core in a simulator and score them: `make run`.

    python -m scripts.run [--trajectory NAME|all|FILE.csv] [--out DIR] [--sim icarus|verilator] ...

Writes OUT/results.csv (for `all`: OUT/<trajectory>/results.csv) and OUT/score.json, and prints a table. Without a
trajectory and a datapath it runs both datapaths on the paper's scenario, with the results in OUT/lean and OUT/paper,
and prints them next to tables 5 and 6 of the paper.
"""

import sys
from collections.abc import Iterable, Sequence
from contextlib import AbstractContextManager as ContextManager
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np

from model.bounds.predict import hand_bar
from model.io import trajectories
from model.io.files import Place
from model.io.scoring import Score, score, score_json, tables
from model.io.words import JOINTS, RESULT_FIELDS, result_values
from model.motion import clip as clips
from model.motion import gltf
from model.motion.clip import Clip
from model.reference import joints
from scripts.console import command, output, progress, show, switch
from scripts.paper.tables import table_of_datapaths
from scripts.tables import table_of_many, table_of_one, verdict
from scripts.trajectory import MOST_DATAPATHS, Prepared, datapaths, prepare, sources, trajectory_options
from scripts.waves import ALIGNED, VCD, WAVES, align, write_save_file
from tb.sim.simulate import LONG, Job, Run, simulate

Done = Sequence[Sequence[tuple[Run, Score]]]
"""Runs and scores of the trajectories, for each datapath."""

SCORES = "score.json"

OPTIONS = [
    *trajectory_options("build/run", "results.csv and score.json", datapath=None, most=MOST_DATAPATHS),
    switch("--waves", f"also write OUT/{VCD}, for a single trajectory OUT/{ALIGNED}, and GTKWave save files"),
    switch("--list", "list the built-in trajectories and stop"),
]


def score_runs(
    arguments: SimpleNamespace, datapath: str, prepared: Sequence[Prepared], runs: Sequence[Run], predict: bool = True
) -> list[tuple[Run, Score]]:
    """Return each run with its score, and with predicted errors if `predict` is set."""
    core = {"width": arguments.width, "datapath": datapath, "simulator": arguments.sim, "bar": arguments.bar}
    scored = []
    for item, run in zip(prepared, runs, strict=True):
        wrists = item.targets.hand is None
        own = {"predicted": hand_bar(item.words, arguments.width, datapath) if predict and wrists else None}
        own |= {"placed": placed(item, run, arguments.width) if item.clip else None, "limits": item.limits}
        scored.append((run, score(item.targets, item.words, item.exponent, run, **core, **own)))
    return scored


def simulated(
    arguments: SimpleNamespace, datapath: str, prepared: Sequence[Prepared], waves: Path | None = None
) -> list[Run]:
    """Run all trajectories through a datapath in one simulation. Raises SimulationError."""
    total = sum(len(item.words) for item in prepared)
    with progress(f"{arguments.sim}, {datapath} datapath, {total} targets", total) as meter:
        meter(0, "compiling and starting")
        jobs = [Job(item.targets.name, item.words) for item in prepared]
        core = {"simulator": arguments.sim, "datapath": datapath, "width": arguments.width, "cores": arguments.cores}
        core |= {"limits": prepared[0].limits} if prepared[0].limits else {}
        return simulate(jobs, waves=waves, progress=lambda done, _: meter(done), **core)


def result_paths(folder: Path, prepared: Sequence[Prepared]) -> list[Path]:
    """Return the paths of the results.csv of each trajectory."""
    many = len(prepared) > 1
    return [folder / item.targets.name / "results.csv" if many else folder / "results.csv" for item in prepared]


def of_datapath(folder: Path, prepared: Sequence[Prepared]) -> list[Path]:
    """Return the paths that `write_results` writes for one datapath."""
    tables = result_paths(folder, prepared)
    clip = [folder / name for name in ("clip.bvh", "clip.glb") if prepared[0].clip]
    return [*tables, *(path.with_suffix(".npz") for path in tables), *clip]


def outputs(out: Path, folders: Iterable[Path], prepared: Sequence[Prepared], *others: Path) -> ContextManager[Place]:
    """Return the `output` of all files that `write_results` writes and of others."""
    paths = [*others, *(path for folder in folders for path in of_datapath(folder, prepared)), out / SCORES]
    return output(out, paths, sources(prepared))


def elbow_errors(item: Prepared, result: Score) -> np.ndarray:
    """Return the distances between the elbows and the clip's elbows, relative to the reach, (N,)."""
    elbow = np.stack([move.elbow for move in item.moves], axis=1).reshape(-1, 3)
    ours = np.ldexp(result.each.elbow, -result.scale_exponent)
    return np.linalg.norm(ours - elbow, axis=1) / item.targets.reach


def quaternions(item: Prepared, ran: Run, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Return Qs (N, 4) in the user's frame, and Qe (N, 4)."""
    first = 0 if item.targets.hand is None else len(JOINTS)
    values = result_values(ran.results[:, first : first + len(RESULT_FIELDS)], width)
    return item.targets.from_core(values[:, :4]), np.pad(values[:, 4:], ((0, 0), (0, 2)))


def by_joints(item: Prepared, ran: Run, width: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return Qs, Qe and Qh (N, 4) of the seven joint angles, by forward kinematics; Qs and Qh in the user's frame."""
    th, targets = ran.results[:, : len(JOINTS)].T * (2 * np.pi / 2**width), item.targets
    qe = np.array((np.sin(th[3] / 2), -np.cos(th[3] / 2), 0 * th[3], 0 * th[3])).T
    _, qh = joints.reached(th, targets.d1, targets.d2, targets.tool)
    return targets.from_core(joints.turned(*th[:3]).T), qe, targets.from_core(qh)


def turned(item: Prepared, ran: Run, width: int) -> Clip:
    """Return the clip with its arms turned by the core's quaternions, or by the seven joint angles of its hand poses,
    read back from its file's content."""
    assert item.clip
    arms, found = len(item.moves), quaternions if item.targets.hand is None else by_joints
    turns = found(item, ran, width)
    moves = [(move, *(q[n::arms] for q in turns)) for n, move in enumerate(item.moves)]
    content = clips.turned(item.clip, moves, item.twist).content()
    return replace(clips.parse(content, item.clip.path), up=item.clip.up)


def placed(item: Prepared, ran: Run, width: int) -> tuple[np.ndarray, ...]:
    """Return the elbows and wrists (N, 3) of the turned clip, from the shoulder, and of hand poses the orientations
    (N, 4)."""
    clip = turned(item, ran, width)
    places, arms = clip.positions, [move.limb for move in item.moves]
    found = [[places[:, arm.fore] - places[:, arm.upper] for arm in arms]]
    found += [[places[:, arm.hand] - places[:, arm.upper] for arm in arms]]
    found += [[clips.hands(clip, arm) for arm in arms]] if item.targets.hand is not None else []
    return tuple(np.concatenate(np.stack(each, axis=1)) for each in found)


def write_results(files: Place, out: Path, folders: Iterable[Path], prepared: Sequence[Prepared], done: Done) -> None:
    """Write the files of each datapath for its folder, and one score.json, each to its path from `files`."""
    for folder, scored in zip(folders, done, strict=True):
        for path, item, (ran, result) in zip(result_paths(folder, prepared), prepared, scored, strict=True):
            targets = item.targets
            if item.clip:
                errors = {"elbow_error": elbow_errors(item, result).tolist()}
                targets = replace(targets, others=targets.others | errors)
                clip = turned(item, ran, result.width)
                files(path.with_name("clip.bvh")).write_bytes(clip.content())
                files(path.with_name("clip.glb")).write_bytes(gltf.animated(clip, targets.name, item.scale))
            own = item.robot.positions(result.each.hand.joints).T if item.robot else []
            more = dict(zip(item.robot.names, own, strict=True)) if item.robot else {}
            for suffix, content in tables(targets, ran, result, more).items():
                files(path.with_suffix(suffix)).write_bytes(content)
    files(out / SCORES).write_bytes(score_json([result for scored in done for _, result in scored]))


def _show(done: Done) -> None:
    """Print a table for each datapath, or for several on one trajectory a single table next to the paper's."""
    if len(done) > 1 and len(done[0]) == 1:
        show(table_of_datapaths([(result, ran.flags) for ((ran, result),) in done]))
        return
    for ran in done:
        runs, scores = zip(*ran, strict=True)
        show(table_of_many(scores) if len(ran) > 1 else table_of_one(scores[0], runs[0].flags))


@command(
    "run",
    "Run trajectories through the core in a simulator and score them.",
    OPTIONS,
    passes="all trajectories pass",
    fails="one fails",
)
def main(arguments: SimpleNamespace) -> int:
    """Load, simulate, score, write and print; return the exit status 0 or 1."""
    if arguments.list:
        for name in (*trajectories.TRAJECTORIES, *trajectories.HANDS):
            print(f"{name:14} {trajectories.describe(name)}")
        return 0
    out = arguments.out
    prepared = prepare(arguments)
    folders = datapaths(arguments, prepared)
    # For a long file the prediction takes longer than everything else.
    predict = sum(len(item.words) for item in prepared) < LONG
    recorded = WAVES[: 4 if len(prepared) == 1 else 2] if arguments.waves else []  # aligned: for one trajectory
    waves = [folder / name for folder in folders.values() for name in recorded]
    with outputs(out, folders.values(), prepared, *waves) as files:
        done = []
        for datapath, folder in folders.items():
            vcd = folder / VCD
            runs = simulated(arguments, datapath, prepared, files(vcd) if arguments.waves else None)
            done.append(score_runs(arguments, datapath, prepared, runs, predict))
            if arguments.waves and len(prepared) == 1:
                align(vcd, prepared[0].words, arguments.width, datapath, files, prepared[0].limits)
            elif arguments.waves:
                write_save_file(files(vcd), datapath, arguments.width, files(vcd.with_suffix(".gtkw")), VCD)
        write_results(files, out, folders.values(), prepared, done)

    _show(done)
    if (count := len(prepared)) == 1:
        tables = [path for folder in folders.values() for path in of_datapath(folder, prepared)]
    else:
        kinds = [f"*/results.{kind} ({count} files)" for kind in ("csv", "npz")]
        tables = [folder / kind for folder in folders.values() for kind in kinds]
    print(*(f"wrote {path}" for path in (*tables, out / SCORES, *waves)), sep="\n")
    return verdict("run", [result for ran in done for _, result in ran])


if __name__ == "__main__":
    sys.exit(main())
