# SPDX-License-Identifier: Apache-2.0
"""Parameters of ``ik_axi`` that the tests and ``make soak-memory`` build, and a run of one in a process of its own.

Most jobs have an echo in the place of the datapath (tb/axi/ik_lean.v): what is around it is the same, and a simulation
takes a quarter of the time.
"""

from __future__ import annotations

import json
import shutil
import sys
import tempfile
from pathlib import Path

from tb.sim.children import started
from tb.sim.env import ROOT, simulator
from tb.sim.runner import simulate
from tb.sim.seeded_bugs import Bug, copy_rtl
from tb.sim.simulate import SimulationError, reason

ROWS = {"DIGIT": 1} if simulator() == "icarus" else {}  # which Verilator takes minutes for
CORE = ({}, {"W": 18, "DATA_W": 128}, {"W": 18, "DATAPATH": 0, **ROWS})
"""With the datapaths themselves."""

ECHO = (
    {"W": 18, "ADDR_W": 20},
    {},
    {"W": 18, "DATA_W": 128, "ADDR_W": 64, "LOG2_BURST": 4},
    {"W": 18, "DATA_W": 32, "ADDR_W": 40, "LOG2_BURST": 5},
    {"W": 25, "DATA_W": 128, "LOG2_BURST": 1},
)
"""With the echo."""


def named(parameters: dict[str, int]) -> str:
    return "-".join(f"{k}{v}" for k, v in parameters.items()) or "defaults"


def echoing(place: Path, bug: Bug | None = None) -> dict:
    """A copy of rtl/ in `place` with the echo; what tells `simulate` of it."""
    shutil.copy2(Path(__file__).with_name("ik_lean.v"), copy_rtl(place, bug) / "rtl" / "lean" / "ik_lean.v")
    return {"root": place, "name": "echo"}


def apart(modules: str, sim: str, env: dict[str, str], root: Path = ROOT, **options) -> None:
    """Runs cocotb tests in a process of its own, as cocotb-test changes signal handlers and the logging of its
    process, and says nothing of one that passes. Raises SimulationError."""
    with tempfile.TemporaryDirectory(prefix="ik_") as folder, open(Path(folder) / "log", "w+") as log:
        given = json.dumps([modules, str(root), {"sim": sim, "env": env, **options}])
        with started([sys.executable, "-m", "tb.axi.instances", given], folder, stdout=log, stderr=log) as process:
            failed = process.wait()
        log.seek(0)
        if failed:
            raise SimulationError(reason(log.read(), sim))


def _child(given: str) -> None:
    modules, root, options = json.loads(given)
    simulate("ik_axi", modules, root=Path(root), **options)


if __name__ == "__main__":
    _child(sys.argv[1])
