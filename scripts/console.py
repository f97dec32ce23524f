# SPDX-License-Identifier: Apache-2.0
"""Options, error messages, exit status and progress that all commands of scripts/ share.

Exit status of a command: 0 success, 1 a check or a simulation fails, 2 bad input (one line on stderr, nothing written),
130 after Ctrl-C, 143 after SIGTERM, 129 after SIGHUP.
"""

from __future__ import annotations

import argparse
import contextlib
import functools
import math
import os
import signal
import sys
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import NoReturn

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.table import Table

from model.dataflow.datapaths import CONFIGURATIONS, DATAPATHS, DEFAULT
from model.dataflow.nodes import WIDTHS
from model.io.words import TargetError
from model.motion import axes
from model.motion.axes import Axis
from model.motion.clip import TORSO
from tb.sim.env import SIMULATORS
from tb.sim.simulate import SimulationError
from tb.sim.subprocesses import end_with_parent

PLAIN_COLUMNS = 120
"""Columns of a table that is not printed on a terminal."""

EVERY = 5.0
"""Seconds between lines of progress without a terminal."""


class InputError(Exception):
    """Bad input; the text is one line for the user."""


# -- the command line ------------------------------------------------------------------------------


class Parser(argparse.ArgumentParser):
    """A parser that raises InputError.

    command: module below scripts/. passes, fails: meaning of the exit status 0 and 1.
    """

    def __init__(self, command: str, description: str, passes: str = "all is well", fails: str = "a check fails"):
        ends = ", ".join(f"{128 + number} {what}" for number, what in SIGNALS.items())
        super().__init__(
            prog=f"python -m scripts.{command}",
            description=description,
            epilog=f"Exit status: 0 {passes}, 1 {fails}, 2 bad input, {ends}.",
            allow_abbrev=False,
        )

    def error(self, message: str) -> NoReturn:
        raise InputError(message)

    def parse_args(self, args=None, namespace=None) -> argparse.Namespace:
        parsed = super().parse_args(args, namespace)
        chosen = (getattr(parsed, name, None) for name in ("datapath", "width"))
        paths, widths = (value if isinstance(value, list) else [value] for value in chosen)  # lists or single values
        for path in (CONFIGURATIONS[name] for name in paths if name in CONFIGURATIONS):
            if any(width and width not in path.widths for width in widths):
                *others, last = map(str, path.widths)
                lengths = f"{', '.join(others)} or {last}" if others else last
                self.error(f"argument --width: the {path.name} datapath has words of {lengths} bits only")
        return parsed

    def choice(self, option: str, what: str, valid: Sequence[str], default: str | None, about: str) -> None:
        """Add an option that takes one of the words `valid`."""
        self.add_argument(option, type=one_of(what, valid), default=default, metavar="|".join(valid), help=about)

    def core(
        self,
        sim: str = SIMULATORS[0],
        datapath: str | None = DEFAULT,
        width: int = WIDTHS[-1],
        most: int = 1,
        sims: Sequence[str] = SIMULATORS,
    ) -> None:
        """Add --sim, --datapath and --width. With `most` above 1 --datapath takes up to that number of names; None as
        its default stands for all dataflows in the paper's scenario, otherwise the first."""
        default = "(default: %(default)s)"
        self.choice("--sim", "simulator", sims, sim, f"the simulator {default}")
        if most == 1:
            self.choice("--datapath", "datapath", list(CONFIGURATIONS), datapath, f"the datapath {default}")
        else:
            scenario = "" if datapath else f"of the paper's scenario {','.join(DATAPATHS)}, otherwise "
            about = (
                f"up to {most} datapaths, separated by commas, on the same targets: {', '.join(CONFIGURATIONS)} "
                f"(default: {scenario}{datapath or DEFAULT})"
            )
            check = some_of("datapath", list(CONFIGURATIONS), most)
            self.add_argument("--datapath", type=check, default=datapath, metavar="NAME[,NAME]", help=about)
        about = f"word length of the core, {WIDTHS[0]} to {WIDTHS[-1]} {default}"
        self.add_argument("--width", type=word_length, default=width, metavar="BITS", help=about)

    def sample(self, targets: int, about: str) -> Parser:
        """Add the options of a command that measures random targets."""
        default = "(default: %(default)s)"
        self.add_argument("--targets", type=whole(1), default=targets, metavar="N", help=f"{about} {default}")
        self.add_argument("--seed", type=whole(0), default=1, metavar="N", help=f"random seed {default}")
        return self


def one_of(what: str, valid: Sequence[str]) -> Callable[[str], str]:
    """Return an option type: one of the words `valid`."""

    def check(text: str) -> str:
        if text not in valid:
            raise argparse.ArgumentTypeError(f"unknown {what} {text!r}; valid: {', '.join(valid)}")
        return text

    return check


def some_of(what: str, valid: Sequence[str], most: int) -> Callable[[str], list[str]]:
    """Return an option type: up to `most` different words of `valid`, separated by commas."""
    one = one_of(what, valid)

    def check(text: str) -> list[str]:
        found = [one(word) for word in text.split(",")]
        if len(found) > most or len(set(found)) < len(found):
            raise argparse.ArgumentTypeError(f"{text!r} is not up to {most} different ones")
        return found

    return check


