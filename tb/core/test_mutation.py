# SPDX-License-Identifier: Apache-2.0
"""A deliberately wrong constant in the RTL is caught, and the scoreboard names the node that it is in."""

import re

import numpy as np
import pytest

from model.dataflow import fixed
from model.dataflow.datapaths import CONFIGURATIONS
from model.io.stimuli import random_reachable, unreachable
from tb.sim.env import ROOT, simulator
from tb.sim.mutants import Bug, copy_rtl
from tb.sim.simulate import Job, simulate

WIDTHS = {"paper": 18, "lean": 18, "fold": 24}
"""All constants are expressions of the width; short words build faster."""

TARGETS = 20
CLAMPED = 3  # number of a target without an elbow; the others are within reach

FIRST_ADMITTED = 6
"""Clock, from the start of the simulation, in which ``tb/core/run_targets.py`` gets its first target admitted."""


MUTANTS = [  # the node that is the first to be wrong, in the first target
    Bug("sign", "rtl/paper/ik_elbow.v",
        "F_C_2_XZ-F_PP_2_M), .OW(W), .SUB_B(1)", "F_C_2_XZ-F_PP_2_M), .OW(W), .SUB_B(0)", "elbow.pp_2_m"),
    Bug("constant", "rtl/paper/ik_guard.v", "QUARTER = {3'b001", "QUARTER = {3'b010", "guard.d_1"),
    Bug("shift", "rtl/paper/ik_swivel.v", "F_SIN_H+F_COS_H-1-F_SIN_PHI", "F_SIN_H+F_COS_H-F_SIN_PHI", "swivel.sin_phi"),
    Bug("branch", "rtl/paper/ik_elbow_q.v", ".MINUS(1)) u_h4_m", ".MINUS(0)) u_h4_m", "elbow_q.h4_m"),
    Bug("delay", "rtl/paper/ik_to_elbow.v", ".DB(T_U_X-T_H)", ".DB(T_U_X-T_H+1)", "to_elbow.uh_x"),
    Bug("narrowing", "rtl/paper/ik_to_wrist.v",
        ".SH(F_C3_R-F_C3_NUM), .OW(W)", ".SH(F_C3_R-F_C3_NUM+1), .OW(W)", "to_wrist.c3_num"),
    Bug("lean_sign", "rtl/lean/ik_lean_turn.v", "c_plus <= cc - ss;", "c_plus <= cc + ss;", "turn.c_plus"),
    Bug("lean_flag", "rtl/lean/ik_lean_guard.v",
        "(too_near || at_shoulder_at_too_far)", "(too_far || at_shoulder_at_too_far)", "guard.fold"),
    Bug("lean_shift", "rtl/lean/ik_lean_triangle.v", "e_ab - e_1s;", "e_ab - e_1s + 6'd1;", "triangle.n_ab"),
    Bug("lean_delay", "rtl/lean/ik_lean_direction.v",
        ".DC(T_INV_S-T_N_EL)", ".DC(T_INV_S-T_N_EL+1)", "direction.inv_s_el"),
    Bug("fold_rounding", "rtl/fold/ik_fold_sum.v",
        "S_HALF_PLAIN: s <= ROUND;", "S_HALF_PLAIN: s <= ROUND << 2;", "direction.u_x"),
    Bug("fold_cut", "rtl/fold/ik_fold_mul.v",
        "CUT_WORD: keep = ONES << WORD;", "CUT_WORD: keep = ONES << (WORD + 4);", "direction.az_sq"),
    Bug("fold_flag", "rtl/fold/ik_fold_flags.v", "clamp = too_far ||", "clamp = too_near ||", "guard.clamp"),
    Bug("fold_count", "rtl/fold/ik_fold_count.v", "twice ? {e[4:0], 1'b0} : e;", "e;", "triangle.n_law"),
    Bug("fold_zero", "rtl/fold/ik_fold_norm.v", "MOST = W - 1;", "MOST = W - 2;", "triangle.e_near"),
    Bug("fold_limit", "rtl/fold/ik_fold_word.v", "wire most = limit &&", "wire most = !limit &&", "triangle.inv_12"),
    Bug("fold_place", "rtl/fold/ik_fold_word.v",
        "low ? ROOT_DROP + 1 : ROOT_DROP", "ROOT_DROP + 1", "direction.inv_s"),
    Bug("fold_row", "rtl/fold/ik_fold_table.v", "cosine ? ~segment : segment", "segment", "turn.cos_h"),
    Bug("fold_segment", "rtl/fold/ik_fold_table.v",
        "first ? word[RW-2:2] : word[RW-3:1]", "word[RW-3:1]", "direction.inv_s"),
    Bug("fold_power", "rtl/fold/ik_fold_memory.v", "(n < AD) ? n :", "(n < AD) ? n | 1 :", "guard.d_sum"),
    Bug("fold_pair", "rtl/fold/ik_fold.v", "f_w[0] ^ w_second", "f_w[0]", "direction.az_c"),
    Bug("fold_straight", "rtl/fold/ik_fold.v",
        "of_i ? (folded ? {W{1'b0}} : -UNIT)", "of_i ? (folded ? {W{1'b0}} : UNIT)", "triangle.qe_i"),
    Bug("fold_arm", "rtl/fold/ik_fold_flags.v", "less = cos_a && !clamp", "less = cos_a", "triangle.arm_sq"),
]  # fmt: skip
ONLY_CLAMPED = ("constant", "lean_flag", "fold_flag", "fold_straight", "fold_arm")
"""Mutants that show in the target without an elbow alone."""

