# SPDX-License-Identifier: Apache-2.0
"""Simulation of the top of examples/icebreaker."""

from pathlib import Path

from tb.icebreaker.bench import PARAMETERS
from tb.sim.env import ROOT
from tb.sim.runner import simulate

FOLDER = ROOT / "examples" / "icebreaker"
PLL = Path(__file__).with_name("SB_PLL40_PAD.v")


def run(module: str, **env: str) -> None:
    """Run a module's cocotb tests on the example with a model of its PLL. Raises SystemExit if one fails."""
    top = "".join(path.read_text(encoding="utf-8") for path in [*sorted(FOLDER.glob("*.v")), PLL])
    simulate("icebreaker", module, top=top, parameters=PARAMETERS, env=env)
