# SPDX-License-Identifier: Apache-2.0
"""Tests that map a small design to each family and simulate it next to its RTL. Wrong netlists have to be refused."""

from pathlib import Path

import pytest

from scripts.fpga import runs
from scripts.fpga.tools import LeftOutError
from tb.sim.sources import closure

pytestmark = pytest.mark.needs("fpga", "verilator")


@pytest.fixture
def figures(monkeypatch, tmp_path):
    """Return a function: family -> figures of the small design, without placement."""
    text = Path(__file__).with_name("ik_small.v").read_text()
    inner = [path for name in ("ik_exact", "ik_delay", "ik_ring", "ik_quadratic") for path in closure(name)]
    small = tmp_path / "ik_small.v"
    monkeypatch.setattr(runs, "BUILD", tmp_path)
    monkeypatch.setattr(runs.Run, "files", lambda _: list(dict.fromkeys([small, *inner])))
    monkeypatch.setattr(runs.Run, "place", lambda *_: {})

    def figures(family, factor="a", square=0):
        words = {"FACTOR": factor, "PRODUCT": str(square), "PART": str(int(family == "ecp5"))}
        made = text
        for name, value in words.items():
            made = made.replace(name, value)
        small.write_text(made)
        return runs.Run("place" if family == "ecp5" else "synth", family, "ik_small", {}).done()

    return figures


@pytest.mark.parametrize(
    "family",
    ["xc7", "ecp5", "up5k", "gowin", *(pytest.param(each, marks=pytest.mark.release) for each in ("xcup", "xc2vp"))],
)
def test_a_netlist_equals_the_rtl(figures, family):
    made = figures(family, square=int(family == "up5k"))
    assert made["simulated"]["results"] >= 8000
    if family == "ecp5":
        assert made["packed"].pop("flip_flops") > 200
        assert made["packed"] == {"multipliers": 14, "memory": 2, "input": 11, "output": 11}


@pytest.mark.parametrize(
    ("family", "factor"), [("xc7", "{a[17], a[17:0]}"), pytest.param("up5k", "a", marks=pytest.mark.release)]
)
def test_a_wrong_netlist_is_refused(figures, family, factor):
    """Use two bugs of Yosys 0.70 (docs/integration.md): products are wrong on xc7 if an operand is sign-extended, on
    iCE40 if two registers follow."""
    with pytest.raises(LeftOutError, match="clocks differ from the RTL"):
        figures(family, factor)