# A build of the whole core takes 3 s with Icarus and 20 s with Verilator, which therefore gets one mutant only.
BUILT = MUTANTS if simulator() == "icarus" else MUTANTS[:1]

MESSAGE = re.compile(
    r"first difference: (?P<node>[\w.]+) (?P<equation>\(L?\d+\) )?of target (?P<target>\d+) at clock (?P<clock>\d+): "
    r"RTL (?P<rtl>[0-9a-f]+) \((?P<rtl_real>[^)]+)\), model (?P<model>[0-9a-f]+) \((?P<model_real>[^)]+)\)$",
    re.MULTILINE,
)


def datapath(mutant: Bug) -> str:
    """paper of rtl/paper/ik_elbow.v"""
    return mutant.file.split("/")[1]


def targets(mutant: Bug) -> np.ndarray:
    """Targets within reach, and one that is not."""
    width = WIDTHS[datapath(mutant)]
    words = random_reachable(TARGETS, width, seed=2)
    words[CLAMPED] = unreachable(1, width, seed=2)
    return words


def test_mutants_change_one_place():
    """Each mutation can be made: its text is in the module once, and the node it is to be found at exists."""
    for mutant in MUTANTS:
        bits = fixed.run(targets(mutant), WIDTHS[datapath(mutant)], datapath(mutant)).bits
        assert mutant.seeded((ROOT / mutant.file).read_text())
        assert mutant.fails in {f"{n.section}.{n.name}" for n in bits.nodes.values()}, mutant.what


@pytest.mark.sim
@pytest.mark.parametrize(
    "mutant",
    # one of each datapath in the quick gate
    [m if m.what in ("sign", "lean_flag", "fold_flag") else pytest.param(m, marks=pytest.mark.slow) for m in BUILT],
    ids=lambda m: m.what,
)
def test_mutant_is_named(mutant, tmp_path):
    """Target, clock, both words and both values of the first wrong node; all that follows from it is counted too."""
    words, path = targets(mutant), datapath(mutant)

    (run,) = simulate(
        [Job("mutant", words)],
        simulator=simulator(),
        datapath=path,
        width=WIDTHS[path],
        root=copy_rtl(tmp_path, mutant),
        name=f"mutant-{mutant.what}",
    )

    assert run.bit_mismatches > 0
    found = MESSAGE.search(run.first_mismatch)
    assert found, run.first_mismatch
    node = fixed.run(words, WIDTHS[path], path).bits.nodes[mutant.fails.split(".")[1]]
    target = CLAMPED if mutant.what in ONLY_CLAMPED else 0
    assert found["node"] == mutant.fails, run.first_mismatch
    assert (found["equation"] or "").strip() == node.equation
    assert int(found["target"]) == target
    if CONFIGURATIONS[path].period == 1:  # else it counts from the beginning of a lap
        assert int(found["clock"]) == FIRST_ADMITTED + target + node.time
    right, wrong = int(found["model"], 16), int(found["rtl"], 16)
    assert right == int(node.value[target]) & ((1 << node.format.width) - 1)
    assert wrong != right
    for word, real in ((right, found["model_real"]), (wrong, found["rtl_real"])):
        if node.format.signed and word >> (node.format.width - 1):
            word -= 1 << node.format.width
        assert float(real) == pytest.approx(word / 2**node.format.frac, rel=1e-11)
