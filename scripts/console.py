# SPDX-License-Identifier: Apache-2.0
"""Options, error messages, exit status and progress shared by all commands of scripts/.

Exit status of a command: 0 success, 1 a check or a simulation fails, 2 bad input (one line on stderr, nothing written),
130 after Ctrl-C, 143 after SIGTERM, 129 after SIGHUP.
"""

import contextlib
import itertools
import os
import re
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import click
from click.core import ParameterSource
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.table import Table

from model.dataflow.datapaths import CONFIGURATIONS, DATAPATHS, DEFAULT, MODELS
from model.dataflow.formats import WIDTHS
from model.io import trajectories
from model.io.files import Place, number, whole_files
from model.io.words import DEFAULT_D1, DEFAULT_D2, TargetError
from model.motion import arms
from model.motion import clip as clips
from model.reference.kinematics import NAMED_AXES, Axis, parse_axis
from tb.sim.env import CORES, ROOT, SIMULATORS
from tb.sim.simulate import LONG, SimulationError
from tb.sim.subprocesses import end_with_parent

PLAIN_COLUMNS = 120  # characters in a line of a table that is not printed on a terminal
MOST_DATAPATHS = 3  # largest number of datapaths that a command compares
EVERY = 5.0  # seconds between progress lines if stderr is no terminal
RECENT = 120.0  # seconds over which a rate is averaged


class Options(SimpleNamespace):
    """Values of a command's options by name; `given` is the set of names that the command line contains."""


class InputError(click.ClickException):
    """Bad input. The message is one line for the user."""


SIGNALS = {signal.SIGINT: "interrupted", signal.SIGTERM: "terminated", signal.SIGHUP: "hung up"}
"""Signal that ends a command and its simulators -> word for the message."""


CONTEXT = {"show_default": True, "help_option_names": ["-h", "--help"], "max_content_width": PLAIN_COLUMNS}


def _options_of_make(parser: click.Command, words: Iterable[str]) -> Iterator[str]:
    """Yield the command-line words; a make variable NAME=value becomes the option --name. Variables without a value and
    switches set to 0 are omitted. Raises InputError for an unknown variable and for a switch other than 0 or 1."""
    options = [param for param in parser.params if isinstance(param, click.Option)]
    switches = {param.opts[0]: param.is_flag for param in options} | {"--help": True}
    for word in words:
        name, equals, value = word.partition("=")
        if not (equals and name.isidentifier()):
            yield word
            continue
        option = f"--{name.lower()}"
        if option not in switches or name != name.upper():
            known = ", ".join(sorted(each[2:].upper() for each in switches))
            raise InputError(f"unknown variable {name}=; known: {known}")
        if switches[option] and value not in ("", "0", "1"):
            raise InputError(f"{name}={value}: use 1 or 0")
        if value and not (switches[option] and value == "0"):
            yield option if switches[option] else f"{option}={value}"


def _parsed(parser: click.Command, program: str, arguments: Sequence[str]) -> Options:
    """Return the values of all options. Raises InputError for a word length that a datapath lacks."""
    with parser.make_context(program, [*_options_of_make(parser, arguments)]) as context:
        given = {name for name in context.params if context.get_parameter_source(name) is ParameterSource.COMMANDLINE}
        options = Options(**context.params, given=given)
    chosen = (context.params.get(name) for name in ("datapath", "width"))
    paths, widths = (value if isinstance(value, (list, tuple)) else [value] for value in chosen)
    for path in (MODELS[name] for name in paths if name in MODELS):
        if any(width and width not in path.widths for width in widths):
            lengths = ", ".join(map(str, path.widths))
            raise InputError(f"argument --width: the {path.name} datapath supports {lengths} bits")
    return options


def command(
    name: str,
    options: Sequence[click.Parameter] = (),
    *,
    about: str = "",
    passes: str = "all is well",
    fails: str = "a check fails",
) -> Callable[[Callable[[Options], int]], Callable[..., int]]:
    """Return a decorator that turns a function of parsed options into `main(words)`, which returns an exit status.

    After an error, `main` prints one line that begins with `name`. If make started the command, the line shows options
    as make variables. Texts for --help: `about` describes the command (default: first line of the module's
    docstring), `passes` and `fails` describe exit status 0 and 1.
    """
    ends = ", ".join(f"{128 + number} {what}" for number, what in SIGNALS.items())
    epilog = f"Exit status: 0 {passes}, 1 {fails}, 2 bad input, {ends}."
    words = {word for option in options for word in option.opts}

    def main_of(work: Callable[[Options], int]) -> Callable[..., int]:
        module, doc = (work.__globals__[key] for key in ("__spec__", "__doc__"))
        summary = about or (doc or "").partition("\n")[0]
        parser = click.Command(name, params=[*options], help=summary, epilog=epilog, context_settings=CONTEXT)
        program = f"python -m {module.name.removesuffix('.__main__')}" if module else name

        @stoppable()
        def main(arguments: Sequence[str] | None = None) -> int:
            try:
                return work(_parsed(parser, program, sys.argv[1:] if arguments is None else arguments))
            except click.exceptions.Exit as exc:  # after --help
                return exc.exit_code
            except Stopped as exc:
                status, line = 128 + exc.args[0], SIGNALS[exc.args[0]]
            except OSError as exc:
                where = repr(os.fspath(exc.filename)) if exc.filename else "a file"
                status, line = 2, f"cannot read or write {where}: {exc.strerror or exc}"
            except click.ClickException as exc:
                param = None if isinstance(exc, click.MissingParameter) else getattr(exc, "param", None)
                status, line = 2, f"argument {param.opts[0]}: {exc}" if param else exc.format_message()
            except (TargetError, SimulationError) as exc:
                status, line = 1 if isinstance(exc, SimulationError) else 2, str(exc)
            if "MAKELEVEL" in os.environ:
                line = re.sub(r"--[a-z0-9]+", lambda at: f"{at[0][2:].upper()}=" if at[0] in words else at[0], line)
            print(f"{name}: {line}", file=sys.stderr)
            return status

        return main

    return main_of


