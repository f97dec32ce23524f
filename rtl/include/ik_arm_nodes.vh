// SPDX-License-Identifier: Apache-2.0
// Written by `python -m scripts.generate.headers` from model/dataflow/arm.py and model/dataflow/lean.py; do not edit.

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
localparam integer LAT_VECTOR = (W + 1) / 2 + ((W < 28) ? W / 2 + 2 : 16);  // CORDIC: one iteration a clock, output
localparam integer LAT_VECTOR_X = (W + 1) / 2;  // the iterations that change its length, output
localparam integer LAT_VECTOR_Y = (W < 28) ? W / 2 + 2 : 16;  // the other iterations
localparam integer LAT_TRIG = (TILE < 18 || FRAC > 23) ? 11 : 8;  // magnitude, a table and u times a slope, as for rsqrt, sign

// exact squares and flags
localparam integer F_HAND_X = W - 2, T_HAND_X = 0;
localparam integer F_HAND_Y = W - 2, T_HAND_Y = 0;
localparam integer F_HAND_Z = W - 2, T_HAND_Z = 0;
localparam integer F_PHI = W - 1, T_PHI = 0;
localparam integer F_D1 = W - 2, T_D1 = 0;
localparam integer F_D2 = W - 2, T_D2 = 0;
localparam integer F_TOOL = W - 2, T_TOOL = 0;
localparam integer F_QH_W = W - 2, T_QH_W = 0;
localparam integer F_QH_I = W - 2, T_QH_I = 0;
localparam integer F_QH_J = W - 2, T_QH_J = 0;
localparam integer F_QH_K = W - 2, T_QH_K = 0;
localparam integer T_BRANCH_SHOULDER = 0;
localparam integer T_BRANCH_ELBOW = 0;
localparam integer T_BRANCH_WRIST = 0;

// wrist target of a hand pose
localparam integer F_HI_SQ = 2*W - 4, T_HI_SQ = LAT_SQUARE;
localparam integer F_HJ_SQ = 2*W - 4, T_HJ_SQ = LAT_SQUARE;
localparam integer F_HK_SQ = 2*W - 4, T_HK_SQ = LAT_SQUARE;
localparam integer F_HW_SQ = 2*W - 4, T_HW_SQ = LAT_SQUARE;
localparam integer F_HIJ_SQ = 2*W - 4, T_HIJ_SQ = T_HI_SQ + LAT_WIDE;
localparam integer F_HIJK_SQ = 2*W - 4, T_HIJK_SQ = T_HIJ_SQ + LAT_WIDE;
localparam integer F_HAND_SQ = 2*W - 4, T_HAND_SQ = T_HIJK_SQ + LAT_WIDE;
localparam integer T_BAD_HAND = T_HAND_SQ + LAT_MUX;
localparam integer F_H_W = W - 2, T_H_W = T_BAD_HAND + LAT_MUX;
localparam integer F_H_I = W - 2, T_H_I = T_BAD_HAND + LAT_MUX;
localparam integer F_H_J = W - 2, T_H_J = T_BAD_HAND + LAT_MUX;
localparam integer F_H_K = W - 2, T_H_K = T_BAD_HAND + LAT_MUX;
localparam integer F_TOOL_H = W - 2, T_TOOL_H = T_BAD_HAND + LAT_MUX;
localparam integer F_H_IK = FRAC, T_H_IK = LAT_MUL3;
localparam integer F_H_WJ = FRAC, T_H_WJ = LAT_MUL3;
localparam integer F_R_X = FRAC, T_R_X = T_H_IK + LAT_MUX;
localparam integer F_H_JK = FRAC, T_H_JK = LAT_MUL3;
localparam integer F_H_WI = FRAC, T_H_WI = LAT_MUL3;
localparam integer F_R_Y = FRAC, T_R_Y = T_H_JK + LAT_MUX;
localparam integer F_H_II = FRAC, T_H_II = LAT_MUL3;
localparam integer F_H_JJ = FRAC, T_H_JJ = LAT_MUL3;
localparam integer F_R_Z = FRAC, T_R_Z = T_H_II + LAT_MUX;
localparam integer F_OFF_X = FRAC, T_OFF_X = T_TOOL_H + LAT_MUL3_FAR;
localparam integer F_X = W - 2, T_X = T_OFF_X + LAT_SUM2;
localparam integer F_OFF_Y = FRAC, T_OFF_Y = T_TOOL_H + LAT_MUL3_FAR;
localparam integer F_Y = W - 2, T_Y = T_OFF_Y + LAT_SUM2;
localparam integer F_OFF_Z = FRAC, T_OFF_Z = T_TOOL_H + LAT_MUL3_FAR;
localparam integer F_Z = W - 2, T_Z = T_OFF_Z + LAT_SUM2;
localparam integer T_SATURATED = T_OFF_X + LAT_SUM2;

