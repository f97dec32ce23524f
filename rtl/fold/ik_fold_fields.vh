// SPDX-License-Identifier: Apache-2.0
// Written by `python -m scripts.pages.gen_headers` from model/dataflow/fold/program.py; do not edit.

// For the body of ik_fold: the fields of the step.

wire [3:0] f_a_by = step[3:0];
wire [3:0] f_b_by = step[7:4];
wire [3:0] f_w_by = step[11:8];
wire [3:0] f_s_by = step[15:12];
wire [3:0] f_minus_by = step[19:16];
wire [1:0] f_r_function = step[21:20];
wire [1:0] f_b_place = step[23:22];
wire [2:0] f_cut = step[26:24];
wire [3:0] f_s = step[30:27];
wire [1:0] f_carry = step[32:31];
wire [1:0] f_window = step[34:33];
wire [1:0] f_last = step[36:35];
wire [3:0] f_sign = step[40:37];
wire [2:0] f_norm = step[43:41];
wire [1:0] f_source = step[45:44];
wire [2:0] f_input = step[48:46];
wire [2:0] f_result = step[51:49];
wire [2:0] f_e_set = step[54:52];
wire [2:0] f_n_base = step[57:55];
wire [2:0] f_n_e = step[60:58];
wire [6:0] f_a = step[67:61];
wire [6:0] f_b = step[74:68];
wire f_b_count = step[75];
wire [5:0] f_r = step[81:76];
wire f_a_bend = step[82];
wire f_b_high = step[83];
wire f_limit = step[84];
wire [5:0] f_w = step[90:85];
wire f_n_minus = step[91];
wire f_n_twice = step[92];
wire f_last_input = step[93];
wire f_hold = step[94];
wire f_first_result = step[95];
wire f_last_result = step[96];
