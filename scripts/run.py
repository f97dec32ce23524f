# SPDX-License-Identifier: Apache-2.0
"""Run trajectories through the core in a simulator and score them: what `make run` does.

    python -m scripts.run [--trajectory NAME|all|FILE.csv] [--out DIR] [--sim icarus|verilator] ...

Writes OUT/results.csv (for `all`: OUT/<trajectory>/results.csv) and OUT/score.json, and prints a table.
Exit status: 0 if every trajectory passes, 1 if one fails or the simulation breaks off, 2 for input that
cannot be used (one line on stderr, nothing written), 130 after Ctrl-C, 143 after SIGTERM, 129 after SIGHUP.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path

from model.bounds.predict import hand_bar
from model.targets import trajectories
from model.targets.scoring import Score, score
from scripts.console import Parser, command, output, progress, show, whole_file, writing
from scripts.recording import ALIGNED, VCD, WAVES, align
from scripts.results import write_results, written
from scripts.tables import table_of_many, table_of_one, verdict
from scripts.trajectory import Prepared, parser_of, prepare
from scripts.waves import write_save_file
from tb.sim.simulate import LONG, Job, Run, simulate


def _parser() -> Parser:
    about = "Run trajectories through the core in a simulator and score them."
    parser = parser_of("run", about, out="build/run", written="results.csv and score.json")
    about = f"also write OUT/{VCD}, of one trajectory OUT/{ALIGNED}, too, and GTKWave save files"
    parser.add_argument("--waves", action="store_true", help=about)
    parser.add_argument("--list", action="store_true", help="list the built-in trajectories and stop")
    return parser


def run_and_score(
    arguments: argparse.Namespace, prepared: Sequence[Prepared], waves: Path | None = None, predict: bool = True
) -> list[tuple[Run, Score]]:
    """Run all trajectories in one simulation and score them, in their order, beside the errors that are predicted
    if `predict` says so. Raises SimulationError."""
    jobs = [Job(name=item.targets.name, words=item.words) for item in prepared]
    total = sum(len(job.words) for job in jobs)
    with progress(f"{arguments.sim}, {total} targets", total) as meter:
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


def _run(arguments: argparse.Namespace) -> int:
    """Load, simulate, score, write and print; the exit status 0 or 1. Raises what `exit_status` reports."""
    width, out = arguments.width, arguments.out
    prepared = prepare(arguments)
    many = len(prepared) > 1
    waves = (out / VCD).absolute() if arguments.waves else None
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
    if waves and many:
        with writing():
            write_save_file(waves, arguments.datapath, width, waves.with_suffix(".gtkw"))
        told += [out / name for name in WAVES if name.stem == waves.stem]
    elif waves:
        align(waves, prepared[0].words, width, arguments.datapath)
        told += [out / name for name in WAVES]
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
