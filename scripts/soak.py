# SPDX-License-Identifier: Apache-2.0
"""Random targets of all kinds through the RTL, as many as wanted, every node compared: what `make soak` does.

    python -m scripts.soak [--targets N] [--seed S] [--datapath ...] [--width ...] [--keep] [--restart] ...
    python -m scripts.soak --again FILE.csv

Targets come in chunks; a chunk depends on seed, width and its number only. After each chunk the state file
OUT/<datapath>-<width>-<seed>.json holds how far the soak is and the hardest targets so far; a run with more targets, or
after Ctrl-C, goes on there. At the end the hardest go into OUT/hardest.csv and, with --keep, into
tb/core/hardest.csv, the regression list.

It stops at the first chunk in which a bit or a flag is wrong, a quaternion is not of unit length or a hand of the lean
datapath is further off than its bar, and writes the targets to OUT/failing.csv. The paper's equations are held to no
bar here: near two singular poses at once their errors pass even what `model.bounds.predict` explains; they are
reported.

Exit status: 0 all is well, 1 a check fails or the simulation breaks off, 2 input that cannot be used (one line on
stderr), 130 after Ctrl-C.
"""

from __future__ import annotations

import argparse
import contextlib
import dataclasses
import hashlib
import json
import math
import re
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from rich import box
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table

from model.dataflow import fixed
from model.dataflow.nodes import WIDTHS
from model.targets.files import write_atomically
from model.targets.flags import expected_flags, names
from model.targets.stimuli import REGIONS, corners, extremes, random_reachable, region, unreachable
from model.targets.words import FIELDS
from scripts.console import InputError, Parser, check_out, exit_status, one_of, show, whole, word_length, writing
from scripts.pages.wordlengths import edges
from tb.core import hardest
from tb.sim.env import ROOT, SIMULATORS
from tb.sim.simulate import DATAPATHS, Job, Run, SimulationError, simulate

CHUNK = 20000
TARGETS = 100_000
SEED = 1

CANDIDATES = 1000
"""Targets of a chunk, those with the largest hand errors, whose bars are predicted where there is no fixed one."""

FORMAT = 1
"""Of the state file."""

TOP = "ik_axis"


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


def digest_of_core(datapath: str, root: Path = ROOT) -> str:
    """Of the Verilog that is simulated, without comments and spaces: a count of targets is of one core.

    That is `ik_axis` and every file of the datapath and of the libraries that it names, or one that it names does.
    """
    texts = {}
    for folder in ("rtl", "rtl/lib", "rtl/cores", f"rtl/{datapath}"):
        for path in (root / folder).glob("*.v*"):
            texts[path.stem] = re.sub(r"//.*", "", path.read_text(encoding="utf-8"))
    used, new = {TOP}, {TOP}
    while new:
        named = {name for file in new for name in re.findall(r"\bik_\w+", texts.get(file, ""))}
        new = (named & set(texts)) - used
        used |= new
    text = "\0".join(f"{file}\0{''.join(texts.get(file, '').split())}" for file in sorted(used))
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def digest_of_targets(width: int, seed: int) -> str:
    """Of the first chunk: a count of targets is of one sequence."""
    return hashlib.sha256(chunk(0, width, seed).astype("<i8").tobytes()).hexdigest()[:16]


# -- judging -----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Hard:
    """A target in reach with its number in the sequence, its errors, and what its hand error is held against."""

    target: int
    words: list[int]
    hand_error: float
    bar: float
    norm_error: float


