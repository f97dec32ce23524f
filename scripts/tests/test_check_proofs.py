# SPDX-License-Identifier: Apache-2.0
"""Tests of make check-proofs: a changed comment has no effect, a changed operator makes a page stale."""

import pytest

from scripts import check_proofs
from scripts.check_proofs import PAGES, Page, check, main
from tb.sim.env import ROOT
from tb.sim.sources import digest

FIFO = "rtl/lib/ik_fifo.v"


def test_every_page_carries_digests():
    """Each page carries digests, and the present code's digests can be computed."""
    for page in PAGES:
        recorded, present = page.recorded(), page.present()
        assert recorded and present and all(len(value) == 16 for value in (*recorded.values(), *present.values()))


@pytest.fixture
def page(tmp_path):
    """A page that describes a copy of ik_fifo.v."""
    copy = tmp_path / "ik_fifo.v"
    copy.write_text((ROOT / FIFO).read_text())
    then = {FIFO: digest([copy])}
    return Page(tmp_path / "proofs.md", "make formal", lambda: then, lambda: {FIFO: digest([copy])}), copy


@pytest.mark.parametrize(
    ("old", "new", "stale"),
    [
        ("", "// another comment\n\n", []),
        ("m_valid <= !empty", "m_valid  <=  // why\n  !empty", []),
        ("m_valid <= !empty", "m_valid <= empty", [FIFO]),
    ],
    ids=["comment", "blanks", "operator"],
)
def test_what_makes_a_page_stale(page, old, new, stale, capsys):
    which, copy = page
    copy.write_text(copy.read_text().replace(old, new, 1))
    assert which.stale() == stale
    assert [check([which], strict) for strict in (False, True)] == [0, int(bool(stale))]
    said = capsys.readouterr().out
    assert (f"warning: proofs.md is stale, `make formal` writes it again: {FIFO} changed" in said) == bool(stale)


def test_what_is_new_or_gone_is_stale(tmp_path):
    assert Page(tmp_path, "", lambda: {"a": "1", "b": "2"}, lambda: {"b": "2", "c": "3"}).stale() == ["a", "c"]


def test_command(monkeypatch):
    monkeypatch.setattr(check_proofs, "PAGES", [Page(ROOT / "x", "", dict, lambda: {"a": "1"})])
    assert (main([]), main(["--strict"]), main(["--strickt"])) == (0, 1, 2)
