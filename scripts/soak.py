# SPDX-License-Identifier: Apache-2.0
"""Run random targets of all kinds through the RTL and compare every node with the model: `make soak`.

Seed, width and chunk number determine the 20000 targets of a chunk, so --from resumes at any chunk. The run stops at
the first chunk with a wrong bit or flag, a quaternion that is not of unit length, or a hand error above its tolerance.
It prints the first target of each failure. The paper datapath has no tolerance near its singular poses, so targets
whose error is above the prediction (`model.bounds.predict`) are only counted. For the whole arm, each target becomes a
hand pose with the same wrist, and errors are relative to the tolerance.

--worst searches the bit-true model of the lean datapath or of the whole arm for the largest errors. Each round changes
words of the previous round's worst targets. For lean, the search restarts every 40 rounds at new targets whose
neighbours have large errors on average; the last quarter of the rounds continues with the worst targets so far. For the
whole arm, errors of the hand's point and of its orientation are searched for separately. Poses with a reach below 1 are
excluded, because the host scales every pose to a reach of 1 or more.
"""

import os
import sys
from collections import Counter
from datetime import date
from functools import partial
from pathlib import Path

import numpy as np

from model.bounds import tolerances
from model.dataflow import fixed
from model.dataflow.datapaths import MODELS
from model.io.files import write_atomically
from model.io.flags import CORE_FLAGS, UNREACHABLE, expected_flags
from model.io.stimuli import REGIONS, SPECIAL, hand_poses, hands, mixed, region, right_angles
from model.io.words import ARM_FIELDS, FIELDS
from scripts import console, parallel
from scripts.console import InputError, Options, command, core_options, option, output, progress, show, switch, whole
from scripts.generate.render import error, read_table, render
from scripts.score_tables import table_of_soak
from tb.core import worst_targets
from tb.core.worst_targets import CHUNK, Core, Failure, Found, chunk, judge
from tb.sim.env import GENERATED
from tb.sim.sources import closure, digest

PAGE = GENERATED / "soak.md"
OPTIONS = [
    option("--targets", "number of targets", whole(1), default=1_000_000, metavar="N"),
    option("--seed", "random seed", whole(0), default=1, metavar="S"),
    option("--from", f"first chunk of {CHUNK} targets", whole(0), default=0, metavar="CHUNK"),
    switch("--special", f"all {SPECIAL} targets with 12 special words per input, instead of random targets"),
    *core_options(sim="verilator", names=MODELS),
    option("--jobs", "parallel chunks", whole(1), default=os.cpu_count(), metavar="N"),
    parallel.FARM,
    option("--out", "folder for hardest.csv", Path, default="build/soak", metavar="DIR"),
    switch("--keep", "update tb/core/worst_targets.csv and soak.md"),
    option("--worst", "search the model of lean or arm for the largest errors", whole(1), metavar="ROUNDS"),
]


def run_chunk(core: Core, seed: int | None, end: int, number: int) -> tuple[Found, list[str]]:
    """Run chunk `number` up to target `end` - 1; return totals and messages of failures. If `core` has no
    simulation program (on a worker of a farm), build it first."""
    start = number * CHUNK
    words = chunk(number, core.width, seed)[: end - start]
    if MODELS[core.datapath].side:
        words = hands(words, core.width, number)
    core = core if core.program else Core.built(core.sim, core.datapath, core.width)
    totals, failures = judge(core, words, range(start, start + len(words)))
    return totals, [line for failure in failures for line in messages(failure, words, start)]


def messages(failure: Failure, words: np.ndarray, start: int) -> list[str]:
    """Return the lines of a failure and the words of its first target. start: number of the first target in `words`."""
    lines, where = [*failure.lines], "unknown target"
    if failure.rows:
        n = failure.rows[0]
        where = f"target {start + n}"
        names = (*ARM_FIELDS, "branch") if words.shape[1] > len(FIELDS) else FIELDS
        named = zip(names, words[n].tolist(), strict=True)
        lines.insert(1, "its words: " + " ".join(f"{name}={word}" for name, word in named))
    return [f"{where}: {lines[0]}", *lines[1:]]


KEPT, EACH, ALIKE = 400, 50, 8
"""Largest numbers of kept targets in a round, of changed copies of each target, of kept targets of one kind. Targets of
one kind have coordinates and lengths of the same signs and sizes."""

RESTART, FRESH, GENERATIONS, COPIES = 40, 100_000, 40, 24
"""Search of lean: rounds between restarts; at a restart, random targets, generations of choices, neighbours of each."""

SEARCHED = {"lean": ("of the reach",), "arm": ("of the reach", "rad")}
"""Datapath -> units of the errors that --worst searches for; arm: error of the hand's point, error of orientation."""