class Stopped(KeyboardInterrupt):
    """Raised when a signal ends the command; the argument is the number of the signal."""


@contextlib.contextmanager
def stoppable() -> Iterator[None]:
    """Raise :class:`Stopped` at the first of SIGNALS; later signals are ignored, so they do not interrupt the clean-up.
    Signals that are ignored from the start, such as SIGHUP under nohup, stay ignored. If make started the command and
    make is killed, the command gets SIGTERM."""

    def stop(number: int, _) -> None:
        for each in SIGNALS:
            signal.signal(each, signal.SIG_IGN)
        raise Stopped(number)

    if "MAKELEVEL" in os.environ:
        end_with_parent()
    before = {number: handler for number in SIGNALS if (handler := signal.getsignal(number)) is not signal.SIG_IGN}
    try:
        for number in before:
            signal.signal(number, stop)
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def option(name: str, about: str, kind: Any = None, **settings) -> click.Option:
    """Return an option that takes a value. With the kind Path, ~ is expanded to the home folder."""
    kind = (lambda text: Path(os.path.expanduser(text))) if kind is Path else kind
    return click.Option([name, *(["from_"] if name == "--from" else [])], help=about, type=kind, **settings)


def switch(name: str, about: str) -> click.Option:
    """Return an option without a value."""
    return click.Option([name], help=about, is_flag=True)


def sim_option(default: str = SIMULATORS[0]) -> click.Option:
    return option("--sim", "simulator", click.Choice(SIMULATORS), default=default)


def installed(need: str) -> bool:
    """Install the programs for ``need``, such as ``verilator``, if missing; return whether they are available."""
    words = [sys.executable, "-ES", ROOT / "scripts" / "setup" / "bootstrap.py", need]
    return subprocess.run(words, check=False).returncode == 0


def choose_simulator(options: Options, targets: int) -> None:
    """Use Verilator for `LONG` targets or more, if it can be installed and neither --waves nor another --sim is given;
    print which simulator is used."""
    chosen = "sim" in options.given
    if targets < LONG or getattr(options, "waves", None) or (chosen and options.sim != "verilator"):
        return
    options.sim = "verilator" if chosen or installed("verilator") else options.sim
    if options.sim == "verilator":
        how = "by Verilator without Python in the loop; SIM=icarus takes longer, with the same results"
    else:
        how = "by Icarus, in minutes; Verilator, which takes seconds, could not be installed"
    print(f"{targets} targets are simulated {how}", file=sys.stderr)


def core_options(
    sim: str = SIMULATORS[0], datapath: str | None = DEFAULT, most: int = 1, names: Iterable[str] = CONFIGURATIONS
) -> list[click.Option]:
    """Return the options --sim, --datapath and --width. --datapath takes up to `most` of `names`. datapath: default of
    --datapath; None stands for all of DATAPATHS in the paper's scenario and for DEFAULT in other scenarios."""
    names = list(names)
    if most == 1:
        paths = option("--datapath", "datapath", click.Choice(names), default=datapath)
    else:
        about = f"up to {most} datapaths, separated by commas, on the same targets: {', '.join(names)}"
        if not datapath:
            about += f"  [default: of the paper's scenario {','.join(DATAPATHS)}, otherwise {DEFAULT}]"
        paths = option("--datapath", about, some_of(names, most), default=datapath, metavar="NAME[,NAME]")
    length = option("--width", "word length of the core", WORD_LENGTH, default=WIDTHS[-1], metavar="BITS")
    return [sim_option(sim), paths, length]


def some_of(valid: Sequence[str], most: int) -> Callable[[str], list[str]]:
    """Return an option type: up to `most` different names of `valid`, separated by commas."""
    one = click.Choice(valid)

    def check(text: str) -> list[str]:
        found = [one(word) for word in text.split(",")]
        if len(found) > most or len(set(found)) < len(found):
            raise click.BadParameter(f"{text!r} is not a list of up to {most} different names")
        return found

    return check


