// SPDX-License-Identifier: Apache-2.0
// Written by `python -m scripts.generate.headers` from model/dataflow/angles.py; do not edit.

// For the body of a module with parameter W: iterations in which X changes, and all; bits of X, Y and the angle;
// the angle of iteration k, one turn = 2^ZW, of those after HEAD half the one before.

/* verilator lint_off UNUSEDPARAM */  // the gain
/* verilator lint_off UNUSEDSIGNAL */  // bits of a turn above 1/4
`include "ik_sincos_table.vh"

localparam integer HEAD = (W + 1) / 2 - 1;
localparam integer LAST = (HEAD + 16 < W + 1) ? HEAD + 16 : W + 1;
localparam integer XW = W + 3;
localparam integer YW = W + 5;
localparam integer ZW = W + 4;

function [ZW-1:0] turn(input integer k);
  reg [TABLE_BITS-1:0] rounded;
  begin
    rounded = (atan_turn(k < HEAD ? k : HEAD) + (48'd1 << (TABLE_BITS - ZW))) >> (TABLE_BITS - ZW + 1);
    turn = rounded[ZW-1:0] >> (k < HEAD ? 0 : k - HEAD);
  end
endfunction
/* verilator lint_on UNUSEDSIGNAL */
/* verilator lint_on UNUSEDPARAM */
