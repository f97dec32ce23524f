# SPDX-License-Identifier: Apache-2.0
"""An unlimited stream of random targets of all kinds through the RTL, every node compared: what `make soak` does.

    python -m scripts.soak [--targets N] [--seed S] [--from CHUNK] [--datapath ...] [--width ...] [--keep] ...
    python -m scripts.soak --again FILE.csv

Targets come in chunks of 20000. A chunk is a function of seed, width and its number only, so there is no state to keep:
--from resumes at any chunk. With Verilator each core of the machine runs chunks of its own. At the end the hardest
targets go into OUT/hardest.csv and, with --keep, into tb/core/hardest.csv, the regression list.

It stops at the first chunk in which a bit or a flag is wrong, a quaternion is not of unit length or a hand of the lean
datapath is further off than its tolerance, names seed and chunk, and writes the targets to OUT/failing.csv. For the
paper's equations at such poses `model.bounds.tolerances` has no figure, so their accuracy is reported beside what
`model.bounds.predict` explains, and judged by nothing.

Exit status: 0 all is well, 1 a check fails or the simulation breaks off, 2 input that cannot be used (one line on
stderr), 130 after Ctrl-C, 143 after SIGTERM, 129 after SIGHUP.
"""

from __future__ import annotations

import argparse
import contextlib
import math
import multiprocessing
import os
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from functools import partial
from pathlib import Path
from typing import NoReturn

import numpy as np

from model.dataflow.datapaths import DEFAULT
from model.dataflow.nodes import WIDTHS
from model.targets.files import write_atomically
from model.targets.words import FIELDS
from scripts.console import (
    InputError,
    Parser,
    Stopped,
    command,
    folder_name,
    output,
    progress,
    show,
    whole,
    writing,
)
from scripts.tables import table_of_hardest, table_of_soak
from tb.core import hardest
from tb.core.random_targets import CHUNK, Core, Failure, Found, chunk, judge
from tb.sim.simulate import SimulationError

TARGETS = 1_000_000
SEED = 1


def tell(failures: list[Failure], words: np.ndarray, where: Callable[[int], str]) -> list[int]:
    """Say on stderr what fails, with the words of each failure's first target; the rows of all of them in order."""
    for failure in failures:
        what, *more = failure.lines
        n = failure.rows[0] if failure.rows else None
        print(f"soak: {'somewhere' if n is None else where(n)}: {what}", file=sys.stderr)
        if n is not None:
            named = " ".join(f"{name}={word}" for name, word in zip(FIELDS, words[n].tolist(), strict=True))
            print(f"soak: its words: {named}", file=sys.stderr)
        for line in more:
            print(f"soak: {line}", file=sys.stderr)
    return list(dict.fromkeys(n for failure in failures for n in failure.rows))


# -- the command line --------------------------------------------------------------------------------------------------


DEFAULTS = {"targets": TARGETS, "seed": SEED, "from_": 0, "datapath": DEFAULT, "width": WIDTHS[-1]}
NOT_AGAIN = (*DEFAULTS, "keep")


