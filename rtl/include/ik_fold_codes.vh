// SPDX-License-Identifier: Apache-2.0
// Written by `python -m scripts.generate.headers` from model/dataflow/fold/program.py; do not edit.

// For the body of each module that reads a field of the step: codes of the fields. _BY_: selecting flags.

/* verilator lint_off UNUSEDPARAM */  // each module uses some of them
localparam integer STEP_W = 88;  // bits of a step

localparam [1:0] A_BY_NONE = 2'd0;
localparam [1:0] A_BY_U_Y = 2'd1;
localparam [1:0] A_BY_AT_SHOULDER = 2'd2;
localparam [1:0] A_BY_CLAMP = 2'd3;

localparam [1:0] B_BY_NONE = 2'd0;
localparam [1:0] B_BY_SIN_EL = 2'd1;
localparam [1:0] B_BY_BEND_SWAP = 2'd2;

localparam [1:0] W_BY_NONE = 2'd0;
localparam [1:0] W_BY_U_Y = 2'd1;
localparam [1:0] W_BY_SIN_EL = 2'd2;
localparam [1:0] W_BY_BEND_SWAP = 2'd3;

localparam [1:0] S_BY_NONE = 2'd0;
localparam [1:0] S_BY_ON_AXIS = 2'd1;
localparam [1:0] S_BY_AT_SHOULDER = 2'd2;
localparam [1:0] S_BY_CLAMP = 2'd3;

localparam [3:0] MINUS_BY_NONE = 4'd0;
localparam [3:0] MINUS_BY_ALWAYS = 4'd1;
localparam [3:0] MINUS_BY_N_0 = 4'd2;
localparam [3:0] MINUS_BY_PHI = 4'd3;
localparam [3:0] MINUS_BY_U_Y = 4'd4;
localparam [3:0] MINUS_BY_SIN_EL_AND_NOT_AT_SHOULDER = 4'd5;
localparam [3:0] MINUS_BY_COS_A_AND_NOT_CLAMP = 4'd6;
localparam [3:0] MINUS_BY_NOT_BEND_SWAP = 4'd7;
localparam [3:0] MINUS_BY_MINUS = 4'd8;

localparam [1:0] R_FUNCTION_ROOT = 2'd0;
localparam [1:0] R_FUNCTION_SINE = 2'd1;
localparam [1:0] R_FUNCTION_COSINE = 2'd2;

localparam [1:0] B_PLACE_NONE = 2'd0;
localparam [1:0] B_PLACE_ROOT = 2'd1;
localparam [1:0] B_PLACE_ANGLE = 2'd2;

localparam [2:0] CUT_EXACT = 3'd0;
localparam [2:0] CUT_POWER = 3'd1;
localparam [2:0] CUT_PLAIN = 3'd2;
localparam [2:0] CUT_DOUBLE = 3'd3;
localparam [2:0] CUT_WORD = 3'd4;
localparam [2:0] CUT_ROOT = 3'd5;
localparam [2:0] CUT_SINE = 3'd6;

localparam [3:0] S_HOLD = 4'd0;
localparam [3:0] S_ZERO = 4'd1;
localparam [3:0] S_HALF_PLAIN = 4'd2;
localparam [3:0] S_HALF_DOUBLE = 4'd3;
localparam [3:0] S_RESULT_PLAIN = 4'd4;
localparam [3:0] S_RESULT_DOUBLE = 4'd5;
localparam [3:0] S_T = 4'd6;
localparam [3:0] S_T_HALF = 4'd7;
localparam [3:0] S_SLOPE = 4'd8;
localparam [3:0] S_SLOPE_LESS = 4'd9;
localparam [3:0] S_VALUE = 4'd10;
localparam [3:0] S_LENGTH = 4'd11;
localparam [3:0] S_NONE_OR_HALF = 4'd12;

localparam [0:0] CARRY_NONE = 1'd0;
localparam [0:0] CARRY_MINUS = 1'd1;

