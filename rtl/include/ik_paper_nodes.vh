// SPDX-License-Identifier: Apache-2.0
// Written by `python -m scripts.generate.headers` from model/dataflow/paper.py; do not edit.

// For the body of a module with parameter W. F_<NODE>: fraction bits of the node. T_<NODE>: the clock in
// which it is valid, counted from the clock in which its target is at the datapath's input.
// LAT_<OPERATION>: clocks of an operation.

localparam integer GUARD = 8;  // more fraction bits of a product that waits for its sum
localparam integer LAT_MUL = 4;  // operands, tile products, tile sums, rounding
localparam integer LAT_SUM2 = 2;  // add, round and saturate
localparam integer LAT_SUM3 = 3;  // add, add, round and saturate
localparam integer LAT_NORM = 3;  // magnitudes, leading-zero count, shift
localparam integer LAT_LZC = 2;  // magnitudes, leading-zero count
localparam integer LAT_SHIFT = 2;  // barrel shift: by eights, by ones
localparam integer LAT_MUX = 1;  // an exact addition, a choice, a sign change or a comparison
localparam integer LAT_DIV = W + 2;  // pipelined radix-2 divider: magnitude, one row a quotient bit, sign
localparam integer LAT_ROOT = W;  // pipelined radix-2 square root: one row a result bit, output
localparam integer LAT_SINCOS = W + 1;  // CORDIC: one iteration a bit, rounding

// domain and scale
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
localparam integer F_X_SQ = 2*W - 4, T_X_SQ = LAT_MUL;
localparam integer F_Y_SQ = 2*W - 4, T_Y_SQ = LAT_MUL;
localparam integer F_Z_SQ = 2*W - 4, T_Z_SQ = LAT_MUL;
localparam integer F_R_SQ = 2*W - 4, T_R_SQ = T_R_RAW + LAT_MUL;
localparam integer F_D_SQ = 2*W - 4, T_D_SQ = T_D_RAW + LAT_MUL;
localparam integer F_XY_SQ = 2*W - 4, T_XY_SQ = T_X_SQ + LAT_MUX;
localparam integer F_S_RAW = 2*W - 4, T_S_RAW = T_XY_SQ + LAT_MUX;
localparam integer T_TOO_FAR = T_S_RAW + LAT_MUX;
localparam integer T_TOO_NEAR = T_S_RAW + LAT_MUX;
localparam integer T_CLAMP = T_TOO_FAR + LAT_MUX;
localparam integer T_CLOSED = T_TOO_NEAR + LAT_MUX;
localparam integer T_AWAY = T_TOO_NEAR + LAT_MUX;
localparam integer T_LZ_P = LAT_NORM;
localparam integer F_P_W_Z = W - 1, T_P_W_Z = LAT_NORM;
localparam integer F_P_W_X = W - 1, T_P_W_X = LAT_NORM;
localparam integer F_P_W_Y = W - 1, T_P_W_Y = LAT_NORM;
localparam integer T_LZ_B = LAT_NORM;
localparam integer F_B_X = W - 1, T_B_X = LAT_NORM;
localparam integer F_B_Y = W - 1, T_B_Y = LAT_NORM;
localparam integer T_LZ_R = T_R_RAW + LAT_LZC;
localparam integer F_D_1_SH = W, T_D_1_SH = T_LZ_R + LAT_SHIFT;
localparam integer F_D_1 = W - 1, T_D_1 = T_CLAMP + LAT_MUX;
localparam integer F_D_2_SH = W, T_D_2_SH = T_LZ_R + LAT_SHIFT;
localparam integer F_D_2 = W - 1, T_D_2 = T_CLAMP + LAT_MUX;
localparam integer F_P_A_X_SH = W, T_P_A_X_SH = T_LZ_R + LAT_SHIFT;
localparam integer F_P_A_X = W - 1, T_P_A_X = T_CLAMP + LAT_MUX;
localparam integer F_P_A_Y_SH = W, T_P_A_Y_SH = T_LZ_R + LAT_SHIFT;
localparam integer F_P_A_Y = W - 1, T_P_A_Y = T_CLAMP + LAT_MUX;
localparam integer F_P_A_Z_SH = W, T_P_A_Z_SH = T_LZ_R + LAT_SHIFT;
localparam integer F_P_A_Z = W - 1, T_P_A_Z = T_CLAMP + LAT_MUX;
localparam integer F_D_DIF_SH = W - 1, T_D_DIF_SH = T_LZ_P + LAT_SHIFT;
localparam integer F_D_DIF_J = W - 2, T_D_DIF_J = T_CLAMP + LAT_MUX;
localparam integer T_SCALE_J = T_CLAMP + LAT_MUX;

