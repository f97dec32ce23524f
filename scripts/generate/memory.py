# SPDX-License-Identifier: Apache-2.0
"""Clocks and bandwidth of ik_axi, measured in the RTL on buses of 32, 64 and 128 bits: memory.md.

python -m scripts.generate.memory [--sim icarus|verilator]
"""

from __future__ import annotations

import json
import sys
import tempfile
from pathlib import Path
from types import SimpleNamespace

from scripts.console import command, sim_option
from scripts.generate.render import render
from tb.axi.ik_axi import BATCH, LONG
from tb.axi.instances import run_in_process
from tb.sim.env import GENERATED, ROOT

PAGE = GENERATED / "memory.md"
BUSES = (32, 64, 128)


def measured(sim: str, parameters: dict[str, int], latency: int | None = None) -> list[dict]:
    """Return the rows that test `rates` of tb/axi/ik_axi.py writes for one or all latencies. Raises SimulationError."""
    with tempfile.TemporaryDirectory(prefix="ik_") as folder:
        path = Path(folder) / "rates.json"
        env = {"IK_AXI_RATES": str(path), "COCOTB_TEST_FILTER": f"latency={latency or ''}" + ("$" if latency else "")}
        run_in_process("tb.axi.ik_axi", sim, env, parameters=parameters)
        return [json.loads(line) for line in path.read_text().splitlines()]


@command("generate.memory", __doc__.splitlines()[0], [sim_option()], fails="a simulation fails")
def main(options: SimpleNamespace) -> int:
    rows = zip(*(measured(options.sim, {"DATA_W": bus}) for bus in BUSES), strict=True)
    PAGE.write_text(render("memory", rows=list(rows), buses=BUSES, short=BATCH, long=LONG))
    print(f"wrote {PAGE.relative_to(ROOT)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
