# SPDX-License-Identifier: Apache-2.0
"""Builds the top of examples/icebreaker, with a bug in it if one is asked for."""

from __future__ import annotations

from pathlib import Path

from tb.icebreaker.bench import PARAMETERS
from tb.sim.env import ROOT
from tb.sim.mutants import Bug
from tb.sim.runner import simulate

FOLDER = ROOT / "examples" / "icebreaker"
PLL = Path(__file__).with_name("SB_PLL40_PAD.v")


def text(bug: Bug | None = None) -> str:
    """All its Verilog, and a model of the PLL."""
    files = {path.name: path.read_text(encoding="utf-8") for path in [*sorted(FOLDER.glob("*.v")), PLL]}
    if bug:
        files[bug.file] = bug.seeded(files[bug.file])
    return "".join(files.values())


def run(module: str, bug: Bug | None = None, **env: str) -> None:
    """The cocotb tests of a module on it. Raises SystemExit where one fails."""
    simulate("icebreaker", module, top=text(bug), parameters=PARAMETERS, env=env)