// 3.1 swivel plane
localparam integer F_S_X = W + GUARD - 2, T_S_X = T_P_W_X + LAT_MUL;  // (10)
localparam integer F_S_Y = W + GUARD - 2, T_S_Y = T_P_W_Y + LAT_MUL;  // (10)
localparam integer F_S_Z = W + GUARD - 2, T_S_Z = T_P_W_Z + LAT_MUL;  // (10)
localparam integer F_S = W - 3, T_S = T_S_X + LAT_SUM3;  // (10)
localparam integer F_L_SW = W - 2, T_L_SW = T_S + LAT_ROOT;  // (10)
localparam integer F_SIN_H = W - 2, T_SIN_H = LAT_SINCOS;  // (11)
localparam integer F_COS_H = W - 2, T_COS_H = LAT_SINCOS;  // (11)
localparam integer F_SIN_PHI = W - 2, T_SIN_PHI = T_SIN_H + LAT_MUL;  // (11)
localparam integer F_COS2_SQ = W + GUARD - 3, T_COS2_SQ = T_COS_H + LAT_MUL;  // (11)
localparam integer F_COS_PHI = W - 2, T_COS_PHI = T_COS2_SQ + LAT_SUM2;  // (11)
localparam integer F_A_X = W - 2, T_A_X = T_P_W_Z + LAT_MUL;  // (11)
localparam integer F_A_Y = W - 2, T_A_Y = T_P_W_Z + LAT_MUL;  // (11)
localparam integer F_RHO_X = W + GUARD - 3, T_RHO_X = T_P_W_X + LAT_MUL;  // (11)
localparam integer F_RHO_Y = W + GUARD - 3, T_RHO_Y = T_P_W_Y + LAT_MUL;  // (11)
localparam integer F_RHO = W - 3, T_RHO = T_RHO_X + LAT_SUM2;  // (11)
localparam integer F_SA_X = W + GUARD - 3, T_SA_X = T_SIN_PHI + LAT_MUL;  // (11)
localparam integer F_SA_Y = W + GUARD - 3, T_SA_Y = T_SIN_PHI + LAT_MUL;  // (11)
localparam integer F_SA_Z = W + GUARD - 3, T_SA_Z = T_SIN_PHI + LAT_MUL;  // (11)
localparam integer F_CB_X = W - 2, T_CB_X = T_COS_PHI + LAT_MUL;  // (11)
localparam integer F_CB_Y = W - 2, T_CB_Y = T_COS_PHI + LAT_MUL;  // (11)
localparam integer F_LCB_X = W + GUARD - 3, T_LCB_X = T_CB_X + LAT_MUL;  // (11)
localparam integer F_LCB_Y = W + GUARD - 3, T_LCB_Y = T_CB_Y + LAT_MUL;  // (11)
localparam integer F_PI_NUM_X = W + GUARD - 3, T_PI_NUM_X = T_LCB_Y + LAT_SUM2;  // (11)
localparam integer F_PI_NUM_Y = W + GUARD - 3, T_PI_NUM_Y = T_LCB_X + LAT_SUM2;  // (11)
localparam integer F_PI_NUM_Z = W + GUARD - 3, T_PI_NUM_Z = T_LCB_Y + LAT_SUM2;  // (11)
localparam integer F_PI_SWIVEL_X = W - 2, T_PI_SWIVEL_X = T_PI_NUM_X + LAT_DIV;  // (11)
localparam integer F_PI_SWIVEL_Y = W - 2, T_PI_SWIVEL_Y = T_PI_NUM_Y + LAT_DIV;  // (11)
localparam integer F_PI_SWIVEL_Z = W - 2, T_PI_SWIVEL_Z = T_PI_NUM_Z + LAT_DIV;  // (11)

