// SPDX-License-Identifier: Apache-2.0
// Written by `python -m scripts.generate.headers` from model/dataflow/fold/program.py; do not edit.

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
wire f_carry = step[23];
wire [1:0] f_window = step[25:24];
wire [1:0] f_last = step[27:26];
wire [3:0] f_sign = step[31:28];
wire [2:0] f_norm = step[34:32];
wire [1:0] f_source = step[36:35];
wire [2:0] f_input = step[39:37];
wire [2:0] f_result = step[42:40];
wire [2:0] f_e_set = step[45:43];
wire [2:0] f_n_base = step[48:46];
wire [2:0] f_n_e = step[51:49];
wire [6:0] f_a = step[58:52];
wire [6:0] f_b = step[65:59];
wire f_b_count = step[66];
wire [5:0] f_r = step[72:67];
wire f_a_bend = step[73];
wire f_b_high = step[74];
wire f_limit = step[75];
wire [5:0] f_w = step[81:76];
wire f_n_minus = step[82];
wire f_n_twice = step[83];
wire f_last_input = step[84];
wire f_hold = step[85];
wire f_first_result = step[86];
wire f_last_result = step[87];
