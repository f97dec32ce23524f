# SPDX-License-Identifier: Apache-2.0
"""A copy of the RTL in which nodes of the paper's datapath are shortened, to be simulated and synthesized.

Words and places stay; what a node has lost are zeros at its end (:mod:`model.dataflow.shortened`), which synthesis
takes out of all that follows. A divider and a root are built as short as their words are, and so is the CORDIC.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

from model.dataflow.nodes import Node
from scripts.fpga.area import zeros
from tb.sim.mutants import Bug, copy_rtl

CUT = "parameter integer CUT = 0,"
KEEP = "({W{1'b1}} << CUT)"

OPERATORS = {
    "rtl/lib/ik_mul.v": (
        ("parameter integer SQUARE = 0,", f"{CUT}\n    parameter integer SQUARE = 0,"),
        ("(SH > 0) ? ({{(PW - 1) {1'b0}}, 1'b1} << (SH - 1))",
         "(SH + CUT > 0) ? ({{(PW - 1) {1'b0}}, 1'b1} << (SH + CUT - 1))"),
        ("shifted = p >>> SH;", "shifted = (p >>> (SH + CUT)) <<< CUT;"),
    ),
    "rtl/lib/ik_sum2.v": (
        ("parameter integer SUB_B = 0,", f"{CUT}\n    parameter integer SUB_B = 0,"),
        ("(SH > 0) ? ({{(RW - 1) {1'b0}}, 1'b1} << (SH - 1))",
         "(SH + CUT > 0) ? ({{(RW - 1) {1'b0}}, 1'b1} << (SH + CUT - 1))"),
        ("$signed(sum + (sum & HALF)) >>> SH;", "($signed(sum + (sum & HALF)) >>> (SH + CUT)) <<< CUT;"),
        ("{rounded[RW-1], {(OW - 1) {~rounded[RW-1]}}};",
         "({rounded[RW-1], {(OW - 1) {~rounded[RW-1]}}} & ({OW{1'b1}} << CUT));"),
    ),
    "rtl/lib/ik_sum3.v": (
        ("parameter integer SUB_C = 0,", f"{CUT}\n    parameter integer SUB_C = 0,"),
        (".OW   (OW),", ".OW   (OW),\n      .CUT  (CUT),"),
    ),
    "rtl/lib/ik_pick.v": (
        ("parameter integer W = 32", f"{CUT}\n    parameter integer W = 32"),
        ("q <= word + {{(W - 1) {1'b0}}, use_b & minus};",
         f"q <= (word + {{{{(W - 1) {{1'b0}}}}, use_b & minus}}) & {KEEP};"),
    ),
    "rtl/lib/ik_norm.v": (
        ("parameter integer W = 32,", f"{CUT}\n    parameter integer W = 32,"),
        ("<= d_2[k*W+:W] << room;", f"<= (d_2[k*W+:W] << room) & {KEEP};"),
    ),
    "rtl/cores/ik_div.v": (
        ("parameter integer DD ", f"{CUT}\n    parameter integer CUT_N = 0,\n    parameter integer CUT_D = 0,\n"
         "    parameter integer DD "),
        (".NW (NW),", ".NW (NW - CUT_N),"),
        (".DW (DW),", ".DW (DW - CUT_D),"),
        (".SH (SH),", ".SH (SH - CUT + CUT_N - CUT_D),"),
        (".QW (QW),", ".QW (QW - CUT),"),
        (".n  (n),", ".n  (n[NW-1:CUT_N]),"),
        (".d  (d_in),", ".d  (d_in[DW-1:CUT_D]),"),
        (".q  (q),\n          .ovf(ovf)", ".q  (q[QW-1:CUT]),\n          .ovf(ovf)"),
        ("if (DIGIT != 0) begin", "if (CUT > 0) assign q[CUT-1:0] = {CUT{1'b0}};\n    if (DIGIT != 0) begin"),
    ),
    "rtl/cores/ik_root.v": (
        ("parameter integer DIGIT = 0", f"{CUT}\n    parameter integer CUT_N = 0,\n    parameter integer DIGIT = 0"),
        (".NW (NW),", ".NW (NW - CUT_N),"),
        (".SH (SH),", ".SH (SH - 2 * CUT + CUT_N),"),
        (".QW (QW),", ".QW (QW - CUT),"),
        (".n  (n),", ".n  (n[NW-1:CUT_N]),"),
        (".q  (q),\n          .neg", ".q  (q[QW-1:CUT]),\n          .neg"),
        ("if (DIGIT != 0) begin", "if (CUT > 0) assign q[CUT-1:0] = {CUT{1'b0}};\n    if (DIGIT != 0) begin"),
    ),
}  # fmt: skip
"""File -> texts and what they become: each operator gets the bits that it drops as parameters, 0 unless said."""

CORDIC = "ik_sincos #(.W(W)) u_sincos (.clk(clk), .phi(phi), .sin_h(sin_h), .cos_h(cos_h));"
SHORT_CORDIC = """wire signed [W-1:{0}] phi_short;
  ik_delay #(.W(W-{0}), .N({0})) u_phi_short (.clk(clk), .d(phi[W-1:{0}]), .q(phi_short));
  assign sin_h[{0}-1:0] = {{{0}{{1'b0}}}};
  assign cos_h[{0}-1:0] = {{{0}{{1'b0}}}};
  ik_sincos #(.W(W-{0})) u_sincos (.clk(clk), .phi(phi_short), .sin_h(sin_h[W-1:{0}]), .cos_h(cos_h[W-1:{0}]));"""

NORMALIZERS = {"norm_p": "p_w_x", "norm_b": "b_x", "norm_u": "u_x", "norm_m": "l_m_x"}
"""Instance -> one of its nodes."""

INSTANCE = re.compile(
    r"\b(ik_(?:mul|sum2|sum3|div|root|pick|norm)) #\(((?:[^()]|\((?:[^()]|\([^()]*\))*\))*)\) u_(\w+) \("
)


def shortened_rtl(place: Path, nodes: Mapping[str, Node], cuts: Mapping[str, int]) -> Path:
    """A fresh copy of rtl/ in ``place`` in which ``cuts`` are made; returns ``place``. For ``DIGIT = 1``.

    Raises LookupError for a text or an instance that the RTL does not have.
    """
    copy_rtl(place)
    for file, changes in OPERATORS.items():
        for old, new in changes:
            seed(place, file, old, new)
    ends, made = zeros(nodes, cuts), set()

    def instance(found: re.Match) -> str:
        module, values, name = found.groups()
        node = NORMALIZERS.get(name, name)
        lost = {"CUT": cuts.get(node, 0)}
        if module in ("ik_div", "ik_root"):
            lost |= {f"CUT_{k}": ends.get(word.name, 0) for k, word in zip("ND", nodes[node].operands, strict=False)}
        made.add(node)
        values = ", ".join([values.rstrip(), *(f".{key}({bits})" for key, bits in lost.items() if bits)])
        return f"{module} #({values}) u_{name} ("

    for path in sorted((place / "rtl" / "paper").glob("*.v")):
        path.write_text(INSTANCE.sub(instance, path.read_text()))
    if cuts.get("sin_h"):
        seed(place, "rtl/paper/ik_swivel.v", CORDIC, SHORT_CORDIC.format(cuts["sin_h"]))
        made |= {"sin_h", "cos_h"}
    missing = [name for name in cuts if name not in made and nodes[name].op != "normalize"]
    if missing:
        raise LookupError(f"no instances of {', '.join(missing)}")
    return place


def seed(place: Path, file: str, old: str, new: str) -> None:
    """In the copy, the text ``old``, which is there once, becomes ``new``."""
    path = place / file
    path.write_text(Bug("shorter", file, old, new).seeded(path.read_text()))
