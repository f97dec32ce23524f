// SPDX-License-Identifier: Apache-2.0
// Written by `python -m scripts.generate.headers` from model/dataflow/short.py; do not edit.

// For the body of a module with parameter SHORT. K_<NODE>: lowest bits of the node's word that are 0.

localparam integer K_L_SW = (SHORT != 0) ? 12 : 0;
localparam integer K_SIN_H = (SHORT != 0) ? 7 : 0;
localparam integer K_COS_H = (SHORT != 0) ? 7 : 0;
localparam integer K_PI_SWIVEL_X = (SHORT != 0) ? 7 : 0;
localparam integer K_PI_SWIVEL_Y = (SHORT != 0) ? 8 : 0;
localparam integer K_PI_SWIVEL_Z = (SHORT != 0) ? 7 : 0;
localparam integer K_TMP_SQR = (SHORT != 0) ? 5 : 0;
localparam integer K_E_X_QUO = (SHORT != 0) ? 4 : 0;
localparam integer K_E_Y_QUO = (SHORT != 0) ? 4 : 0;
localparam integer K_E_Z_QUO = (SHORT != 0) ? 5 : 0;
localparam integer K_C4_QUO = (SHORT != 0) ? 7 : 0;
localparam integer K_QE_W = (SHORT != 0) ? 6 : 0;
localparam integer K_QE_ABS = (SHORT != 0) ? 7 : 0;
localparam integer K_L_M = (SHORT != 0) ? 7 : 0;
localparam integer K_Q12_I = (SHORT != 0) ? 7 : 0;
localparam integer K_Q12_J = (SHORT != 0) ? 6 : 0;
localparam integer K_Q12_K = (SHORT != 0) ? 5 : 0;
localparam integer K_PI_ABS = (SHORT != 0) ? 9 : 0;
localparam integer K_PI_INV = (SHORT != 0) ? 7 : 0;
localparam integer K_Q3_SCALAR = (SHORT != 0) ? 6 : 0;
localparam integer K_Q3_ABS = (SHORT != 0) ? 6 : 0;