// exact squares and flags
localparam integer T_BAD_LENGTH = T_Z + LAT_MUX;
localparam integer T_ON_AXIS = T_X + LAT_MUX;
localparam integer T_AT_SHOULDER = T_X + LAT_MUX;
localparam integer F_D_SUM = W - 2, T_D_SUM = T_Z + LAT_MUX;
localparam integer F_D_DIF = W - 2, T_D_DIF = T_Z + LAT_MUX;
localparam integer F_X_SQ = 2*W - 4, T_X_SQ = T_X + LAT_SQUARE;
localparam integer F_Y_SQ = 2*W - 4, T_Y_SQ = T_Y + LAT_SQUARE;
localparam integer F_Z_SQ = 2*W - 4, T_Z_SQ = T_Z + LAT_SQUARE;
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
localparam integer T_E_1 = T_Z + LAT_EVEN;
localparam integer T_M_1 = T_Z + LAT_EVEN;
localparam integer F_INV_1 = FRAC, T_INV_1 = T_M_1 + LAT_RSQRT_FAR;
localparam integer T_E_2 = T_Z + LAT_EVEN;
localparam integer T_M_2 = T_Z + LAT_EVEN;
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
localparam integer F_SIN_H = FRAC, T_SIN_H = T_Z + LAT_TRIG;
localparam integer F_COS_H = FRAC, T_COS_H = T_Z + LAT_TRIG;
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

// wrist quaternion
localparam integer F_G_WW = FRAC, T_G_WW = T_QS_W + LAT_MUL3_FAR;
localparam integer F_G_II = FRAC, T_G_II = T_QS_I + LAT_MUL3_FAR;
localparam integer F_G_JJ = FRAC, T_G_JJ = T_QS_J + LAT_MUL3_FAR;
localparam integer F_G_KK = FRAC, T_G_KK = T_QS_K + LAT_MUL3_FAR;
localparam integer F_G_W = FRAC, T_G_W = T_G_WW + LAT_SUM2;
localparam integer F_G_WI = FRAC, T_G_WI = T_QS_W + LAT_MUL3_FAR;
localparam integer F_G_IW = FRAC, T_G_IW = T_QS_I + LAT_MUL3_FAR;
localparam integer F_G_JK = FRAC, T_G_JK = T_QS_J + LAT_MUL3_FAR;
localparam integer F_G_KJ = FRAC, T_G_KJ = T_QS_K + LAT_MUL3_FAR;
localparam integer F_G_I = FRAC, T_G_I = T_G_WI + LAT_SUM2;
localparam integer F_G_WJ = FRAC, T_G_WJ = T_QS_W + LAT_MUL3_FAR;
localparam integer F_G_JW = FRAC, T_G_JW = T_QS_J + LAT_MUL3_FAR;
localparam integer F_G_KI = FRAC, T_G_KI = T_QS_K + LAT_MUL3_FAR;
localparam integer F_G_IK = FRAC, T_G_IK = T_QS_I + LAT_MUL3_FAR;
localparam integer F_G_J = FRAC, T_G_J = T_G_WJ + LAT_SUM2;
localparam integer F_G_WK = FRAC, T_G_WK = T_QS_W + LAT_MUL3_FAR;
localparam integer F_G_KW = FRAC, T_G_KW = T_QS_K + LAT_MUL3_FAR;
localparam integer F_G_IJ = FRAC, T_G_IJ = T_QS_I + LAT_MUL3_FAR;
localparam integer F_G_JI = FRAC, T_G_JI = T_QS_J + LAT_MUL3_FAR;
localparam integer F_G_K = FRAC, T_G_K = T_G_WK + LAT_SUM2;
localparam integer F_F_WW = FRAC, T_F_WW = T_G_W + LAT_MUL3_FAR;
localparam integer F_F_WI = FRAC, T_F_WI = T_G_I + LAT_MUL3_FAR;
localparam integer F_QW_W = W - 2, T_QW_W = T_F_WW + LAT_SUM2;
localparam integer F_F_II = FRAC, T_F_II = T_G_I + LAT_MUL3_FAR;
localparam integer F_F_IW = FRAC, T_F_IW = T_G_W + LAT_MUL3_FAR;
localparam integer F_QW_I = W - 2, T_QW_I = T_F_II + LAT_SUM2;
localparam integer F_F_JJ = FRAC, T_F_JJ = T_G_J + LAT_MUL3_FAR;
localparam integer F_F_JK = FRAC, T_F_JK = T_G_K + LAT_MUL3_FAR;
localparam integer F_QW_J = W - 2, T_QW_J = T_F_JJ + LAT_SUM2;
localparam integer F_F_KK = FRAC, T_F_KK = T_G_K + LAT_MUL3_FAR;
localparam integer F_F_KJ = FRAC, T_F_KJ = T_G_J + LAT_MUL3_FAR;
localparam integer F_QW_K = W - 2, T_QW_K = T_F_KK + LAT_SUM2;

