# SPDX-License-Identifier: Apache-2.0
"""Tests of the mutation campaign: it resumes, lists survivors and rejects invalid options."""

from pathlib import Path

import pytest

from scripts import mutants
from tb.mutation import campaign
from tb.mutation.campaign import KILLED, SURVIVED, Result
from tb.mutation.netlists import Mutant, Netlist

FILE = "rtl/lib/ik_half.v"


@pytest.fixture
def judged(monkeypatch):
    """Replace netlists and benches; return the mutants that were judged. Mutant 3 survives."""
    monkeypatch.setattr(Netlist, "key", "key")
    netlist = Netlist("lean 18", "ik_axis", (), 1)
    command = "mutate -mode inv -module ik_half -cell u -port a -portbit {}"
    found = [Mutant(netlist, FILE, number, 5, command.format(number)) for number in range(1, 31)]
    seen = []

    def judge(job):
        mutant = found[job[2] - 1]
        seen.append(mutant.number)
        survives = mutant.number == 3
        by = "" if survives else "nodes lean 18 250"
        return Result(mutant.key, FILE, mutant.describe(), SURVIVED if survives else KILLED, by)

    monkeypatch.setattr(campaign, "order", lambda seed, only: iter([(0, seed, mutant) for mutant in found]))
    monkeypatch.setattr(campaign, "judge", judge)
    return seen


def test_a_campaign_resumes_and_tries_survivors_again(command, judged):
    words = ["--count", "5", "--jobs", "1"]
    status, out, _ = command(mutants.main, *words)
    assert status == 1 and judged == [1, 2, 3, 4, 5]
    assert out[-2:] == [f"{FILE}:5: inv ik_half: u.a[3], lean 18", "seed 1: 5 mutants, 1 survived"]
    with open("build/mutants/1.jsonl", "a") as file:
        file.write('{"key": "cut of')
    judged.clear()
    command(mutants.main, *words, "--count", "7")
    assert judged == [3, 6, 7]


def test_keep_writes_the_page(command, judged, monkeypatch, tmp_path):
    monkeypatch.setattr(mutants, "PAGE", tmp_path / "mutants.md")
    command(mutants.main, "--count", "4", "--jobs", "1")
    assert not mutants.PAGE.exists()
    command(mutants.main, "--count", "4", "--jobs", "1", "--keep")
    assert "| all | 4 | 3 | 0 | 0 | 0 | 1 |" in mutants.PAGE.read_text()
    assert Path("build/mutants/1.jsonl").exists()
