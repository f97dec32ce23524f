// SPDX-License-Identifier: Apache-2.0
// Written by `python -m scripts.pages.gen_headers` from model/dataflow/lean.py; do not edit.

// For the body of a module with parameter W. F_<NODE>: fraction bits of the node. T_<NODE>: the clock in
// which it is valid, counted from the clock in which its target stands at the datapath's input.
// LAT_<OPERATION>: clocks of an operation.

localparam integer FRAC = (W < 16) ? 21 : ((W < 28) ? W + 5 : 33);  // of an inner word
localparam integer ROOT_FRAC = (W < 19) ? 21 : ((FRAC < 31) ? FRAC : 31);
localparam integer LAT_SUM2 = 2;  // add, round and saturate
localparam integer LAT_SHIFT = 2;  // barrel shift: by eights, by ones
localparam integer LAT_MUX = 1;  // an exact addition, a choice, a sign change or a comparison
localparam integer LAT_MUL3 = 4;  // operands, three tile products, tile sums, rounded sum
localparam integer LAT_SQUARE = 5;  // operands, tile products, tile sums, lower half, upper half
localparam integer LAT_WIDE = 2;  // lower half, upper half
localparam integer LAT_EVEN = 3;  // zero pairs in groups, shift by groups, shift by pairs
localparam integer LAT_SHIFT3 = 3;  // barrel shift: by sixteens, by fours, by ones
localparam integer LAT_RSQRT = (ROOT_FRAC > 21) ? 11 : 5;  // table and two multiplications; beyond 21 fraction bits a Newton step
localparam integer LAT_TRIG = 10;  // table, Taylor series of the rest, addition theorem

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
localparam integer F_R_RAW = W - 2, T_R_RAW = LAT_MUX;
localparam integer F_D_RAW = W - 2, T_D_RAW = LAT_MUX;
localparam integer F_X_SQ = 2*W - 4, T_X_SQ = LAT_SQUARE;
localparam integer F_Y_SQ = 2*W - 4, T_Y_SQ = LAT_SQUARE;
localparam integer F_Z_SQ = 2*W - 4, T_Z_SQ = LAT_SQUARE;
localparam integer F_R_SQ = 2*W - 4, T_R_SQ = T_R_RAW + LAT_SQUARE;
localparam integer F_D_SQ = 2*W - 4, T_D_SQ = T_D_RAW + LAT_SQUARE;
localparam integer F_RD = 2*W - 4, T_RD = T_R_RAW + LAT_SQUARE;
localparam integer F_RHO_SQ = 2*W - 4, T_RHO_SQ = T_X_SQ + LAT_WIDE;
localparam integer F_S = 2*W - 4, T_S = T_RHO_SQ + LAT_WIDE;
localparam integer F_A_FAR = 2*W - 4, T_A_FAR = T_S + LAT_WIDE;
localparam integer F_B_NEAR = 2*W - 4, T_B_NEAR = T_S + LAT_WIDE;
localparam integer F_K_LAW = 2*W - 4, T_K_LAW = T_S + LAT_WIDE;
localparam integer T_TOO_FAR = T_A_FAR + LAT_MUX;
localparam integer T_TOO_NEAR = T_B_NEAR + LAT_MUX;
localparam integer T_CLAMP = T_TOO_FAR + LAT_MUX;
localparam integer T_FOLD = T_TOO_NEAR + LAT_MUX;
localparam integer T_AWAY = T_TOO_NEAR + LAT_MUX;

// azimuth and elevation
localparam integer T_E_RHO = T_RHO_SQ + LAT_EVEN;  // (10)
localparam integer T_M_RHO = T_RHO_SQ + LAT_EVEN;  // (10)
localparam integer F_INV_RHO = FRAC, T_INV_RHO = T_M_RHO + LAT_RSQRT;  // (10)
localparam integer T_E_S = T_S + LAT_EVEN;  // (10)
localparam integer T_M_S = T_S + LAT_EVEN;  // (10)
localparam integer F_INV_S = FRAC, T_INV_S = T_M_S + LAT_RSQRT;  // (10)
localparam integer F_X_N = ((W < 16) ? 16 : W), T_X_N = T_E_RHO + LAT_SHIFT;  // (10)
localparam integer F_Y_N = ((W < 16) ? 16 : W), T_Y_N = T_E_RHO + LAT_SHIFT;  // (10)
localparam integer F_Z_N = ((W < 16) ? 16 : W), T_Z_N = T_E_S + LAT_SHIFT;  // (10)
localparam integer F_U_X = FRAC, T_U_X = T_INV_RHO + LAT_MUL3;  // (10)
localparam integer F_U_Y = FRAC, T_U_Y = T_INV_RHO + LAT_MUL3;  // (10)
localparam integer F_SIN_EL = FRAC, T_SIN_EL = T_INV_S + LAT_MUL3;  // (10)
localparam integer F_L_RHO = FRAC, T_L_RHO = T_INV_RHO + LAT_MUL3;  // (10)
localparam integer T_N_EL = T_E_S + LAT_MUX;  // (10)
localparam integer F_INV_S_EL = FRAC, T_INV_S_EL = T_INV_S + LAT_SHIFT;  // (10)
localparam integer F_COS_EL = FRAC, T_COS_EL = T_L_RHO + LAT_MUL3;  // (10)
localparam integer F_G_1 = FRAC, T_G_1 = T_U_Y + LAT_MUX;  // (11)
localparam integer F_H1_C = FRAC, T_H1_C = T_G_1 + LAT_MUX;  // (11)
localparam integer F_H1_S = FRAC, T_H1_S = T_G_1 + LAT_MUX;  // (11)
localparam integer F_G_T = FRAC, T_G_T = T_SIN_EL + LAT_MUX;  // (11)
localparam integer F_HT_C = FRAC, T_HT_C = T_COS_EL + LAT_MUX;  // (11)
localparam integer F_HT_S = FRAC, T_HT_S = T_COS_EL + LAT_MUX;  // (11)

