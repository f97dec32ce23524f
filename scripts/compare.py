# SPDX-License-Identifier: Apache-2.0
"""The paper's, the lean and the folded datapath on the same targets: clocks, operations, errors of hand and angles.

    python -m scripts.compare [--targets 4000] [--seed 1]

writes docs/generated/compare.md and its picture.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence

from model.dataflow.fixed import latency
from model.io.stimuli import region
from scripts.console import Parser, command
from scripts.pages.comparison import BATCH, MACHINES, PAGE, PLOT, WIDTH, Measured, batch_clocks, page, plot
from tb.sim.env import SIMULATORS
from tb.sim.simulate import Job, SimulationError, simulate


def simulated(width: int) -> list[str]:
    """The clocks that the RTL takes for a batch, a line a datapath.  SimulationError where the schedule is wrong."""
    words, lines = region("anywhere", BATCH, width, 1), []
    for path in MACHINES:
        (run,) = simulate([Job(path, words)], simulator=SIMULATORS[0], datapath=path, width=width)
        seen = run.latency_cycles, run.total_cycles, run.bit_mismatches
        clocks = latency(path, width)
        said = clocks, batch_clocks(path, clocks), 0
        if seen != said:
            raise SimulationError(f"{path}: the RTL takes {seen}, the schedule says {said}")
        lines.append(f"{path} RTL: latency {seen[0]} clocks, {BATCH} targets in {seen[1]}, no bit unlike the model's")
    return lines


@command("compare")
def main(arguments: Sequence[str] | None) -> int:
    parser = Parser("compare", "Both datapaths on the same targets: clocks, operations, errors.")
    options = parser.sample(4000, "targets of a region").parse_args(arguments)
    print(f"seed {options.seed}, {options.targets} targets a region", flush=True)
    measured = Measured.now(options.targets, options.seed)
    for line in simulated(WIDTH):
        print(line)
    PAGE.write_text(page(measured, options.targets, options.seed), encoding="utf-8")
    PLOT.write_bytes(plot(measured.near))
    print(f"wrote {PAGE.name} and {PLOT.name}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
