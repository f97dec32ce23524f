# SPDX-License-Identifier: Apache-2.0
"""Check that generated files are up to date, that headers have the model's values, and that the files named in
documents exist."""

import re
import subprocess
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

from model.dataflow import fixed
from model.dataflow.datapaths import DATAPATHS, MODELS
from model.io.flags import UNREACHABLE, expected_flags
from model.io.scoring import model_errors
from model.io.stimuli import REGIONS, region
from model.io.words import result_values
from model.reference.kinematics import forward
from scripts.generate import headers, pages, registers
from scripts.generate.flow import WIDTH, start
from tb.sim.env import ROOT, environment

PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md", *sorted((ROOT / "docs").glob("*.md"))]


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.name)
def test_links_and_named_files_and_targets_exist(page):
    text = page.read_text()
    links = [page.parent / link for link in re.findall(r"\]\(([^)#]+)[^)]*\)", text) if "://" not in link]
    names, places = [], []
    if page.name != "CHANGELOG.md":
        names = re.findall(r"`((?:rtl|tb|model|scripts|docs|examples)/[\w/.]+)`", text)
        places = re.findall(r"(?:`|^ {4})make (?:-C (\S+) )?(?:-f \S+ )?([a-z][a-z0-9-]*)", text, re.M)
    missing = [path for path in (*links, *map(ROOT.joinpath, names)) if not path.exists()]
    assert not missing, f"{page.name} names {missing}"
    for place, target in places:
        targets = re.findall(r"^([a-z0-9-]+):", (ROOT / place / "Makefile").read_text(), re.M)
        assert target in targets, f"{page.name} names make {target}"


@pytest.mark.parametrize("datapath", DATAPATHS)
def test_every_operation_is_in_one_lane_at_its_clocks(datapath):
    nodes = fixed.nodes(datapath, WIDTH).values()
    lanes = pages.lanes(nodes)
    drawn = [(name, begin, end) for lane in lanes for _, begin, end, names in lane for name in names]
    assert sorted(drawn) == sorted((node.name, start(node), node.time) for node in nodes if node.time > start(node))
    for lane in lanes:
        pairs = combinations(lane, 2)
        assert all(end <= other or last <= begin for (_, begin, end, _), (_, other, last, _) in pairs), "overlap"


def test_hand_error_by_its_definition():
    words = region("near the z axis", 5, 24, 3)
    value = result_values(fixed.run(words, 24, "lean").results, 24)
    for n, (x, y, z, _, d1, d2) in enumerate(words.tolist()):
        _, wrist = forward(value[n : n + 1, :4], value[n : n + 1, 4:], d1, d2)
        expected = np.linalg.norm(wrist[0] - (x, y, z)) / (d1 + d2)
        assert model_errors(words, 24, "lean")[0][n] == pytest.approx(expected, rel=1e-9)


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
    if "fold" in name:
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
    """Return a dict: localparam of a header -> value, evaluated by Icarus."""
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
    """Check the clocks and fraction bits of all nodes at every word length."""
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
