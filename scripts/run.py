# SPDX-License-Identifier: Apache-2.0
"""Run trajectories through the core in a simulator and score them: what `make run` does.

    python -m scripts.run [--trajectory NAME|all|FILE.csv] [--out DIR] [--sim icarus|verilator] ...

Writes OUT/results.csv (for `all`: OUT/<trajectory>/results.csv) and OUT/score.json, and prints a table.
Exit status: 0 if every trajectory passes, 1 if one fails or the simulation breaks off, 2 for input that
cannot be used (one line on stderr, nothing written), 130 after Ctrl-C.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich import box
from rich.markup import escape
from rich.table import Table

from model.bounds.predict import hand_bar
from model.targets import flags as flag_bits
from model.targets import trajectories
from model.targets.files import read_csv
from model.targets.scoring import Score, score, write_results_csv, write_score_json
from model.targets.words import DEFAULT_D1, DEFAULT_D2, DEFAULT_PHI, Targets, to_words
from scripts.console import InputError, Parser, arm_length, check_out, command, finite, progress, show, writing
from scripts.waves import write_save_file
from tb.sim.env import CORES
from tb.sim.simulate import LONG, Job, Run, simulate

ALL = "all"

@dataclass(frozen=True)
class Prepared:
    """A trajectory that is ready to run: its targets and the words (N, 6) that `to_words` made of them."""

    targets: Targets
    words: np.ndarray
    exponent: int


# -- the command line ------------------------------------------------------------------------------


def parser_of(command: str, description: str, *, out: str, written: str) -> Parser:
    """The parser of a command that runs trajectories, with the options that all of them have.

    out: the default of --out; written: what is written there, for its help.
    """
    parser = Parser(command, description, passes="all trajectories pass", fails="one fails")
    about = (
        "a built-in trajectory (see --list), all of them, or a CSV file with a header: x,y,z and optionally phi (rad), "
        "d1, d2, in any unit of length (default: %(default)s)"
    )
    parser.add_argument("--trajectory", default=trajectories.DEFAULT, metavar="NAME|all|FILE.csv", help=about)
    about = f"folder for {written}, made if need be (default: %(default)s)"
    parser.add_argument("--out", type=Path, default=Path(out), metavar="DIR", help=about)
    parser.core()
    parser.choice(
        "--cores", "cores", CORES, CORES[0],
        "the dividers and roots, which only the paper datapath has: behavioural, or made of rows for synthesis; "
        "the results are the same (default: %(default)s)",
    )  # fmt: skip
    only_csv = "only with a CSV file, for rows of a file without that column"
    for option, kind, unit, what, default in (
        ("--d1", arm_length, "LENGTH", "upper arm", DEFAULT_D1),
        ("--d2", arm_length, "LENGTH", "forearm", DEFAULT_D2),
        ("--phi", finite, "RAD", "swivel angle", DEFAULT_PHI),
    ):
        parser.add_argument(option, type=kind, metavar=unit, help=f"{what}, {only_csv} (default: {default})")
    return parser


def _parser() -> Parser:
    about = "Run trajectories through the core in a simulator and score them."
    parser = parser_of("run", about, out="build/run", written="results.csv and score.json")
    parser.add_argument("--waves", action="store_true", help="also write OUT/waves.vcd and a GTKWave save file")
    parser.add_argument("--list", action="store_true", help="list the built-in trajectories and stop")
    return parser


# -- input and output, checked before anything is simulated ----------------------------------------


def _load(arguments: argparse.Namespace) -> list[Targets]:
    """The targets that --trajectory asks for. Raises InputError or TargetError."""
    name = arguments.trajectory
    if name == ALL or name in trajectories.TRAJECTORIES:
        for option in ("d1", "d2", "phi"):
            if getattr(arguments, option) is not None:
                raise InputError(
                    f"argument --{option}: is for CSV files; built-in trajectories ({name}) have their own"
                )
        return [trajectories.make(each) for each in (trajectories.TRAJECTORIES if name == ALL else [name])]
    if not (name.lower().endswith(".csv") or os.sep in name or os.path.exists(name)):
        valid = ", ".join((ALL, *trajectories.TRAJECTORIES))
        raise InputError(f"argument --trajectory: unknown trajectory {name!r}; valid: {valid}, or a CSV file")
    phi = DEFAULT_PHI if arguments.phi is None else arguments.phi
    return [read_csv(name, d1=arguments.d1, d2=arguments.d2, phi=phi)]


def prepare(arguments: argparse.Namespace) -> list[Prepared]:
    """The trajectories of --trajectory as words of --width bits. Raises InputError or TargetError."""
    return [Prepared(targets, *to_words(targets, arguments.width)) for targets in _load(arguments)]


def _results_path(out: Path, name: str, many: bool) -> Path:
    return out / name / "results.csv" if many else out / "results.csv"


# -- the run ---------------------------------------------------------------------------------------


def run_and_score(
    arguments: argparse.Namespace, prepared: Sequence[Prepared], waves: Path | None = None, predict: bool = True
) -> list[tuple[Run, Score]]:
    """Run all trajectories in one simulation and score them, in their order, beside the errors that are predicted
    if `predict` says so. Raises SimulationError."""
    jobs = [Job(name=item.targets.name, words=item.words) for item in prepared]
    total = sum(len(job.words) for job in jobs)
    with progress(f"{arguments.sim}, {total} targets", total) as meter:
        runs = simulate(
            jobs,
            simulator=arguments.sim,
            datapath=arguments.datapath,
            width=arguments.width,
            waves=waves,
            progress=(lambda done, _: meter(done)) if meter.bar else None,
            cores=arguments.cores,
        )
    scores = [
        score(
            item.targets, item.words, item.exponent, run.results, run.flags,
            width=arguments.width, datapath=arguments.datapath, simulator=arguments.sim,
            latency_cycles=run.latency_cycles, total_cycles=run.total_cycles,
            bit_mismatches=run.bit_mismatches, first_mismatch=run.first_mismatch,
            predicted=hand_bar(item.words, arguments.width, arguments.datapath) if predict else None,
        )
        for item, run in zip(prepared, runs, strict=True)
    ]  # fmt: skip
    return list(zip(runs, scores, strict=True))


def verdict(name: str, scores: Sequence[Score]) -> int:
    """Say on stderr, for the command `name`, what fails; the exit status 0 or 1."""
    for result in scores:
        for failure in result.failures:
            print(f"{name}: {result.trajectory} fails: {failure}", file=sys.stderr)
    return 0 if all(result.passed for result in scores) else 1


def _run(arguments: argparse.Namespace) -> int:
    """Load, simulate, score, write and print; the exit status 0 or 1. Raises what `exit_status` reports."""
    width, out = arguments.width, arguments.out
    prepared = prepare(arguments)
    many = len(prepared) > 1
    score_path = out / "score.json"
    result_paths = [_results_path(out, item.targets.name, many) for item in prepared]
    check_out(out, [*result_paths, score_path])

    waves = (out / "waves.vcd").absolute() if arguments.waves else None
    # A prediction takes longer than everything else of a long file.
    predict = sum(len(item.words) for item in prepared) < LONG
    runs, scores = zip(*run_and_score(arguments, prepared, waves, predict), strict=True)
    with writing():
        for path, item, run, result in zip(result_paths, prepared, runs, scores, strict=True):
            write_results_csv(path, item.targets, run.results, run.flags, result.each.hand_error, width)
        write_score_json(score_path, scores)

    show(_table_of_many(scores) if many else _table_of_one(scores[0], runs[0].flags))
    written = [f"{out / '*' / 'results.csv'} ({len(prepared)} files)" if many else result_paths[0], score_path]
    if waves:
        save_file = waves.with_suffix(".gtkw")
        write_save_file(waves, scores[0].datapath, width, save_file)
        written += [out / waves.name, out / save_file.name]
    for path in written:
        print(f"wrote {path}")
    return verdict("run", scores)


# -- tables ----------------------------------------------------------------------------------------


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.1e}"


def _verdict(result: Score) -> str:
    return "[green]pass[/]" if result.passed else "[bold red]FAIL[/]"


def figures(result: Score, flags: np.ndarray) -> list[tuple[str, ...]]:
    """The figures of one trajectory: a name, the measured value and, where there are any, bar and prediction.

    flags (N,): the core's flag bits.
    """
    rows: list[tuple[str, ...]] = [
        ("bits that differ from the bit-true model", str(result.bit_mismatches), "0"),
        (
            "hand error / reach, largest",
            _number(result.hand_error_max),
            _number(result.hand_error_bar),
            _number(result.hand_error_predicted),
        ),
        ("hand error / reach, rms", _number(result.hand_error_rms)),
    ]
    if result.hand_error_over_bar is not None:
        rows.append(("hand error / bar of the same target", f"{result.hand_error_over_bar:.2g}", "1"))
    rows += [
        ("shoulder angle error, largest (rad)", _number(result.shoulder_angle_error_max)),
        ("elbow angle error, largest (rad)", _number(result.elbow_angle_error_max)),
        ("elbow point error / reach, largest", _number(result.elbow_point_error_max)),
        ("abs(norm^2 - 1) of Qs and Qe, largest", _number(result.norm_error_max)),
    ]
    if result.clamped_error_max is not None:
        bar = _number(result.clamped_error_bar)
        rows.append(("error of the clamped hand / reach, largest", _number(result.clamped_error_max), bar, bar))
    occurred = int(np.bitwise_or.reduce(flags))
    return [
        *rows,
        ("distance from singular poses, least (rad)", f"{result.singular_distance_min:.3f}"),
        ("latency (clocks)", str(result.latency_cycles)),
        ("clocks for all targets", str(result.total_cycles)),
        ("results per clock while they flow", f"{result.results_per_cycle:.3f}"),
        ("flagged targets", f"{result.flagged} ({flag_bits.names(occurred)})" if occurred else "0"),
    ]


def _table_of_one(result: Score, flags: np.ndarray) -> Table:
    """The figures of one trajectory, a line each, beside their bars and predictions."""
    table = Table(
        title=f"{escape(result.trajectory)}: {result.targets} targets, {result.datapath} datapath, "
        f"{result.width} bits, {result.simulator}",
        box=box.SIMPLE_HEAD,
        title_justify="left",
    )
    table.add_column("figure")
    for heading in ("measured", "bar", "predicted"):
        table.add_column(heading, justify="right")
    for row in figures(result, flags):
        table.add_row(*row)
    table.add_row("result", _verdict(result))
    return table


def _table_of_many(scores: Sequence[Score]) -> Table:
    """One line a trajectory, narrow enough for a terminal of 80 columns."""
    first = scores[0]
    table = Table(
        title=f"{first.datapath} datapath, {first.width} bits, {first.simulator}, "
        f"latency {first.latency_cycles} clocks",
        caption="hand: largest hand error / reach, with its bar and prediction; clamped: the same for "
        "targets out of reach; angle: largest shoulder or elbow angle error (rad); bits: differing from the "
        "bit-true model",
        box=box.SIMPLE_HEAD,
        padding=(0, 1, 0, 0),
        title_justify="left",
        caption_justify="left",
    )
    table.add_column("trajectory", no_wrap=True)
    for heading in ("hand", "bar", "predict", "clamped", "angle", "bits", "flags", ""):
        table.add_column(heading, justify="right", no_wrap=True)
    for result in scores:
        hand = result.hand_error_max, result.hand_error_bar, result.hand_error_predicted
        errors = map(_number, (*hand, result.clamped_error_max, result.angle_error_max))
        counts = str(result.bit_mismatches), str(result.flagged)
        table.add_row(escape(result.trajectory), *errors, *counts, _verdict(result))
    return table


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