// 3.2 elbow point
localparam integer F_D_SUM = W - 1, T_D_SUM = T_D_1 + LAT_MUX;  // (12)
localparam integer F_S_J = W - 3, T_S_J = T_S + LAT_SHIFT;  // (12)
localparam integer F_DD_J = W - 3, T_DD_J = T_D_SUM + LAT_MUL;  // (12)
localparam integer F_K_E = W - 3, T_K_E = T_DD_J + LAT_SUM2;  // (12)
localparam integer F_PP_I = W - 4, T_PP_I = T_PI_SWIVEL_X + LAT_MUL;  // (12)
localparam integer F_PP_J = W - 4, T_PP_J = T_PI_SWIVEL_Y + LAT_MUL;  // (12)
localparam integer F_PP_K = W - 4, T_PP_K = T_PI_SWIVEL_Z + LAT_MUL;  // (12)
localparam integer F_D_1_SQ = W - 1, T_D_1_SQ = T_D_1 + LAT_MUL;  // (12)
localparam integer F_C_1_ZY = W + GUARD - 3, T_C_1_ZY = T_PI_SWIVEL_Y + LAT_MUL;  // (19)
localparam integer F_C_1_YZ = W + GUARD - 3, T_C_1_YZ = T_PI_SWIVEL_Z + LAT_MUL;  // (19)
localparam integer F_PP_1_M = W - 4, T_PP_1_M = T_C_1_ZY + LAT_SUM2;  // (19)
localparam integer F_PP_1_P = W - 4, T_PP_1_P = T_PP_1_M + LAT_MUL;  // (19)
localparam integer F_PP_1_PM = W + GUARD - 6, T_PP_1_PM = T_PP_1_P + LAT_MUL;  // (19)
localparam integer F_C_2_XZ = W + GUARD - 3, T_C_2_XZ = T_PI_SWIVEL_Z + LAT_MUL;  // (19)
localparam integer F_C_2_ZX = W + GUARD - 3, T_C_2_ZX = T_PI_SWIVEL_X + LAT_MUL;  // (19)
localparam integer F_PP_2_M = W - 4, T_PP_2_M = T_C_2_XZ + LAT_SUM2;  // (19)
localparam integer F_PP_2_P = W - 4, T_PP_2_P = T_PP_2_M + LAT_MUL;  // (19)
localparam integer F_PP_2_PM = W + GUARD - 6, T_PP_2_PM = T_PP_2_P + LAT_MUL;  // (19)
localparam integer F_C_3_YX = W + GUARD - 3, T_C_3_YX = T_PI_SWIVEL_X + LAT_MUL;  // (19)
localparam integer F_C_3_XY = W + GUARD - 3, T_C_3_XY = T_PI_SWIVEL_Y + LAT_MUL;  // (19)
localparam integer F_PP_3_M = W - 4, T_PP_3_M = T_C_3_YX + LAT_SUM2;  // (19)
localparam integer F_PP_3_P = W - 4, T_PP_3_P = T_PP_3_M + LAT_MUL;  // (19)
localparam integer F_PP_3_PM = W + GUARD - 6, T_PP_3_PM = T_PP_3_P + LAT_MUL;  // (19)
localparam integer F_PP_1_SQ = W + GUARD - 6, T_PP_1_SQ = T_PP_1_M + LAT_MUL;  // (13)
localparam integer F_PP_2_SQ = W + GUARD - 6, T_PP_2_SQ = T_PP_2_M + LAT_MUL;  // (13)
localparam integer F_PP_3_SQ = W + GUARD - 6, T_PP_3_SQ = T_PP_3_M + LAT_MUL;  // (13)
localparam integer F_INF_PP = W - 6, T_INF_PP = T_PP_1_SQ + LAT_SUM3;  // (13)
localparam integer F_PP_I_SQ = W + GUARD - 6, T_PP_I_SQ = T_PP_I + LAT_MUL;  // (13)
localparam integer F_PP_J_SQ = W + GUARD - 6, T_PP_J_SQ = T_PP_J + LAT_MUL;  // (13)
localparam integer F_PP_K_SQ = W + GUARD - 6, T_PP_K_SQ = T_PP_K + LAT_MUL;  // (13)
localparam integer F_PP_SQ = W + GUARD - 6, T_PP_SQ = T_PP_I_SQ + LAT_SUM3;  // (13)
localparam integer F_PP_PM = W + GUARD - 6, T_PP_PM = T_PP_1_PM + LAT_SUM3;  // (13)
localparam integer F_TMP1 = W - 4, T_TMP1 = T_PP_PM + LAT_SUM2;  // (13)
localparam integer F_TMP_SQR = W - 3, T_TMP_SQR = T_TMP1 + LAT_ROOT;  // (13)
localparam integer T_FLAT = T_TMP1 + LAT_MUX;  // (13)
localparam integer T_BACK = T_K_E + LAT_MUX;  // (13)
localparam integer F_E_X_K = W + GUARD - 6, T_E_X_K = T_PP_2_M + LAT_MUL;  // (13)
localparam integer F_E_X_J = W + GUARD - 6, T_E_X_J = T_PP_3_M + LAT_MUL;  // (13)
localparam integer F_E_X_PP = W + GUARD - 6, T_E_X_PP = T_E_X_K + LAT_SUM2;  // (13)
localparam integer F_E_X_SQR = W + GUARD - 6, T_E_X_SQR = T_TMP_SQR + LAT_MUL;  // (13)
localparam integer F_E_X_NUM = W + GUARD - 6, T_E_X_NUM = T_E_X_SQR + LAT_SUM2;  // (13)
localparam integer F_E_X_QUO = W - 2, T_E_X_QUO = T_E_X_NUM + LAT_DIV;  // (13)
localparam integer F_P_E_X = W - 2, T_P_E_X = T_E_X_QUO + LAT_MUX;  // (13)
localparam integer F_E_Y_I = W + GUARD - 6, T_E_Y_I = T_PP_3_M + LAT_MUL;  // (13)
localparam integer F_E_Y_K = W + GUARD - 6, T_E_Y_K = T_PP_1_M + LAT_MUL;  // (13)
localparam integer F_E_Y_PP = W + GUARD - 6, T_E_Y_PP = T_E_Y_I + LAT_SUM2;  // (13)
localparam integer F_E_Y_SQR = W + GUARD - 6, T_E_Y_SQR = T_TMP_SQR + LAT_MUL;  // (13)
localparam integer F_E_Y_NUM = W + GUARD - 6, T_E_Y_NUM = T_E_Y_SQR + LAT_SUM2;  // (13)
localparam integer F_E_Y_QUO = W - 2, T_E_Y_QUO = T_E_Y_NUM + LAT_DIV;  // (13)
localparam integer F_P_E_Y = W - 2, T_P_E_Y = T_E_Y_QUO + LAT_MUX;  // (13)
localparam integer F_E_Z_J = W + GUARD - 6, T_E_Z_J = T_PP_1_M + LAT_MUL;  // (13)
localparam integer F_E_Z_I = W + GUARD - 6, T_E_Z_I = T_PP_2_M + LAT_MUL;  // (13)
localparam integer F_E_Z_PP = W + GUARD - 6, T_E_Z_PP = T_E_Z_J + LAT_SUM2;  // (13)
localparam integer F_E_Z_SQR = W + GUARD - 6, T_E_Z_SQR = T_TMP_SQR + LAT_MUL;  // (13)
localparam integer F_E_Z_NUM = W + GUARD - 6, T_E_Z_NUM = T_E_Z_SQR + LAT_SUM2;  // (13)
localparam integer F_E_Z_QUO = W - 2, T_E_Z_QUO = T_E_Z_NUM + LAT_DIV;  // (13)
localparam integer F_P_E_Z = W - 2, T_P_E_Z = T_E_Z_QUO + LAT_MUX;  // (13)
localparam integer F_D_E = W - 2, T_D_E = T_L_SW + LAT_MUX;  // (13)

