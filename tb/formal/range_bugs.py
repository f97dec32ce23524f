# SPDX-License-Identifier: Apache-2.0
"""Seeded bugs for which a node can no longer be proved to fit its word."""

from __future__ import annotations

from dataclasses import dataclass

from tb.sim.seeded_bugs import Bug

FULL = 32
"""The width at which all is proved."""

SWEEP = 16
"""The width at which every format is tried a bit shorter."""


@dataclass(frozen=True)
class NodeBug:
    """A bug that the proof of `node` of a datapath of one width must notice."""

    datapath: str
    node: str
    bug: Bug
    width: int


def _seed(
    what: str, datapath: str, node: str, file: str, old: str, new: str, fails: str = "does not fit", width: int = FULL
) -> NodeBug:
    return NodeBug(datapath, node, Bug(what, file, old, new, fails), width)


LIB, PAPER, LEAN = "rtl/lib/", "rtl/paper/", "rtl/lean/"
HEADER = "rtl/include/ik_paper_nodes.vh"
BUGS: tuple[NodeBug, ...] = (
    # formats and wiring
    _seed("sum with an integer bit too few", "paper", "inf_pp", HEADER, "F_INF_PP = W - 6,", "F_INF_PP = W - 5,"),
    _seed("sum without saturation, an integer bit too few", "paper", "s", HEADER, "F_S = W - 3,", "F_S = W - 2,"),
    _seed(
        "no saturation where the range counts on it", "paper", "t_e",
        f"{PAPER}ik_elbow_q.v", ".OW(W)) u_t_e (", ".OW(W), .SAT(0)) u_t_e (", "no saturation",
    ),
    _seed("product with an integer bit too few", "paper", "cb_x", HEADER, "F_CB_X = W - 2,", "F_CB_X = W - 1,"),
    _seed("quotient with an integer bit too few", "paper", "pi_inv", HEADER, "F_PI_INV = W - 3,", "F_PI_INV = W - 2,"),
    _seed("root with an integer bit too few", "paper", "l_sw", HEADER, "F_L_SW = W - 2,", "F_L_SW = W - 1,"),
    _seed(
        "three-tile product with two integer bits too few", "lean", "cc",
        f"{LEAN}ik_lean_turn.v",
        "(FRAC), .OW(N), .DB(T_AZ_C-T_SIN_H), .TILE(TILE)) u_cc",
        "(FRAC - 2), .OW(N), .DB(T_AZ_C-T_SIN_H), .TILE(TILE)) u_cc",
    ),
    _seed(
        "another node at a product's input", "paper", "sa_x",
        f"{PAPER}ik_swivel.v", ".b(a_x_at_sin_phi), .q(sa_x)", ".b(rho_at_sin_phi), .q(sa_x)", "made of",
    ),
    _seed(
        "an operand of the target before", "paper", "sa_z",
        f"{PAPER}ik_swivel.v", ".N(T_SIN_PHI-T_RHO)) u_rho", ".N(T_SIN_PHI-T_RHO+1)) u_rho", "is used at",
    ),
    _seed(
        "an operand of the target before, by the operator's own delay", "paper", "pp_1_pm",
        f"{PAPER}ik_elbow.v", ".DB(T_PP_1_P-T_PP_1_M)", ".DB(T_PP_1_P-T_PP_1_M+1)", "is used at",
    ),
    # ik_sum2, ik_sum3
    _seed(
        "no guard bit for the rounding", "paper", "tmp1", f"{LIB}ik_sum2.v",
        "(IW + 2 > OW + SH) ? (IW + 2)", "(IW + 1 > OW + SH) ? (IW + 1)", "bound",
    ),
    _seed(
        "b extended by zeros", "paper", "tmp1", f"{LIB}ik_sum2.v",
        "b_x = {{(RW - IW) {b_in[IW-1]}}, b_in}", "b_x = {{(RW - IW) {1'b0}}, b_in}", "saturates",
    ),
    _seed("rounds down", "paper", "rho", f"{LIB}ik_sum2.v", "$signed(sum + (sum & HALF))", "$signed(sum)", "modulo"),
    _seed("c extended by a zero", "paper", "pp_pm", f"{LIB}ik_sum3.v", "{c[IW-1], c}", "{1'b0, c}", "bound"),
    # ik_mul
    _seed(
        "register of the high tile a bit too short", "paper", "s_x", f"{LIB}ik_mul.v",
        "reg signed [AH+BH-1:0] hh;", "reg signed [AH+BH-2:0] hh;", "hh fits",
    ),
    _seed(
        "tile extended by zeros", "paper", "a_x", f"{LIB}ik_mul.v",
        "{{(PW - AL - BH) {lh[AL+BH-1]}}, lh}", "{{(PW - AL - BH) {1'b0}}, lh}", "recombined",
    ),
    _seed(
        "low half taken for signed", "paper", "s_x", f"{LIB}ik_mul.v",
        "wire signed [AL:0] a_lo = {1'b0,", "wire signed [AL:0] a_lo = {a_q[AL-1],", "tile_ll",
    ),
    _seed(
        "register of the low tile a bit too short", "paper", "a_x", f"{LIB}ik_mul.v",
        "reg [AL+BL-1:0] ll;", "reg [AL+BL-2:0] ll;", "ll fits",
    ),
    _seed(
        "mixed tile of a square taken once", "paper", "s_x", f"{LIB}ik_mul.v",
        "hl_x <<< (AL + 1)", "hl_x <<< AL", "recombined",
    ),
    _seed(
        "register of the only tile a bit too short", "paper", "a_x", f"{LIB}ik_mul.v",
        "reg signed [PW-1:0] product;", "reg signed [PW-2:0] product;", "product fits", SWEEP,
    ),
    # ik_mul3
    _seed(
        "no carry bit in the middle sum", "lean", "cc", f"{LIB}ik_mul3.v",
        "? HLW : LHW) + 1;", "? HLW : LHW);", "recombined",
    ),
    _seed(
        "middle sum extended by zeros", "lean", "cc", f"{LIB}ik_mul3.v",
        "{{(SW - MW) {mid[MW-1]}}, mid}", "{{(SW - MW) {1'b0}}, mid}", "recombined",
    ),
    _seed(
        "guess at the low tile from other bits", "lean", "cc", f"{LIB}ik_mul3.v",
        "{2'b00, a_padded[AL+1-:2]}", "{2'b00, a_padded[AL-:2]}", "tile_ll",
    ),
    # ik_exact, ik_wide
    _seed(
        "no carries", "lean", "x_sq", f"{LIB}ik_exact.v",
        "outer + (inner_x <<< L)", "outer | (inner_x <<< L)", "recombined",
    ),
    _seed(
        "no carries", "lean", "s", f"{LIB}ik_wide.v",
        "a_in - b_in : a_in + b_in", "a_in - b_in : a_in | b_in", "modulo",
    ),
    # counts and shifts
    _seed(
        "a place too far", "lean", "m_rho", f"{LIB}ik_even.v", "v_2 << {fine_2, 1'b0}", "v_2 << {fine_2, 1'b1}",
        "mantissa",
    ),
    _seed("a place too far", "paper", "p_w_x", f"{LIB}ik_norm.v", "<< room;", "<< (room + 6'd1);", "guard_bits"),
    _seed("one too many", "paper", "lz_r", f"{LIB}ik_lzc.v", "room = W - 2 - i;", "room = W - 1 - i;", "guard_bits"),
    _seed(
        "-1 taken for nothing", "paper", "p_w_x", f"{LIB}ik_lzc.v",
        "{(W - 1) {1'b0}}) && !minus;", "{(W - 1) {1'b0}});", "guard_bits",
    ),
    _seed("no limit at 1", "paper", "h3_p", f"{LIB}ik_half.v", "else if (u[W-1:0] > TOP) q <= TOP;", "", "limited"),
    _seed(
        "shifts zeros in", "lean", "inv_12_far_raw", f"{LIB}ik_shift.v",
        "(d_in >>> {count_in[5:3], 3'b000})", "(d_in >> {count_in[5:3], 3'b000})", "modulo",
    ),
    _seed(
        "a power of two too short", "paper", "d_1_sh", f"{LIB}ik_shift.v",
        "16'd1 << count_in[3:0]", "16'd1 << count_in[2:0]", "modulo",
    ),
    _seed(
        "a bit too short inside", "lean", "k_scaled", f"{LIB}ik_shift3.v",
        "TOP = DROP + OW;", "TOP = DROP + OW - 1;", "modulo",
    ),
    # what sections compute themselves, ik_pick included
    _seed("a changed with b's sign", "paper", "side_x", f"{LIB}ik_pick.v", "use_b & minus}", "minus}"),
    _seed("inverted only", "paper", "q3_k", f"{LIB}ik_pick.v", "use_b & minus}", "1'b0}"),
    _seed("wraps", "paper", "d_sum", f"{PAPER}ik_elbow.v", "d_sum <= d_1 + d_2;", "d_sum <= d_1 + d_1 + d_2;"),
    _seed("extended by a zero", "paper", "r_raw", f"{PAPER}ik_guard.v", "d1_x = {d1[W-1], d1}", "d1_x = {1'b0, d1}"),
    _seed("no limit", "paper", "h", f"{PAPER}ik_to_elbow.v", "(h_sum[W:W-1] != 2'b00)", "1'b0"),
    _seed(
        "no limit above 2", "lean", "inv_12_far", f"{LEAN}ik_lean_triangle.v",
        "(|inv_12_far_raw[RW-1:N-1])", "(|inv_12_far_raw[RW-1:N])",
    ),
    _seed(
        "half of four times", "lean", "m_q", f"{LEAN}ik_lean_turn.v",
        "low ? {length_sq[FRAC-3:0], {(UP + 2) {1'b0}}}", "low ? {length_sq[FRAC-2:0], {(UP + 1) {1'b0}}}",
    ),
)  # fmt: skip
