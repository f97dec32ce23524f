# SPDX-License-Identifier: Apache-2.0
"""Tests of make check-proofs. tb/sim/test_sources.py tests the digest, which ignores comments and blanks."""

from scripts import check_proofs


def test_every_page_carries_digests():
    """Each page carries digests, and the present code's digests can be computed."""
    for _, recorded, present in check_proofs.PAGES.values():
        written, now = recorded(), present()
        assert written and now and all(len(value) == 16 for value in (*written.values(), *now.values()))


def test_changed_new_and_gone_digests_are_stale(command, monkeypatch):
    page = "make fpga", lambda: {"a": "1", "b": "2", "d": "5"}, lambda: {"b": "3", "c": "4", "d": "5"}
    monkeypatch.setattr(check_proofs, "PAGES", {"fpga.md": page})
    out = ["warning: fpga.md is stale, `make fpga` writes it again: a, b, c changed"]
    out.append("0 of 1 pages are of the present code")
    assert [command(check_proofs.main, *words) for words in ([], ["--strict"])] == [(0, out, []), (1, out, [])]
