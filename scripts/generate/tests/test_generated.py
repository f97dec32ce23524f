# SPDX-License-Identifier: Apache-2.0
"""Check that generated files are up to date, headers have the model's values, and files named in documents exist."""

import re
import subprocess
from pathlib import Path

import numpy as np
import pytest

from model.dataflow.datapaths import MODELS
from model.io.flags import UNREACHABLE, expected_flags
from model.io.stimuli import REGIONS, region
from scripts.generate import headers, pages, registers
from tb.sim.env import ROOT, environment

PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md", *sorted((ROOT / "docs").glob("*.md"))]


def test_links_and_named_files_and_targets_exist():
    missing = []
    for page in PAGES:
        text, name = page.read_text(), page.name
        links = [page.parent / link for link in re.findall(r"\]\(([^)#]+)[^)]*\)", text) if "://" not in link]
        missing += [(name, path) for path in links if not path.exists()]
        if name == "CHANGELOG.md":
            continue
        files = re.findall(r"`((?:rtl|tb|model|scripts|docs|examples)/[\w/.]+)`", text)
        missing += [(name, path) for path in files if not (ROOT / path).exists()]
        for place, target in re.findall(r"(?:`|^ {4})make (?:-C (\S+) )?(?:-f \S+ )?([a-z][a-z0-9-]*)", text, re.M):
            targets = re.findall(r"^([a-z0-9-]+):", (ROOT / place / "Makefile").read_text(), re.M)
            missing += [] if target in targets else [(name, f"make {target}")]
    assert missing == []


@pytest.mark.parametrize("width", (16, 32))
@pytest.mark.parametrize("name", REGIONS)
def test_regions_are_in_reach_and_where_they_claim(name, width):
    words = region(name, 1000, width, 2)
    assert words.shape == (1000, 6)
    assert not (expected_flags(words, width) & UNREACHABLE).any()
    assert (words == region(name, 1000, width, 2)).all() and (words != region(name, 1000, width, 3)).any()
    x, y, z, _, d1, d2 = words.T.astype(float)
    distance, ratio = np.sqrt(x**2 + y**2 + z**2), np.maximum(d1, d2) / np.minimum(d1, d2)
    lsb = 3 / np.maximum(distance, 1)
    if "the z axis" in name and "elbow" not in name:
        assert (np.hypot(x, y) <= (0.11 + lsb) * np.maximum(np.abs(z), 1) + 1).all()
        assert (z > 0).any() and (z < 0).any()
    if "stretch" in name:  # with short lengths, an LSB exceeds the intended gap
        assert ((d1 + d2 - distance) / (d1 + d2) <= 0.12 + 3 / (d1 + d2)).all()
    if "closed" in name:
        assert (distance - np.abs(d1 - d2) <= 0.12 * distance + 2).all()
    if name == "unequal lengths":
        big = np.minimum(d1, d2) > 20
        assert (ratio[big] > 4.7).all() and (ratio[big] < 21).all()
    if name == "most unequal lengths":
        assert ratio.max() > 2.0 ** (width - 5) and np.median(ratio) > 20
    if name == "short lengths":
        assert (d1 + d2 <= 185).all()


@pytest.mark.parametrize("generator", [headers, registers, pages])
def test_files_are_up_to_date(generator):
    stale = [path.name for path, text in generator.texts().items() if path.read_text() != text]
    assert not stale, f"run `python -m {generator.__name__}`: out of date are {stale}"


def evaluated(header: str, datapath: str, width: int, folder: Path) -> dict[str, int]:
    """Return a dict: localparam of a header -> its value, as evaluated by Icarus."""
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
    [("lean", "lean", 100), ("lean16", "lean", 1100), ("paper", "paper", 0), ("arm", "arm", -1), ("arm16", "arm", -1)],
)
def test_header_expressions_give_the_models_clocks(datapath, header, key, tmp_path):
    """Check the clocks and fraction bits of all nodes at all word lengths."""
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
        assert values["T_OUT"] == leave and (key < 0 or leave == int(latencies[str(key + width)]))