def hand_errors(words: np.ndarray, width: int, datapath: str) -> np.ndarray:
    """Return errors and tolerances, (2, M, N), for the M units in SEARCHED. The error of an excluded target is 0."""
    answer = fixed.run(words, width, datapath)
    if datapath == "lean":
        hand = np.nan_to_num(worst_targets.errors(words, answer.results, width)[0])[None]
        return np.array((hand, np.full_like(hand, tolerances.sought(width))))
    return np.array(worst_targets.arm_errors(words, answer, width))


def _changed(words: np.ndarray, width: int, random: np.random.Generator) -> np.ndarray:
    """Return randomly changed copies of targets. The quaternions of hand poses are scaled back to unit length."""
    rows = np.repeat(words, EACH, axis=0)
    steps = random.choice([-1, 1], rows.shape) * random.integers(1, 4, rows.shape)
    steps <<= random.integers(0, random.integers(1, width, (len(rows), 1)), rows.shape)
    changed = random.random(rows.shape) < random.choice([0.2, 0.5, 1.0], (len(rows), 1))
    top = (1 << (width - 1)) - 1
    rows = np.clip(rows + np.where(changed, steps, 0), -top - 1, top)
    hand = rows[:, len(ARM_FIELDS) - 4 :]
    hand[:] = np.rint(hand * ((1 << width - 2) / np.maximum(np.linalg.norm(hand, axis=1, keepdims=True), 1)))
    return np.unique(rows, axis=0)


