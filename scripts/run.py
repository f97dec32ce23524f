# SPDX-License-Identifier: Apache-2.0
"""Run trajectories through the core in a simulator and score them: `make run`.

Writes OUT/results.csv (for `all`: OUT/<trajectory>/results.csv) and OUT/score.json, and prints a table. Without
--trajectory and --datapath, both datapaths run on the paper's scenario; results go to OUT/lean and OUT/paper, and the
table shows them next to the paper's tables 5 and 6.
"""

import sys

from model.io import trajectories
from scripts import trajectory
from scripts.console import MOST_DATAPATHS, Options, command, show, switch, trajectory_options
from scripts.score_tables import table_of_datapaths, table_of_many, table_of_one, verdict
from scripts.waves import ALIGNED, VCD, WAVES, align, write_save_file

PREDICTED = 5000  # most targets with predicted errors, whose computation takes longer than everything else


@command(
    "run",
    [
        *trajectory_options("build/run", "results.csv and score.json", datapath=None, most=MOST_DATAPATHS),
        switch("--waves", f"also write OUT/{VCD}, for a single trajectory OUT/{ALIGNED}, and GTKWave save files"),
        switch("--list", "list the built-in trajectories and stop"),
    ],
    passes="no trajectory fails",
    fails="one fails",
)
def main(arguments: Options) -> int:
    if arguments.list:
        for name in (*trajectories.TRAJECTORIES, *trajectories.HANDS):
            print(f"{name:14} {trajectories.describe(name)}")
        return 0
    out = arguments.out
    prepared = trajectory.prepare(arguments)
    folders = trajectory.datapaths(arguments, prepared)
    predict = sum(len(item.words) for item in prepared) <= PREDICTED
    recorded = WAVES[: 4 if len(prepared) == 1 else 2] if arguments.waves else []  # aligned: for one trajectory
    waves = [folder / name for folder in folders.values() for name in recorded]
    with trajectory.outputs(out, folders.values(), prepared, *waves) as files:
        done = []
        for datapath, folder in folders.items():
            vcd = folder / VCD
            runs = trajectory.simulated(arguments, datapath, prepared, files(vcd) if arguments.waves else None)
            done.append(trajectory.score_runs(arguments, datapath, prepared, runs, predict))
            if arguments.waves and len(prepared) == 1:
                align(vcd, prepared[0].words, arguments.width, datapath, files, prepared[0].limits)
            elif arguments.waves:
                write_save_file(files(vcd), datapath, arguments.width, files(vcd.with_suffix(".gtkw")), VCD)
        trajectory.write_results(files, out, folders.values(), prepared, done)

    if (count := len(prepared)) == 1:
        scored = [(result, ran.flags, trajectory.speeds_of(prepared[0], result).figures()) for ((ran, result),) in done]
        show(table_of_datapaths(scored) if len(scored) > 1 else table_of_one(*scored[0]))
        tables = [path for folder in folders.values() for path in trajectory.result_paths(folder, prepared)]
    else:
        show(*(table_of_many([result for _, result in scored]) for scored in done))
        kinds = [f"*/results.{kind} ({count} files)" for kind in ("csv", "npz")]
        tables = [folder / kind for folder in folders.values() for kind in kinds]
    print(*(f"wrote {path}" for path in (*tables, out / trajectory.SCORES, *waves)), sep="\n")
    return verdict("run", [result for ran in done for _, result in ran])


if __name__ == "__main__":
    sys.exit(main())
