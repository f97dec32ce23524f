# SPDX-License-Identifier: Apache-2.0
"""What the nodes that a section computes itself, without an operator module, are in exact arithmetic.

For each section of rtl/paper and rtl/lean: node -> :class:`Value`, a Verilog expression of the section's own signals.
``tb/formal/overflow.py`` evaluates it in a word so long that nothing can be lost, and proves that the node holds all
of it. Every signal in an expression is signed, unsigned ones behind ``$signed({1'b0, ...})``, so that Verilog extends
signs. Nodes of one bit are left out: they have nothing to overflow.
"""

from __future__ import annotations

import re
from dataclasses import dataclass


@dataclass(frozen=True)
class Value:
    """The `expression` that a node holds `clocks` later; `limited`: why it holds a bound instead of what is larger."""

    expression: str
    clocks: int = 1
    limited: str = ""


def _whole(word: str) -> str:
    return f"$signed({{1'b0, {word}}})"


def _jam(word: str, clamped: str) -> Value:
    """Half of a word, the bit that is dropped or-ed in."""
    return Value(f"clamp ? {clamped} : (({word} >>> 1) | {_whole(f'{word}[0]')})")


def _magnitude(word: str) -> str:
    """|word|, or one less."""
    return f"({word} < 0 ? -1 - {word} : {word})"


GUARD = {
    "r_raw": Value("d1 + d2"),
    "d_raw": Value("d1 - d2"),
    "xy_sq": Value("x_sq + y_sq"),
    "s_raw": Value("xy_sq + z_sq_s"),
    "d_1": _jam("d_1_c", "(1 <<< (W - 3))"),
    "d_2": _jam("d_2_c", "(1 <<< (W - 3))"),
    **{f"p_a_{axis}": _jam(f"p_a_{axis}_c", "0") for axis in "xyz"},
    "d_dif_j": Value("clamp ? 0 : (d_dif_c >>> 1)"),
    "scale_j": Value(f"clamp ? 2 : ({_whole('lz_p_c')} - {_whole('lz_r_c')} + 1)"),
}

ELBOW = {
    "d_sum": Value("d_1 + d_2"),
    **{
        f"p_e_{a}": Value(f"!clamp_quo ? e_{a}_quo : away_quo ? -(p_w_{a}_quo >>> 2) : (p_w_{a}_quo >>> 2)")
        for a in "xyz"
    },
    "d_e": Value("clamp_l ? (l_sw >>> 1) : (d_1_l >>> 1)"),
}

ELBOW_Q = {
    "c4": Value("!clamp_quo ? c4_quo : fold_quo ? (1 <<< (W - 2)) : -(1 <<< (W - 2))"),
    "qe_i": Value("-qe_abs"),
}

# h is the sum of two registers: what comes in two clocks before.
H_SUM = "(wide + d_e_p + (p_e_z < 0 ? -p_e_z : p_e_z))"
TO_ELBOW = {
    "h": Value(
        f"{H_SUM} < (1 <<< (W - 1)) ? {H_SUM} : (1 <<< (W - 1)) - 1",
        2,
        "d1 + |p_ez| may be rounded to 2: the largest word stands for it",
    ),
    "m_x": Value("p_e_z_below_uh ? uh_x : p_e_x_uh"),
    "m_y": Value("p_e_z_below_uh ? uh_y : p_e_y_uh"),
    "m_z": Value("p_e_z_below_uu ? uu : h_uu"),
}

TO_WRIST = {
    **{
        f"side_{a}": Value(f"!flat ? p_w_{a}_flat : back_flat ? pp_{m}_m_flat : -pp_{m}_m_flat")
        for a, m in zip("xyz", "123", strict=True)
    },
    "q3_k": Value("negative_abs ? -q3_abs : q3_abs"),
}

LEAN_GUARD = {"d_sum": Value("d1 + d2"), "d_dif": Value("d1 - d2")}

LEAN_DIRECTION = {
    "n_el": Value(f"{_whole('e_rho_s')} - {_whole('e_s')}"),
    "az_sq": Value(f"((1 <<< FRAC) + {_magnitude('u_y')}) >>> 1"),
    "az_c": Value("(sign_u_y_h || axis_h) ? az_sq : (u_x_h >>> 1)"),
    "az_s": Value("sign_u_y_h ? (u_x_h >>> 1) : az_sq"),
    "tilt_sq": Value(f"shoulder_el ? (1 <<< FRAC) : (((1 <<< FRAC) + {_magnitude('sin_el')}) >>> 1)"),
    "tilt_c": Value("sign_h ? (cos_el >>> 1) : tilt_sq_h"),
    "tilt_s": Value("sign_h ? tilt_sq_h : (cos_el >>> 1)"),
}


def _limited(word: str) -> Value:
    """Wiring, no register."""
    top = "((1 <<< (N - 1)) - 1)"
    why = "2, which powers of two can give, becomes the largest word"
    return Value(f"wide + {word} > {top} ? {top} : {word}", 0, why)