def _worst_of(words: np.ndarray, width: int, datapath: str, unit: int) -> np.ndarray:
    """Return up to `KEPT` targets, largest error first, at most `ALIKE` of each kind. `unit` selects the error by its
    index in SEARCHED."""
    seen, chosen = Counter(), []
    for n in np.argsort(-hand_errors(words, width, datapath)[0, unit], kind="stable").tolist():
        row = np.delete(words[n, :7], 3)
        kind = np.concatenate([np.sign(row), np.frexp(row.astype(float))[1] // 2]).tobytes()
        seen[kind] += 1
        if seen[kind] <= ALIKE:
            chosen.append(n)
    return words[chosen[:KEPT]]


def _start(width: int, random: np.random.Generator) -> np.ndarray:
    """Return neighbours, which differ in low bits, of the targets whose neighbours have the largest mean error."""

    def neighbours(words: np.ndarray, copies: int) -> tuple[np.ndarray, np.ndarray]:
        rows, bits = np.repeat(words, copies, axis=0), width // 3
        steps = random.integers(-(1 << bits), 1 << bits, rows.shape) >> np.array([0, 4, 4, 0, 0, 0])
        rows = np.clip(rows + steps, 1 - (1 << width - 1), (1 << width - 1) - 1)
        return rows, hand_errors(rows, width, "lean")[0, 0]

    words = right_angles(FRESH, width, int(random.integers(1 << 30)))
    words = words[np.argsort(-hand_errors(words, width, "lean")[0, 0])[: 10 * KEPT]]
    for _ in range(GENERATIONS):
        means = neighbours(words, COPIES)[1].reshape(-1, COPIES).mean(axis=1)
        words = words[np.argsort(-means)[:KEPT]]
        words = np.concatenate([words, random.permutation(_changed(words, width, random))[: 9 * KEPT]])
    return neighbours(words[:KEPT], 2 * EACH)[0]


def _worst(options: Options) -> int:
    datapath, width, beyond = options.datapath, options.width, False
    listed = worst_targets.groups(worst_targets.read(worst_targets.LIST)) if options.keep else {}
    rows = listed.pop((datapath, width), [])
    parts = [mixed(20000, width, options.seed), *(region(name, 5000, width, options.seed) for name in REGIONS)]
    start = np.concatenate(parts)
    if datapath == "arm":
        start = hand_poses(start[expected_flags(start, width) & UNREACHABLE == 0], width, options.seed)
    for unit, name in enumerate(SEARCHED[datapath]):
        random = np.random.default_rng((options.seed, width))
        words, kept, last = _worst_of(start, width, datapath, unit), [], options.worst - options.worst // 4
        with progress("soak", options.worst) as meter:
            for number in range(options.worst):
                if datapath == "lean" and number and (number == last or number < last and number % RESTART == 0):
                    kept.append(words[:EACH])
                    fresh = np.concatenate(kept) if number == last else _start(width, random)
                    words = _worst_of(fresh, width, datapath, unit)
                changed = np.concatenate([words, _changed(words, width, random)])
                words = _worst_of(np.unique(changed, axis=0), width, datapath, unit)
                meter(number + 1, f"W = {width}")
        error, tolerance = hand_errors(words[:1], width, datapath)[:, unit, 0]
        print(f"W = {width}: {error:.3e} {name}, tolerance {tolerance:.3g}: {', '.join(map(str, words[0]))}")
        beyond |= error > tolerance
        branch = [0] * bool(MODELS[datapath].side)
        worst = [(*target, *branch) for target in words[: worst_targets.KEPT].tolist()]
        rows += [worst_targets.Row(datapath, width, target, 0.0, "search") for target in worst]
    if options.keep:
        listed[datapath, width] = worst_targets.merge(rows)
        write_atomically(worst_targets.LIST, worst_targets.text(row for key in sorted(listed) for row in listed[key]))
    return int(beyond)


def code(datapath: str) -> str:
    """Return a digest of the Verilog of a datapath and its top module."""
    path = MODELS[datapath]
    return digest({*closure(path.entity), *closure(path.top)[:1]})


def _keep(core: Core, of: str, totals: Found) -> None:
    """Write the totals to the page; a row for the same core and targets is replaced. `of` describes the targets."""
    key = [core.datapath, str(core.width), of]
    errors = totals.hand_error_max, tolerances.hand(core.width, core.datapath), totals.norm_error_max
    row = [*key, date.today().isoformat(), str(totals.targets), str(totals.reachable), *(error(e, 2) for e in errors)]
    row += [*(str(totals.flags[name]) for name in CORE_FLAGS), code(core.datapath)]
    rows = sorted([row, *(other for other in read_table(PAGE, "datapath") if other[:3] != key)])
    write_atomically(PAGE, render("soak", flags=[*CORE_FLAGS], rows=rows))


def _soak(arguments: Options) -> int:
    hardest_path = arguments.out / "hardest.csv"
    with output(arguments.out, [hardest_path]):
        lists = [hardest_path, *([worst_targets.LIST] if arguments.keep else [])]
        earlier = {file: worst_targets.read(file) if file.exists() else [] for file in lists}
        which = arguments.sim, arguments.datapath, arguments.width
        core = Core(*which)
        if not arguments.farm:
            with progress("soak", 1) as meter:
                meter(0, "compiling")
                core = Core.built(*which)
        name = "all targets of special words" if arguments.seed is None else f"seed {arguments.seed}"
        print(f"soak: {core}, {name}, {arguments.targets} targets from chunk {arguments.from_}", flush=True)
        end = arguments.from_ * CHUNK + arguments.targets
        numbers = range(arguments.from_, -(-end // CHUNK))
        work = partial(run_chunk, core, arguments.seed, end)
        totals, number, failed = Found(), arguments.from_, []
        try:
            with (
                progress("soak", arguments.targets) as meter,
                parallel.shared(min(arguments.jobs, len(numbers)), arguments.farm) as ordered_map,
            ):
                for number, (run, failed) in zip(numbers, ordered_map(work, numbers), strict=True):
                    if failed:
                        break
                    totals += run
                    number += 1
                    meter(totals.targets)
                rate = totals.targets / meter.task.elapsed
        except parallel.BrokenOffError as error:
            raise parallel.BrokenOffError(f"{error}, in chunk {number} of {name} or later") from None
        except console.Stopped:
            print(f"soak: stopped; {totals.targets} targets passed; --from {number} resumes", file=sys.stderr)
            raise
        if failed:
            lines = [*failed, f"in chunk {number} of {name}; the same options with --from {number} repeat it"]
            print(*(f"soak: {line}" for line in lines), sep="\n", file=sys.stderr)
            return 1
        show(table_of_soak(f"{core}, {name}", core, totals, rate))
        hards = {tuple(hard.words): hard for hard in totals.by_hand + totals.by_norm}.values()
        row = partial(worst_targets.Row, core.datapath, core.width)
        rows = [row(tuple(hard.words), hard.hand_error, f"{name} target {hard.target}") for hard in hards]
        rows *= not MODELS[core.datapath].chooses  # arm's targets are the same
        for file, before in earlier.items():
            write_atomically(file, worst_targets.text(worst_targets.merge(before + rows)))
            print(f"wrote {file}")
        if arguments.keep:
            _keep(core, name, totals)
            print(f"wrote {PAGE.name}")
        return 0


@command("soak", OPTIONS)
def main(options: Options) -> int:
    if options.special and (others := sorted(options.given & {"targets", "seed"})):
        raise InputError(f"argument --{others[0]}: not allowed with --special")
    if options.special:
        options.seed, options.targets = None, SPECIAL - CHUNK * options.from_
        if options.targets <= 0:
            raise InputError(f"argument --from: with --special, chunks are 0 to {(SPECIAL - 1) // CHUNK}")
    if options.worst and options.datapath not in SEARCHED:
        raise InputError(f"argument --worst: only for {' and '.join(SEARCHED)}")
    return _worst(options) if options.worst else _soak(options)


if __name__ == "__main__":
    sys.exit(main())
