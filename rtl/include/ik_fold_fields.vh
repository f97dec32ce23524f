// SPDX-License-Identifier: Apache-2.0
// Written by `python -m scripts.generate.headers` from model/dataflow/fold/program.py; do not edit.

// For the body of ik_fold: lowest bit of each field of a step, and the number of bits if not 1.

localparam integer AT_A_BY = 0, BITS_A_BY = 2;
localparam integer AT_B_BY = 2, BITS_B_BY = 2;
localparam integer AT_W_BY = 4, BITS_W_BY = 2;
localparam integer AT_S_BY = 6, BITS_S_BY = 2;
localparam integer AT_MINUS_BY = 8, BITS_MINUS_BY = 4;
localparam integer AT_R_FUNCTION = 12, BITS_R_FUNCTION = 2;
localparam integer AT_B_PLACE = 14, BITS_B_PLACE = 2;
localparam integer AT_CUT = 16, BITS_CUT = 3;
localparam integer AT_S = 19, BITS_S = 4;
localparam integer AT_CARRY = 23;
localparam integer AT_WINDOW = 24, BITS_WINDOW = 2;
localparam integer AT_LAST = 26, BITS_LAST = 2;
localparam integer AT_SIGN = 28, BITS_SIGN = 4;
localparam integer AT_NORM = 32, BITS_NORM = 3;
localparam integer AT_SOURCE = 35, BITS_SOURCE = 2;
localparam integer AT_INPUT = 37, BITS_INPUT = 3;
localparam integer AT_RESULT = 40, BITS_RESULT = 3;
localparam integer AT_E_SET = 43, BITS_E_SET = 3;
localparam integer AT_N_BASE = 46, BITS_N_BASE = 3;
localparam integer AT_N_E = 49, BITS_N_E = 3;
localparam integer AT_A = 52, BITS_A = 7;
localparam integer AT_B = 59, BITS_B = 7;
localparam integer AT_B_COUNT = 66;
localparam integer AT_R = 67, BITS_R = 6;
localparam integer AT_A_BEND = 73;
localparam integer AT_B_HIGH = 74;
localparam integer AT_LIMIT = 75;
localparam integer AT_W = 76, BITS_W = 6;
localparam integer AT_N_MINUS = 82;
localparam integer AT_N_TWICE = 83;
localparam integer AT_LAST_INPUT = 84;
localparam integer AT_HOLD = 85;
localparam integer AT_FIRST_RESULT = 86;
localparam integer AT_LAST_RESULT = 87;
