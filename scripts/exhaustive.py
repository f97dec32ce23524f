# SPDX-License-Identifier: Apache-2.0
"""make exhaustive: every argument of a divider, a square root and the reciprocal root, each answer judged.

    python -m scripts.exhaustive [--only NAME] [--small] [--jobs N] [--list]

A case is a module with its parameters, in a program that Verilator makes of it and of tb/units/exhaustive.cpp, which
drives
one argument a clock and holds each answer against the module's definition in integers of C++: no Python in the loop,
and no line in common with the model. The arguments are cut into pieces, a process each. A full run without a failure
writes docs/generated/exhaustive.md; --small takes short words and seconds, and writes nothing.

Exit status: 0 all is well, 1 failures found, 2 wrong options or no program can be built (one line on stderr),
130 after Ctrl-C.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from datetime import date
from importlib import metadata
from pathlib import Path

from model.dataflow.cores import rsqrt_clocks
from model.dataflow.nodes import Latency
from model.io.files import write_atomically
from scripts.console import InputError, Meter, Parser, command, progress, whole, writing
from scripts.pages.render import render
from tb.sim.env import CORES, GENERATED, ROOT
from tb.sim.native import build
from tb.sim.simulate import SimulationError
from tb.sim.sources import closure, digest

HARNESS = ROOT / "tb" / "units" / "exhaustive.cpp"
PAGE = GENERATED / "exhaustive.md"

PIECE = 1 << 23
"""Vectors of one process: about a second, so that Ctrl-C need not stop one."""

DIVIDER = "q = floor(n 2^SH / d), saturated; by the sign of n where d <= 0"
ROOT_OF = "q = floor(sqrt(n 2^SH)), 0 where n < 0"
RECIPROCAL = "y = 1/(2 sqrt m), error below a place, also where m was cut off; m + 1/4 for m < 1/4"


@dataclass(frozen=True)
class Case:
    """A module with its parameters, and the width of all its arguments together, each of which comes once.

    clocks: from argument to answer. harness: what is in tb/units/exhaustive.cpp for this module.
    """

    name: str
    module: str
    harness: str
    parameters: dict[str, int] = field(hash=False)
    bits: int
    clocks: int
    arguments: str
    says: str

    @property
    def vectors(self) -> int:
        return 1 << self.bits

    @property
    def words(self) -> str:
        """The parameters in one line."""
        return " ".join(f"{name}={value}" for name, value in self.parameters.items())


def _divider(name: str, width: int, shift: int, core: str = "digit", earlier: int = 0) -> Case:
    """Of words of one width; with `earlier`, fewer clocks than the datapath gives it, so that one makes two bits."""
    clocks = Latency(width)["div"] - earlier
    parameters = {"NW": width, "DW": width, "SH": shift, "QW": width, "LAT": clocks, "DIGIT": CORES.index(core)}
    return Case(name, "ik_div", "Div", parameters, 2 * width, clocks, "every signed n with every signed d", DIVIDER)


def _root(
    name: str, argument: int, shift: int, width: int, signed: bool, core: str = "digit", earlier: int = 0
) -> Case:
    """From `argument` bits, sign included, to `width` bits; `earlier` as above."""
    clocks = Latency(width)["root"] - earlier
    parameters = {"NW": argument, "SH": shift, "QW": width, "LAT": clocks, "DIGIT": CORES.index(core)}
    bits, arguments = (argument, "every signed n") if signed else (argument - 1, "every n that is not negative")
    return Case(name, "ik_root", "Root", parameters, bits, clocks, arguments, ROOT_OF)


def _reciprocal(frac: int) -> Case:
    clocks = 1 + rsqrt_clocks(frac)  # into the mantissa's register, and from there
    return Case(f"rsqrt_{frac}", "ik_rsqrt", "Rsqrt", {"F": frac}, frac + 3, clocks, "every m", RECIPROCAL)


FULL = (
    _divider("div_16_0", 16, 0),
    _divider("div_16_14", 16, 14),  # of (14) at W = 16
    _root("root_32", 33, 29, 32, signed=False),  # of the half angles at W = 32
    *(_reciprocal(frac) for frac in range(19, 25)),
)
SMALL = (
    _divider("div_8_0", 8, 0),
    _divider("div_8_6", 8, 6, earlier=2),
    _divider("div_8_behavioural", 8, 6, core="behavioural"),
    _root("root_17", 17, 13, 16, signed=True),
    _root("root_17_overflow", 17, 13, 12, signed=True, earlier=1),
    _root("root_17_behavioural", 17, 13, 12, signed=True, core="behavioural"),
    _reciprocal(19),
)


@dataclass
class Result:
    """What came of a case: vectors judged, failures, answers that are right but not the nearest, and the seconds."""

    case: Case
    vectors: int = 0
    failures: int = 0
    not_nearest: int = 0
    seconds: float = 0.0
    first: str = ""
    """Number and words of the first vector that failed, what was expected and what was seen."""

    @property
    def rate(self) -> float:
        """Vectors a second."""
        return self.vectors / max(self.seconds, 1e-9)


# -- the run -----------------------------------------------------------------------------------------------------------


def program(case: Case, root: Path = ROOT, name: str = "") -> Path:
    """The case as a program, built if need be; `root` holds another copy of rtl/, `name` tells it apart.

    Raises RuntimeError.
    """
    tag = "-".join(part for part in (case.name, name) if part)
    return build(case.module, HARNESS, case.parameters, root=root, name=tag, define=f"CORE={case.harness}")


def piece(case: Case, path: Path, first: int, end: int) -> Result:
    """Vectors number `first` to `end` - 1. Raises SimulationError."""
    command = [path, first, end, case.bits, case.clocks, *case.words.split()]
    # a session of its own: Ctrl-C is for this program, which lets the pieces at hand end
    done = subprocess.run([*map(str, command)], capture_output=True, text=True, check=False, start_new_session=True)
    said = re.fullmatch(r"(\d+) (\d+) (\d+)\n(.*)", done.stdout)
    if not said or done.returncode != (said[2] != "0") or int(said[1]) != end - first:
        told = (done.stderr or done.stdout).strip()[-200:]
        raise SimulationError(f"{case.name}: vectors {first} to {end - 1} broke off ({done.returncode}): {told}")
    return Result(case, *(int(number) for number in said.groups()[:3]), first=said[4])


def check(case: Case, path: Path, pool: ThreadPoolExecutor, tell: Callable[[Result], None] = lambda _: None) -> Result:
    """All vectors of a case; `tell` is called with what came of it so far. Raises SimulationError."""
    begin = time.monotonic()
    result = Result(case)
    starts = range(0, case.vectors, PIECE)
    for part in pool.map(lambda start: piece(case, path, start, min(start + PIECE, case.vectors)), starts):
        result.vectors += part.vectors
        result.failures += part.failures
        result.not_nearest += part.not_nearest
        result.first = result.first or part.first
        result.seconds = time.monotonic() - begin
        tell(result)
    return result


class Watch:
    """Progress over all vectors of all cases; a case's first failure is told at once."""

    def __init__(self, meter: Meter) -> None:
        self.meter = meter
        self.before = 0
        self.failed: set[str] = set()

    def so_far(self, result: Result) -> None:
        """What came of the case at hand."""
        name = result.case.name
        if result.failures and name not in self.failed:
            self.failed.add(name)
            self.meter.line(f"exhaustive: {name}: vector {result.first}")
        self.meter(self.before + result.vectors, name)
        if result.vectors == result.case.vectors:
            self.before += result.vectors


