// SPDX-License-Identifier: Apache-2.0
// Written by `python -m scripts.pages.gen_headers` from model/dataflow/fold/program.py; do not edit.

// For the body of ik_fold: the fields of the step.

wire [1:0] f_a_by = step[1:0];
wire [1:0] f_b_by = step[3:2];
wire [1:0] f_w_by = step[5:4];
wire [1:0] f_s_by = step[7:6];
wire [3:0] f_minus_by = step[11:8];
wire [1:0] f_r_function = step[13:12];
wire [1:0] f_b_place = step[15:14];
wire [2:0] f_cut = step[18:16];
wire [3:0] f_s = step[22:19];
wire [1:0] f_carry = step[24:23];
wire [1:0] f_window = step[26:25];
wire [1:0] f_last = step[28:27];
wire [3:0] f_sign = step[32:29];
wire [2:0] f_norm = step[35:33];
wire [1:0] f_source = step[37:36];
wire [2:0] f_input = step[40:38];
wire [2:0] f_result = step[43:41];
wire [2:0] f_e_set = step[46:44];
wire [2:0] f_n_base = step[49:47];
wire [2:0] f_n_e = step[52:50];
wire [6:0] f_a = step[59:53];
wire [6:0] f_b = step[66:60];
wire f_b_count = step[67];
wire [5:0] f_r = step[73:68];
wire f_a_bend = step[74];
wire f_b_high = step[75];
wire f_limit = step[76];
wire [5:0] f_w = step[82:77];
wire f_n_minus = step[83];
wire f_n_twice = step[84];
wire f_last_input = step[85];
wire f_hold = step[86];
wire f_first_result = step[87];
wire f_last_result = step[88];