localparam [1:0] WINDOW_PLAIN = 2'd0;
localparam [1:0] WINDOW_DOUBLE = 2'd1;
localparam [1:0] WINDOW_LOW = 2'd2;

localparam [1:0] LAST_INNER = 2'd0;
localparam [1:0] LAST_ROOT = 2'd1;
localparam [1:0] LAST_SLOPE = 2'd2;
localparam [1:0] LAST_SINE = 2'd3;

localparam [3:0] SIGN_NONE = 4'd0;
localparam [3:0] SIGN_D1 = 4'd1;
localparam [3:0] SIGN_D2 = 4'd2;
localparam [3:0] SIGN_D_DIF = 4'd3;
localparam [3:0] SIGN_A_FAR = 4'd4;
localparam [3:0] SIGN_B_NEAR = 4'd5;
localparam [3:0] SIGN_U_Y = 4'd6;
localparam [3:0] SIGN_SIN_EL = 4'd7;
localparam [3:0] SIGN_COS_A = 4'd8;
localparam [3:0] SIGN_K_1 = 4'd9;

localparam [2:0] NORM_NONE = 3'd0;
localparam [2:0] NORM_EVEN = 3'd1;
localparam [2:0] NORM_INVERSE = 3'd2;
localparam [2:0] NORM_ARM = 3'd3;
localparam [2:0] NORM_COUNT = 3'd4;
localparam [2:0] NORM_UNIT = 3'd5;

localparam [1:0] SOURCE_NONE = 2'd0;
localparam [1:0] SOURCE_SUM = 2'd1;
localparam [1:0] SOURCE_NORMAL = 2'd2;
localparam [1:0] SOURCE_INPUT = 2'd3;

localparam [2:0] INPUT_X = 3'd0;
localparam [2:0] INPUT_Y = 3'd1;
localparam [2:0] INPUT_Z = 3'd2;
localparam [2:0] INPUT_PHI = 3'd3;
localparam [2:0] INPUT_D1 = 3'd4;
localparam [2:0] INPUT_D2 = 3'd5;

localparam [2:0] RESULT_NONE = 3'd0;
localparam [2:0] RESULT_QS_W = 3'd1;
localparam [2:0] RESULT_QS_I = 3'd2;
localparam [2:0] RESULT_QS_J = 3'd3;
localparam [2:0] RESULT_QS_K = 3'd4;
localparam [2:0] RESULT_QE_W = 3'd5;
localparam [2:0] RESULT_QE_I = 3'd6;

localparam [2:0] E_SET_NONE = 3'd0;
localparam [2:0] E_SET_E_RHO = 3'd1;
localparam [2:0] E_SET_E_S = 3'd2;
localparam [2:0] E_SET_E_FAR = 3'd3;
localparam [2:0] E_SET_E_NEAR = 3'd4;
localparam [2:0] E_SET_E_1 = 3'd5;
localparam [2:0] E_SET_E_2 = 3'd6;
localparam [2:0] E_SET_E_Q = 3'd7;

localparam [2:0] N_BASE_COUNT = 3'd0;
localparam [2:0] N_BASE_1 = 3'd1;
localparam [2:0] N_BASE_2 = 3'd2;
localparam [2:0] N_BASE_4 = 3'd3;
localparam [2:0] N_BASE_MINUS_2 = 3'd4;

localparam [2:0] N_E_NONE = 3'd0;
localparam [2:0] N_E_E_RHO = 3'd1;
localparam [2:0] N_E_E_S = 3'd2;
localparam [2:0] N_E_E_FAR = 3'd3;
localparam [2:0] N_E_E_NEAR = 3'd4;
localparam [2:0] N_E_E_1 = 3'd5;
localparam [2:0] N_E_E_2 = 3'd6;
localparam [2:0] N_E_E_Q = 3'd7;

/* verilator lint_on UNUSEDPARAM */