def _programs(cases: Sequence[Case], pool: ThreadPoolExecutor) -> list[Path]:
    print(f"exhaustive: building {len(cases)} programs", file=sys.stderr, flush=True)
    try:
        return list(pool.map(program, cases))
    except RuntimeError as error:
        said = str(error).splitlines()
        wrong = [line for line in said if re.search(r"\berror\b", line, re.IGNORECASE)]
        raise InputError(f"cannot build a program: {(wrong or said)[0][:200]}") from error


def run(cases: Sequence[Case], jobs: int) -> list[Result]:
    """All cases, one after the other, each by `jobs` processes. Raises InputError and SimulationError."""
    results = []
    with ThreadPoolExecutor(jobs) as pool:
        try:
            programs = _programs(cases, pool)
            with progress("exhaustive", sum(case.vectors for case in cases)) as meter:
                watch = Watch(meter)
                for case, path in zip(cases, programs, strict=True):
                    result = check(case, path, pool, watch.so_far)
                    results.append(result)
                    print(_line(result), flush=True)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return results


def _line(result: Result) -> str:
    verdict = "FAIL" if result.failures else "ok  "
    return (
        f"{verdict} {result.case.name:<20} {result.vectors:>11} vectors {result.failures:>10} failures "
        f"{result.seconds:>7.1f} s {result.rate / 1e6:>5.1f} million/s"
    )