// 3.3 elbow quaternion
localparam integer F_F_X = W - 2, T_F_X = T_P_E_X + LAT_SUM2;  // (14)
localparam integer F_T_X = W + GUARD - 2, T_T_X = T_F_X + LAT_MUL;  // (14)
localparam integer F_F_Y = W - 2, T_F_Y = T_P_E_Y + LAT_SUM2;  // (14)
localparam integer F_T_Y = W + GUARD - 2, T_T_Y = T_F_Y + LAT_MUL;  // (14)
localparam integer F_F_Z = W - 2, T_F_Z = T_P_E_Z + LAT_SUM2;  // (14)
localparam integer F_T_Z = W + GUARD - 2, T_T_Z = T_F_Z + LAT_MUL;  // (14)
localparam integer F_T_E = W, T_T_E = T_T_X + LAT_SUM3;  // (14)
localparam integer F_D_12 = W, T_D_12 = T_D_1 + LAT_MUL;  // (14)
localparam integer F_C4_QUO = W - 2, T_C4_QUO = T_T_E + LAT_DIV;  // (14)
localparam integer F_C4 = W - 2, T_C4 = T_C4_QUO + LAT_MUX;  // (14)
localparam integer T_H4_P = T_C4 + LAT_MUX;  // (14)
localparam integer T_H4_M = T_C4 + LAT_MUX;  // (14)
localparam integer F_QE_W = W - 2, T_QE_W = T_H4_P + LAT_ROOT;  // (14)
localparam integer F_QE_ABS = W - 2, T_QE_ABS = T_H4_M + LAT_ROOT;  // (14)
localparam integer F_QE_I = W - 2, T_QE_I = T_QE_ABS + LAT_MUX;  // (14)

