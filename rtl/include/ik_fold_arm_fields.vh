// SPDX-License-Identifier: Apache-2.0
// Written by `python -m scripts.generate.headers` from model/dataflow/fold/program.py; do not edit.

// For the body of ik_fold_arm: lowest bit of each field of a step, and the number of bits if not 1.

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
localparam integer AT_SOURCE = 35, BITS_SOURCE = 3;
localparam integer AT_INPUT = 38, BITS_INPUT = 4;
localparam integer AT_RESULT = 42, BITS_RESULT = 5;
localparam integer AT_E_SET = 47, BITS_E_SET = 3;
localparam integer AT_N_BASE = 50, BITS_N_BASE = 3;
localparam integer AT_N_E = 53, BITS_N_E = 3;
localparam integer AT_AGAIN_BY = 56, BITS_AGAIN_BY = 2;
localparam integer AT_A = 58, BITS_A = 7;
localparam integer AT_B = 65, BITS_B = 7;
localparam integer AT_B_COUNT = 72;
localparam integer AT_R = 73, BITS_R = 6;
localparam integer AT_A_BEND = 79;
localparam integer AT_B_HIGH = 80;
localparam integer AT_LIMIT = 81;
localparam integer AT_W = 82, BITS_W = 6;
localparam integer AT_N_MINUS = 88;
localparam integer AT_N_TWICE = 89;
localparam integer AT_LAST_INPUT = 90;
localparam integer AT_HOLD = 91;
localparam integer AT_FIRST_RESULT = 92;
localparam integer AT_LAST_RESULT = 93;
localparam integer AT_OVER = 94;
localparam integer AT_TO_H = 95;
