# SPDX-License-Identifier: Apache-2.0
"""A deliberately wrong constant in the RTL is caught, and the scoreboard names the node that it is in."""

import re
import shutil
from dataclasses import dataclass

import numpy as np
import pytest

from model.dataflow import fixed
from model.dataflow.datapaths import DATAPATHS
from model.targets.stimuli import random_reachable, unreachable
from tb.sim.env import ROOT, simulator
from tb.sim.simulate import Job, simulate

WIDTH = 18  # all constants are expressions of the width; short words build faster
TARGETS = 20
CLAMPED = 3  # number of a target without an elbow; the others are within reach

FIRST_ADMITTED = {"icarus": 6, "verilator": 7}[simulator()]
"""Clock, counted from the start of the simulation, in which ``tb/core/run_targets.py`` gets its first target admitted.

The stream source of cocotbext-axi notices the end of reset one clock later under Verilator."""


@dataclass(frozen=True)
class Mutant:
    """In ``module``, ``right`` becomes ``wrong``; the first wrong value must be ``node``'s, of target ``target``."""

    datapath: str
    name: str
    module: str
    right: str
    wrong: str
    node: str
    target: int = 0


MUTANTS = [
    Mutant("paper", "sign", "ik_elbow",
           "F_C_2_XZ-F_PP_2_M), .OW(W), .SUB_B(1)", "F_C_2_XZ-F_PP_2_M), .OW(W), .SUB_B(0)", "elbow.pp_2_m"),
    Mutant("paper", "constant", "ik_guard", "QUARTER = {3'b001", "QUARTER = {3'b010", "guard.d_1", target=CLAMPED),
    Mutant("paper", "shift", "ik_swivel", "F_SIN_H+F_COS_H-1-F_SIN_PHI", "F_SIN_H+F_COS_H-F_SIN_PHI", "swivel.sin_phi"),
    Mutant("paper", "branch", "ik_elbow_q", ".MINUS(1)) u_h4_m", ".MINUS(0)) u_h4_m", "elbow_q.h4_m"),
    Mutant("paper", "delay", "ik_to_elbow", ".DB(T_U_X-T_H)", ".DB(T_U_X-T_H+1)", "to_elbow.uh_x"),
    Mutant("paper", "narrowing", "ik_to_wrist", ".SH(F_C3_R-F_C3_NUM), .OW(W)", ".SH(F_C3_R-F_C3_NUM+1), .OW(W)",
           "to_wrist.c3_num"),
    Mutant("lean", "lean_sign", "ik_lean_turn", "c_plus <= cc - ss;", "c_plus <= cc + ss;", "turn.c_plus"),
    Mutant("lean", "lean_flag", "ik_lean_guard",
           "(too_near || at_shoulder_at_too_far)", "(too_far || at_shoulder_at_too_far)", "guard.fold", target=CLAMPED),
    Mutant("lean", "lean_shift", "ik_lean_triangle", "e_ab - e_1s;", "e_ab - e_1s + 6'd1;", "triangle.n_ab"),
    Mutant("lean", "lean_delay", "ik_lean_direction", ".DC(T_INV_S-T_N_EL)", ".DC(T_INV_S-T_N_EL+1)",
           "direction.inv_s_el"),
]  # fmt: skip

# A build of the whole core takes 3 s with Icarus and 20 s with Verilator, which therefore gets one mutant only.
BUILT = MUTANTS if simulator() == "icarus" else MUTANTS[:1]

MESSAGE = re.compile(
    r"first difference: (?P<node>[\w.]+) (?P<equation>\(L?\d+\) )?of target (?P<target>\d+) at clock (?P<clock>\d+): "
    r"RTL (?P<rtl>[0-9a-f]+) \((?P<rtl_real>[^)]+)\), model (?P<model>[0-9a-f]+) \((?P<model_real>[^)]+)\)$",
    re.MULTILINE,
)


def targets() -> np.ndarray:
    """Targets within reach, and one that is not."""
    words = random_reachable(TARGETS, WIDTH, seed=2)
    words[CLAMPED] = unreachable(1, WIDTH, seed=2)
    return words


def test_mutants_change_one_place():
    """Each mutation can be made: its text stands once in the module, and the node it is to be found at exists."""
    for mutant in MUTANTS:
        nodes = {f"{n.section}.{n.name}" for n in fixed.run(targets(), WIDTH, mutant.datapath).bits.nodes.values()}
        file = ROOT / DATAPATHS[mutant.datapath].folder / f"{mutant.module}.v"
        assert file.read_text().count(mutant.right) == 1, mutant.name
        assert mutant.node in nodes, mutant.name


@pytest.mark.sim
@pytest.mark.parametrize(
    "mutant",
    # one of each datapath in the quick gate
    [m if m.name in ("sign", "lean_flag") else pytest.param(m, marks=pytest.mark.slow) for m in BUILT],
    ids=lambda m: m.name,
)
def test_mutant_is_named(mutant, tmp_path):
    """Target, clock, both words and both values of the first wrong node; all that follows from it is counted too."""
    shutil.copytree(ROOT / "rtl", tmp_path / "rtl")
    module = tmp_path / DATAPATHS[mutant.datapath].folder / f"{mutant.module}.v"
    module.write_text(module.read_text().replace(mutant.right, mutant.wrong))
    words = targets()

    (run,) = simulate(
        [Job("mutant", words)],
        simulator=simulator(),
        datapath=mutant.datapath,
        width=WIDTH,
        root=tmp_path,
        name=f"mutant-{mutant.name}",
    )

    assert run.bit_mismatches > 0
    found = MESSAGE.search(run.first_mismatch)
    assert found, run.first_mismatch
    node = fixed.run(words, WIDTH, mutant.datapath).bits.nodes[mutant.node.split(".")[1]]
    assert found["node"] == mutant.node, run.first_mismatch
    assert (found["equation"] or "").strip() == node.equation
    assert int(found["target"]) == mutant.target
    assert int(found["clock"]) == FIRST_ADMITTED + mutant.target + node.time
    right, wrong = int(found["model"], 16), int(found["rtl"], 16)
    assert right == int(node.value[mutant.target]) & ((1 << node.format.width) - 1)
    assert wrong != right
    for word, real in ((right, found["model_real"]), (wrong, found["rtl_real"])):
        if node.format.signed and word >> (node.format.width - 1):
            word -= 1 << node.format.width
        assert float(real) == pytest.approx(word / 2**node.format.frac, rel=1e-11)
