# SPDX-License-Identifier: Apache-2.0
"""The campaign: which mutants it tries, what it counts, how it resumes, what it says of survivors."""

import json
from collections import Counter
from pathlib import Path

import pytest

from scripts import mutants
from tb.mutation import mutant as mutation
from tb.mutation import netlist
from tb.mutation.mutant import BROKEN, KILLED, SURVIVED, Result


@pytest.fixture
def tried(monkeypatch, tmp_path):
    """Stands in for the benches: every fifth does not build, ik_half's survive where their operator is one of these."""
    seen, surviving = [], set()

    def judge(mutant):
        seen.append(mutant)
        if mutant.operator in surviving:
            return Result(mutant, SURVIVED)
        return Result(mutant, BROKEN if len(seen) % 5 == 0 else KILLED, "unit ik_half few", "q", 0.5)

    monkeypatch.setattr(mutants, "judge", judge)
    monkeypatch.setattr(netlist, "order", lambda file, seed: iter(()))
    for module in (mutation, mutants):
        monkeypatch.setattr(module, "RESULTS", tmp_path / "results.jsonl")
    return seen, surviving


def words(count, *more):
    return ["--count", str(count), "--jobs", "1", *more]


def test_counts_what_builds_and_spreads_it_over_the_files(command, tried):
    status, out, _ = command(mutants.main, *words(100))
    assert status == 0 and out[-1] == "seed 1: 100 mutants, 0 survived; 24 others did not count"
    assert set(Counter(m.file for m in tried[0]).values()) <= {1, 2, 3, 4}
    lines = Path("build/mutants/1.jsonl").read_text().splitlines()
    assert len({m.key for m in tried[0]}) == len(tried[0]) == len(lines)


def test_to_four_of_the_text_comes_one_of_a_netlist(command, tried, monkeypatch):
    monkeypatch.setattr(netlist.Netlist, "key", "key")
    commands = [f"mutate -mode inv -module ik_half -cell u -port a -portbit {bit}" for bit in range(24)]
    found = [netlist.Wired("rtl/lib/ik_half.v", "lean 18", 1, n, 5, one) for n, one in enumerate(commands)]
    monkeypatch.setattr(netlist, "order", lambda file, seed: iter(found))
    tried[1].add("mutate inv")
    status, out, _ = command(mutants.main, *words(20, "--only", "lib/ik_half"))
    assert status == 1 and out[-1].startswith("seed 1: 25 mutants, 5 survived")
    assert tried[0][-5:] == found[:5] and "rtl/lib/ik_half.v:5: mutate inv" in out
    assert "  + inv ik_half: u.a[0], lean 18" in out
    tried[0].clear()
    command(mutants.main, *words(24, "--only", "lib/ik_half"))
    assert tried[0][-6:] == found[:6]


def test_resumes_but_tries_survivors_again(command, tried):
    seen, surviving = tried
    surviving.add("sub_to_add")
    assert command(mutants.main, *words(30, "--only", "lib/ik_half"))[0] == 1
    first = [*seen]
    with open("build/mutants/1.jsonl", "a") as file:
        file.write('{"key": "cut of')
    seen.clear()
    assert command(mutants.main, *words(30, "--only", "lib/ik_half"))[0] == 1
    assert seen == [m for m in first if m.operator == "sub_to_add"] != []
    seen.clear()
    assert command(mutants.main, *words(30, "--only", "lib/ik_half", "--seed", "2"))[0] in (0, 1)
    assert len(seen) >= 30 and seen[:10] != first[:10]


def test_a_survivor_is_listed_unless_there_is_a_reason(command, tried, monkeypatch, tmp_path):
    tried[1].add("falling_edge")
    options = words(1000, "--only", "lib/ik_half")
    status, out, _ = command(mutants.main, *options)
    survivors = [m for m in tried[0] if m.operator == "falling_edge"]
    said = [f"{m.file}:{m.line}: falling_edge" for m in survivors]
    assert status == 1 and said and all(line in out for line in said)
    assert f"  - {survivors[0].lines()[0]}" in out and f"  + {survivors[0].lines()[1]}" in out
    rows = [dict(zip(("file", "old", "new"), (m.file, *m.lines()), strict=True), reason="why") for m in survivors]
    monkeypatch.setattr(mutation, "EQUIVALENT", tmp_path / "equivalent.json")
    mutation.EQUIVALENT.write_text(json.dumps(rows))
    assert command(mutants.main, *options)[0] == 0


def test_writes_the_page_only_where_it_is_asked_to(command, tried, monkeypatch, tmp_path):
    monkeypatch.setattr(mutants, "PAGE", tmp_path / "mutants.md")
    monkeypatch.setattr(mutants, "HARD", tmp_path / "hard.json")
    monkeypatch.setattr(mutants, "hardest", lambda results: [])
    tried[1].add("falling_edge")
    command(mutants.main, *words(60))
    assert not mutants.PAGE.exists()
    command(mutants.main, *words(60, "--keep"))
    text = mutants.PAGE.read_text()
    assert "`make mutants COUNT=60 SEED=1 KEEP=1`" in text and "| all | 60 |" in text
    assert json.loads(mutants.HARD.read_text()) == []
    Path("build/mutants/1.jsonl").unlink()
    tried[0].clear()
    command(mutants.main, *words(60))
    assert {m.operator for m in tried[0]} == {"falling_edge"}  # the others are in the results that were kept


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ("--only nothing", "mutants: argument --only: no file of rtl/ has 'nothing' in its name"),
        ("--only lean --keep", "mutants: argument --keep: goes with all files, not with --only"),
        ("--count 0", "mutants: argument --count: '0' is not a whole number of at least 1"),
    ],
)
def test_a_mistake_is_one_line(command, tried, options, said):
    assert command(mutants.main, *options.split()) == (2, [], [said])