E_FAR, E_NEAR, E_1, E_2, E_S = map(_whole, ("e_far", "e_near", "e_1_far", "e_2_far", "e_s_far"))
ROUNDED = "((1 <<< (DROP - 1)) {} {}) >>> DROP"
LEAN_TRIANGLE = {
    "n_far": Value(f"{E_FAR} - {E_1} - {E_2} + 2 + ODD"),
    "n_near": Value(f"{E_NEAR} - {E_1} - {E_2} + 2 + ODD"),
    "inv_12_far": _limited("inv_12_far_raw"),
    "inv_12_near": _limited("inv_12_near_raw"),
    "qe_w": Value(f"!clamp_el ? {ROUNDED.format('+', 'elbow_w')} : fold_el ? (1 <<< (W - 2)) : 0"),
    "qe_i": Value(f"!clamp_el ? {ROUNDED.format('-', 'elbow_i')} : fold_el ? 0 : -(1 <<< (W - 2))"),
    "inv_law": _limited("inv_law_raw"),
    "n_law": Value(f"2 * {_whole('e_1_s')} + {_whole('e_s')}"),
    "n_ab": Value(f"{E_FAR} + {E_NEAR} + 2 + ODD - 2 * {E_1} - {E_S}", 2),
    "inv_law_ab": _limited("inv_law_ab_raw"),
    "arm_sq": Value(f"clamp_cos ? (1 <<< FRAC) : (((1 <<< FRAC) + {_magnitude('cos_a')}) >>> 1)"),
    "arm_c": Value("clamp_sin ? (away_sin ? 0 : arm_sq_sin) : sign_sin ? (sin_a >>> 1) : arm_sq_sin"),
    "arm_s": Value("clamp_sin ? (away_sin ? arm_sq_sin : 0) : sign_sin ? arm_sq_sin : (sin_a >>> 1)"),
}

LEAN_TURN = {
    "c_plus": Value("cc - ss"),
    "c_minus": Value("cc + ss"),
    "s_plus": Value("sc + cs"),
    "s_minus": Value("sc - cs"),
    "w_1": Value("w_c + i_s"),
    "i_1": Value("i_c - w_s"),
    "j_1": Value("j_c - k_s"),
    "k_1": Value("k_c + j_s"),
    "m_q": Value(
        "wide + length_sq >= (1 <<< FRAC) ? (1 <<< MW) - 1"
        " : wide + length_sq < (1 <<< (FRAC - 2)) ? (length_sq <<< (UP + 2)) : (length_sq <<< UP)",
        1,
        "1 and more becomes the largest mantissa",
    ),
    **{
        f"{unit}_n": Value(f"minus ? -(low_n ? ({unit}_1 <<< 1) : {unit}_1) : low_n ? ({unit}_1 <<< 1) : {unit}_1")
        for unit in "wijk"
    },
    **{f"qs_{unit}": Value(ROUNDED.format("+", f"{unit}_q")) for unit in "wijk"},
}

SECTIONS = {
    "ik_guard": GUARD,
    "ik_elbow": ELBOW,
    "ik_elbow_q": ELBOW_Q,
    "ik_to_elbow": TO_ELBOW,
    "ik_to_wrist": TO_WRIST,
    "ik_lean_guard": LEAN_GUARD,
    "ik_lean_direction": LEAN_DIRECTION,
    "ik_lean_triangle": LEAN_TRIANGLE,
    "ik_lean_turn": LEAN_TURN,
}
"""Section's module -> node -> its value."""


def inner(section: str, node: str) -> list[str]:
    """The other nodes, computed in the same section, that a node is made of."""
    expression = SECTIONS[section][node].expression
    return [other for other in SECTIONS[section] if other != node and re.search(rf"\b{other}\b", expression)]


def depth(section: str, node: str) -> int:
    """Clocks after which a node depends on what came into its section alone."""
    return SECTIONS[section][node].clocks + bool(inner(section, node))


def properties(section: str) -> str:
    """Verilog to append to a section: for each node its exact value and the assertion that the node holds it."""
    lines = ["localparam integer EXACT_W = 2 * W + 8;", "reg [1:0] exact_age = 2'd0;  // clocks, up to 3"]
    lines.append("wire signed [EXACT_W-1:0] wide = 0;  // makes what it is added to as long in a comparison")
    lines += ["always @(posedge clk) if (exact_age != 2'd3) exact_age <= exact_age + 2'd1;"]
    for node, value in SECTIONS[section].items():
        name = f"exact_{node}"
        lines.append(f"wire signed [EXACT_W-1:0] {name} = {value.expression};")
        for clock in range(value.clocks):
            before = f"{name}_{clock}" if clock else name
            lines.append(f"reg signed [EXACT_W-1:0] {name}_{clock + 1};")
            lines.append(f"always @(posedge clk) {name}_{clock + 1} <= {before};")
        held = f"{name}_{value.clocks}" if value.clocks else name
        whole = f"$signed({{1'b0, {node}}})" if node in UNSIGNED else node
        lines.append(f"always @* if (exact_age >= {depth(section, node)}) holds_{node} : assert ({held} == {whole});")
    return "\n".join(lines) + "\n"


UNSIGNED = ("scale_j", "n_el", "n_far", "n_near", "n_law", "n_ab", "m_q")
"""Nodes that are unsigned words."""