// angles
localparam integer T_QS_IJ = T_QW_K + LAT_VECTOR_X;
localparam integer F_QS_D = W + 3, T_QS_D = T_QS_IJ + LAT_VECTOR_Y;
localparam integer T_QS_WK = T_QW_K + LAT_VECTOR_X;
localparam integer F_QS_S = W + 3, T_QS_S = T_QS_WK + LAT_VECTOR_Y;
localparam integer F_QS_B = W + 3, T_QS_B = T_QS_WK + LAT_VECTOR;
localparam integer F_TH1 = W - 1, T_TH1 = T_QS_S + LAT_SUM2;
localparam integer F_TH3 = W - 1, T_TH3 = T_QS_S + LAT_SUM2;
localparam integer F_TH2 = W - 1, T_TH2 = T_QS_B + LAT_MUX;
localparam integer F_QE_E = W + 3, T_QE_E = T_QW_K + LAT_VECTOR;
localparam integer F_TH4 = W - 1, T_TH4 = T_QE_E + LAT_MUX;
localparam integer T_QW_IJ = T_QW_I + LAT_VECTOR_X;
localparam integer F_QW_D = W + 3, T_QW_D = T_QW_IJ + LAT_VECTOR_Y;
localparam integer T_QW_WK = T_QW_W + LAT_VECTOR_X;
localparam integer F_QW_S = W + 3, T_QW_S = T_QW_WK + LAT_VECTOR_Y;
localparam integer F_QW_B = W + 3, T_QW_B = T_QW_WK + LAT_VECTOR;
localparam integer F_TH5 = W - 1, T_TH5 = T_QW_S + LAT_SUM2;
localparam integer F_TH7 = W - 1, T_TH7 = T_QW_S + LAT_SUM2;
localparam integer F_TH6 = W - 1, T_TH6 = T_QW_B + LAT_MUX;
localparam integer T_OVER_1 = T_TH1 + LAT_MUX;
localparam integer T_OVER_2 = T_TH2 + LAT_MUX;
localparam integer T_OVER_3 = T_TH3 + LAT_MUX;
localparam integer T_OVER_4 = T_TH4 + LAT_MUX;
localparam integer T_OVER_5 = T_TH5 + LAT_MUX;
localparam integer T_OVER_6 = T_TH6 + LAT_MUX;
localparam integer T_OVER_7 = T_TH7 + LAT_MUX;

// All results leave together.
localparam integer T_OUT = T_OVER_2;