// shoulder angle, elbow
localparam integer T_E_A = T_A_FAR + LAT_EVEN;  // (14)
localparam integer T_M_A = T_A_FAR + LAT_EVEN;  // (14)
localparam integer F_INV_A = FRAC, T_INV_A = T_M_A + LAT_RSQRT;  // (14)
localparam integer T_E_B = T_B_NEAR + LAT_EVEN;  // (14)
localparam integer T_M_B = T_B_NEAR + LAT_EVEN;  // (14)
localparam integer F_INV_B = FRAC, T_INV_B = T_M_B + LAT_RSQRT;  // (14)
localparam integer T_E_1 = LAT_EVEN;  // (14)
localparam integer T_M_1 = LAT_EVEN;  // (14)
localparam integer F_INV_1 = FRAC, T_INV_1 = T_M_1 + LAT_RSQRT;  // (14)
localparam integer T_E_2 = LAT_EVEN;  // (14)
localparam integer T_M_2 = LAT_EVEN;  // (14)
localparam integer F_INV_2 = FRAC, T_INV_2 = T_M_2 + LAT_RSQRT;  // (14)
localparam integer F_L_A = FRAC, T_L_A = T_INV_A + LAT_MUL3;  // (14)
localparam integer F_L_B = FRAC, T_L_B = T_INV_B + LAT_MUL3;  // (14)
localparam integer F_INV_12 = FRAC + 1, T_INV_12 = T_INV_1 + LAT_MUL3;  // (14)
localparam integer T_N_A = T_E_A + LAT_MUX;  // (14)
localparam integer F_V_A_RAW = FRAC, T_V_A_RAW = (T_INV_12 > T_N_A ? T_INV_12 : T_N_A) + LAT_SHIFT;  // (14)
localparam integer F_V_A = FRAC, T_V_A = T_V_A_RAW;  // (14)
localparam integer F_EL_A = FRAC, T_EL_A = T_L_A + LAT_MUL3;  // (14)
localparam integer T_N_B = T_E_B + LAT_MUX;  // (14)
localparam integer F_V_B_RAW = FRAC, T_V_B_RAW = (T_INV_12 > T_N_B ? T_INV_12 : T_N_B) + LAT_SHIFT;  // (14)
localparam integer F_V_B = FRAC, T_V_B = T_V_B_RAW;  // (14)
localparam integer F_EL_B = FRAC, T_EL_B = T_L_B + LAT_MUL3;  // (14)
localparam integer F_QE_W = W - 2, T_QE_W = T_EL_A + LAT_MUX;  // (14)
localparam integer F_QE_I = W - 2, T_QE_I = T_EL_B + LAT_MUX;  // (14)
localparam integer F_INV_11 = FRAC, T_INV_11 = T_INV_1 + LAT_MUL3;  // (13)
localparam integer F_T_A_RAW = FRAC, T_T_A_RAW = T_INV_S + LAT_MUL3;  // (13)
localparam integer F_T_A = FRAC, T_T_A = T_T_A_RAW;  // (13)
localparam integer T_N_K = T_E_S + LAT_MUX;  // (13)
localparam integer F_K_T = FRAC, T_K_T = T_N_K + LAT_SHIFT3;  // (13)
localparam integer F_COS_A = FRAC, T_COS_A = T_T_A + LAT_MUL3;  // (13)
localparam integer F_L_AB = FRAC, T_L_AB = T_L_A + LAT_MUL3;  // (13)
localparam integer T_N_AB = T_E_A + LAT_SUM2;  // (13)
localparam integer F_V_AB_RAW = FRAC, T_V_AB_RAW = T_T_A + LAT_SHIFT;  // (13)
localparam integer F_V_AB = FRAC, T_V_AB = T_V_AB_RAW;  // (13)
localparam integer F_SIN_A = FRAC, T_SIN_A = T_L_AB + LAT_MUL3;  // (13)
localparam integer F_G_A = FRAC, T_G_A = T_COS_A + LAT_MUX;  // (13)
localparam integer F_HA_C = FRAC, T_HA_C = T_SIN_A + LAT_MUX;  // (13)
localparam integer F_HA_S = FRAC, T_HA_S = T_SIN_A + LAT_MUX;  // (13)