def _parse(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = Parser("soak", "Random targets of all kinds through the core, every node compared with the model.")
    add = parser.add_argument
    add("--targets", type=whole(1), metavar="N", help=f"how many (default: {TARGETS})")
    add("--seed", type=whole(0), metavar="S", help=f"of everything random (default: {SEED})")
    add("--from", dest="from_", type=whole(0), metavar="CHUNK", help=f"begin at this chunk of {CHUNK} (default: 0)")
    parser.core(sim="verilator", datapath=None, width=None)
    add("--jobs", type=whole(1), default=os.cpu_count(), metavar="N", help="chunks at a time (default: %(default)s)")
    add(
        "--out", type=folder_name, default=Path("build/soak"), metavar="DIR",
        help="folder for hardest.csv and failing.csv, made if need be (default: %(default)s)",
    )  # fmt: skip
    add("--keep", action="store_true", help="put the hardest targets into tb/core/hardest.csv too")
    add("--again", type=Path, metavar="FILE", help="run the targets of a failing.csv or hardest.csv")
    parsed = parser.parse_args(arguments)
    if parsed.again:
        for name in NOT_AGAIN:
            value = getattr(parsed, name)
            if value is not None and value is not False:  # a seed of 0 is one
                option = name.rstrip("_")
                raise InputError(f"argument --{option}: does not go with --again, whose file says what to run")
    for name, value in DEFAULTS.items():
        if getattr(parsed, name) is None:
            setattr(parsed, name, value)
    return parsed


# -- the run -----------------------------------------------------------------------------------------------------------


def _worker() -> None:
    """A process of its own: Ctrl-C is for the parent, whose SIGTERM is a way out that ends the simulation, too."""

    def end(*_) -> NoReturn:
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        raise SystemExit

    os.setsid()
    signal.signal(signal.SIGTERM, end)


def _built(sim: str, datapath: str, width: int) -> Core:
    with progress("soak", 1) as meter:
        meter(0, "compiling")
        return Core.built(sim, datapath, width)


def piece(core: Core, seed: int, end: int, number: int) -> tuple[np.ndarray, Found, list[Failure], np.ndarray]:
    """Chunk `number` as far as target `end`: its words, and what :func:`judge` says."""
    start = number * CHUNK
    words = chunk(number, core.width, seed)[: end - start]
    return words, *judge(core, words, range(start, start + len(words)))


@contextlib.contextmanager
def spread(jobs: int) -> Iterator[Callable]:
    """A `map` that keeps the order; with more than one job, over processes, which end with the block."""
    if jobs == 1:
        yield map
        return
    # Not forked: a progress bar has a thread.
    with ProcessPoolExecutor(jobs, multiprocessing.get_context("spawn"), _worker) as pool:
        try:
            yield pool.map
        except BaseException:
            for process in multiprocessing.active_children():
                process.terminate()
            raise
        finally:
            pool.shutdown(cancel_futures=True)


def _soak(arguments: argparse.Namespace) -> int:
    """Run the chunks; the exit status 0 or 1. Raises what `exit_status` reports, and Stopped."""
    hardest_path, failing = arguments.out / "hardest.csv", arguments.out / "failing.csv"
    with output(arguments.out, [hardest_path, failing]):
        return _chunks(arguments, hardest_path, failing)


def _chunks(arguments: argparse.Namespace, hardest_path: Path, failing: Path) -> int:
    lists = [hardest_path, *([hardest.LIST] if arguments.keep else [])]
    earlier = {file: _read_rows(file) if file.exists() else [] for file in lists}
    end = arguments.from_ * CHUNK + arguments.targets
    chunks = range(arguments.from_, -(-end // CHUNK))
    found, number = Found(), arguments.from_
    try:
        core = _built(arguments.sim, arguments.datapath, arguments.width)
        what = f"{core}, seed {arguments.seed}"
        print(f"soak: {what}, {arguments.targets} targets from chunk {arguments.from_}", flush=True)
        work = partial(piece, core, arguments.seed, end)
        with (
            spread(min(arguments.jobs, len(chunks))) as each,
            progress("soak", arguments.targets) as meter,
        ):
            for words, more, failures, hand in each(work, chunks):  # noqa: B007
                if failures:
                    break
                number += 1
                found += more
                meter(found.targets)
    except BrokenProcessPool:
        raise SimulationError(f"a process broke off, in chunk {number} of seed {arguments.seed} or later") from None
    except Stopped:
        done = f"{found.targets} targets passed, those before chunk {number}; --from {number} resumes"
        print(f"soak: stopped; {done}", file=sys.stderr)
        raise
    if failures:
        numbers = range(number * CHUNK, (number + 1) * CHUNK)
        rows = tell(failures, words, lambda n: f"target {numbers[n]} in chunk {number} of seed {arguments.seed}")
        _write(failing, [_row(arguments, words[n], hand[n], numbers[n]) for n in rows])
        print(f"soak: {len(rows)} failing targets in {failing}; to rerun them: --again {failing}", file=sys.stderr)
        return 1
    show(table_of_soak(what, core, found, meter.rate), table_of_hardest(found))
    hards = {tuple(hard.words): hard for hard in found.by_hand + found.by_norm}.values()
    rows = [_row(arguments, hard.words, hard.hand_error, hard.target) for hard in hards]
    for file, before in earlier.items():
        _write(file, hardest.merge(before + rows))
        print(f"wrote {file}")
    return 0


def _write(path: Path, rows: list[hardest.Row]) -> None:
    with writing():
        write_atomically(path, hardest.text(rows))


def _row(arguments, words, hand_error: float, number: int) -> hardest.Row:
    error = None if math.isnan(hand_error) else float(hand_error)
    words = tuple(map(int, words))
    return hardest.Row(arguments.datapath, arguments.width, words, error, f"seed {arguments.seed} target {number}")


def _read_rows(path: Path) -> list[hardest.Row]:
    try:
        return hardest.read(path)
    except ValueError as error:
        raise InputError(str(error)) from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None


def _again(arguments: argparse.Namespace) -> int:
    """Run the targets of a list; the exit status 0 or 1. Raises what `exit_status` reports."""
    rows = _read_rows(arguments.again)
    if not rows:
        raise InputError(f"{arguments.again}: no targets")
    status = 0
    for (datapath, width), group in hardest.groups(rows).items():
        core = _built(arguments.sim, datapath, width)
        words = hardest.array(group)
        found, failures, _ = judge(core, words, range(len(words)))
        tell(failures, words, lambda n, group=group: group[n].found)
        status |= bool(failures)
        print(
            f"{core}: {len(words)} targets, largest hand error / reach {found.hand_error_max:.3e}: "
            f"{'FAIL' if failures else 'pass'}"
        )
    return status


@command("soak")
def main(arguments: Sequence[str] | None) -> int:
    """Run the command line; the exit status."""
    parsed = _parse(arguments)
    try:
        return _again(parsed) if parsed.again else _soak(parsed)
    except Stopped as stopped:
        return 128 + stopped.args[0]


if __name__ == "__main__":
    sys.exit(main())
