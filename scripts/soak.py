# SPDX-License-Identifier: Apache-2.0
"""An unlimited stream of random targets of all kinds through the RTL, every node compared: what `make soak` does.

    python -m scripts.soak [--targets N] [--seed S] [--from CHUNK] [--datapath ...] [--width ...] [--keep] ...
    python -m scripts.soak --against c ...
    python -m scripts.soak --special [--from CHUNK] [--datapath ...] [--width ...] ...
    python -m scripts.soak ... --farm tcp://HOST:PORT
    python -m scripts.soak --again FILE.csv

Targets come in chunks of 20000. A chunk is a function of seed, width and its number only, so there is no state to keep:
--from resumes at any chunk. --against c: results of the lean equations are also held against those of
scripts/paper/table6/long.c. --special: not random, but all 12^6 targets of twelve special words on each input. With
Verilator each core of the machine runs chunks of its own; with --farm Dask workers do (scripts/parallel.py),
to the same end. At the end the hardest targets go into OUT/hardest.csv and,
with --keep, into tb/core/hardest.csv, the regression list; docs/generated/soak.md then gets what was found.

It stops at the first chunk in which a bit or a flag is wrong, a quaternion is not of unit length or a hand of the lean
datapath is further off than its tolerance, names seed and chunk, and writes the targets to OUT/failing.csv. For the
paper's equations at such poses `model.bounds.tolerances` has no figure, so their accuracy is reported beside what
`model.bounds.predict` explains, and judged by nothing.

Exit status: 0 all is well, 1 a check fails or the simulation breaks off, 2 input that cannot be used (one line on
stderr), 130 after Ctrl-C, 143 after SIGTERM, 129 after SIGHUP.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from model.dataflow.datapaths import CONFIGURATIONS, DEFAULT
from model.dataflow.nodes import WIDTHS
from model.io.stimuli import SPECIAL
from scripts import parallel, second, soak_page
from scripts.chunks import Chunks, named
from scripts.console import InputError, Parser, Stopped, command, folder_name, output, progress, show, whole
from scripts.failing import read_rows, row_of, tell, write_rows
from scripts.tables import table_of_hardest, table_of_soak
from tb.core import hardest
from tb.core.random_targets import CHUNK, Core, judge

TARGETS = 1_000_000
SEED = 1


# -- the command line --------------------------------------------------------------------------------------------------


DEFAULTS = {"targets": TARGETS, "seed": SEED, "from_": 0, "datapath": DEFAULT, "width": WIDTHS[-1]}
NOT_AGAIN = (*DEFAULTS, "keep", "special", "farm", "against")


def _parse(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = Parser("soak", "Random targets of all kinds through the core, every node compared with the model.")
    add = parser.add_argument
    add("--targets", type=whole(1), metavar="N", help=f"how many (default: {TARGETS})")
    add("--seed", type=whole(0), metavar="S", help=f"of everything random (default: {SEED})")
    add("--from", dest="from_", type=whole(0), metavar="CHUNK", help=f"begin at this chunk of {CHUNK} (default: 0)")
    add("--special", action="store_true", help=f"in their place all {SPECIAL} targets of 12 special words an input")
    parser.core(sim="verilator", datapath=None, width=None)
    add("--jobs", type=whole(1), default=os.cpu_count(), metavar="N", help="chunks at a time (default: %(default)s)")
    parallel.option(parser)
    add(
        "--out", type=folder_name, default=Path("build/soak"), metavar="DIR",
        help="folder for hardest.csv and failing.csv, made if need be (default: %(default)s)",
    )  # fmt: skip
    add("--against", choices=["c"], help="hold results against those of the C of table 6 in long double, too")
    add("--keep", action="store_true", help="keep the hardest targets in tb/core/hardest.csv, the figures in soak.md")
    add("--again", type=Path, metavar="FILE", help="run the targets of a failing.csv or hardest.csv")
    parsed = parser.parse_args(arguments)
    if parsed.again:
        for name in NOT_AGAIN:
            value = getattr(parsed, name)
            if value is not None and value is not False:  # a seed of 0 is one
                option = name.rstrip("_")
                raise InputError(f"argument --{option}: does not go with --again, whose file says what to run")
    if parsed.special:
        for name in ("targets", "seed"):
            if getattr(parsed, name) is not None:
                raise InputError(f"argument --{name}: does not go with --special, which has its own targets")
        parsed.targets = max(0, SPECIAL - CHUNK * (parsed.from_ or 0))
        if not parsed.targets:
            raise InputError(f"argument --from: special words have chunks 0 to {(SPECIAL - 1) // CHUNK}")
    for name, value in DEFAULTS.items():
        if getattr(parsed, name) is None:
            setattr(parsed, name, value)
    if parsed.special:
        parsed.seed = None
    if parsed.against and CONFIGURATIONS[parsed.datapath].equations != "lean":
        raise InputError(f"argument --against: the {parsed.datapath} datapath has no tolerance for it")
    return parsed


# -- the run -----------------------------------------------------------------------------------------------------------


def _built(sim: str, datapath: str, width: int) -> Core:
    with progress("soak", 1) as meter:
        meter(0, "compiling")
        return Core.built(sim, datapath, width)


def _soak(arguments: argparse.Namespace) -> int:
    """Run the chunks; the exit status 0 or 1. Raises what `exit_status` reports, and Stopped."""
    hardest_path, failing = arguments.out / "hardest.csv", arguments.out / "failing.csv"
    with output(arguments.out, [hardest_path, failing]):
        return _chunks(arguments, hardest_path, failing)


def _chunks(arguments: argparse.Namespace, hardest_path: Path, failing: Path) -> int:
    lists = [hardest_path, *([hardest.LIST] if arguments.keep else [])]
    earlier = {file: read_rows(file) if file.exists() else [] for file in lists}
    if arguments.keep:
        soak_page.recorded()  # a file that is of no use is said before, not after hours
    if arguments.against:
        second.compiled()
    core = (Core if arguments.farm else _built)(arguments.sim, arguments.datapath, arguments.width)
    of = named(arguments.seed)
    what = f"{core}, {of}"
    print(f"soak: {what}, {arguments.targets} targets from chunk {arguments.from_}", flush=True)
    chunks = Chunks(core, arguments.seed, arguments.from_, arguments.targets, bool(arguments.against))
    with progress("soak", arguments.targets) as meter:
        try:
            broken = chunks.run(arguments.jobs, meter, arguments.farm)
            rate = chunks.found.targets / (time.monotonic() - meter.begin)
        except Stopped:
            done = f"{chunks.found.targets} targets passed, those before chunk {chunks.number}"
            print(f"soak: stopped; {done}; --from {chunks.number} resumes", file=sys.stderr)
            raise
    if broken:
        where = f"in chunk {chunks.number} of {of}"
        rows = tell(broken.failures, broken.words, lambda n: f"target {broken.first + n} {where}")
        found = [f"{of} target {broken.first + n}" for n in rows]
        listed = zip(rows, found, strict=True)
        write_rows(failing, [row_of(core, broken.words[n], broken.hand[n], text) for n, text in listed])
        print(f"soak: {len(rows)} failing targets in {failing}; to rerun them: --again {failing}", file=sys.stderr)
        return 1
    found = chunks.found
    show(table_of_soak(what, core, found, rate), table_of_hardest(found))
    hards = {tuple(hard.words): hard for hard in found.by_hand + found.by_norm}.values()
    rows = [row_of(core, h.words, h.hand_error, f"{of} target {h.target}") for h in hards]
    for file, before in earlier.items():
        write_rows(file, hardest.merge(before + rows))
        print(f"wrote {file}")
    if arguments.keep:
        soak_page.keep(core, of, found, arguments.from_)
        print(f"wrote {soak_page.PAGE.name}")
    return 0


def _again(arguments: argparse.Namespace) -> int:
    """Run the targets of a list; the exit status 0 or 1. Raises what `exit_status` reports."""
    rows = read_rows(arguments.again)
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
