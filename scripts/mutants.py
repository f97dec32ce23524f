# SPDX-License-Identifier: Apache-2.0
"""Run mutants of the netlists; each must be killed by a bench or proved equivalent: `make mutants`.

Yosys' `mutate` makes the mutants (tb/mutation/netlists.py); the seed determines them and their order. Results are
appended to OUT/SEED.jsonl. A later call skips the mutants in that file, except survivors, which it tries again. The
command finally prints a table by source file and a list of all survivors.
"""

import itertools
import json
import os
import sys
from dataclasses import asdict
from datetime import date
from pathlib import Path

from rich.table import Table

from model.io.files import write_atomically
from scripts import parallel
from scripts.console import InputError, Options, Stopped, command, option, progress, show, switch, whole
from scripts.generate.render import commit, render
from tb.mutation import campaign
from tb.mutation.campaign import COLUMNS, SURVIVED
from tb.sim.env import GENERATED, ROOT
from tb.sim.sources import sources

PAGE = GENERATED / "mutants.md"
HEAD = ("file", "mutants", *COLUMNS)


@command(
    "mutants",
    [
        option("--count", "number of mutants", whole(1), default=600, metavar="N"),
        option("--seed", "choice of mutants", whole(0), default=1, metavar="S"),
        option("--only", "files of rtl/ whose names contain FILE", default="", metavar="FILE"),
        option("--jobs", "parallel mutants", whole(1), default=os.cpu_count(), metavar="N"),
        parallel.FARM,
        option("--out", "folder of the results", Path, default="build/mutants", metavar="DIR"),
        switch("--keep", "write docs/generated/mutants.md; not with --only"),
    ],
    fails="one survives",
)
def main(options: Options) -> int:
    if options.keep and options.only:
        raise InputError("argument --keep: not allowed with --only")
    if not any(options.only in path.relative_to(ROOT).as_posix() for path in sources()):
        raise InputError(f"argument --only: no file of rtl/ has {options.only!r} in its name")
    path = options.out / f"{options.seed}.jsonl"
    path.parent.mkdir(parents=True, exist_ok=True)
    known = campaign.recorded(path)
    jobs = list(itertools.islice(campaign.order(options.seed, options.only), options.count))
    results = [known[mutant.key] for *_, mutant in jobs if mutant.key in known]
    new = [(*which, mutant.number) for *which, mutant in jobs if mutant.key not in known]
    with parallel.shared(options.jobs, options.farm) as ordered_map, progress("mutants", len(jobs)) as meter:
        try:
            for result in ordered_map(campaign.judge, new):
                with path.open("a", encoding="utf-8") as file:
                    file.write(f"{json.dumps(asdict(result))}\n")
                results.append(result)
                meter(len(results))
        except Stopped:
            print(f"mutants: stopped after {len(results)}; the same command resumes", file=sys.stderr)
            raise
    table, rows = Table(*HEAD), campaign.rows(results)
    for row in rows:
        table.add_row(*map(str, row))
    show(table)
    survivors = [result.mutant for result in results if result.verdict == SURVIVED]
    print(*survivors, f"seed {options.seed}: {len(results)} mutants, {len(survivors)} survived", sep="\n")
    if options.keep:
        about = {"today": date.today().isoformat(), "commit": commit(), "count": options.count, "seed": options.seed}
        about |= {"designs": [design.name for design in campaign.DESIGNS], "head": HEAD[:-1]}
        about["rows"] = [row[:-1] for row in rows]  # survivors are listed below the table
        mean = sum(result.seconds for result in results) / max(len(results), 1)
        write_atomically(PAGE, render("mutants", mean=mean, survivors=sorted(survivors), **about))
        print(f"wrote {PAGE.name}")
    return 1 if survivors else 0


if __name__ == "__main__":
    sys.exit(main())