whole = click.IntRange  # option type: whole(low, high) is a whole number in that range; high is optional
WORD_LENGTH = whole(WIDTHS[0], WIDTHS[-1])


class Finite(click.FloatRange):
    """Option type: a finite number in a range."""

    def convert(self, value, param, context) -> float:
        try:
            return super().convert(number(value) if isinstance(value, str) else value, param, context)
        except ValueError as error:
            self.fail(str(error), param, context)


POSITIVE = Finite(min=0, min_open=True)


def reference_axis(text: str) -> Axis:
    """Convert an option's text to a reference axis; return "torso" unchanged."""
    try:
        return text if text == clips.TORSO else parse_axis(text)
    except ValueError as exc:
        raise click.BadParameter(str(exc)) from None


def point(text: str) -> list[float] | str:
    """Convert an option's text x,y,z to a point; return a text without commas (a joint's name) unchanged."""
    if "," not in text:
        return text
    numbers = [Finite()(part) for part in text.split(",")]
    if len(numbers) != 3:
        raise click.BadParameter(f"{text!r} is not x,y,z")
    return numbers


def swivel_angle(text: str) -> float | str:
    """Convert an option's text to a swivel angle (rad); return "clip" and "constant" unchanged."""
    return text if text in ("clip", "constant") else Finite()(text)


def trajectory_options(
    out: str, written: str, *, datapath: str | None = DEFAULT, most: int = 1, core: bool = True
) -> list[click.Option]:
    """Return the options of a command that runs trajectories.

    out: default of --out. written: names of the files written there, for --help. datapath: default of --datapath; None:
    the trajectory determines it. most: largest number of names in --datapath. core: also return the core's options.
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
        "swivel angle; CSV file: for rows without that column (default: the elbow hangs down); clip: 'clip' for its "
        "own angles (default), 'constant' for the mean of each arm, or one number"
    )
    pole = "point the elbow at X,Y,Z (CSV file: from the shoulder; clip: world) or at a clip's joint; overrides phi"
    soft = "outer fraction of the reach, 0 to 1, in which CSV or clip targets are pulled in smoothly"
    robot = "arm with its lengths, tool and joint limits; hand poses are poses of its tip in its base frame"
    plan = "choose branch and swivel angle of hand poses along the whole path, or of each row alone  [default: path]"
    limits = "rows with a joint outside the limits of ROBOT: fail the run, or report them  [default: fail]"
    rate = "rows per second of a ROBOT's path, for its joint speeds  [default: times (s) in column t, if present]"
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
        option("--arm", "clip: sides to run  [default: both]", click.Choice(["both", *clips.SIDES])),
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


def output(out: Path, paths: Sequence[Path], inputs: Iterable[Path] = ()) -> contextlib.AbstractContextManager[Place]:
    """Make `out` and the folders of `paths`; return the context `whole_files()`, at whose end all output files appear.

    Raises InputError if an output is one of `inputs` or a folder, and OSError if a folder is not writable.
    """
    for path, source in itertools.product(paths, inputs):
        if os.path.realpath(path) == os.path.realpath(source):
            raise InputError(f"argument --out: {str(path)!r} is the input {str(source)!r}, which must not be replaced")
    for path in paths:
        if path.is_dir():
            raise InputError(f"argument --out: {os.fspath(path)!r} is a folder, not a file")
    for folder in dict.fromkeys([out, *(path.parent for path in paths)]):
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    return whole_files()


def show(*tables: Table) -> None:
    """Print tables as wide as the terminal, or `PLAIN_COLUMNS` wide if stdout is no terminal."""
    console = Console(width=None if sys.stdout.isatty() else PLAIN_COLUMNS, highlight=False)
    for table in tables:
        console.print(table)


class Meter(Progress):
    """Progress bar of `total` items on stderr. If stderr is not a terminal, a line is printed every few seconds, even
    while no item completes."""

    def __init__(self, name: str, total: int):
        console = Console(stderr=True)
        columns = TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn()
        more = {"console": console, "transient": True, "disable": not console.is_terminal}
        super().__init__(*columns, TimeRemainingColumn(), speed_estimate_period=RECENT, **more)
        self.add_task(name, total=total)
        (self.task,) = self.tasks
        self.name, self.over = name, threading.Event()

    def __call__(self, done: int, what: str = "") -> None:
        """Update the number of items done and the present activity `what`."""
        self.update(self.task.id, completed=done, description=what or self.name)

    def start(self) -> None:
        super().start()
        if self.disable:
            threading.Thread(target=self._lines, daemon=True).start()

    def stop(self) -> None:
        self.over.set()
        super().stop()

    def _lines(self) -> None:
        while not self.over.wait(EVERY):
            task = self.task
            left = f", {task.time_remaining:.0f} s left" if task.time_remaining else ""
            what = f"{task.description}: " if task.description != self.name else ""
            line = f"{self.name}: {what}{task.completed} of {task.total} done after {task.elapsed:.0f} s{left}"
            print(line, file=sys.stderr, flush=True)


progress = Meter  # with progress(name, total) as meter: ... meter(done)
