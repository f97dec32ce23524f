# SPDX-License-Identifier: Apache-2.0
"""Test the mutation campaign: it resumes, lists survivors, kills mutants, and proves equivalent mutants."""

import dataclasses

import pytest

from scripts import mutants
from tb.mutation import campaign
from tb.mutation.benches import fault, unit_bench
from tb.mutation.campaign import DESIGNS, KILLED, SURVIVED, Result, netlist, proof
from tb.mutation.netlists import BUILD, Mutant, Netlist, source_name, unchanged

FILE = "rtl/lib/ik_half.v"


def test_a_campaign_resumes_and_tries_survivors_again(command, monkeypatch, tmp_path):
    """Stub the netlists and benches, so that only mutant 3 survives."""
    monkeypatch.setattr(Netlist, "key", "key")
    netlist = Netlist("lean 18", "ik_axis", (), 1)
    options = "mutate -mode inv -module ik_half -cell u -port a -portbit {}"
    known = [Mutant(netlist, FILE, number, 5, options.format(number)) for number in range(1, 31)]
    judged = []

    def judge(job):
        mutant = known[job[2] - 1]
        judged.append(mutant.number)
        verdict = (SURVIVED, "") if mutant.number == 3 else (KILLED, "nodes lean 18 250")
        return Result(mutant.key, FILE, mutant.describe(), *verdict)

    monkeypatch.setattr(campaign, "order", lambda seed, only: iter([(0, seed, mutant) for mutant in known]))
    monkeypatch.setattr(campaign, "judge", judge)
    monkeypatch.setattr(mutants, "PAGE", tmp_path / "mutants.md")
    words = ["--count", "5", "--jobs", "1"]
    status, out, _ = command(mutants.main, *words)
    assert status == 1 and judged == [1, 2, 3, 4, 5] and not mutants.PAGE.exists()
    assert out[-2:] == [f"{FILE}:5: inv ik_half: u.a[3], lean 18", "seed 1: 5 mutants, 1 survived"]
    with open("build/mutants/1.jsonl", "a") as file:
        file.write('{"key": "cut of')
    judged.clear()
    command(mutants.main, *words, "--count", "7", "--keep")
    assert judged == [3, 6, 7] and "| all | 7 | 6 | 0 | 0 | 0 |" in mutants.PAGE.read_text()


@pytest.fixture(scope="module")
def lean():
    return netlist(0, 1)


@pytest.fixture
def place(tmp_path):
    folder = BUILD / "work" / tmp_path.name
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def mutant_of(lean, source: str, cell: str, mode: str, port: str):
    """Return a mutant of a cell in a module from `source`: `mode` of Yosys' `mutate`, applied to bit 0 of a port."""
    module = next(name for name in lean.modules if source_name(name) == source)
    command = f"mutate -mode {mode} -module {module} -cell {cell} -port {port} -portbit 0"
    return dataclasses.replace(lean.mutants[0], command=command)


@pytest.mark.release
@pytest.mark.needs("fpga")
def test_only_an_equivalent_mutant_is_proved(lean, place):
    square = lean, "ik_lean_guard", "u_x_sq"
    assert proof(mutant_of(*square, "const1", "b"), place, deep=True) == "ik_lean_guard"  # a square ignores b
    assert proof(mutant_of(*square, "inv", "p"), place, deep=False) == ""
    assert proof(mutant_of(*square, "inv", "clk"), place, deep=True) == ""  # equiv commands ignore clocks


@pytest.mark.release
@pytest.mark.needs("fpga")
@pytest.mark.sim
def test_unit_bench_kills_a_mutant(lean, place):
    mutant = mutant_of(lean, "ik_mul3", "u_a", "inv", "q")
    assert fault(unit_bench(mutant), mutant, place)


@pytest.mark.release
@pytest.mark.needs("fpga")
@pytest.mark.sim
def test_jobs_kill_a_mutant(place):
    number = [design.name for design in DESIGNS].index("memory 32")
    mutant = next(mutant for mutant in netlist(number, 1).mutants if mutant.file.endswith("ik_axi_target.v"))
    assert fault(DESIGNS[number].benches[0], mutant, place)


def test_a_bit_stuck_at_its_constant_is_no_mutant():
    modules = {"ik": {"cells": {"u": {"connections": {"b": [7, "0", "x"]}}}}}
    stuck = [(mode, bit) for bit in range(3) for mode in ("const0", "const1")]
    words = "mutate -mode {} -module ik -cell u -port b -portbit {}"
    same = [unchanged(Mutant(None, FILE, 1, 1, words.format(*each)), modules) for each in stuck]
    assert same == [False, False, True, False, True, True]