def whole(least: int) -> Callable[[str], int]:
    """Return an option type: a whole number of at least `least`."""

    def check(text: str) -> int:
        if not (text.isascii() and text.isdigit() and len(text) <= 15 and int(text) >= least):
            raise argparse.ArgumentTypeError(f"{text!r} is not a whole number of at least {least}")
        return int(text)

    return check


def reference_axis(text: str) -> Axis:
    """Convert an option to a reference axis."""
    try:
        return text if text == TORSO else axes.parse(text)
    except axes.AxisError as exc:
        raise argparse.ArgumentTypeError(str(exc)) from None


def swivel_angle(text: str) -> float | str:
    """Convert an option to a swivel angle (rad) or one of the words clip and constant."""
    return text if text in ("clip", "constant") else finite(text)


def word_length(text: str) -> int:
    """Convert an option to the core's W (bits)."""
    if not (text.isascii() and text.isdigit() and int(text) in WIDTHS):
        raise argparse.ArgumentTypeError(f"unknown width {text!r}; valid: {WIDTHS[0]} to {WIDTHS[-1]} bits")
    return int(text)


def finite(text: str) -> float:
    """Convert an option to a finite number."""
    try:
        value = float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number") from None
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"{text!r} is not a finite number")
    return value


def positive(text: str) -> float:
    """Convert an option to a positive number, such as a length or an error."""
    value = finite(text)
    if value <= 0:
        raise argparse.ArgumentTypeError(f"{text!r} is not positive")
    return value


# -- exit status and files -------------------------------------------------------------------------


class Stopped(KeyboardInterrupt):
    """A signal ended the command; the argument is its number."""


SIGNALS = {signal.SIGINT: "interrupted", signal.SIGTERM: "terminated", signal.SIGHUP: "hung up"}
"""Signals that end a command and the simulators it has started."""


@contextlib.contextmanager
def stoppable() -> Iterator[None]:
    """Raise :class:`Stopped` at the first of SIGNALS, except ignored ones, such as SIGHUP under nohup; later ones
    do not interrupt the clean-up. If make has started the command and is killed, the command gets SIGTERM.

    Outside the main thread this has no effect.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: signal.getsignal(number) for number in SIGNALS}
    stopped = False

    def stop(number: int, _) -> None:
        nonlocal stopped
        if not stopped:
            stopped = True
            raise Stopped(number)

    if "MAKELEVEL" in os.environ:
        end_with_parent()
    try:
        for number, handler in before.items():
            if handler is not signal.SIG_IGN:
                signal.signal(number, stop)
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def exit_status(name: str, work: Callable[[], int]) -> int:
    """Return the status of `work`; after an error print one line, `name` first, and return 1, 2 or 128 + signal.

    Without a terminal, a line every few seconds reports the elapsed time, unless an inner meter reports more.
    """
    try:
        with stoppable(), contextlib.nullcontext() if Console(stderr=True).is_terminal else progress(name, 0):
            return work()
    except KeyboardInterrupt as exc:
        number = exc.args[0] if isinstance(exc, Stopped) else signal.SIGINT
        print(f"{name}: {SIGNALS[number]}", file=sys.stderr)
        return 128 + number
    except OSError as exc:
        print(f"{name}: cannot read or write {_what_failed(exc)}", file=sys.stderr)
        return 2
    except (SimulationError, InputError, TargetError) as exc:
        print(f"{name}: {exc}", file=sys.stderr)
        return 1 if isinstance(exc, SimulationError) else 2


def command(name: str) -> Callable[[Callable[[Sequence[str] | None], int]], Callable[..., int]]:
    """Decorate a function of command-line words to become a `main` that returns an `exit_status`."""

    def main_of(work: Callable[[Sequence[str] | None], int]) -> Callable[..., int]:
        @functools.wraps(work)
        def main(arguments: Sequence[str] | None = None) -> int:
            return exit_status(name, lambda: work(arguments))

        return main

    return main_of


@contextlib.contextmanager
def output(out: Path, paths: Sequence[Path]) -> Iterator[None]:
    """Make the folders of `paths` and check that they are writable; on exit remove new folders that are empty.

    Raises InputError.
    """
    folders = list(dict.fromkeys([out, *(path.parent for path in paths)]))
    new = [one for one in dict.fromkeys(p for f in folders for p in (f, *f.parents)) if not os.path.exists(one)]
    try:
        _check_out(folders, paths)
        yield
    finally:
        for folder in sorted(new, key=lambda path: -len(path.parts)):
            with contextlib.suppress(OSError):  # not empty
                folder.rmdir()


def _check_out(folders: Sequence[Path], paths: Sequence[Path]) -> None:
    for folder in folders:
        probe = folder / f".probe.{os.getpid()}"
        try:
            folder.mkdir(parents=True, exist_ok=True)
            probe.write_bytes(b"")
            probe.unlink()
        except OSError as exc:
            raise InputError(f"argument --out: cannot write in {os.fspath(folder)!r}: {exc.strerror}") from None
    for path in paths:
        if path.is_dir():
            raise InputError(f"argument --out: {os.fspath(path)!r} is a folder; a file is to be written there")


@contextlib.contextmanager
def writing() -> Iterator[None]:
    """Turn an OSError, a full disk for example, into an InputError."""
    try:
        yield
    except OSError as exc:
        raise InputError(f"cannot write {_what_failed(exc)}") from None


def _what_failed(error: OSError) -> str:
    where = repr(os.fspath(error.filename)) if error.filename else "a file"
    return f"{where}: {error.strerror or error}"


@contextlib.contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Yield a temporary path in the folder of `path`; rename it to `path` at the end, or remove it after an error."""
    temporary = path.with_name(f".{os.getpid()}.{path.name}")
    try:
        yield temporary
        if temporary.exists():
            os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)


