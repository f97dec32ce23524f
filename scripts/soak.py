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
import re
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import NoReturn

import numpy as np
from rich import box
from rich.table import Table

from model.bounds import tolerances
from model.dataflow.nodes import WIDTHS
from model.targets.files import write_atomically
from model.targets.flags import expected_flags, names
from model.targets.observed import edges
from model.targets.stimuli import REGIONS, corners, extremes, random_reachable, region, unreachable
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
from tb.core import hardest
from tb.sim import every_node
from tb.sim.simulate import DATAPATHS, Job, Run, SimulationError, simulate

CHUNK = 20000
TARGETS = 1_000_000
EVERY = 5  # seconds between lines of progress where there is no terminal
SEED = 1

CANDIDATES = 1000
"""Targets of a chunk, those with the largest hand errors, that are ranked: the paper's by a prediction."""


# -- targets ---------------------------------------------------------------------------------------------------------


def chunk(number: int, width: int, seed: int, count: int = CHUNK) -> np.ndarray:
    """The `number`-th chunk of targets, shuffled: half near singular poses and in the other `REGIONS`, an eighth
    each clamped, at the edges of formats and of extreme words, every corner, the rest anywhere in reach."""
    own = int(np.random.SeedSequence((seed, number)).generate_state(1, np.uint64)[0])
    named = np.array(list(corners(width).values()), dtype=np.int64)
    parts = [region(name, count // 2 // len(REGIONS), width, own) for name in REGIONS]
    parts += [make(count // 8, width, own) for make in (unreachable, edges, extremes)]
    parts.append(named[: count // 8])
    parts.append(random_reachable(count - sum(map(len, parts)), width, own))
    return np.random.default_rng((own, width)).permutation(np.concatenate(parts))


# -- judging -----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Hard:
    """A target in reach with its number in the sequence, its errors, and what its hand error is held against."""

    target: int
    words: list[int]
    hand_error: float
    tolerance: float
    norm_error: float


@dataclass
class Found:
    """What some targets gave: how many there are, in reach, above their prediction; the largest errors, the hardest
    targets by either measure."""

    targets: int = 0
    reachable: int = 0
    above: int = 0
    hand_error_max: float = 0.0
    norm_error_max: float = 0.0
    by_hand: list[Hard] = field(default_factory=list)
    by_norm: list[Hard] = field(default_factory=list)

    def __add__(self, other: Found) -> Found:
        return Found(
            self.targets + other.targets,
            self.reachable + other.reachable,
            self.above + other.above,
            max(self.hand_error_max, other.hand_error_max),
            max(self.norm_error_max, other.norm_error_max),
            _first(self.by_hand + other.by_hand, lambda hard: hard.hand_error / hard.tolerance),
            _first(self.by_norm + other.by_norm, lambda hard: hard.norm_error),
        )


def _first(of: list[Hard], measure: Callable[[Hard], float]) -> list[Hard]:
    once = {tuple(hard.words): hard for hard in sorted(of, key=lambda hard: -hard.target)}
    return sorted(once.values(), key=lambda hard: (-measure(hard), hard.target))[: hardest.KEPT]


@dataclass(frozen=True)
class Failure:
    """What is wrong: lines for the user, and the rows of the targets (K,), the first one's or the worst one's first."""

    lines: list[str]
    rows: list[int]


@dataclass(frozen=True)
class Core:
    """What is simulated: simulator, datapath, word length, and the native program, which Verilator makes."""

    sim: str
    datapath: str
    width: int
    program: Path | None = None

    @classmethod
    def built(cls, sim: str, datapath: str, width: int) -> Core:
        with progress("soak", 1, every=EVERY) as meter:
            meter(0, "compiling")
            program = every_node.program(datapath, width) if sim == "verilator" else None
        return cls(sim, datapath, width, program)

    def run(self, words: np.ndarray) -> tuple[Run, np.ndarray, np.ndarray]:
        """What the RTL makes of targets (N, 6), the model's results (N, 6) and flags (N,). Raises SimulationError."""
        frames = list(every_node.answered(words, self.width, self.datapath))
        if self.program:
            run = every_node.compare(self.program, frames, self.width, self.datapath)
        else:
            (run,) = simulate([Job("soak", words)], simulator=self.sim, datapath=self.datapath, width=self.width)
        return run, *(np.concatenate([getattr(answer, part) for _, answer in frames]) for part in ("results", "flags"))

    def __str__(self) -> str:
        return f"{self.datapath} datapath, {self.width} bits, {self.sim}"


def judge(core: Core, words: np.ndarray, numbers: Sequence[int]) -> tuple[Found, list[Failure], np.ndarray]:
    """Run targets: what they give, what fails, and the hand errors (N,), nan out of reach.

    numbers (N,): of the targets in their sequence. Raises SimulationError, for lost results too.
    """
    run, results, flags = core.run(words)
    if run.results.shape != words.shape or run.flags.shape != (len(words),):
        raise SimulationError(f"{len(words)} targets were sent, {len(run.results)} results came back")
    hand, norm = hardest.errors(words, run.results, core.width)
    reachable = np.flatnonzero(~np.isnan(hand))
    candidates = reachable[np.argsort(-hand[reachable], kind="stable")][:CANDIDATES]
    tolerance = np.full(len(words), np.inf)
    tolerance[candidates] = tolerances.yardstick(words[candidates], core.width, core.datapath)
    above = candidates[hand[candidates] > tolerance[candidates]]
    judged = tolerances.hand(core.width, core.datapath) is not None

    failures = []
    differs = (run.results != results).any(axis=1) | (run.flags != flags)
    if run.bit_mismatches or differs.any():
        failures.append(_bits_failure(run, np.flatnonzero(differs).tolist(), numbers))
    wrong = np.flatnonzero(run.flags != (owed := expected_flags(words, core.width)))
    if len(wrong):
        n = int(wrong[0])
        text = f"flags {names(int(run.flags[n]))} instead of {names(int(owed[n]))} ({len(wrong)} targets)"
        failures.append(Failure([text], wrong.tolist()))
    for what, error, most, rows in (
        ("hand error / reach", hand, tolerance, above if judged else above[:0]),
        ("abs(norm^2 - 1)", norm, np.full(len(words), tolerances.norm(core.width)),
         np.flatnonzero(~(norm <= tolerances.norm(core.width)))),
    ):  # fmt: skip
        if len(rows):
            worst = rows[np.argsort(-error[rows] / most[rows], kind="stable")].tolist()
            n = worst[0]
            text = f"{what} {error[n]:.3e} is above its tolerance {most[n]:.3e} ({len(rows)} targets)"
            failures.append(Failure([text], worst))

    by_norm = reachable[np.argsort(-norm[reachable], kind="stable")][: hardest.KEPT]
    missing = by_norm[np.isinf(tolerance[by_norm])]
    tolerance[missing] = tolerances.yardstick(words[missing], core.width, core.datapath)

    def hard(rows) -> list[Hard]:
        return [
            Hard(int(numbers[n]), words[n].tolist(), float(hand[n]), float(tolerance[n]), float(norm[n]))
            for n in rows.tolist()
        ]

    by_ratio = candidates[np.argsort(-hand[candidates] / tolerance[candidates], kind="stable")][: hardest.KEPT]
    largest = float(hand[reachable].max(initial=0.0)), float(norm.max(initial=0.0))
    found = Found(len(words), len(reachable), len(above), *largest, hard(by_ratio), hard(by_norm))
    return Found() + found, failures, hand


_TARGET = re.compile(r"(?<= of target )\d+")


def _bits_failure(run: Run, differing: list[int], numbers: Sequence[int]) -> Failure:
    """The message with numbers of the sequence in the place of those of the run."""
    lines = [f"{run.bit_mismatches} bits differ from the bit-true model, results of {len(differing)} targets"]
    first = run.first_mismatch or ""
    named = [int(n) for n in _TARGET.findall(first)[:1]]
    lines += _TARGET.sub(lambda match: str(numbers[int(match[0])]), first).splitlines()
    return Failure(lines, list(dict.fromkeys(named + differing)))


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


DEFAULTS = {"targets": TARGETS, "seed": SEED, "from_": 0, "datapath": DATAPATHS[0], "width": WIDTHS[-1]}
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


def piece(core: Core, seed: int, end: int, number: int) -> tuple[np.ndarray, Found, list[Failure], np.ndarray]:
    """Chunk `number` as far as target `end`: its words, and what :func:`judge` says."""
    start = number * CHUNK
    words = chunk(number, core.width, seed)[: end - start]
    return words, *judge(core, words, range(start, start + len(words)))


@contextlib.contextmanager
def _spread(jobs: int) -> Iterator[Callable]:
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
        core = Core.built(arguments.sim, arguments.datapath, arguments.width)
        what = f"{core}, seed {arguments.seed}"
        print(f"soak: {what}, {arguments.targets} targets from chunk {arguments.from_}", flush=True)
        work = partial(piece, core, arguments.seed, end)
        with (
            _spread(min(arguments.jobs, len(chunks))) as spread,
            progress("soak", arguments.targets, every=EVERY) as meter,
        ):
            for words, more, failures, hand in spread(work, chunks):  # noqa: B007
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
    show(_summary(what, core, found, meter.rate), _table(found))
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
        core = Core.built(arguments.sim, datapath, width)
        words = hardest.array(group)
        found, failures, _ = judge(core, words, range(len(words)))
        tell(failures, words, lambda n, group=group: group[n].found)
        status |= bool(failures)
        print(
            f"{core}: {len(words)} targets, largest hand error / reach {found.hand_error_max:.3e}: "
            f"{'FAIL' if failures else 'pass'}"
        )
    return status


# -- tables ------------------------------------------------------------------------------------------------------------


def _summary(what: str, core: Core, found: Found, rate: float) -> Table:
    """The figures of all targets; only those that pass are counted, so no bit differs."""
    most = tolerances.hand(core.width, core.datapath)
    ratio = found.by_hand[0].hand_error / found.by_hand[0].tolerance if found.by_hand else 0.0
    table = Table(title=f"soak: {what}", box=box.SIMPLE_HEAD, title_justify="left")
    table.add_column("figure")
    table.add_column("measured", justify="right")
    table.add_column("tolerance", justify="right")
    for row in (
        ("targets", str(found.targets)),
        ("of them in reach", str(found.reachable)),
        ("bits that differ from the bit-true model", "0", "0"),
        ("hand error / reach, largest", f"{found.hand_error_max:.2e}",
         "not asked" if most is None else f"{most:.2e}"),
        (f"hand error / {'tolerance' if most else 'prediction'}, largest", f"{ratio:.3f}", "1" if most else ""),
        *([] if most else [("targets seen above their prediction", str(found.above))]),
        ("abs(norm^2 - 1) of Qs and Qe, largest", f"{found.norm_error_max:.2e}", f"{tolerances.norm(core.width):.2e}"),
        ("targets a second, build excluded", f"{rate:.0f}"),
    ):  # fmt: skip
        table.add_row(*row)
    return table


def _table(found: Found) -> Table:
    """The hardest targets: first by hand error beside its tolerance, then by norm error."""
    table = Table(title="the hardest targets", box=box.SIMPLE_HEAD, title_justify="left", padding=(0, 1, 0, 0))
    for heading in ("target", "hand", "/ tol.", "norm", *FIELDS):
        table.add_column(heading, justify="right")
    for hards in (found.by_hand, found.by_norm):
        for hard in hards:
            figures = f"{hard.hand_error:.2e}", f"{hard.hand_error / hard.tolerance:.3f}", f"{hard.norm_error:.2e}"
            table.add_row(str(hard.target), *figures, *map(str, hard.words))
        table.add_section()
    return table


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