@dataclass
class Found:
    """What some targets gave: how many of them are in reach and above their prediction, the largest errors, the
    hardest targets by either measure."""

    reachable: int = 0
    above: int = 0
    hand_error_max: float = 0.0
    norm_error_max: float = 0.0
    by_hand: list[Hard] = field(default_factory=list)
    by_norm: list[Hard] = field(default_factory=list)

    def __add__(self, other: Found) -> Found:
        return Found(
            self.reachable + other.reachable,
            self.above + other.above,
            max(self.hand_error_max, other.hand_error_max),
            max(self.norm_error_max, other.norm_error_max),
            _first(self.by_hand + other.by_hand, lambda hard: hard.hand_error / hard.bar),
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


def judge(
    words: np.ndarray, run: Run, numbers: Sequence[int], width: int, datapath: str
) -> tuple[Found, list[Failure], np.ndarray]:
    """What a run of targets gave, what fails, and the hand errors (N,), nan out of reach.

    numbers (N,): of the targets in their sequence. Raises SimulationError for lost results.
    """
    if run.results.shape != words.shape or run.flags.shape != (len(words),):
        raise SimulationError(f"{len(words)} targets were sent, {len(run.results)} results came back")
    answer = fixed.run(words, width, datapath)
    hand, norm = hardest.errors(words, run.results, width)
    reachable = np.flatnonzero(~np.isnan(hand))
    candidates = reachable[np.argsort(-hand[reachable], kind="stable")][:CANDIDATES]
    bar = np.full(len(words), np.inf)
    bar[candidates] = hardest.bars(words[candidates], width, datapath)
    above = candidates[hand[candidates] > bar[candidates]]

    failures = []
    differs = (run.results != answer.results).any(axis=1) | (run.flags != answer.flags)
    if run.bit_mismatches or differs.any():
        failures.append(_bits_failure(run, np.flatnonzero(differs).tolist(), numbers))
    wrong = np.flatnonzero(run.flags != (owed := expected_flags(words, width)))
    if len(wrong):
        n = int(wrong[0])
        text = f"flags {names(int(run.flags[n]))} instead of {names(int(owed[n]))} ({len(wrong)} targets)"
        failures.append(Failure([text], wrong.tolist()))
    if datapath == "lean" and len(above):
        rows = above[np.argsort(-hand[above] / bar[above], kind="stable")].tolist()
        n = rows[0]
        text = f"hand error / reach {hand[n]:.3e} is above its bar {bar[n]:.3e} ({len(rows)} targets)"
        failures.append(Failure([text], rows))
    long = np.flatnonzero(~(norm <= hardest.norm_bar(width)))
    if len(long):
        rows = long[np.argsort(-norm[long], kind="stable")].tolist()
        most = hardest.norm_bar(width)
        text = f"abs(norm^2 - 1) {norm[rows[0]]:.3e} is above its bar {most:.3e} ({len(rows)} targets)"
        failures.append(Failure([text], rows))

    by_norm = reachable[np.argsort(-norm[reachable], kind="stable")][: hardest.KEPT]
    missing = by_norm[np.isinf(bar[by_norm])]
    if len(missing):
        bar[missing] = hardest.bars(words[missing], width, datapath)

    def hard(rows) -> list[Hard]:
        return [
            Hard(int(numbers[n]), words[n].tolist(), float(hand[n]), float(bar[n]), float(norm[n]))
            for n in rows.tolist()
        ]

    by_ratio = candidates[np.argsort(-hand[candidates] / bar[candidates], kind="stable")][: hardest.KEPT]
    found = Found() + Found(
        reachable=len(reachable),
        above=len(above),
        hand_error_max=float(hand[reachable].max(initial=0.0)),
        norm_error_max=float(norm.max(initial=0.0)),
        by_hand=hard(by_ratio),
        by_norm=hard(by_norm),
    )
    return found, failures, hand


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


# -- the state ---------------------------------------------------------------------------------------------------------


@dataclass
class State:
    """How far a soak of one datapath, word length and seed is, and what it found."""

    datapath: str
    width: int
    seed: int
    core: str
    targets: str
    done: int = 0
    found: Found = field(default_factory=Found)

    def write(self, path: Path) -> None:
        """Raises OSError; then the file is what it was before."""
        data = {"format": FORMAT, **dataclasses.asdict(self)}
        write_atomically(path, json.dumps(data, indent=1, allow_nan=False) + "\n")


def _is(kind: type, value) -> bool:
    """Whether a value of a JSON file is a count, a finite number, a text or a list."""
    if kind is float:
        return type(value) in (int, float) and math.isfinite(value) and value >= 0
    return type(value) is kind and (kind is not int or value >= 0)


def _record(cls, data, kinds: dict[str, type]):
    """The dataclass `cls` from a JSON object that has just these keys. Raises ValueError."""
    if type(data) is not dict or set(data) != set(kinds):
        raise ValueError(f"its {cls.__name__} has other keys than {', '.join(kinds)}")
    for name, kind in kinds.items():
        if not _is(kind, data[name]):
            raise ValueError(f"{name} is {str(data[name])[:40]}")
    return cls(**data)


def read_state(path: Path) -> State:
    """The state in a file. Raises InputError, in one line."""
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
        if type(data) is not dict or data.pop("format", None) != FORMAT:
            raise ValueError(f"it is not of format {FORMAT}")
        state = _record(
            State, data,
            {"datapath": str, "width": int, "seed": int, "core": str, "targets": str, "done": int, "found": dict},
        )  # fmt: skip
        found = _record(
            Found, state.found,
            {"reachable": int, "above": int, "hand_error_max": float, "norm_error_max": float, "by_hand": list,
             "by_norm": list},
        )  # fmt: skip
        kinds = {"target": int, "words": list, "hand_error": float, "bar": float, "norm_error": float}
        for name in ("by_hand", "by_norm"):
            hards = [_record(Hard, hard, kinds) for hard in getattr(found, name)]
            if any(len(h.words) != len(FIELDS) or h.bar == 0 or {*map(type, h.words)} != {int} for h in hards):
                raise ValueError(f"a target of {name} makes no sense")
            setattr(found, name, hards)
        state.found = found
        return state
    except (ValueError, RecursionError) as error:  # of which UnicodeDecodeError and JSONDecodeError are some
        raise InputError(f"{path}: not a state of a soak: {error}; --restart begins anew") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None


def state_of(arguments: argparse.Namespace, path: Path) -> State:
    """The state to go on from. Raises InputError."""
    fresh = State(
        arguments.datapath,
        arguments.width,
        arguments.seed,
        digest_of_core(arguments.datapath),
        digest_of_targets(arguments.width, arguments.seed),
    )
    if arguments.restart or not path.exists():
        return fresh
    state = read_state(path)
    for name, what in (("datapath", "another datapath"), ("width", "another width"), ("seed", "another seed"),
                       ("core", "other Verilog"), ("targets", "other targets")):  # fmt: skip
        if getattr(state, name) != getattr(fresh, name):
            raise InputError(f"{path}: is of {what} than there would be now; --restart begins anew")
    return state


# -- the command line --------------------------------------------------------------------------------------------------


NOT_AGAIN = ("targets", "seed", "datapath", "width", "restart", "keep")


def _parser() -> argparse.ArgumentParser:
    parser = Parser(
        "soak", "Random targets of all kinds through the core in a simulator, every node compared with the model."
    )
    parser.add_argument(
        "--targets", type=whole(1), metavar="N", help=f"how many in all, earlier runs included (default: {TARGETS})"
    )
    parser.add_argument("--seed", type=whole(0), metavar="S", help=f"of everything random (default: {SEED})")
    parser.add_argument(
        "--datapath", type=one_of("datapath", DATAPATHS), metavar="|".join(DATAPATHS),
        help=f"which dataflow of the core to run (default: {DATAPATHS[0]})",
    )  # fmt: skip
    about = f"word length, {WIDTHS[0]} to {WIDTHS[-1]} (default: {WIDTHS[-1]})"
    parser.add_argument("--width", type=word_length, metavar="BITS", help=about)
    parser.add_argument(
        "--sim", type=one_of("simulator", SIMULATORS), default="verilator", metavar="|".join(SIMULATORS),
        help="the simulator (default: %(default)s)",
    )  # fmt: skip
    parser.add_argument(
        "--out", type=Path, default=Path("build/soak"), metavar="DIR",
        help="folder for the state, hardest.csv and failing.csv, made if need be (default: %(default)s)",
    )  # fmt: skip
    parser.add_argument("--restart", action="store_true", help="begin anew instead of going on where the state is")
    parser.add_argument("--keep", action="store_true", help="put the hardest targets into tb/core/hardest.csv too")
    parser.add_argument("--again", type=Path, metavar="FILE", help="run the targets of a failing.csv or hardest.csv")
    return parser


def _parse(arguments: Sequence[str] | None) -> argparse.Namespace:
    parsed = _parser().parse_args(arguments)
    if parsed.again:
        for name in NOT_AGAIN:
            value = getattr(parsed, name)
            if value is not None and value is not False:  # a seed of 0 is one
                raise InputError(f"argument --{name}: does not go with --again, whose file says what to run")
    for name, value in (("targets", TARGETS), ("seed", SEED), ("datapath", DATAPATHS[0]), ("width", WIDTHS[-1])):
        if getattr(parsed, name) is None:
            setattr(parsed, name, value)
    return parsed


# -- the run -----------------------------------------------------------------------------------------------------------


class _Watch:
    """Progress over all targets: a bar on a terminal, else a line a chunk."""

    def __init__(self, progress: Progress | None, done: int, total: int) -> None:
        self.progress = progress
        self.first, self.total = done, total
        self.begin = time.monotonic()
        if progress:
            self.task = progress.add_task("soak", total=total, completed=done, rate=0.0)

    def rate(self, done: int) -> float:
        """Targets a second in this run."""
        return (done - self.first) / max(time.monotonic() - self.begin, 1e-9)

    def simulated(self, since: int) -> Callable[[int, int], None] | None:
        """For `simulate`, in a chunk that begins at target `since`."""
        if not self.progress:
            return None
        return lambda done, total: self.progress.update(self.task, completed=since + done, rate=self.rate(since + done))

    def chunk_done(self, done: int) -> None:
        """A chunk is judged and its state written."""
        rate = self.rate(done)
        if self.progress:
            self.progress.update(self.task, completed=done, rate=rate)
        else:
            left = (self.total - done) / rate
            print(f"soak: {done} of {self.total} targets, {rate:.0f}/s, {left:.0f} s left", file=sys.stderr)


@contextlib.contextmanager
def _watch(done: int, total: int) -> Iterator[_Watch]:
    console = Console(stderr=True)
    if not console.is_terminal:
        yield _Watch(None, done, total)
        return
    columns = (
        TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TextColumn("{task.fields[rate]:.0f}/s"),
        TimeRemainingColumn(), TextColumn("left"),
    )  # fmt: skip
    with Progress(*columns, console=console, transient=True, speed_estimate_period=120) as progress:
        yield _Watch(progress, done, total)


def _write_failing(arguments: argparse.Namespace, rows: list[hardest.Row]) -> None:
    path = arguments.out / "failing.csv"
    with writing():
        write_atomically(path, hardest.text(rows))
    print(f"soak: {len(rows)} failing targets in {path}; to run them again: --again {path}", file=sys.stderr)


def _row(arguments, words, hand_error: float, number: int) -> hardest.Row:
    error = None if math.isnan(hand_error) else float(hand_error)
    words = tuple(map(int, words))
    return hardest.Row(arguments.datapath, arguments.width, words, error, f"seed {arguments.seed} target {number}")


def _step(arguments: argparse.Namespace, state: State, watch: _Watch) -> bool:
    """The next chunk, or what is left of it or wanted of it, and the state after it; False when something fails."""
    number, since = divmod(state.done, CHUNK)
    words = chunk(number, arguments.width, arguments.seed)[since:][: arguments.targets - state.done]
    numbers = range(state.done, state.done + len(words))
    (run,) = simulate(
        [Job(f"chunk {number}", words)],
        simulator=arguments.sim,
        datapath=arguments.datapath,
        width=arguments.width,
        progress=watch.simulated(state.done),
    )
    found, failures, hand = judge(words, run, numbers, arguments.width, arguments.datapath)
    if failures:
        if watch.progress:
            watch.progress.stop()
        where = f"in chunk {number} of seed {arguments.seed}"
        rows = tell(failures, words, lambda n: f"target {numbers[n]} {where}")
        _write_failing(arguments, [_row(arguments, words[n], hand[n], numbers[n]) for n in rows])
        return False
    if digest_of_core(arguments.datapath) != state.core:
        raise InputError("the Verilog changed during the soak: its last chunk does not count; --restart begins anew")
    state.done += len(words)
    state.found += found
    return True


def _soak(arguments: argparse.Namespace) -> int:
    """Go on to --targets; the exit status 0, 1 or 130. Raises what `exit_status` reports."""
    path = arguments.out / f"{arguments.datapath}-{arguments.width}-{arguments.seed}.json"
    hardest_path = arguments.out / "hardest.csv"
    check_out(arguments.out, [path, hardest_path, arguments.out / "failing.csv"])
    lists = [hardest_path, *([hardest.LIST] if arguments.keep else [])]
    earlier = {file: _read_rows(file) if file.exists() else [] for file in lists}
    state = state_of(arguments, path)
    print(
        f"soak: {arguments.datapath} datapath, {arguments.width} bits, {arguments.sim}, seed {arguments.seed}; "
        f"{state.done} of {arguments.targets} targets done before ({path})",
        flush=True,
    )
    rate = None
    try:
        if state.done < arguments.targets:
            with _watch(state.done, arguments.targets) as watch:
                while state.done < arguments.targets:
                    if not _step(arguments, state, watch):
                        return 1
                    with writing():
                        state.write(path)
                    watch.chunk_done(state.done)
                rate = watch.rate(state.done)
    except KeyboardInterrupt:
        print(
            f"soak: interrupted; {state.done} targets are done, the same command (without --restart) goes on there",
            file=sys.stderr,
        )
        return 130
    show(_summary(arguments, state, rate), _table(state))
    hards = {tuple(hard.words): hard for hard in state.found.by_hand + state.found.by_norm}.values()
    rows = [_row(arguments, hard.words, hard.hand_error, hard.target) for hard in hards]
    for file, before in earlier.items():
        with writing():
            write_atomically(file, hardest.text(hardest.merge(before + rows)))
        print(f"wrote {file}")
    return 0


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
        words = hardest.array(group)
        (run,) = simulate([Job("again", words)], simulator=arguments.sim, datapath=datapath, width=width)
        found, failures, _ = judge(words, run, range(len(words)), width, datapath)
        tell(failures, words, lambda n, group=group: group[n].found)
        status |= bool(failures)
        print(
            f"{datapath} datapath, {width} bits, {arguments.sim}: {len(words)} targets, {run.bit_mismatches} bits "
            f"differ, largest hand error / reach {found.hand_error_max:.3e}: {'FAIL' if failures else 'pass'}"
        )
    return status


# -- tables ------------------------------------------------------------------------------------------------------------


def _summary(arguments: argparse.Namespace, state: State, rate: float | None) -> Table:
    """The figures of all targets so far; only those that pass are counted, so no bit differs."""
    found, width = state.found, state.width
    fixed_bar = state.datapath == "lean" and hardest.LEAN_BARS.get(width)
    ratio = found.by_hand[0].hand_error / found.by_hand[0].bar if found.by_hand else 0.0
    table = Table(
        title=f"soak: {state.datapath} datapath, {width} bits, {arguments.sim}, seed {state.seed}",
        box=box.SIMPLE_HEAD,
        title_justify="left",
    )
    table.add_column("figure")
    table.add_column("measured", justify="right")
    table.add_column("bar", justify="right")
    table.add_row("targets", str(state.done))
    table.add_row("of them in reach", str(found.reachable))
    table.add_row("bits that differ from the bit-true model", "0", "0")
    table.add_row("hand error / reach, largest", f"{found.hand_error_max:.2e}", f"{fixed_bar:.2e}" if fixed_bar else "")
    table.add_row(
        f"hand error / {'bar' if fixed_bar else 'prediction'}, largest",
        f"{ratio:.3f}", "1" if state.datapath == "lean" else "",
    )  # fmt: skip
    if not fixed_bar:
        table.add_row("targets seen above their prediction", str(found.above))
    table.add_row(
        "abs(norm^2 - 1) of Qs and Qe, largest", f"{found.norm_error_max:.2e}", f"{hardest.norm_bar(width):.2e}"
    )
    table.add_row("targets a second in this run, build included", "-" if rate is None else f"{rate:.0f}")
    return table


def _table(state: State) -> Table:
    """The hardest targets: first by hand error beside its bar, then by norm error."""
    table = Table(title="the hardest targets", box=box.SIMPLE_HEAD, title_justify="left", padding=(0, 1, 0, 0))
    for heading in ("target", "hand", "/ bar", "norm", *FIELDS):
        table.add_column(heading, justify="right")
    for hards in (state.found.by_hand, state.found.by_norm):
        for hard in hards:
            figures = f"{hard.hand_error:.2e}", f"{hard.hand_error / hard.bar:.3f}", f"{hard.norm_error:.2e}"
            table.add_row(str(hard.target), *figures, *map(str, hard.words))
        table.add_section()
    return table


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; the exit status."""

    def work() -> int:
        parsed = _parse(arguments)
        return _again(parsed) if parsed.again else _soak(parsed)

    return exit_status("soak", work)


if __name__ == "__main__":
    sys.exit(main())