// shoulder quaternion
localparam integer F_SIN_H = FRAC, T_SIN_H = LAT_TRIG;  // (17)
localparam integer F_COS_H = FRAC, T_COS_H = LAT_TRIG;  // (17)
localparam integer F_CC = FRAC, T_CC = T_H1_C + LAT_MUL3;  // (17)
localparam integer F_SS = FRAC, T_SS = T_H1_S + LAT_MUL3;  // (17)
localparam integer F_SC = FRAC, T_SC = T_H1_S + LAT_MUL3;  // (17)
localparam integer F_CS = FRAC, T_CS = T_H1_C + LAT_MUL3;  // (17)
localparam integer F_C_P = FRAC, T_C_P = T_CC + LAT_MUX;  // (17)
localparam integer F_C_M = FRAC, T_C_M = T_CC + LAT_MUX;  // (17)
localparam integer F_S_P = FRAC, T_S_P = T_SC + LAT_MUX;  // (17)
localparam integer F_S_M = FRAC, T_S_M = T_SC + LAT_MUX;  // (17)
localparam integer F_W_0 = FRAC, T_W_0 = T_C_P + LAT_MUL3;  // (17)
localparam integer F_I_0 = FRAC, T_I_0 = T_C_M + LAT_MUL3;  // (17)
localparam integer F_J_0 = FRAC, T_J_0 = T_S_M + LAT_MUL3;  // (17)
localparam integer F_K_0 = FRAC, T_K_0 = T_S_P + LAT_MUL3;  // (17)
localparam integer F_W_C = FRAC, T_W_C = T_HA_C + LAT_MUL3;  // (18)
localparam integer F_W_S = FRAC, T_W_S = T_HA_S + LAT_MUL3;  // (18)
localparam integer F_I_C = FRAC, T_I_C = T_HA_C + LAT_MUL3;  // (18)
localparam integer F_I_S = FRAC, T_I_S = T_HA_S + LAT_MUL3;  // (18)
localparam integer F_J_C = FRAC, T_J_C = T_HA_C + LAT_MUL3;  // (18)
localparam integer F_J_S = FRAC, T_J_S = T_HA_S + LAT_MUL3;  // (18)
localparam integer F_K_C = FRAC, T_K_C = T_HA_C + LAT_MUL3;  // (18)
localparam integer F_K_S = FRAC, T_K_S = T_HA_S + LAT_MUL3;  // (18)
localparam integer F_W_1 = FRAC, T_W_1 = T_W_C + LAT_MUX;  // (18)
localparam integer F_I_1 = FRAC, T_I_1 = T_I_C + LAT_MUX;  // (18)
localparam integer F_J_1 = FRAC, T_J_1 = T_J_C + LAT_MUX;  // (18)
localparam integer F_K_1 = FRAC, T_K_1 = T_K_C + LAT_MUX;  // (18)
localparam integer F_G_1T = FRAC, T_G_1T = T_G_T + LAT_MUL3;  // (18)
localparam integer F_LENGTH_SQ = FRAC, T_LENGTH_SQ = T_G_1T + LAT_MUL3;  // (18)
localparam integer T_LOW = T_LENGTH_SQ;  // (18)
localparam integer T_M_Q = T_LENGTH_SQ + LAT_MUX;  // (18)
localparam integer F_INV_Q = FRAC, T_INV_Q = T_M_Q + LAT_RSQRT;  // (18)
localparam integer T_MINUS = T_K_1;  // (18)
localparam integer F_W_N = FRAC, T_W_N = T_W_1 + LAT_MUX;  // (18)
localparam integer F_W_Q = FRAC, T_W_Q = (T_W_N > T_INV_Q ? T_W_N : T_INV_Q) + LAT_MUL3;  // (18)
localparam integer F_QS_W = W - 2, T_QS_W = T_W_Q + LAT_MUX;  // (18)
localparam integer F_I_N = FRAC, T_I_N = T_I_1 + LAT_MUX;  // (18)
localparam integer F_I_Q = FRAC, T_I_Q = (T_I_N > T_INV_Q ? T_I_N : T_INV_Q) + LAT_MUL3;  // (18)
localparam integer F_QS_I = W - 2, T_QS_I = T_I_Q + LAT_MUX;  // (18)
localparam integer F_J_N = FRAC, T_J_N = T_J_1 + LAT_MUX;  // (18)
localparam integer F_J_Q = FRAC, T_J_Q = (T_J_N > T_INV_Q ? T_J_N : T_INV_Q) + LAT_MUL3;  // (18)
localparam integer F_QS_J = W - 2, T_QS_J = T_J_Q + LAT_MUX;  // (18)
localparam integer F_K_N = FRAC, T_K_N = T_K_1 + LAT_MUX;  // (18)
localparam integer F_K_Q = FRAC, T_K_Q = (T_K_N > T_INV_Q ? T_K_N : T_INV_Q) + LAT_MUL3;  // (18)
localparam integer F_QS_K = W - 2, T_QS_K = T_K_Q + LAT_MUX;  // (18)

// All results leave together.
localparam integer T_OUT = T_QS_W;
