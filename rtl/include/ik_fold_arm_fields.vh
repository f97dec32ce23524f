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
wire [1:0] f_rounding = step[57:56];
wire [1:0] f_negative_by = step[59:58];
wire [2:0] f_half_by = step[62:60];
wire [6:0] f_a = step[69:63];
wire [6:0] f_b = step[76:70];
wire f_b_count = step[77];
wire [5:0] f_r = step[83:78];
wire f_a_bend = step[84];
wire f_b_high = step[85];
wire f_limit = step[86];
wire [5:0] f_w = step[92:87];
wire f_n_minus = step[93];
wire f_n_twice = step[94];
wire f_last_input = step[95];
wire f_hold = step[96];
wire f_first_result = step[97];
wire f_last_result = step[98];
wire f_load_x = step[99];
wire f_load_y = step[100];
wire f_opposite = step[101];
wire f_over = step[102];
wire f_again = step[103];
wire f_to_h = step[104];
wire f_less = step[105];
wire f_twice = step[106];
