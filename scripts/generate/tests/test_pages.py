# SPDX-License-Identifier: Apache-2.0
"""Documentation: generated pages are current, links resolve, named files and commands exist."""

import re

import pytest

from scripts.generate import pages
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
