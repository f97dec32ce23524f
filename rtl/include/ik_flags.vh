// SPDX-License-Identifier: Apache-2.0
// Written by `python -m scripts.generate.headers` from model/io/flags.py; do not edit.

// For the body of a module with flags: their bits above the tag in m_axis_tuser. over_1 to over_7 follow each other.

/* verilator lint_off UNUSEDPARAM */  // each module uses some of them
localparam integer FLAG_TOO_FAR = 0;
localparam integer FLAG_TOO_NEAR = 1;
localparam integer FLAG_ON_AXIS = 2;
localparam integer FLAG_AT_SHOULDER = 3;
localparam integer FLAG_BAD_LENGTH = 4;
localparam integer FLAG_SATURATED = 5;
localparam integer FLAG_BAD_HAND = 8;
localparam integer FLAG_OVER_1 = 9;
localparam integer FLAG_OVER_2 = 10;
localparam integer FLAG_OVER_3 = 11;
localparam integer FLAG_OVER_4 = 12;
localparam integer FLAG_OVER_5 = 13;
localparam integer FLAG_OVER_6 = 14;
localparam integer FLAG_OVER_7 = 15;
/* verilator lint_on UNUSEDPARAM */
