// SPDX-License-Identifier: Apache-2.0
// Written by `python -m scripts.generate.headers` from model/dataflow/nodes.py; do not edit.

// For the body of a module with parameters W and TILE: fraction bits of the words and of a table row, widths of the
// words of a row and of its index, and the bits that a polynomial sum drops from the product of the high parts.

/* verilator lint_off UNUSEDPARAM */  // each module uses some of them
`include "ik_lean_formats.vh"
localparam integer SINE_FRAC = (FRAC < 31) ? FRAC : 31;
localparam [0:0] SMALL = TILE < 18;
localparam integer INDEX_BITS = SMALL ? 9 : 10;
localparam integer C0_FRAC = SMALL ? 34 : 35;
localparam integer C1_FRAC = SMALL ? 22 : 23;
localparam integer C2_FRAC = SMALL ? 11 : 12;
localparam integer SLOPE_FRAC = SMALL ? 24 : 25;
localparam integer C0_BITS = SMALL ? 34 : 35;
localparam integer C1_BITS = SMALL ? 23 : 24;
localparam integer C2_BITS = SMALL ? 14 : 15;
localparam integer ROOT_DROP = SMALL ? 5 : 8;
localparam integer SINE_DROP = SMALL ? 4 : 7;
localparam integer ROOT_SUM_FRAC = SMALL ? 34 : 36;
localparam integer SINE_SUM_FRAC = SMALL ? 34 : 36;
/* verilator lint_on UNUSEDPARAM */
