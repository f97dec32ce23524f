# SPDX-License-Identifier: Apache-2.0
"""Tests that a selected mutant of a netlist is killed, and that only equivalent mutants are proved."""

import dataclasses

import pytest

from tb.formal.tools import missing
from tb.mutation.benches import fault, unit_bench
from tb.mutation.campaign import DESIGNS, netlist
from tb.mutation.equivalence import proof
from tb.mutation.netlists import BUILD, source_name, unchanged
from tb.sim.env import simulator

pytestmark = pytest.mark.release


@pytest.fixture(scope="module")
def lean():
    if missing() or simulator() != "icarus":
        pytest.skip("needs the Yosys of `make mutants`, and Icarus")
    return netlist(0, 1)


@pytest.fixture
def place(tmp_path):
    return BUILD / "work" / tmp_path.name


def square(lean, mode: str, port: str, bit: int):
    """Return a mutant of the first square in ik_lean_guard."""
    (module,) = (name for name in lean.modules if source_name(name) == "ik_lean_guard")
    command = f"mutate -mode {mode} -module {module} -cell u_x_sq -port {port} -portbit {bit}"
    return dataclasses.replace(lean.mutants[0], command=command)


@pytest.mark.sim
def test_selected_mutant_is_killed(lean, place):
    found = [m for m in lean.mutants if m.file.endswith("ik_lean_turn.v") and m.options["mode"] == "inv"]
    first = DESIGNS[0].benches[0]
    assert found and all(fault(first, mutant, place) for mutant in found[:3])


def test_only_an_equivalent_mutant_is_proved(lean, place):
    assert proof(square(lean, "const1", "b", 0), place) == "ik_lean_guard"  # a square ignores b
    assert proof(square(lean, "inv", "p", 0), place, climb=False) == ""
    assert proof(square(lean, "inv", "clk", 0), place) == ""  # ignored by the solver


@pytest.mark.sim
def test_unit_bench_kills_a_mutant(lean, place):
    (module, *_) = (name for name in lean.modules if source_name(name) == "ik_mul3")
    command = f"mutate -mode inv -module {module} -cell u_a -port q -portbit 0"
    mutant = dataclasses.replace(lean.mutants[0], command=command)
    assert fault(unit_bench(mutant), mutant, place)


def test_a_bit_stuck_at_its_constant_is_no_mutant(lean):
    (module,) = (name for name in lean.modules if source_name(name) == "ik_lean_guard")
    modules = {module: {"cells": {"u_x_sq": {"connections": {"b": [7, "0", "x"]}}}}}
    bits = [unchanged(square(lean, "const0", "b", bit), modules) for bit in range(3)]
    assert bits == [False, True, True] and not unchanged(square(lean, "const1", "b", 1), modules)
