# SPDX-License-Identifier: Apache-2.0
"""Documentation: pages are current, links resolve, named files and commands exist, pictures show every node."""

import re
from itertools import combinations

import pytest

from model.dataflow.datapaths import DATAPATHS
from model.dataflow.fixed import FIFO_CLOCKS
from scripts.generate import pages
from scripts.generate.flow import design, start
from tb.sim.env import ROOT

PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md", *sorted((ROOT / "docs").glob("*.md"))]


@pytest.mark.parametrize("page", pages.pages(), ids=lambda p: p.name)
def test_page_is_up_to_date(page):
    assert page.read_text() == pages.pages()[page], "run `python -m scripts.generate.pages`"


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


RECT = re.compile(r'<rect x="([\d.]+)" y="(\d+)" width="([\d.]+)".*<title>([^<]*), clocks (\d+) to (\d+): ([^<]*)<')


@pytest.mark.parametrize("datapath", DATAPATHS)
@pytest.mark.parametrize("width", [32, 18])
def test_pipeline_shows_every_operation_once_at_its_clocks(datapath, width):
    nodes = design(datapath, width)
    working = {n: (start(v, width), v.time) for n, v in nodes.items() if v.section != "results"}
    total = max(node.time for node in nodes.values()) + FIFO_CLOCKS
    text = pages.pipeline_svg(datapath, width)
    drawn, lanes = {}, {}
    for x, y, wide, _, begin, end, names in RECT.findall(text):
        at = int(begin), int(end)
        place = pages.LEFT + pages.DRAWN * at[0] / total, pages.DRAWN * (at[1] - at[0]) / total
        assert (float(x), float(wide)) == pytest.approx(place, abs=0.06)
        assert not drawn.keys() & names.split(", ")
        drawn |= dict.fromkeys(names.split(", "), at)
        lanes.setdefault(y, []).append(at)
    expected = {n: (begin, end) for n, (begin, end) in working.items() if end > begin}
    assert drawn == expected | {"ik_fifo": (total - FIFO_CLOCKS, total)}
    for bars in lanes.values():
        assert all(end <= other or last <= begin for (begin, end), (other, last) in combinations(bars, 2)), "overlap"
    assert f"{total} clocks from input to output" in text and f'class="t">{total}<' in text