# -- the page ----------------------------------------------------------------------------------------------------------


def files(cases: Sequence[Case] = FULL) -> list[Path]:
    """What the cases are made of: the harness and the Verilog."""
    found = {HARNESS, *(path for module in {case.module for case in cases} for path in closure(module))}
    return sorted(found, key=lambda path: path.relative_to(ROOT).as_posix())


def digests() -> dict[str, str]:
    """File of the full run: the digest of its code."""
    return {path.relative_to(ROOT).as_posix(): digest([path]) for path in files()}


def page(results: Sequence[Result], jobs: int, seconds: float, sources: dict[str, str]) -> str:
    """docs/generated/exhaustive.md."""
    return render(
        "exhaustive", today=date.today().isoformat(), verilator=metadata.version("verilator"), jobs=jobs,
        seconds=seconds, results=results, digests=sources,
    )  # fmt: skip


# -- the command line --------------------------------------------------------------------------------------------------


def _parser() -> Parser:
    parser = Parser(
        "exhaustive",
        "Every argument of a divider, a square root and the reciprocal root, each answer judged.",
        fails="failures found",
    )
    parser.add_argument("--only", action="append", metavar="NAME", help="only cases with NAME in their name; no page")
    parser.add_argument("--small", action="store_true", help="the cases of short words, in seconds; no page")
    parser.add_argument(
        "--jobs", type=whole(1), default=os.cpu_count(), metavar="N", help="processes (default: %(default)s)"
    )
    parser.add_argument("--list", action="store_true", help="only say which cases there are")
    return parser


@command("exhaustive")
def main(arguments: Sequence[str] | None) -> int:
    options = _parser().parse_args(arguments)
    cases = SMALL if options.small else FULL
    chosen = [case for case in cases if not options.only or any(name in case.name for name in options.only)]
    if not chosen:
        valid = ", ".join(case.name for case in cases)
        raise InputError(f"argument --only: no case {', '.join(options.only)!r}; there are {valid}")
    if options.list:
        for case in chosen:
            print(f"{case.name:<20} {case.module:<9} {case.vectors:>11} vectors  {case.words}: {case.says}")
        return 0

    before, begin = digests(), time.monotonic()
    results = run(chosen, options.jobs)
    seconds = time.monotonic() - begin
    failed = [result.case.name for result in results if result.failures]
    print(f"{len(results) - len(failed)} of {len(results)} cases without a failure, {seconds:.0f} s")
    if failed:
        return 1
    if tuple(chosen) != FULL:
        return 0
    if digests() != before:
        print("exhaustive: sources were changed during the run, the page is not written", file=sys.stderr)
        return 1
    with writing():
        write_atomically(PAGE, page(results, options.jobs, seconds, before))
    print(f"wrote {PAGE.relative_to(ROOT)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
