# SPDX-License-Identifier: Apache-2.0
"""How quick ik_axi is, measured in the RTL on buses of 32, 64 and 128 bits: memory.md.

    python -m scripts.pages.memory [--sim icarus|verilator]
"""

from __future__ import annotations

import json
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from scripts.console import Parser, command
from scripts.pages.render import render
from tb.axi.rates import LONG, SHORT
from tb.sim.env import GENERATED, ROOT, SIMULATORS
from tb.sim.runner import simulate

PAGE = GENERATED / "memory.md"
BUSES = (32, 64, 128)


def measured(sim: str) -> dict[int, list[dict]]:
    """Width of the bus -> a row for each latency, as tb/axi/rates.py writes them."""
    rows = {}
    for data_width in BUSES:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "rates.json"
            parameters = {"DATA_W": data_width}
            simulate("ik_axi", "tb.axi.rates", parameters=parameters, sim=sim, env={"IK_AXI_RATES": str(path)})
            rows[data_width] = [json.loads(line) for line in path.read_text().splitlines()]
    return rows


@command("pages.memory")
def main(arguments: Sequence[str] | None) -> int:
    parser = Parser("pages.memory", __doc__.splitlines()[0], fails="a simulation fails")
    parser.choice("--sim", "simulator", SIMULATORS, SIMULATORS[0], "the simulator (default: %(default)s)")
    rows = measured(parser.parse_args(arguments).sim)
    PAGE.write_text(render("memory", rows=list(zip(*rows.values(), strict=True)), buses=BUSES, short=SHORT, long=LONG))
    print(f"wrote {PAGE.relative_to(ROOT)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
