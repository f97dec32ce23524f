# SPDX-License-Identifier: Apache-2.0
"""Run random memory-to-memory jobs of ik_axi: `make soak-memory`.

Jobs have random size and alignment, with and without random pauses on the AXI channels. Every result in memory is
compared with the model's; a monitor checks the rules of AXI in every clock. A piece is one simulation of many jobs;
seed and piece number determine the jobs, so --from resumes at any piece. Successive pieces cycle through the parameter
sets of tb/axi/instances.py: first those with a real datapath, then those with an echo as datapath.

The run stops at the first piece in which a test fails, and prints seed and piece.
"""

import os
import sys
import tempfile
from collections import Counter
from functools import partial

from scripts.console import Options, command, option, progress, sim_option, whole
from scripts.parallel import shared
from tb.axi.instances import CORE, ECHO, FOLDED, echoing, named, run_in_process
from tb.sim.env import ROOT
from tb.sim.simulate import SimulationError

INSTANCES = [(parameters, False) for parameters in (*CORE, *FOLDED)] + [(parameters, True) for parameters in ECHO]
PIECE = 100  # jobs of a piece, including those with pauses on a single channel

ECHO_PLACE = ROOT / "build" / "soak-memory"


def piece(sim: str, seed: int, number: int) -> tuple[str, int, int, str]:
    """Simulate a piece; return its instance's name, numbers of jobs and targets that passed, and failure or ""."""
    parameters, echo = INSTANCES[number % len(INSTANCES)]
    what = f"{'echo' if echo else 'core'} {named(parameters)}"
    with tempfile.NamedTemporaryFile("r", prefix="ik_") as done:
        env = {"IK_AXI_SEED": str(seed * 1_000_000 + number + 1), "IK_AXI_JOBS": str(PIECE * 4 // 5)}
        env |= {"IK_AXI_DONE": done.name, "COCOTB_TEST_FILTER": "many_jobs"} | ({"IK_AXI_CORE": "echo"} if echo else {})
        options = {"root": ECHO_PLACE, "name": "echo"} if echo else {}
        failed = ""
        try:
            run_in_process("tb.axi.test_ik_axi", sim, env, parameters=parameters, **options)
        except SimulationError as error:
            failed = str(error)
        rows = [[int(word) for word in line.split()] for line in done]
    return what, sum(jobs for jobs, _ in rows), sum(targets for _, targets in rows), failed


@command(
    "soak_memory",
    [
        option("--jobs", "minimum number of jobs", whole(1), default=1000, metavar="N"),
        option("--seed", "random seed", whole(0), default=1, metavar="S"),
        option("--from", "first piece", whole(0), default=0, metavar="PIECE"),
        sim_option("verilator"),
        option("--processes", "parallel pieces", whole(1), default=os.cpu_count(), metavar="N"),
    ],
)
def main(options: Options) -> int:
    echoing(ECHO_PLACE)
    numbers = range(options.from_, options.from_ + -(-options.jobs // PIECE))
    jobs, targets = Counter(), 0
    work = partial(piece, options.sim, options.seed)
    with shared(min(options.processes, len(numbers))) as each, progress("soak_memory", options.jobs) as meter:
        for number, (what, right, solved, failed) in zip(numbers, each(work, numbers), strict=True):
            if failed:
                print(f"soak_memory: seed {options.seed}, piece {number}, {what}:\n{failed}", file=sys.stderr)
                again = f"--seed {options.seed} --from {number} --jobs 1 --sim {options.sim}"
                print(f"soak_memory: to run it again: python -m scripts.soak_memory {again}", file=sys.stderr)
                return 1
            jobs[what] += right
            targets += solved
            meter(jobs.total(), what)
    for what, right in jobs.items():
        print(f"{what:48} {right:7d} jobs")
    print(f"{jobs.total()} jobs, {targets} targets, seed {options.seed}, {options.sim}: pass")
    return 0


if __name__ == "__main__":
    sys.exit(main())
