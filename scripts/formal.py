# SPDX-License-Identifier: Apache-2.0
"""Run the proofs and check that each fails on its seeded bug: `make formal`.

Each successful proof updates its row in docs/generated/proofs.md and writes its full table to build/proofs/. The proof
``accuracy`` also writes docs/generated/accuracy.md.
"""

import json
import math
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict
from datetime import date
from fractions import Fraction
from functools import partial
from os import cpu_count

from model.bounds.accuracy import CELLS, SIDES, STATED, accuracy
from model.dataflow.fixed import dataflow
from model.dataflow.formats import WIDTHS
from model.io.files import write_atomically
from scripts.console import InputError, Options, command, option, switch
from scripts.generate.render import read_table, render
from tb.formal.accuracy import ALGEBRA, NODES
from tb.formal.proofs import TASKS
from tb.formal.task import Outcome, Task, digest_of
from tb.formal.tools import missing, stop, versions
from tb.sim.env import GENERATED, ROOT

PAGE, ACCURACY = GENERATED / "proofs.md", GENERATED / "accuracy.md"
BUILD = ROOT / "build" / "proofs"
say = partial(print, flush=True)


def digests() -> dict[str, str]:
    """Return a dict: proof -> digest of the present code."""
    return {task.name: task.digest() for task in TASKS}


def rows() -> dict[str, list[str]]:
    """Return a dict: proof -> its row in docs/generated/proofs.md."""
    return {row[0]: row for row in read_table(PAGE, "proof")}


def write_page(proved: dict[str, tuple[Outcome, str]]) -> None:
    """Write docs/generated/proofs.md: new rows for ``proved`` (name -> outcome, digest), old rows for other proofs."""
    table, tasks = rows(), {task.name: task for task in TASKS}
    for name, (outcome, digest) in proved.items():
        result = [f"{outcome.result}, bug found", f"{outcome.seconds:.0f}", date.today().isoformat(), digest]
        table[name] = [name, tasks[name].what, tasks[name].engine, *result]
    write_atomically(PAGE, render("proofs", rows=[table[name] for name in tasks if name in table]))
    say(f"wrote {PAGE.relative_to(ROOT)}")
    if "accuracy" in proved:
        write_atomically(ACCURACY, accuracy_page())
        say(f"wrote {ACCURACY.relative_to(ROOT)}")


def accuracy_page() -> str:
    """Return the text of docs/generated/accuracy.md. Its statements and constants come from the proof's code."""
    shown = {width: accuracy(width) | accuracy(width, "arm") for width in (32, 24, 18)}

    def up(value: Fraction, places: int) -> str:
        return f"{math.ceil(value * 10**places) / 10**places:.{places}f}"

    def share(units: Fraction, width: int) -> str:
        """Format a limit, given in units of 2^-(W-2), as a fraction of a length, rounded up to three digits."""
        exponent = math.floor(math.log10(units) + (2 - width) * math.log10(2))
        return f"{up(units * Fraction(2) ** (2 - width) / Fraction(10) ** exponent, 2)}e{exponent}"

    def constants(datapath: str) -> list[list]:
        names = [name for name in accuracy(WIDTHS[0], datapath) if name != "rounded"]
        numbers = [[name, *(up(of[name], 3) for of in shown.values())] for name in names]
        return [[f"{datapath}, W =", *shown], *numbers]

    stated = [[w, *(share(of[w], w) if w in of else "" for of in STATED.values())] for w in WIDTHS]
    tables = {"stated": stated, "wrist": constants("lean"), "hand": constants("arm")}
    claim = {name: text for name, (text, _) in (dataflow("lean", WIDTHS[0]).lemmas | NODES).items()}
    claim |= {name: text for name, (_, text) in ALGEBRA.items()}
    return render("accuracy", **tables, claim=claim, cells=CELLS, sides=SIDES)


def prove(task: Task, pool: ThreadPoolExecutor, again: bool) -> tuple[Outcome, str]:
    """Return a proof's outcome and digest. An earlier result for the same code and tools is reused unless ``again``."""
    before = task.digest()
    kept = BUILD / f"{task.name}-{digest_of(before, versions())}.json"
    if kept.exists() and not again:
        outcome = Outcome(**json.loads(kept.read_text()))
        say(f"ok   {task.name:<16} {outcome.result}, unchanged since an earlier run ({outcome.seconds:.0f} s)")
        return outcome, before
    outcome = task.run(pool, say)
    if task.digest() != before:
        outcome.failed.append("sources were changed during the run")
    BUILD.mkdir(parents=True, exist_ok=True)
    lines = [f"{task.name}: {task.what}", outcome.result, *("\t".join(cells) for cells in outcome.table)]
    write_atomically(BUILD / f"{task.name}.tsv", "\n".join(lines) + "\n")
    if not outcome.failed:
        write_atomically(kept, json.dumps(asdict(outcome)))
    say(f"{'FAIL' if outcome.failed else 'ok  '} {task.name:<16} {outcome.result}, {outcome.seconds:.0f} s")
    for line in outcome.failed:
        say(f"     {line}")
    return outcome, before


@command(
    "formal",
    [
        option("--only", "proofs whose names begin with NAME", metavar="NAME", multiple=True),
        switch("--again", "also rerun proofs that have passed on the same code"),
        switch("--list", "print the names of the proofs"),
    ],
    passes="all is proved",
)
def main(options: Options) -> int:
    for name in options.only:
        if not any(task.name.startswith(name) for task in TASKS):
            raise InputError(f"argument --only: no proof {name!r}; --list prints their names")
    chosen = [task for task in TASKS if not options.only or task.name.startswith(tuple(options.only))]
    if options.list:
        say("\n".join(f"{task.name:<16} {task.engine:<9} {task.what}" for task in chosen))
        return 0
    if absent := missing():
        raise InputError(f"{', '.join(absent)} not installed here: `make formal` sets them up")
    with ThreadPoolExecutor(cpu_count()) as pool:
        try:
            outcomes = {task.name: prove(task, pool, options.again) for task in chosen}
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            stop()
            raise
    proved = {name: pair for name, pair in outcomes.items() if not pair[0].failed}
    say(f"{len(proved)} of {len(chosen)} proofs, {sum(pair[0].seconds for pair in outcomes.values()):.0f} s")
    if proved:
        write_page(proved)
    return 0 if len(proved) == len(chosen) else 1


if __name__ == "__main__":
    sys.exit(main())