def folder_name(text: str) -> Path:
    """Convert an option to the path of a folder."""
    if not text.strip():
        raise argparse.ArgumentTypeError("the name of a folder is empty")
    return Path(text)


def show(*tables: Table) -> None:
    """Print tables, as wide as the terminal, or `PLAIN_COLUMNS` into a file."""
    console = Console(width=None if sys.stdout.isatty() else PLAIN_COLUMNS, highlight=False)
    for table in tables:
        console.print(table)


# -- progress --------------------------------------------------------------------------------------


RECENT = 120.0
"""Seconds over which a rate is averaged."""


def pace(rate: float) -> str:
    """Format a rate per second, minute or hour."""
    of, seconds = next(((of, k) for of, k in (("s", 1), ("min", 60)) if rate * k >= 1 or not rate), ("h", 3600))
    return f"{rate * seconds:.0f}/{of}"


class Meter:
    """Progress on stderr: a bar on a terminal, otherwise a line every `every` seconds that begins with `name`.

    total, first: number of items, and of items done by an earlier run.
    """

    def __init__(self, name: str, total: int, first: int = 0, every: float = EVERY, bar: Progress | None = None):
        self.name, self.total, self.every, self.bar = name, total, every, bar
        self.done, self.what, self.lock = first, "", threading.Lock()
        self.begin = self.said = time.monotonic()
        self.recent = deque([(self.begin, first)])
        self.task = bar.add_task(name, total=total, completed=first, rate=pace(0.0)) if bar else None

    def __call__(self, done: int, what: str = "") -> None:
        """Report the number of items done and the present activity."""
        with self.lock:
            self.done, self.what = done, what
            self.recent.append((time.monotonic(), done))
        if self.bar:
            self.bar.update(self.task, description=what or self.name, completed=done, rate=pace(self.rate()))
        else:
            self.beat()

    def rate(self) -> float:
        """Return items per second over the last RECENT seconds, or between the last two reports if that is longer."""
        with self.lock:
            now = time.monotonic()
            while len(self.recent) > 2 and now - self.recent[1][0] > RECENT:
                self.recent.popleft()
            since, before = self.recent[0]
            return (self.done - before) / max(now - since, 1e-9)

    def beat(self) -> None:
        """Print a line if it is due, also without progress."""
        with self.lock:
            now = time.monotonic()
            if now - self.said < self.every:
                return
            self.said = now
        of = f"{now - self.begin:.0f} s so far"
        if rate := self.rate():
            left = (self.total - self.done) / rate
            of = f"{self.done} of {self.total} done, {pace(rate)}, {left:.0f} s left"
        self.line(": ".join(part for part in (self.name, self.what, of) if part))

    def line(self, text: str) -> None:
        """Print a line on stderr, above the bar if there is one."""
        if self.bar:
            self.bar.console.print(text, highlight=False, markup=False, soft_wrap=True)
        else:
            print(text, file=sys.stderr, flush=True)


@contextlib.contextmanager
def _repeated(call: Callable[[], None], seconds: float) -> Iterator[None]:
    """Call a function every `seconds` in a thread."""
    over = threading.Event()

    def repeat() -> None:
        while not over.wait(seconds):
            call()

    thread = threading.Thread(target=repeat, daemon=True)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()


_meters: list[Meter] = []
"""Nested meters without a terminal; the innermost prints."""


@contextlib.contextmanager
def progress(name: str, total: int, first: int = 0, every: float = EVERY) -> Iterator[Meter]:
    """Yield a `Meter`, which also prints while nothing is reported, during a compilation for example."""
    console = Console(stderr=True)
    if not console.is_terminal:
        meter = Meter(name, total, first, every)
        if _meters:
            meter.said = _meters[-1].said
        _meters.append(meter)
        try:
            with _repeated(lambda: _meters[-1] is meter and meter.beat(), every / 5):
                yield meter
        finally:
            _meters.pop()
            if _meters:
                _meters[-1].said = meter.said
        return
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[rate]}"),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console, transient=True, speed_estimate_period=RECENT) as bar:
        yield Meter(name, total, first, bar=bar)