// 3.4 rotate to the elbow position
localparam integer T_LZ_U = T_P_E_X + LAT_NORM;  // (15)
localparam integer F_U_X = W - 1, T_U_X = T_P_E_X + LAT_NORM;  // (15)
localparam integer F_U_Y = W - 1, T_U_Y = T_P_E_X + LAT_NORM;  // (15)
localparam integer F_H = W - 2, T_H = T_P_E_Z + LAT_SUM2;  // (15)
localparam integer F_UH_X = W - 2, T_UH_X = T_U_X + LAT_MUL;  // (15)
localparam integer F_UH_Y = W - 2, T_UH_Y = T_U_Y + LAT_MUL;  // (15)
localparam integer F_UU_X = W + GUARD - 2, T_UU_X = T_U_X + LAT_MUL;  // (15)
localparam integer F_UU_Y = W + GUARD - 2, T_UU_Y = T_U_Y + LAT_MUL;  // (15)
localparam integer F_UU = W - 2, T_UU = T_UU_X + LAT_SUM2;  // (15)
localparam integer F_M_X = W - 2, T_M_X = T_UH_X + LAT_MUX;  // (15)
localparam integer F_M_Y = W - 2, T_M_Y = T_UH_Y + LAT_MUX;  // (15)
localparam integer F_M_Z = W - 2, T_M_Z = T_UU + LAT_MUX;  // (15)
localparam integer T_LZ_M = T_M_Z + LAT_NORM;  // (15)
localparam integer F_L_M_Z = W - 1, T_L_M_Z = T_M_Z + LAT_NORM;  // (15)
localparam integer F_L_M_X = W - 1, T_L_M_X = T_M_Z + LAT_NORM;  // (15)
localparam integer F_L_M_Y = W - 1, T_L_M_Y = T_M_Z + LAT_NORM;  // (15)
localparam integer F_TMP2_X = W + GUARD - 2, T_TMP2_X = T_L_M_X + LAT_MUL;  // (15)
localparam integer F_TMP2_Y = W + GUARD - 2, T_TMP2_Y = T_L_M_Y + LAT_MUL;  // (15)
localparam integer F_TMP2_Z = W + GUARD - 2, T_TMP2_Z = T_L_M_Z + LAT_MUL;  // (15)
localparam integer F_TMP2 = W - 3, T_TMP2 = T_TMP2_X + LAT_SUM3;  // (15)
localparam integer F_L_M = W - 2, T_L_M = T_TMP2 + LAT_ROOT;  // (15)
localparam integer F_Q12_I = W - 2, T_Q12_I = T_L_M + LAT_DIV;  // (15)
localparam integer F_Q12_J = W - 2, T_Q12_J = T_L_M + LAT_DIV;  // (15)
localparam integer F_Q12_K = W - 2, T_Q12_K = T_L_M + LAT_DIV;  // (15)

