// SPDX-License-Identifier: Apache-2.0
// Written by `python -m scripts.generate.headers` from model/dataflow/fold/schedule.json and model/dataflow/lean.py; do not edit.

// For the body of ik_fold: the program. The lap, 0 a target's own, 1 the next, in which the datapath may
// stall before the target's first result (HOLD_LAP), writes it (FIRST_LAP) and writes the last (LAST_LAP).

localparam integer PERIOD = 88;  // clocks of a lap
localparam [6:0] END = 7'd87;  // the last of them
localparam integer HOLD_LAP = 0;
localparam integer FIRST_LAP = 1;
localparam integer LAST_LAP = 1;

(* rom_style = "block", ram_style = "block" *)
reg [STEP_W-1:0] rom[0:PERIOD-1];
initial begin
  rom[0] = 88'h40c000693005b800c80100;  // d2 loaded; -> qe_w; elbow_i: root_near * inv_12_near
  rom[1] = 88'h00d00000000098003a0700;  // d1 loaded
  rom[2] = 88'h00e00210d0000808020100;  // d1/2: d1 * 1/2; -> inv_q'
  rom[3] = 88'h011000a0e0000890220100;  // -> k_1; inv_q: inv_q' * m_q
  rom[4] = 88'h0130a210c0000800004000;  // d_sum: d2 * 1/2; -> j_1
  rom[5] = 88'h00e00210c0061800080000;  // x loaded; d_dif: d2 * 1/2; -> qe_i
  rom[6] = 88'h00f00070e0005800d50100;  // z loaded; x_sq: x * x
  rom[7] = 88'h01000210d0003800300000;  // y loaded; d1: d1 * 1/2
  rom[8] = 88'h0140008100000806800100;  // rho_sq: y * y; -> inv_q
  rom[9] = 88'h00d000a110000801080000;  // -> d_sum; k_q: k_1 * inv_q
  rom[10] = 88'h01100078f0000831080000;  // -> d_dif; s: z * z
  rom[11] = 88'h112000a130007800300000;  // phi loaded; j_q: j_1 * inv_q
  rom[12] = 88'h00000068d00003102b0800;  // a_far: d_sum * d_sum
  rom[13] = 88'h0000008910000100300000;  // b_near: d_dif * d_dif
  rom[14] = 88'h01300088d02c10012b0800;  // -> m_1; k_law: d_sum * d_dif; -> qs_k
  rom[15] = 88'h00d000a160081100300100;  // -> m_rho; i_q: i_1 * inv_q
  rom[16] = 88'h000068a150030001800100;  // -> qs_j; w_q: w_1 * inv_q
  rom[17] = 88'h091098680b101240000000;  // -> m_s; inv_rho': c2 * m_rho
  rom[18] = 88'h00066898040001502b4800;  // inv_1': c2 * m_1
  rom[19] = 88'h01469a09001814002b4800;  // -> m_far; y_n: y * 1
  rom[20] = 88'h0100020920221001c80100;  // -> m_near; |phi|: phi * 1; -> qs_i
  rom[21] = 88'h81208a10c0011001c80100;  // -> k_scaled; d2: d2 * 1/2; -> qs_w
  rom[22] = 88'h00c0008800000808080000;  // -> inv_rho'; inv_s': c2 * m_s
  rom[23] = 88'h01568a08e2800808884300;  // -> inv_1'; x_n: x * 1
  rom[24] = 88'h00000068c0000400080000;  // inv_rho: inv_rho' * m_rho
  rom[25] = 88'h00c0680000000800c84100;  // -> |phi|
  rom[26] = 88'h00e0809950001320080000;  // -> y_n; inv_1: inv_1' * m_1
  rom[27] = 88'h0150988002800808d54100;  // -> inv_s'; inv_near': c2 * m_near
  rom[28] = 88'h01368208f0301400004000;  // -> m_2; z_n: z * 1
  rom[29] = 88'h00f0008950000804d50100;  // -> inv_rho; inv_s: inv_s' * m_s
  rom[30] = 88'h0150880000001000c84100;  // -> x_n
  rom[31] = 88'h01109878e0000804080000;  // -> inv_1; u_y: y_n * inv_rho
  rom[32] = 88'h00e0a09804800808d50100;  // -> inv_near'; inv_2': c2 * m_2
  rom[33] = 88'h000698a000000400004000;  // inv_far': c2 * m_far
  rom[34] = 88'h0166a07950000804124000;  // -> inv_s; u_x: x_n * inv_rho
  rom[35] = 88'h01506068f0001000c80100;  // -> z_n; root_rho: inv_rho * m_rho
  rom[36] = 88'h00d0606000000860c81100;  // -> u_y; |sin_h|': c2 * |phi|
  rom[37] = 88'h00f660600000080812a000;  // -> inv_2'; cos_h': c2 * |phi|
  rom[38] = 88'h01766080e0000808129000;  // -> inv_far'; inv_near: inv_near' * m_near
  rom[39] = 88'h00e08098f0000800c86100;  // -> u_x; inv_2: inv_2' * m_2
  rom[40] = 88'h00f0988910000800c04000;  // -> root_rho; inv_11: inv_1 * inv_1
  rom[41] = 88'h013000a170000808d50100;  // -> |sin_h|'; inv_far: inv_far' * m_far
  rom[42] = 88'h0170a06130000808d54100;  // -> cos_h'; |sin_h|: |sin_h|' * |phi|
  rom[43] = 88'h01306210d0000804128000;  // -> inv_near; az_sq: u_y * 1/2
  rom[44] = 88'h00d0008132400804d51100;  // -> inv_2; root_near: inv_near * m_near
  rom[45] = 88'h050000b154000800d60000;  // -> inv_11; sin_el: z_n * inv_s
  rom[46] = 88'h01300401600008045c0400;  // -> inv_far; inv_s_el: inv_s * 2^-n
  rom[47] = 88'h015000617000080d120000;  // -> |sin_h|; cos_h: cos_h' * |phi|
  rom[48] = 88'h001060a130000800128010;  // -> az_c+1 (u_y<0); root_far: inv_far * m_far
  rom[49] = 88'h01300210e0000800892200;  // -> root_near; u_x/2: u_x * 1/2
  rom[50] = 88'h002000b100000870d60100;  // -> sin_el; inv_law_raw: inv_11 * inv_s
  rom[51] = 88'h00c0020950000800120000;  // -> inv_s_el; sin_h: |sin_h| * 1
  rom[52] = 88'h00e0021026c0080d640042;  // -> cos_h; tilt_sq: sin_el (at_shoulder) * 1/2
  rom[53] = 88'h01000060f80008001b0000;  // -> root_far; cos_el: root_rho * inv_s_el
  rom[54] = 88'h0c0000990a000800880310;  // -> az_c (u_y<0); root_ab: root_far * root_near
  rom[55] = 88'h04c80070040008015c0580;  // -> inv_law; cc: az_c * cos_h
  rom[56] = 88'h00f00400c00008001b0000;  // -> sin_h; inv_law_ab_raw: inv_law * 2^-n
  rom[57] = 88'h0040007810000800120020;  // -> tilt_c (sin_el<0); c_plus: az_c+1 * sin_h
  rom[58] = 88'h0140007810000801120000;  // -> cos_el; c_minus: az_c+1 * sin_h
  rom[59] = 88'h0150006120000800890200;  // -> root_ab; cos_a: k_scaled * inv_law
  rom[60] = 88'h00000211400000003a0100;  // cos_el/2: cos_el * 1/2
  rom[61] = 88'h00c8006910000801020000;  // -> inv_law_ab; inv_12_raw: inv_1 * inv_2
  rom[62] = 88'h00d00070100008001b0000;  // -> c_plus; sc: az_c+1 * cos_h
  rom[63] = 88'h00e00061500008000c0000;  // -> c_minus; sin_a: root_ab * inv_law_ab
  rom[64] = 88'h00600078000008811b0000;  // -> cos_a; s_plus: az_c * sin_h
  rom[65] = 88'h0050007800000800120020;  // -> tilt_c+1 (sin_el<0); s_minus: az_c * sin_h
  rom[66] = 88'h00c80068400008011b0000;  // -> inv_12; w_0: tilt_c * c_plus
  rom[67] = 88'h00000020100000003a0005;  // az_tilt_sq: az_c+1 (u_y<0) * tilt_c (sin_el<0)
  rom[68] = 88'h0080007056c00801020100;  // -> sin_a; wi_0: tilt_c+1 * c_minus
  rom[69] = 88'h04d002108a000800120003;  // -> s_plus; sin_a/2: sin_a (clamp) * 1/2
  rom[70] = 88'h04f002106c000800120003;  // -> s_minus; bend_sq: cos_a (clamp) * 1/2
  rom[71] = 88'h01100400c00008003a0000;  // -> w_0; inv_12_far_raw: inv_12 * 2^-n
  rom[72] = 88'h01200210800008000c0003;  // -> az_tilt_sq; bend_dif: sin_a (clamp) * 1/2
  rom[73] = 88'h01400210800008005c06c3;  // -> wi_0; bend_sum: sin_a (clamp) * 1/2
  rom[74] = 88'h00b0007050000800890230;  // -> bend_c+1 (bend_swap); i_0: tilt_c+1 * c_minus
  rom[75] = 88'h00a0006840000800b40130;  // -> bend_c (bend_swap); k_0: tilt_c * s_plus
  rom[76] = 88'h00d8005120000801040008;  // -> inv_12_far; length_sq: az_tilt_sq * bend_c (bend_swap)
  rom[77] = 88'h00e0007850000800120000;  // -> bend_dif; kj_0: tilt_c+1 * s_minus
  rom[78] = 88'h0120005140000800120000;  // -> bend_sum; wi_c: wi_0 * bend_c
  rom[79] = 88'h0140007858c00800120000;  // -> i_0; j_0: tilt_c+1 * s_minus
  rom[80] = 88'h04f000714a0008003a0000;  // -> k_0; w_1: i_0 * bend_dif
  rom[81] = 88'h040000911c000500120000;  // i_1: w_0 * bend_sum
  rom[82] = 88'h01100400c0000800120000;  // -> kj_0; inv_12_near_raw: inv_12 * 2^-n
  rom[83] = 88'h01400069003810003a0700;  // -> m_q; elbow_w: root_far * inv_12_far
  rom[84] = 88'h00c0a05110000800020100;  // -> j_0; kj_c: kj_0 * bend_c
  rom[85] = 88'h015000a000000800890200;  // -> w_1; inv_q': c2 * m_q
  rom[86] = 88'h0166a070c0000800224000;  // -> i_1; k_1: j_0 * bend_dif
  rom[87] = 88'h20d80090f0000801120000;  // -> inv_12_near; j_1: k_0 * bend_sum
end
