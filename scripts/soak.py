# SPDX-License-Identifier: Apache-2.0
"""Random targets of all kinds through the RTL, every node compared with the model: `make soak`.

    python -m scripts.soak [--targets N] [--seed S] [--from CHUNK] [--special] [--against c] [--farm ADDRESS] ...
    python -m scripts.soak --again FILE.csv
    python -m scripts.soak --worst ROUNDS [--width W] [--seed S]

A chunk of 20000 targets is a function of seed, width and chunk number, so --from resumes at any chunk. --special runs
all 12^6 targets of twelve special words on each input. --against c also compares results with the C of table 6. The
hardest targets go into OUT/hardest.csv and, with --keep, into tb/core/worst_targets.csv and docs/generated/soak.md.
The whole arm gets hand poses with these wrists, its hardest ones are in OUT/hardest_poses.csv only, and the error of a
pose is relative to its tolerance.

The run stops at the first chunk with a wrong bit or flag, a quaternion that is not of unit length or a hand of the lean
datapath beyond its tolerance, and writes those targets to OUT/failing.csv. The paper datapath has no tolerance near its
singular poses; the excess over `model.bounds.predict` is reported.

--worst searches the bit-true model of the lean datapath for the largest hand errors: each round changes the worst
targets of the round before in one to six words.
"""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import date
from functools import cache, partial
from pathlib import Path
from types import SimpleNamespace

import click
import numpy as np

from model.bounds import tolerances
from model.bounds.tolerances import REGULAR_DISTANCE
from model.dataflow import fixed
from model.dataflow.datapaths import MODELS
from model.io.files import write_atomically
from model.io.flags import CORE_FLAGS, expected_flags
from model.io.scoring import singular_distance
from model.io.stimuli import REGIONS, SPECIAL, hands, mixed, region
from model.io.words import from_words
from scripts import parallel
from scripts.console import (
    InputError,
    Meter,
    Stopped,
    command,
    core_options,
    option,
    output,
    progress,
    show,
    switch,
    whole,
)
from scripts.generate.render import read_table, render
from scripts.paper.table6.compiled import EQUATIONS, SCALAR, Solver, shared_object
from scripts.tables import table_of_hardest, table_of_soak
from tb.core import worst_targets
from tb.core.random_targets import CHUNK, Core, Failure, Found, Opinion, chunk, judge
from tb.sim.env import GENERATED
from tb.sim.sources import closure, digest

PAGE = GENERATED / "soak.md"
EXCLUDED = {
    "again": {"targets", "seed", "from_", "datapath", "width", "keep", "special", "farm", "against"},
    "special": {"targets", "seed"},
}

OPTIONS = [
    option("--targets", "number of targets", whole(1), default=1_000_000, metavar="N"),
    option("--seed", "random seed", whole(0), default=1, metavar="S"),
    option("--from", f"first chunk of {CHUNK} targets", whole(0), default=0, metavar="CHUNK"),
    switch("--special", f"all {SPECIAL} targets with 12 special words per input, instead of random targets"),
    *core_options(sim="verilator", names=MODELS),
    option("--jobs", "parallel chunks", whole(1), default=os.cpu_count(), metavar="N"),
    parallel.FARM,
    option("--out", "folder for hardest.csv and failing.csv", Path, default="build/soak", metavar="DIR"),
    option("--against", "also compare results with the C of table 6 in long double", click.Choice(["c"])),
    switch("--keep", "update tb/core/worst_targets.csv and soak.md"),
    option("--again", "run the targets of a failing.csv or hardest.csv", Path, metavar="FILE"),
    option("--worst", "search the model of the lean datapath for the largest errors", whole(1), metavar="ROUNDS"),
]


