# SPDX-License-Identifier: Apache-2.0
"""Mutants of a netlist: the netlist itself is right, a mutant that is switched on is noticed, and only what makes no
difference is proved."""

import json
import re

import pytest

from tb.formal.tools import missing
from tb.mutation import netlist
from tb.mutation.killers import BUILD, KILLED, SAME
from tb.mutation.netlist import Wired, judged, plain_name, switched
from tb.sim.env import simulator

SEED = 1


@pytest.fixture(scope="module")
def lean():
    if missing() or simulator() != "icarus":
        pytest.skip("made by Yosys of `make mutants`, and run by Icarus")
    return netlist.netlist("lean 18", SEED)


@pytest.fixture
def place():
    place = BUILD / "copies" / "netlist"
    place.mkdir(parents=True, exist_ok=True)
    return place


def of(lean, mode: str, port: str, bit: int) -> Wired:
    """A mutant of the square in the guard, as nothing of the netlist switches it on."""
    modules = json.loads((lean.folder / "parents.json").read_text())
    (module,) = (name for name in modules if plain_name(name) == "ik_lean_guard")
    command = f"mutate -mode {mode} -module {module} -cell u_x_sq -port {port} -portbit {bit}"
    return Wired("rtl/lean/ik_lean_guard.v", "lean 18", SEED, 0, 64, command)


@pytest.mark.slow
@pytest.mark.sim
@pytest.mark.cost(40)
def test_a_mutant_is_noticed_where_it_is_on(lean, place):
    found = [one for one in lean.mutants["rtl/lean/ik_lean_turn.v"] if one.told["mode"] == "inv"]
    first = lean.of.benches[0]
    assert lean.wrong(first, 0, place) is None
    assert found and all(lean.wrong(first, one.number, place) for one in found[:3])
    assert judged(found[0], place)[:2] == (KILLED, first.name)
    assert judged(of(lean, "const0", "b", 0), place)[0] == SAME  # it is 0


@pytest.mark.slow
@pytest.mark.sim
@pytest.mark.cost(20)
def test_the_bench_of_its_module_notices_what_the_machine_never_asks_for(lean, place):
    """A sign that the operand never has in it; no bench is of a module that has none."""
    module = re.search(r" cell (\S+) \\u_az_tilt_sq\n", (lean.folder / "design.il").read_text())[1]
    command = f"mutate -mode cnot1 -module {module} -cell u_a -port q -portbit 22 -ctrlbit 24"
    mutant = Wired("rtl/lib/ik_mul3.v", "lean 18", SEED, 0, 50, command)
    assert lean.unit(mutant, place)[0] == "unit ik_mul3"
    assert lean.unit(of(lean, "inv", "p", 0), place) == ("", "")


@pytest.mark.slow
@pytest.mark.cost(20)
def test_only_what_makes_no_difference_is_proved(lean, place):
    unused, other, clock = of(lean, "const1", "b", 0), of(lean, "inv", "p", 0), of(lean, "inv", "clk", 0)
    assert lean.equivalent(unused, place, climb=False) == "ik_lean_guard"  # of no use to a square
    assert not lean.same(other, other.told["module"], place, deep=False)
    assert lean.equivalent(clock, place, climb=False) == ""  # which the solver does not see


def test_a_top_without_a_switch_is_refused():
    with pytest.raises(AssertionError, match="ik_axis has no mutant"):
        switched("module ik_axis(clk);\n  input clk;\nendmodule\n", "ik_axis", {})


def test_names():
    assert plain_name("$paramod$069ce062\\ik_delay") == "ik_delay"
    assert plain_name("$paramod\\ik_exact\\W=s32'00010011") == "ik_exact"
    assert plain_name("ik_axis") == "ik_axis"
