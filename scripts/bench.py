# SPDX-License-Identifier: Apache-2.0
"""Simulated targets per second: both simulators and the native harness in one run, and their ratio (make bench).

Times the whole command that a user waits for, build excluded: start of the simulator, every node of every target
compared with the bit-true model, results read back.  Prints the Markdown table of docs/results.md.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence

import numpy as np

from model.bounds import predict
from model.dataflow import fixed
from model.dataflow.datapaths import DATAPATHS
from model.io.stimuli import random_reachable
from scripts.console import Parser, command
from tb.sim.simulate import Job, simulate

TARGETS, WIDTH = 5000, 32
WAYS = (("icarus", False), ("verilator", False), ("verilator", True))
"""Simulator, and whether Python is out of the loop."""


def timed(action) -> float:
    """Seconds that ``action()`` takes, the better of two."""
    times = []
    for _ in range(2):
        begin = time.perf_counter()
        action()
        times.append(time.perf_counter() - begin)
    return min(times)


@command("bench")
def main(arguments: Sequence[str] | None) -> int:
    Parser("bench", __doc__.splitlines()[0]).parse_args(arguments)
    words = random_reachable(TARGETS, WIDTH, seed=1)
    print("| what | targets a second | ratio | start (s) |")
    print("| --- | --- | --- | --- |")
    slow = None
    for datapath in DATAPATHS:
        for sim, native in WAYS:
            way = f"{sim}, natively" if native else sim
            print(f"{datapath} in {way} ...", file=sys.stderr, flush=True)

            def simulated(jobs, datapath=datapath, sim=sim, native=native):
                simulate(jobs, simulator=sim, datapath=datapath, width=WIDTH, native=native)

            simulated([Job("warm", words[:1])])  # builds
            start = timed(lambda run=simulated: run([Job("one", words[:1])]))
            longer = words if not native else np.concatenate([words] * 20)
            rate = len(longer) / (timed(lambda run=simulated, of=longer: run([Job("many", of)])) - start)
            slow = slow or rate
            print(f"| {datapath} RTL in {way}, every node compared | {rate:.0f} | {rate / slow:.2g} | {start:.1f} |")
        many = np.concatenate([words] * (100_000 // TARGETS))
        model = len(many) / timed(lambda many=many, path=datapath: fixed.run(many, WIDTH, path))
        bars = TARGETS / timed(lambda path=datapath: predict.hand_bar(words, WIDTH, path))
        print(f"| {datapath} bit-true model, every node | {model:.0f} | {model / slow:.2g} | - |")
        print(f"| {datapath} predicted error of the hand | {bars:.0f} | {bars / slow:.2g} | - |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
