// SPDX-License-Identifier: Apache-2.0
// Written by `python -m scripts.generate.headers` from model/dataflow/lean.py; do not edit.

// For the body of a module with parameters W and TILE. F_<NODE>: fraction bits of the node. T_<NODE>: the clock in
// which it is valid, counted from the clock in which its target is at the datapath's input.
// LAT_<OPERATION>: clocks of an operation.

`include "ik_lean_formats.vh"
localparam integer LAT_SUM2 = 2;  // add, round and saturate
localparam integer LAT_SHIFT = 2;  // barrel shift: by eights, by ones
localparam integer LAT_MUX = 1;  // an exact addition, a choice, a sign change or a comparison
localparam integer LAT_MUL3 = 3;  // three tile products, tile sums, rounded sum
localparam integer LAT_MUL3_FAR = 4;  // operands, three tile products, tile sums, rounded sum
localparam integer LAT_PRODUCT = 4;  // operands, tile products, tile sums, sum
localparam integer LAT_SQUARE = 3;  // operands, tile products, sum
localparam integer LAT_WIDE = 1;  // an exact addition of long words
localparam integer LAT_EVEN = 3;  // zero pairs in groups, shift by groups, shift by pairs
localparam integer LAT_SHIFT3 = 3;  // barrel shift: by sixteens, by fours, by ones
localparam integer LAT_RSQRT = (TILE < 18 || ROOT_FRAC > 22) ? 8 : 5;  // a table and u times a slope; in the long form in tiles, the slope by another product
localparam integer LAT_RSQRT_FAR = (TILE < 18 || ROOT_FRAC > 22) ? 9 : 6;  // the table's address, and the same
localparam integer LAT_TRIG = (TILE < 18 || FRAC > 23) ? 11 : 8;  // magnitude, a table and u times a slope, as for rsqrt, sign

// exact squares and flags
localparam integer F_X = W - 2, T_X = 0;
localparam integer F_Y = W - 2, T_Y = 0;
localparam integer F_Z = W - 2, T_Z = 0;
localparam integer F_PHI = W - 1, T_PHI = 0;
localparam integer F_D1 = W - 2, T_D1 = 0;
localparam integer F_D2 = W - 2, T_D2 = 0;
localparam integer T_BAD_LENGTH = LAT_MUX;
localparam integer T_ON_AXIS = LAT_MUX;
localparam integer T_AT_SHOULDER = LAT_MUX;
localparam integer F_D_SUM = W - 2, T_D_SUM = LAT_MUX;
localparam integer F_D_DIF = W - 2, T_D_DIF = LAT_MUX;
localparam integer F_X_SQ = 2*W - 4, T_X_SQ = LAT_SQUARE;
localparam integer F_Y_SQ = 2*W - 4, T_Y_SQ = LAT_SQUARE;
localparam integer F_Z_SQ = 2*W - 4, T_Z_SQ = LAT_SQUARE;
localparam integer F_D_SUM_SQ = 2*W - 4, T_D_SUM_SQ = T_D_SUM + LAT_SQUARE;
localparam integer F_D_DIF_SQ = 2*W - 4, T_D_DIF_SQ = T_D_DIF + LAT_SQUARE;
localparam integer F_SUM_DIF = 2*W - 4, T_SUM_DIF = T_D_SUM + LAT_PRODUCT;
localparam integer F_RHO_SQ = 2*W - 4, T_RHO_SQ = T_X_SQ + LAT_WIDE;
localparam integer F_S = 2*W - 4, T_S = T_RHO_SQ + LAT_WIDE;
localparam integer F_A_FAR = 2*W - 4, T_A_FAR = T_S + LAT_WIDE;
localparam integer F_B_NEAR = 2*W - 4, T_B_NEAR = T_S + LAT_WIDE;
localparam integer F_K_LAW = 2*W - 4, T_K_LAW = T_S + LAT_WIDE;
localparam integer T_TOO_FAR = T_A_FAR + LAT_MUX;
localparam integer T_TOO_NEAR = T_B_NEAR + LAT_MUX;
localparam integer T_CLAMP = T_TOO_FAR + LAT_MUX;
localparam integer T_CLOSED = T_TOO_NEAR + LAT_MUX;
localparam integer T_AWAY = T_TOO_NEAR + LAT_MUX;

// azimuth and elevation
localparam integer T_E_RHO = T_RHO_SQ + LAT_EVEN;
localparam integer T_M_RHO = T_RHO_SQ + LAT_EVEN;
localparam integer F_INV_RHO = FRAC, T_INV_RHO = T_M_RHO + LAT_RSQRT_FAR;
localparam integer T_E_S = T_S + LAT_EVEN;
localparam integer T_M_S = T_S + LAT_EVEN;
localparam integer F_INV_S = FRAC, T_INV_S = T_M_S + LAT_RSQRT_FAR;
localparam integer F_X_N = WX, T_X_N = T_E_RHO + LAT_SHIFT;
localparam integer F_Y_N = WX, T_Y_N = T_E_RHO + LAT_SHIFT;
localparam integer F_Z_N = WX, T_Z_N = T_E_S + LAT_SHIFT;
localparam integer F_U_X = FRAC, T_U_X = T_INV_RHO + LAT_MUL3;
localparam integer F_U_Y = FRAC, T_U_Y = T_INV_RHO + LAT_MUL3;
localparam integer F_SIN_EL = FRAC, T_SIN_EL = T_INV_S + LAT_MUL3;
localparam integer F_ROOT_RHO = FRAC, T_ROOT_RHO = T_INV_RHO + LAT_MUL3;
localparam integer T_N_EL = T_E_S + LAT_MUX;
localparam integer F_INV_S_EL = FRAC, T_INV_S_EL = T_INV_S + LAT_SHIFT;
localparam integer F_COS_EL = FRAC, T_COS_EL = T_ROOT_RHO + LAT_MUL3_FAR;
localparam integer F_AZ_SQ = FRAC, T_AZ_SQ = T_U_Y + LAT_MUX;
localparam integer F_AZ_C = FRAC, T_AZ_C = T_U_Y + LAT_MUX;
localparam integer F_AZ_S = FRAC, T_AZ_S = T_U_Y + LAT_MUX;
localparam integer F_TILT_SQ = FRAC, T_TILT_SQ = T_SIN_EL + LAT_MUX;
localparam integer F_TILT_C = FRAC, T_TILT_C = T_COS_EL + LAT_MUX;
localparam integer F_TILT_S = FRAC, T_TILT_S = T_COS_EL + LAT_MUX;

// shoulder angle, elbow
localparam integer T_E_FAR = T_A_FAR + LAT_EVEN;
localparam integer T_M_FAR = T_A_FAR + LAT_EVEN;
localparam integer F_INV_FAR = FRAC, T_INV_FAR = T_M_FAR + LAT_RSQRT_FAR;
localparam integer T_E_NEAR = T_B_NEAR + LAT_EVEN;
localparam integer T_M_NEAR = T_B_NEAR + LAT_EVEN;
localparam integer F_INV_NEAR = FRAC, T_INV_NEAR = T_M_NEAR + LAT_RSQRT_FAR;
localparam integer T_E_1 = LAT_EVEN;
localparam integer T_M_1 = LAT_EVEN;
localparam integer F_INV_1 = FRAC, T_INV_1 = T_M_1 + LAT_RSQRT_FAR;
localparam integer T_E_2 = LAT_EVEN;
localparam integer T_M_2 = LAT_EVEN;
localparam integer F_INV_2 = FRAC, T_INV_2 = T_M_2 + LAT_RSQRT_FAR;
localparam integer F_ROOT_FAR = FRAC, T_ROOT_FAR = T_INV_FAR + LAT_MUL3;
localparam integer F_ROOT_NEAR = FRAC, T_ROOT_NEAR = T_INV_NEAR + LAT_MUL3;
localparam integer F_INV_12_RAW = FRAC + 1, T_INV_12_RAW = T_INV_1 + LAT_MUL3;
localparam integer F_INV_12 = FRAC + 1, T_INV_12 = T_INV_12_RAW + LAT_MUX;
localparam integer T_N_FAR = T_E_FAR + LAT_MUX;
localparam integer F_INV_12_FAR_RAW = FRAC, T_INV_12_FAR_RAW = T_INV_12 + LAT_SHIFT;
localparam integer F_INV_12_FAR = FRAC, T_INV_12_FAR = T_INV_12_FAR_RAW + LAT_MUX;
localparam integer F_ELBOW_W = FRAC, T_ELBOW_W = T_ROOT_FAR + LAT_MUL3_FAR;
localparam integer T_N_NEAR = T_E_NEAR + LAT_MUX;
localparam integer F_INV_12_NEAR_RAW = FRAC, T_INV_12_NEAR_RAW = T_INV_12 + LAT_SHIFT;
localparam integer F_INV_12_NEAR = FRAC, T_INV_12_NEAR = T_INV_12_NEAR_RAW + LAT_MUX;
localparam integer F_ELBOW_I = FRAC, T_ELBOW_I = T_ROOT_NEAR + LAT_MUL3_FAR;
localparam integer F_QE_W = W - 2, T_QE_W = T_ELBOW_W + LAT_MUX;  // (14)
localparam integer F_QE_I = W - 2, T_QE_I = T_ELBOW_I + LAT_MUX;  // (14)
localparam integer F_INV_11 = FRAC, T_INV_11 = T_INV_1 + LAT_MUL3;
localparam integer F_INV_LAW_RAW = FRAC, T_INV_LAW_RAW = T_INV_S + LAT_MUL3;
localparam integer F_INV_LAW = FRAC, T_INV_LAW = T_INV_LAW_RAW + LAT_MUX;
localparam integer T_N_LAW = T_E_S + LAT_MUX;
localparam integer F_K_SCALED = FRAC, T_K_SCALED = T_N_LAW + LAT_SHIFT3;
localparam integer F_COS_A = FRAC, T_COS_A = T_INV_LAW + LAT_MUL3;
localparam integer F_ROOT_AB = FRAC, T_ROOT_AB = T_ROOT_FAR + LAT_MUL3;
localparam integer T_N_AB = T_E_FAR + LAT_SUM2;
localparam integer F_INV_LAW_AB_RAW = FRAC, T_INV_LAW_AB_RAW = T_INV_LAW + LAT_SHIFT;
localparam integer F_INV_LAW_AB = FRAC, T_INV_LAW_AB = T_INV_LAW_AB_RAW + LAT_MUX;
localparam integer F_SIN_A = FRAC, T_SIN_A = T_ROOT_AB + LAT_MUL3_FAR;
localparam integer F_BEND_SQ = FRAC, T_BEND_SQ = T_COS_A + LAT_MUX;
localparam integer F_BEND_C = FRAC, T_BEND_C = T_SIN_A + LAT_MUX;
localparam integer F_BEND_S = FRAC, T_BEND_S = T_SIN_A + LAT_MUX;
localparam integer T_BEND_SWAP = T_COS_A + LAT_MUX;
localparam integer F_BEND_DIF = FRAC, T_BEND_DIF = T_SIN_A + LAT_MUX;
localparam integer F_BEND_SUM = FRAC, T_BEND_SUM = T_SIN_A + LAT_MUX;

// shoulder quaternion
localparam integer F_SIN_H = FRAC, T_SIN_H = LAT_TRIG;
localparam integer F_COS_H = FRAC, T_COS_H = LAT_TRIG;
localparam integer F_CC = FRAC, T_CC = T_AZ_C + LAT_MUL3;
localparam integer F_SS = FRAC, T_SS = T_AZ_S + LAT_MUL3;
localparam integer F_SC = FRAC, T_SC = T_AZ_S + LAT_MUL3;
localparam integer F_CS = FRAC, T_CS = T_AZ_C + LAT_MUL3;
localparam integer F_C_PLUS = FRAC, T_C_PLUS = T_CC + LAT_MUX;
localparam integer F_S_PLUS = FRAC, T_S_PLUS = T_SC + LAT_MUX;
localparam integer F_C_MINUS = FRAC, T_C_MINUS = T_CC + LAT_MUX;
localparam integer F_S_MINUS = FRAC, T_S_MINUS = T_SC + LAT_MUX;
localparam integer F_W_0 = FRAC, T_W_0 = T_TILT_C + LAT_MUL3_FAR;
localparam integer F_I_0 = FRAC, T_I_0 = T_TILT_S + LAT_MUL3_FAR;
localparam integer F_J_0 = FRAC, T_J_0 = T_TILT_S + LAT_MUL3_FAR;
localparam integer F_K_0 = FRAC, T_K_0 = T_TILT_C + LAT_MUL3_FAR;
localparam integer F_WI_0 = FRAC, T_WI_0 = T_W_0 + LAT_MUX;
localparam integer F_WI_C = FRAC, T_WI_C = T_WI_0 + LAT_MUL3_FAR;
localparam integer F_I_DIF = FRAC, T_I_DIF = T_BEND_DIF + LAT_MUL3_FAR;
localparam integer F_W_1 = FRAC, T_W_1 = T_WI_C + LAT_MUX;
localparam integer F_W_SUM = FRAC, T_W_SUM = T_BEND_SUM + LAT_MUL3_FAR;
localparam integer F_I_1 = FRAC, T_I_1 = T_WI_C + LAT_MUX;
localparam integer F_KJ_0 = FRAC, T_KJ_0 = T_K_0 + LAT_MUX;
localparam integer F_KJ_C = FRAC, T_KJ_C = T_KJ_0 + LAT_MUL3_FAR;
localparam integer F_J_DIF = FRAC, T_J_DIF = T_BEND_DIF + LAT_MUL3_FAR;
localparam integer F_K_1 = FRAC, T_K_1 = T_KJ_C + LAT_MUX;
localparam integer F_K_SUM = FRAC, T_K_SUM = T_BEND_SUM + LAT_MUL3_FAR;
localparam integer F_J_1 = FRAC, T_J_1 = T_KJ_C + LAT_MUX;
localparam integer F_AZ_TILT_SQ = FRAC, T_AZ_TILT_SQ = T_TILT_SQ + LAT_MUL3;
localparam integer F_LENGTH_SQ = FRAC, T_LENGTH_SQ = T_BEND_SQ + LAT_MUL3;
localparam integer T_LOW = T_LENGTH_SQ;
localparam integer T_M_Q = T_LENGTH_SQ + LAT_MUX;
localparam integer F_INV_Q = FRAC, T_INV_Q = T_M_Q + LAT_RSQRT;
localparam integer T_MINUS = T_K_1;
localparam integer F_W_Q = FRAC, T_W_Q = T_INV_Q + LAT_MUL3_FAR;
localparam integer F_QS_W = W - 2, T_QS_W = T_W_Q + LAT_MUX;  // (18)
localparam integer F_I_Q = FRAC, T_I_Q = T_INV_Q + LAT_MUL3_FAR;
localparam integer F_QS_I = W - 2, T_QS_I = T_I_Q + LAT_MUX;  // (18)
localparam integer F_J_Q = FRAC, T_J_Q = T_INV_Q + LAT_MUL3_FAR;
localparam integer F_QS_J = W - 2, T_QS_J = T_J_Q + LAT_MUX;  // (18)
localparam integer F_K_Q = FRAC, T_K_Q = T_INV_Q + LAT_MUL3_FAR;
localparam integer F_QS_K = W - 2, T_QS_K = T_K_Q + LAT_MUX;  // (18)

// All results leave together.
localparam integer T_OUT = T_QS_W;
