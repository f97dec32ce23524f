# SPDX-License-Identifier: Apache-2.0
"""Mutation operators on a few lines each: what they change, and what they leave alone."""

import pytest

from tb.mutation.mutant import files
from tb.mutation.operators import OPERATORS, edits
from tb.mutation.source import Code, masked
from tb.sim.env import ROOT

MODULE = """\
// a + b
module ik_some #(parameter integer W = 4) (
    input wire clk, input wire rst, input wire signed [W-1:0] a, input wire [W-1:0] b, output reg [W-1:0] q
);
  `include "some.vh"
  (* ram_style = "block" *)
  reg [W-1:0] mem[0:3];  /* W - 1 */
  wire more = a >= b && !(a == 0) || a <= 3;
  wire [W-1:0] up = {{(W - 2) {1'b0}}, b[1], b[0]} << 2;
  ik_mul #(.AW(W), .DB(T_X-T_Y)) u_mul (.clk(clk), .a(a), .b(up), .q());
  generate
    if (W < 2) begin : g_illegal
      ik_some_needs_W_of_at_least_2 u_stop ();
    end
  endgenerate
  always @(posedge clk)
    if (rst) q <= {W{1'b1}};
    else if (more) q <= $signed(a) >>> 1;
    else case (b[1:0])
      2'd0: q <= more ? a : b;
      A_1: q <= ~a;
    endcase
  wire unused = &{1'b0, up + 1};
endmodule
"""

CHANGES = {  # operator: lines that it makes, of all that it does
    "at_least_to_more": ["wire more = a > b && !(a == 0) || a <= 3;"],
    "at_most_to_less": ["wire more = a >= b && !(a == 0) || a < 3;"],
    "and_to_or": ["wire more = a >= b || !(a == 0) || a <= 3;"],
    "equal_to_unequal": ["wire more = a >= b && !(a != 0) || a <= 3;"],
    "invert_dropped": ["wire more = a >= b && (a == 0) || a <= 3;", "A_1: q <= a;"],
    "condition_inverted": ["if (!(rst)) q <= {W{1'b1}};", "else if (!(more)) q <= $signed(a) >>> 1;"],
    "always_true": ["if (1'b1) q <= {W{1'b1}};", "else if (1'b1) q <= $signed(a) >>> 1;"],
    "reset_never": ["if (1'b0) q <= {W{1'b1}};"],
    "arithmetic_to_logic": ["else if (more) q <= $signed(a) >> 1;"],
    "shift_minus_one": [
        "wire [W-1:0] up = {{(W - 2) {1'b0}}, b[1], b[0]} << -1 +  2;",
        "else if (more) q <= $signed(a) >>> -1 +  1;",
    ],
    "index_plus_one": [
        "wire [W-1:0] up = {{(W - 2) {1'b0}}, b[(1)+1], b[0]} << 2;",
        "wire [W-1:0] up = {{(W - 2) {1'b0}}, b[1], b[(0)+1]} << 2;",
    ],
    "slice_top_minus_one": ["else case (b[(1)-1:0])"],
    "delay_plus_one": ["ik_mul #(.AW(W), .DB((T_X-T_Y)+1)) u_mul (.clk(clk), .a(a), .b(up), .q());"],
    "parameter_minus_one": ["ik_mul #(.AW((W)-1), .DB(T_X-T_Y)) u_mul (.clk(clk), .a(a), .b(up), .q());"],
    "ports_swapped": ["ik_mul #(.AW(W), .DB(T_X-T_Y)) u_mul (.clk(clk), .a(up), .b(a), .q());"],
    "choice_swapped": ["2'd0: q <= more ? (b) : (a);"],
    "choice_always_first": ["2'd0: q <= more ? a : (a);"],
    "concatenation_swapped": [
        "wire [W-1:0] up = {b[1], {(W - 2) {1'b0}}, b[0]} << 2;",
        "wire [W-1:0] up = {{(W - 2) {1'b0}}, b[0], b[1]} << 2;",
    ],
    "repetition_plus_one": [
        "wire [W-1:0] up = {{((W - 2))+1 {1'b0}}, b[1], b[0]} << 2;",
        "if (rst) q <= {(W)+1{1'b1}};",
    ],
    "assignment_removed": [
        "if (rst) q <= q;", "else if (more) q <= q;", "2'd0: q <= q;", "A_1: q <= q;",
    ],
    "falling_edge": ["always @(negedge clk)"],
    "signed_dropped": ["else if (more) q <= $unsigned(a) >>> 1;"],
}  # fmt: skip


def made(name):
    """The lines that an operator makes in the module."""
    before = MODULE.splitlines()
    found = []
    for start, end, new in edits(MODULE)[name]:
        after = (MODULE[:start] + new + MODULE[end:]).splitlines()
        found += [line.strip() for line in after if line not in before]
    return found


@pytest.mark.parametrize("name", CHANGES)
def test_an_operator_makes_these_lines(name):
    lines = made(name)
    assert all(line in lines for line in CHANGES[name]), lines


def test_a_bit_is_stuck_in_what_is_assigned():
    assert "A_1: q <= ((~a) | (1 << 0));" in made("stuck_at_1")
    assert "wire more = ((a >= b && !(a == 0) || a <= 3) & ~(1 << 0));" in made("stuck_at_0")


def test_labels_of_cases_are_swapped():
    start, end, new = edits(MODULE)["case_swapped"][0]
    assert MODULE[start:end].startswith("2'd0:") and new.startswith("A_1:") and new.endswith("2'd0")


def test_nothing_else_is_touched():
    """Comments, attributes, headers, checks of parameters, what is there for lint."""
    hidden = ("// a + b", "/* W - 1 */", "ram_style", "some.vh", "W < 2", "u_stop", "up + 1")
    text = masked(MODULE)
    assert len(text) == len(MODULE) and text.count("\n") == MODULE.count("\n")
    assert not any(part in text for part in hidden)
    for name, found in edits(MODULE).items():
        for start, end, _ in found:
            assert text[start:end].strip() == MODULE[start:end].strip(), name


def test_an_assignment_is_no_comparison():
    code = Code("always @(posedge clk) if (a <= b) q[W-1] <= c <= d; else {x, y} <= 2;")
    assert [code.word(at + 1) for at in code.assignments] == ["c", "2"]
    assert len(code.relations) == 2


@pytest.mark.parametrize("file", files())
def test_every_file_has_mutants_of_its_code_only(file):
    text = (ROOT / file).read_text()
    code, found = masked(text), edits(text)
    assert sum(map(len, found.values())) > 20
    for name, own in found.items():
        for start, end, new in own:
            assert text[start:end] != new
            assert start == end or code[start:end].strip(), (name, start)


def test_every_operator_finds_something():
    used = {name for file in files() for name in edits((ROOT / file).read_text())}
    assert used == set(OPERATORS) and len(OPERATORS) > 35
