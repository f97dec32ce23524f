# SPDX-License-Identifier: Apache-2.0
"""Test make formal with dummy proofs, and make check-proofs; tb/sim/test_runner.py tests the digests."""

import pytest

from scripts import check_proofs, formal
from scripts.formal import main
from tb.formal.proofs import TASKS
from tb.formal.task import Outcome, Task


@pytest.fixture
def proofs(tmp_path, monkeypatch):
    """Replace proofs by `good`, `bad` and `more`, and folders by tmp_path; return a dict: proof -> number of runs."""
    runs = {"good": 0, "bad": 0, "more": 0}

    def task(name, failed):
        def run(pool, say):
            runs[name] += 1
            return Outcome("3 nodes", 2.0, list(failed), [["node", "fits"], ["a", "operands"]])

        return Task(name, "nothing overflows", "z3", lambda: "0123456789abcdef", run)

    values = {"ROOT": tmp_path, "BUILD": tmp_path / "build", "PAGE": tmp_path / "proofs.md", "missing": list}
    tasks = task("good", ()), task("bad", ("a: counterexample",)), task("more", ())
    for name, value in (values | {"versions": lambda: "z3-solver 1.2", "TASKS": tasks}).items():
        monkeypatch.setattr(formal, name, value)
    return runs


def test_proof_that_fails_gets_no_row_and_other_rows_stay(proofs, capsys):
    for arguments, status in ([], 1), (["--only", "more", "--again"], 0):
        assert main(arguments) == status
        rows = {name: row[-1] for name, row in formal.rows().items()}
        assert rows == dict.fromkeys(("good", "more"), "0123456789abcdef")
    assert "a: counterexample" in capsys.readouterr().out
    assert "a\toperands" in (formal.BUILD / "good.tsv").read_text()


def test_result_is_kept(proofs, monkeypatch):
    for arguments in ([], [], ["--again"]):
        main([*arguments, "--only", "good"])
    assert proofs == {"good": 2, "bad": 0, "more": 0}
    monkeypatch.setattr(formal, "versions", lambda: "z3-solver 1.3")
    assert main(["--only", "good"]) == 0 and proofs["good"] == 3


@pytest.mark.release
def test_page_of_the_accuracy_is_up_to_date():
    assert formal.ACCURACY.read_text() == formal.accuracy_page()


def test_names_of_proofs_are_different():
    assert len({task.name for task in TASKS}) == len(TASKS)


def test_stale_digests(command, monkeypatch):
    """Check that every page has digests, and that a changed, new or removed digest makes its page stale."""
    for _, recorded, present in check_proofs.PAGES.values():
        written, now = recorded(), present()
        assert written and now and all(len(value) == 16 for value in (*written.values(), *now.values()))
    page = "make fpga", lambda: {"a": "1", "b": "2", "d": "5"}, lambda: {"b": "3", "c": "4", "d": "5"}
    monkeypatch.setattr(check_proofs, "PAGES", {"fpga.md": page})
    for status, words in enumerate(([], ["--strict"])):
        exit_status, (warning, _), _ = command(check_proofs.main, *words)
        assert exit_status == status and "fpga.md" in warning and "`make fpga`: a, b, c changed" in warning
