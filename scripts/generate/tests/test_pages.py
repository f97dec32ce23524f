# SPDX-License-Identifier: Apache-2.0
"""Documentation: pages are current, links resolve, named files and commands exist, pictures show every node."""

import re
from itertools import combinations

import pytest

from model.dataflow.datapaths import DATAPATHS
from scripts.generate import pages
from scripts.generate.flow import design, start
from tb.sim.env import ROOT

PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md", *sorted((ROOT / "docs").glob("*.md"))]


def test_pages_are_up_to_date():
    stale = [page.name for page, text in pages.pages().items() if page.read_text() != text]
    assert not stale, "run `python -m scripts.generate.pages`"


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.name)
def test_links_lead_to_files(page):
    links = re.findall(r"\]\(([^)#]+)[^)]*\)", page.read_text())
    missing = [link for link in links if "://" not in link and not (page.parent / link).exists()]
    assert not missing, f"{page.name} links to {missing}"


@pytest.mark.parametrize("page", [page for page in PAGES if page.name != "CHANGELOG.md"], ids=lambda p: p.name)
def test_named_files_and_targets_exist(page):
    text = page.read_text()
    for name in re.findall(r"`((?:rtl|tb|model|scripts|docs|examples)/[\w/.]+)`", text):
        assert (ROOT / name).exists(), f"{page.name} names {name}"
    for place, target in re.findall(r"(?:`|^ {4})make (?:-C (\S+) )?(?:-f \S+ )?([a-z][a-z0-9-]*)", text, re.M):
        targets = re.findall(r"^([a-z0-9-]+):", (ROOT / place / "Makefile").read_text(), re.M)
        assert target in targets, f"{page.name} names make {target}"


@pytest.mark.parametrize("datapath", DATAPATHS)
def test_every_operation_is_in_one_lane_at_its_clocks(datapath):
    nodes = design(datapath).values()
    lanes = pages.lanes(nodes)
    drawn = [(name, begin, end) for lane in lanes for _, begin, end, names in lane for name in names]
    working = [(node.name, start(node), node.time) for node in nodes]
    assert sorted(drawn) == sorted((name, begin, end) for name, begin, end in working if end > begin)
    for lane in lanes:
        pairs = combinations(lane, 2)
        assert all(end <= other or last <= begin for (_, begin, end, _), (_, other, last, _) in pairs), "overlap"
