// SPDX-License-Identifier: Apache-2.0
// Written by `python -m scripts.generate.headers` from model/dataflow/fold/program.py; do not edit.

// For the body of ik_fold_arm: the fields of the step.

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
wire [2:0] f_source = step[37:35];
wire [3:0] f_input = step[41:38];
wire [4:0] f_result = step[46:42];
wire [2:0] f_e_set = step[49:47];
wire [2:0] f_n_base = step[52:50];
wire [2:0] f_n_e = step[55:53];
wire [1:0] f_again_by = step[57:56];
wire [6:0] f_a = step[64:58];
wire [6:0] f_b = step[71:65];
wire f_b_count = step[72];
wire [5:0] f_r = step[78:73];
wire f_a_bend = step[79];
wire f_b_high = step[80];
wire f_limit = step[81];
wire [5:0] f_w = step[87:82];
wire f_n_minus = step[88];
wire f_n_twice = step[89];
wire f_last_input = step[90];
wire f_hold = step[91];
wire f_first_result = step[92];
wire f_last_result = step[93];
wire f_over = step[94];
wire f_to_h = step[95];