def _check(options: SimpleNamespace) -> None:
    """Check combinations of options; set seed and targets for --special. Raises InputError."""
    for name, excluded in EXCLUDED.items():
        if getattr(options, name) and (others := sorted(options.given & excluded)):
            raise InputError(f"argument --{others[0].rstrip('_')}: not allowed with --{name}")
    if options.special:
        options.seed, options.targets = None, SPECIAL - CHUNK * options.from_
        if options.targets <= 0:
            raise InputError(f"argument --from: special words have chunks 0 to {(SPECIAL - 1) // CHUNK}")
    if options.against and (MODELS[options.datapath].equations != "lean" or MODELS[options.datapath].side):
        raise InputError(f"argument --against: the {options.datapath} datapath has no tolerance for it")


# -- chunks ------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Chunk:
    """The verdict on a chunk; words and hand errors are kept if it fails."""

    first: int
    words: np.ndarray
    found: Found
    failures: list[Failure]
    hand: np.ndarray


@cache
def _built(core: Core) -> Core:
    return Core.built(core.sim, core.datapath, core.width)


def run_chunk(core: Core, seed: int | None, end: int, against: bool, number: int) -> Chunk:
    """Run chunk `number`, at most to target `end`; on a farm, with a program of the worker."""
    start = number * CHUNK
    words = chunk(number, core.width, seed)[: end - start]
    if MODELS[core.datapath].side:
        words = hands(words, core.width, number)
    core = core if core.program else _built(core)
    found, failures, hand = judge(core, words, range(start, start + len(words)), opinions if against else None)
    kept = slice(None if failures else 0)
    return Chunk(start, words[kept], found, failures, hand[kept])


# -- the C of table 6 --------------------------------------------------------------------------------------------------

UNEQUAL = 2.0**-24
"""Ratio of the arms below which the paper's equations, which add their squares, lose too much of 64 bits."""


def opinions(words: np.ndarray, width: int) -> list[Opinion]:
    """Solve input words (N, 6) in C with both sets of equations; each applies to regular targets without flags."""
    phi, d1, d2 = 3, 4, 5
    scale = np.full(words.shape[1], np.longdouble(2) ** (2 - width))
    scale[phi] = np.longdouble(2) ** (1 - width) * 4 * np.arctan(np.longdouble(1))
    given = [column * factor for column, factor in zip(words.T, scale, strict=True)]
    plain = expected_flags(words, width) == 0
    regular = plain.copy()
    regular[plain] = singular_distance(from_words(words[plain], 0, width, "soak")) >= REGULAR_DISTANCE
    shorter, longer = np.sort(words[:, [d1, d2]].astype(float)).T
    regular &= shorter >= UNEQUAL * longer
    found = []
    for name, rows in zip(EQUATIONS, (plain, regular), strict=True):
        answers = Solver(given, name, "long double")().astype(float)
        found.append(Opinion(f"C, long double, {name} equations", answers, rows))
    return found


# -- the worst targets -------------------------------------------------------------------------------------------------

KEPT, EACH, ALIKE = 400, 50, 8
"""Targets of a round, changed copies of each, and targets of one kind: the same signs and sizes."""


def hand_errors(words: np.ndarray, width: int) -> np.ndarray:
    """Return hand error / reach (N,) of the lean model; 0 for targets out of reach."""
    return np.nan_to_num(worst_targets.errors(words, fixed.run(words, width, "lean").results, width)[0])


def _changed(words: np.ndarray, width: int, random: np.random.Generator) -> np.ndarray:
    rows = np.repeat(words, EACH, axis=0)
    steps = random.choice([-1, 1], rows.shape) * random.integers(1, 4, rows.shape)
    steps <<= random.integers(0, random.integers(1, width, (len(rows), 1)), rows.shape)
    changed = random.random(rows.shape) < random.choice([0.2, 0.5, 1.0], (len(rows), 1))
    top = (1 << (width - 1)) - 1
    return np.unique(np.clip(rows + np.where(changed, steps, 0), -top - 1, top), axis=0)