// 3.5 rotate to the wrist location
localparam integer F_PI_SQ_X = W + GUARD - 3, T_PI_SQ_X = T_PI_SWIVEL_X + LAT_MUL;  // (17)
localparam integer F_PI_SQ_Y = W + GUARD - 3, T_PI_SQ_Y = T_PI_SWIVEL_Y + LAT_MUL;  // (17)
localparam integer F_PI_SQ_Z = W + GUARD - 3, T_PI_SQ_Z = T_PI_SWIVEL_Z + LAT_MUL;  // (17)
localparam integer F_PI_SQ = W - 3, T_PI_SQ = T_PI_SQ_X + LAT_SUM3;  // (17)
localparam integer F_PI_ABS = W - 2, T_PI_ABS = T_PI_SQ + LAT_ROOT;  // (17)
localparam integer F_PI_INV = W - 3, T_PI_INV = T_PI_ABS + LAT_DIV;  // (17)
localparam integer F_Q12_I_SQ = W + GUARD - 2, T_Q12_I_SQ = T_Q12_I + LAT_MUL;  // (17)
localparam integer F_Q12_J_SQ = W + GUARD - 2, T_Q12_J_SQ = T_Q12_J + LAT_MUL;  // (17)
localparam integer F_Q12_K_SQ = W + GUARD - 2, T_Q12_K_SQ = T_Q12_K + LAT_MUL;  // (17)
localparam integer F_R_X = W - 2, T_R_X = T_Q12_K_SQ + LAT_SUM3;  // (17)
localparam integer F_G_Y = W + GUARD - 2, T_G_Y = T_Q12_J + LAT_MUL;  // (17)
localparam integer F_G_Z = W + GUARD - 2, T_G_Z = T_Q12_K + LAT_MUL;  // (17)
localparam integer F_G = W - 2, T_G = T_G_Y + LAT_SUM2;  // (17)
localparam integer F_C3_R = W + GUARD - 2, T_C3_R = T_R_X + LAT_MUL;  // (17)
localparam integer F_C3_G = W + GUARD - 2, T_C3_G = T_G + LAT_MUL;  // (17)
localparam integer F_C3_NUM = W - 2, T_C3_NUM = T_C3_R + LAT_SUM2;  // (17)
localparam integer F_C3 = W - 2, T_C3 = T_C3_NUM + LAT_MUL;  // (17)
localparam integer F_SIDE_X = W - 1, T_SIDE_X = T_FLAT + LAT_MUX;  // (17)
localparam integer F_SIDE_Y = W - 1, T_SIDE_Y = T_FLAT + LAT_MUX;  // (17)
localparam integer F_SIDE_Z = W - 1, T_SIDE_Z = T_FLAT + LAT_MUX;  // (17)
localparam integer F_SG_R = W + GUARD - 2, T_SG_R = T_R_X + LAT_MUL;  // (17)
localparam integer F_SG_Y = W + GUARD - 2, T_SG_Y = T_Q12_J + LAT_MUL;  // (17)
localparam integer F_SG_Z = W + GUARD - 2, T_SG_Z = T_Q12_K + LAT_MUL;  // (17)
localparam integer F_SG = W - 2, T_SG = T_SG_Y + LAT_SUM2;  // (17)
localparam integer F_SG_G = W + GUARD - 2, T_SG_G = T_SG + LAT_MUL;  // (17)
localparam integer F_SIGN = W + GUARD - 2, T_SIGN = T_SG_R + LAT_SUM2;  // (17)
localparam integer T_H3_P = T_C3 + LAT_MUX;  // (17)
localparam integer T_H3_M = T_C3 + LAT_MUX;  // (17)
localparam integer F_Q3_SCALAR = W - 2, T_Q3_SCALAR = T_H3_P + LAT_ROOT;  // (17)
localparam integer F_Q3_ABS = W - 2, T_Q3_ABS = T_H3_M + LAT_ROOT;  // (17)
localparam integer F_Q3_K = W - 2, T_Q3_K = T_Q3_ABS + LAT_MUX;  // (17)
localparam integer F_W_KK = W + GUARD - 2, T_W_KK = T_Q3_K + LAT_MUL;  // (18)
localparam integer F_I_IS = W + GUARD - 2, T_I_IS = T_Q3_SCALAR + LAT_MUL;  // (18)
localparam integer F_I_JK = W + GUARD - 2, T_I_JK = T_Q3_K + LAT_MUL;  // (18)
localparam integer F_J_JS = W + GUARD - 2, T_J_JS = T_Q3_SCALAR + LAT_MUL;  // (18)
localparam integer F_J_IK = W + GUARD - 2, T_J_IK = T_Q3_K + LAT_MUL;  // (18)
localparam integer F_K_KS = W + GUARD - 2, T_K_KS = T_Q3_SCALAR + LAT_MUL;  // (18)
localparam integer F_QS_W = W - 2, T_QS_W = T_W_KK + LAT_SUM2;  // (18)
localparam integer F_QS_I = W - 2, T_QS_I = T_I_JK + LAT_SUM2;  // (18)
localparam integer F_QS_J = W - 2, T_QS_J = T_J_IK + LAT_SUM2;  // (18)
localparam integer F_QS_K = W - 2, T_QS_K = T_K_KS + LAT_SUM2;  // (18)

// All results leave together.
localparam integer T_OUT = T_QS_W;
