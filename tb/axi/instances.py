# SPDX-License-Identifier: Apache-2.0
"""Parameter sets of ``ik_axi`` for the tests and ``make soak-memory``, and a runner in a separate process.

Most jobs run with an echo in place of the datapath (tb/axi/ik_lean.v, ik_lean_arm.v), in a quarter of the time. The
logic around the datapath is unchanged.
"""

import shutil
from pathlib import Path

from tb.sim.env import ROOT, simulator
from tb.sim.runner import command
from tb.sim.seeded_bugs import Bug, copy_rtl
from tb.sim.simulate import SimulationError, reason
from tb.sim.subprocesses import compiled

ROWS = {"DIGIT": 1} if simulator() == "icarus" else {}  # Verilator needs minutes to compile DIGIT = 1
CORE = ({}, {"W": 18, "DATA_W": 128}, {"W": 18, "DATAPATH": 0, **ROWS}, {"W": 18, "DATA_W": 128, "ARM": 1}, {"ARM": 1})
FOLDED = ({"W": 20, "DATAPATH": 2}, {"W": 24, "DATA_W": 32, "LOG2_BURST": 1, "DATAPATH": 2, "ARM": 1})
"""Parameter sets for the real datapaths."""

ECHO = (
    {"W": 18, "ADDR_W": 20},
    {},
    {"W": 18, "DATA_W": 128, "ADDR_W": 64, "LOG2_BURST": 4},
    {"W": 24, "DATA_W": 128, "ARM": 1},
    {"ARM": 1},
    {"W": 18, "DATA_W": 32, "ADDR_W": 40, "LOG2_BURST": 5},
    {"W": 25, "DATA_W": 128, "LOG2_BURST": 1},
    {"W": 18, "DATA_W": 32, "ADDR_W": 40, "LOG2_BURST": 4, "ARM": 1},
)
"""Parameter sets for the echo."""


def named(parameters: dict[str, int]) -> str:
    return "-".join(f"{k}{v}" for k, v in parameters.items()) or "defaults"


def echoing(place: Path, bug: Bug | None = None) -> dict:
    """Copy rtl/ to ``place``, with ``bug`` if given, and replace ik_lean and ik_lean_arm by echoes. Return the options
    of `simulate` for this copy."""
    copy_rtl(place, bug)
    for name in ("ik_lean.v", "ik_lean_arm.v"):
        shutil.copy2(Path(__file__).with_name(name), place / "rtl" / "lean" / name)
    return {"root": place, "name": "echo"}


def run_in_process(modules: str, sim: str, env: dict[str, str], root: Path = ROOT, **options) -> None:
    """Run cocotb tests in a separate process, because cocotb-test changes signal handlers and logging.

    Raise SimulationError if a test fails.
    """
    done = compiled(command("ik_axi", modules, sim=sim, env=env, root=root, **options))
    if done.returncode:
        raise SimulationError(reason(done.stdout + done.stderr, sim))