def _worst_of(words: np.ndarray, width: int) -> np.ndarray:
    """Return the KEPT worst targets, the worst first, with a limited number of each kind."""
    seen: dict[bytes, int] = {}
    chosen = []
    for n in np.argsort(-hand_errors(words, width), kind="stable").tolist():
        row = words[n, [0, 1, 2, 4, 5]]
        kind = np.concatenate([np.sign(row), np.frexp(row.astype(float))[1] // 2]).tobytes()
        seen[kind] = seen.get(kind, 0) + 1
        if seen[kind] <= ALIKE:
            chosen.append(n)
    return words[chosen[:KEPT]]


def worst_target(width: int, rounds: int, seed: int, meter: Meter) -> np.ndarray:
    """Return the worst target found, (1, 6)."""
    random = np.random.default_rng((seed, width))
    words = np.concatenate([mixed(20000, width, seed), *(region(name, 5000, width, seed) for name in REGIONS)])
    words = _worst_of(words, width)
    for number in range(rounds):
        words = _worst_of(np.unique(np.concatenate([words, _changed(words, width, random)]), axis=0), width)
        meter(number + 1, f"W = {width}")
    return words[:1]


def _worst(arguments: SimpleNamespace) -> int:
    width, bar = arguments.width, tolerances.sought(arguments.width)
    with progress("soak", arguments.worst) as meter:
        words = worst_target(width, arguments.worst, arguments.seed, meter)
    hand = hand_errors(words, width)[0]
    print(f"W = {width}: {hand:.3e} of the reach, tolerance {bar:.3g}: {', '.join(map(str, words[0]))}")
    return int(hand > bar)


# -- files -------------------------------------------------------------------------------------------------------------


def _row(core: Core, words: Sequence[int], hand_error: float, found: str) -> worst_targets.Row:
    error = None if math.isnan(hand_error) else float(hand_error)
    return worst_targets.Row(core.datapath, core.width, tuple(map(int, words)), error, found)


def code(datapath: str) -> str:
    """Return a digest of the Verilog of a datapath, and of its top."""
    path = MODELS[datapath]
    return digest({*closure(path.entity), *closure(path.top)[:1]})


def _keep(core: Core, of: str, found: Found) -> None:
    """Replace the rows of these targets on the page."""
    key = [core.datapath, str(core.width), of]
    errors = found.hand_error_max, tolerances.hand(core.width, core.datapath), found.norm_error_max
    row = [*key, date.today().isoformat(), str(found.targets), str(found.reachable), *map(_number, errors)]
    row += [*(str(found.flags[name]) for name in CORE_FLAGS), code(core.datapath)]
    last = 2.0 ** (2 - core.width)
    apart = [
        [of, *key, str(n), _number(most), f"{most / last:.2f}", _number(tolerances.lean(core.width))]
        for of, (n, most) in found.apart.items()
    ]
    rows = sorted([row, *(other for other in read_table(PAGE, "datapath") if other[:3] != key)])
    apart = sorted([*apart, *(other for other in read_table(PAGE, "equations") if other[1:4] != key)])
    write_atomically(PAGE, render("soak", flags=[*CORE_FLAGS], rows=rows, apart=apart))


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.2e}"


# -- the run -----------------------------------------------------------------------------------------------------------


def _report(failures: list[Failure], words: np.ndarray, where: Callable[[int], str]) -> list[int]:
    """Report failures on stderr, with the words of the first target of each; return the rows of all."""
    for failure in failures:
        first, *more = failure.lines
        n = failure.rows[0] if failure.rows else None
        print(f"soak: {'unknown target' if n is None else where(n)}: {first}", file=sys.stderr)
        if n is not None:
            names = worst_targets.named(words.shape[1])
            named = " ".join(f"{name}={word}" for name, word in zip(names, words[n].tolist(), strict=True))
            print(f"soak: its words: {named}", file=sys.stderr)
        for line in more:
            print(f"soak: {line}", file=sys.stderr)
    return list(dict.fromkeys(n for failure in failures for n in failure.rows))


def _compile(sim: str, datapath: str, width: int) -> Core:
    with progress("soak", 1) as meter:
        meter(0, "compiling")
        return Core.built(sim, datapath, width)


def _soak(arguments: SimpleNamespace) -> int:
    poses = bool(MODELS[arguments.datapath].side)
    hardest_path = arguments.out / ("hardest_poses.csv" if poses else "hardest.csv")
    failing = arguments.out / "failing.csv"
    with output(arguments.out, [hardest_path, failing]):
        lists = [hardest_path, *([worst_targets.LIST] if arguments.keep and not poses else [])]
        earlier = {file: worst_targets.read(file) if file.exists() else [] for file in lists}
        if arguments.against:
            for name in EQUATIONS:
                shared_object(name, "long double", SCALAR)  # fail without a compiler before the run
        core = (Core if arguments.farm else _compile)(arguments.sim, arguments.datapath, arguments.width)
        name = "all targets of special words" if arguments.seed is None else f"seed {arguments.seed}"
        print(f"soak: {core}, {name}, {arguments.targets} targets from chunk {arguments.from_}", flush=True)
        end = arguments.from_ * CHUNK + arguments.targets
        numbers = range(arguments.from_, -(-end // CHUNK))
        work = partial(run_chunk, core, arguments.seed, end, bool(arguments.against))
        found, number, broken = Found(), arguments.from_, None
        try:
            with (
                progress("soak", arguments.targets) as meter,
                parallel.shared(min(arguments.jobs, len(numbers)), arguments.farm) as each,
            ):
                for number, run in zip(numbers, each(work, numbers), strict=True):
                    if run.failures:
                        broken = run
                        break
                    found += run.found
                    number += 1
                    meter(found.targets)
                rate = found.targets / meter.task.elapsed
        except parallel.BrokenOffError as error:
            raise parallel.BrokenOffError(f"{error}, in chunk {number} of {name} or later") from None
        except Stopped:
            print(f"soak: stopped; {found.targets} targets passed; --from {number} resumes", file=sys.stderr)
            raise
        if broken:
            where = f"in chunk {number} of {name}"
            rows = _report(broken.failures, broken.words, lambda n: f"target {broken.first + n} {where}")
            content = [_row(core, broken.words[n], broken.hand[n], f"{name} target {broken.first + n}") for n in rows]
            write_atomically(failing, worst_targets.text(content))
            print(f"soak: {len(rows)} failing targets in {failing}; to rerun them: --again {failing}", file=sys.stderr)
            return 1
        show(table_of_soak(f"{core}, {name}", core, found, rate), table_of_hardest(found))
        hards = {tuple(hard.words): hard for hard in found.by_hand + found.by_norm}.values()
        rows = [_row(core, hard.words, hard.hand_error, f"{name} target {hard.target}") for hard in hards]
        for file, before in earlier.items():
            write_atomically(file, worst_targets.text(worst_targets.merge(before + rows)))
            print(f"wrote {file}")
        if arguments.keep:
            _keep(core, name, found)
            print(f"wrote {PAGE.name}")
        return 0


def _again(arguments: SimpleNamespace) -> int:
    rows = worst_targets.read(arguments.again)
    if not rows:
        raise InputError(f"{arguments.again}: no targets")
    status = 0
    for (datapath, width), group in worst_targets.groups(rows).items():
        core = _compile(arguments.sim, datapath, width)
        words = worst_targets.array(group)
        found, failures, _ = judge(core, words, range(len(words)))
        _report(failures, words, lambda n, group=group: group[n].found)
        status |= bool(failures)
        verdict = "FAIL" if failures else "pass"
        print(f"{core}: {len(words)} targets, largest {MODELS[datapath].error} {found.hand_error_max:.3e}: {verdict}")
    return status


@command("soak", "Run random targets of all kinds and compare every node with the model.", OPTIONS)
def main(parsed: SimpleNamespace) -> int:
    _check(parsed)
    return _again(parsed) if parsed.again else _worst(parsed) if parsed.worst else _soak(parsed)


if __name__ == "__main__":
    sys.exit(main())
