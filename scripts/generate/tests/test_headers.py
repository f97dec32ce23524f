# SPDX-License-Identifier: Apache-2.0
"""Generated headers and register files: current, and equal to the model."""

import re
import subprocess
from pathlib import Path

import pytest

from model.dataflow.datapaths import MODELS
from scripts.generate import headers, registers
from tb.sim.env import environment


@pytest.mark.parametrize("generator", [headers, registers])
def test_files_are_up_to_date(generator):
    stale = [path.name for path, text in generator.texts().items() if path.read_text() != text]
    assert not stale, f"run `python -m {generator.__name__}`: out of date are {stale}"


def evaluated(header: str, datapath: str, width: int, folder: Path) -> dict[str, int]:
    """Return the localparams of a header as Icarus evaluates them."""
    names = re.findall(r"\b([A-Z]\w*) = ", "\n".join(re.findall(r"^localparam integer .*", header, re.M)))
    shown = "\n".join(f'$display("{name} %0d", {name});' for name in names)
    tile = MODELS[datapath].tile
    text = f"module top;\nlocalparam W = {width}, TILE = {tile};\n{header}\ninitial begin\n{shown}\nend\nendmodule\n"
    (folder / "top.v").write_text(text)
    subprocess.run(["iverilog", "-o", "top", "top.v"], cwd=folder, env=environment(), check=True)
    out = subprocess.run(["vvp", "top"], cwd=folder, env=environment(), capture_output=True, text=True, check=True)
    return {name: int(value) for name, value in map(str.split, out.stdout.splitlines())}


@pytest.mark.parametrize(
    ("datapath", "header", "key"),
    [("lean", "lean", 100), ("lean16", "lean", 1100), ("paper", "paper", 0), ("arm", "arm", None)],
)
def test_header_expressions_give_the_models_clocks(datapath, header, key, tmp_path):
    """Expressions evaluate to the model's clocks and fraction bits at every word length."""
    text = headers.node_formats(header).replace('`include "ik_lean_formats.vh"', headers.lean_formats())
    latencies = dict(re.findall(r"(\d+): datapath_latency = (\d+);", headers.latencies()))
    runs = headers.traced(datapath)
    assert tuple(runs) == tuple(MODELS[datapath].widths)
    for width, nodes in runs.items():
        values = evaluated(text, datapath, width, tmp_path)
        for name, node in nodes.items():
            assert values[f"T_{name.upper()}"] == node.time, f"W={width}: clock of {name}"
            if node.format.signed:
                assert values[f"F_{name.upper()}"] == node.format.frac, f"W={width}: fraction bits of {name}"
        leave = max(node.time for node in nodes.values())
        assert values["T_OUT"] == leave and (key is None or leave == int(latencies[str(key + width)]))
