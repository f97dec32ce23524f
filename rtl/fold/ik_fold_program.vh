// SPDX-License-Identifier: Apache-2.0
// Written by `python -m scripts.pages.gen_headers` from model/dataflow/fold/schedule.json and model/dataflow/lean.py; do not edit.

// For the body of ik_fold: the program. HOLD_, FIRST_ and LAST_LAP: the lap of a target, its own or the next
// where the machine may wait before the first result, gives it, and gives the last.

localparam integer PERIOD = 88;  // clocks of a lap
localparam [6:0] END = 7'd87;  // the last of them
localparam integer HOLD_LAP = 0;
localparam integer FIRST_LAP = 1;
localparam integer LAST_LAP = 1;

(* rom_style = "block", ram_style = "block" *)
reg [STEP_W-1:0] rom[0:PERIOD-1];
initial begin
  rom[0] = 89'h0818000d2600b7001480100;  // d2 loaded; -> qe_w; elbow_i: root_near * inv_12_near
  rom[1] = 89'h001a00000000130003a0700;  // d1 loaded
  rom[2] = 89'h001c00421a0001010020100;  // d1/2: d1 * 1/2; -> inv_q'
  rom[3] = 89'h002200141c0001120220100;  // -> k_1; inv_q: inv_q' * m_q
  rom[4] = 89'h00261442180001000004000;  // d_sum: d2 * 1/2; -> j_1
  rom[5] = 89'h001c00421800c3000080000;  // x loaded; d_dif: d2 * 1/2; -> qe_i
  rom[6] = 89'h001e000e1c000b001550100;  // z loaded; x_sq: x * x
  rom[7] = 89'h002000421a0007000300000;  // y loaded; d1: d1 * 1/2
  rom[8] = 89'h0028001020000100d000100;  // rho_sq: y * y; -> inv_q
  rom[9] = 89'h001a0014220001002080000;  // -> d_sum; k_q: k_1 * inv_q
  rom[10] = 89'h0022000f1e0001062080000;  // -> d_dif; s: z * z
  rom[11] = 89'h0224001426000f000300000;  // phi loaded; j_q: j_1 * inv_q
  rom[12] = 89'h0000000d1a00006202b0800;  // a_far: d_sum * d_sum
  rom[13] = 89'h00000011220000200300000;  // b_near: d_dif * d_dif
  rom[14] = 89'h002600111a05820022b0800;  // -> m_1; k_law: d_sum * d_dif; -> qs_k
  rom[15] = 89'h001a00142c0102200300100;  // -> m_rho; i_q: i_1 * inv_q
  rom[16] = 89'h00000d142a0060003000100;  // -> qs_j; w_q: w_1 * inv_q
  rom[17] = 89'h0122130d016202480000000;  // -> m_s; inv_rho': c2 * m_rho
  rom[18] = 89'h0000cd130080002a02b4800;  // inv_1': c2 * m_1
  rom[19] = 89'h0028d3412003028002b4800;  // -> m_far; y_n: y * 1
  rom[20] = 89'h00200041240442003480100;  // -> m_near; |phi|: phi * 1; -> qs_i
  rom[21] = 89'h10241142180022003480100;  // -> k_scaled; d2: d2 * 1/2; -> qs_w
  rom[22] = 89'h00180011000001010080000;  // -> inv_rho'; inv_s': c2 * m_s
  rom[23] = 89'h002ad1411c5001011084300;  // -> inv_1'; x_n: x * 1
  rom[24] = 89'h0000000d180000800080000;  // inv_rho: inv_rho' * m_rho
  rom[25] = 89'h00180d00000001001484100;  // -> |phi|
  rom[26] = 89'h001c10132a0002640080000;  // -> y_n; inv_1: inv_1' * m_1
  rom[27] = 89'h002a1310005001011554100;  // -> inv_s'; inv_near': c2 * m_near
  rom[28] = 89'h0026d0411e0602800004000;  // -> m_2; z_n: z * 1
  rom[29] = 89'h001e00112a0001009550100;  // -> inv_rho; inv_s: inv_s' * m_s
  rom[30] = 89'h002a1100000002001484100;  // -> x_n
  rom[31] = 89'h0022130f1c0001008080000;  // -> inv_1; u_y: y_n * inv_rho
  rom[32] = 89'h001c1413009001011550100;  // -> inv_near'; inv_2': c2 * m_2
  rom[33] = 89'h0000d314000000800004000;  // inv_far': c2 * m_far
  rom[34] = 89'h002cd40f2a0001008124000;  // -> inv_s; u_x: x_n * inv_rho
  rom[35] = 89'h002a0c0d1e0002001480100;  // -> z_n; root_rho: inv_rho * m_rho
  rom[36] = 89'h001a0c0c0000010c1481100;  // -> u_y; |sin_h|': c2 * |phi|
  rom[37] = 89'h001ecc0c00000101012a000;  // -> inv_2'; cos_h': c2 * |phi|
  rom[38] = 89'h002ecc101c0001010129000;  // -> inv_far'; inv_near: inv_near' * m_near
  rom[39] = 89'h001c10131e0001001486100;  // -> u_x; inv_2: inv_2' * m_2
  rom[40] = 89'h001e1311220001001404000;  // -> root_rho; inv_11: inv_1 * inv_1
  rom[41] = 89'h002600142e0001011550100;  // -> |sin_h|'; inv_far: inv_far' * m_far
  rom[42] = 89'h002e140c260001011554100;  // -> cos_h'; |sin_h|: |sin_h|' * |phi|
  rom[43] = 89'h00260c421a0001008128000;  // -> inv_near; az_sq: u_y * 1/2
  rom[44] = 89'h001a0010264801009551100;  // -> inv_2; root_near: inv_near * m_near
  rom[45] = 89'h00a000162a8001001560000;  // -> inv_11; sin_el: z_n * inv_s
  rom[46] = 89'h002600802c00010085c0400;  // -> inv_far; inv_s_el: inv_s * 2^-n
  rom[47] = 89'h002a000c2e000101a120000;  // -> |sin_h|; cos_h: cos_h' * |phi|
  rom[48] = 89'h00020c14260001000128010;  // -> az_c+1 (u_y<0); root_far: inv_far * m_far
  rom[49] = 89'h002600421c0001001092200;  // -> root_near; u_x/2: u_x * 1/2
  rom[50] = 89'h000400162000010e1560100;  // -> sin_el; inv_law_raw: inv_11 * inv_s
  rom[51] = 89'h001800412a0001000120000;  // -> inv_s_el; sin_h: |sin_h| * 1
  rom[52] = 89'h001c004204d80101a640042;  // -> cos_h; tilt_sq: sin_el (at_shoulder) * 1/2
  rom[53] = 89'h0020000c1f00010001b0000;  // -> root_far; cos_el: root_rho * inv_s_el
  rom[54] = 89'h01800013214001001080310;  // -> az_c (u_y<0); root_ab: root_far * root_near
  rom[55] = 89'h0099000e0080010025c0580;  // -> inv_law; cc: az_c * cos_h
  rom[56] = 89'h001e00801800010001b0000;  // -> sin_h; inv_law_ab_raw: inv_law * 2^-n
  rom[57] = 89'h0008000f020001000120020;  // -> tilt_c (sin_el<0); c_plus: az_c+1 * sin_h
  rom[58] = 89'h0028000f020001002120000;  // -> cos_el; c_minus: az_c+1 * sin_h
  rom[59] = 89'h002a000c240001001090200;  // -> root_ab; cos_a: k_scaled * inv_law
  rom[60] = 89'h000000422800000003a0100;  // cos_el/2: cos_el * 1/2
  rom[61] = 89'h0019000d220001002020000;  // -> inv_law_ab; inv_12_raw: inv_1 * inv_2
  rom[62] = 89'h001a000e0200010001b0000;  // -> c_plus; sc: az_c+1 * cos_h
  rom[63] = 89'h001c000c2a00010000c0000;  // -> c_minus; sin_a: root_ab * inv_law_ab
  rom[64] = 89'h000c000f0000011021b0000;  // -> cos_a; s_plus: az_c * sin_h
  rom[65] = 89'h000a000f000001000120020;  // -> tilt_c+1 (sin_el<0); s_minus: az_c * sin_h
  rom[66] = 89'h0019000d0800010021b0000;  // -> inv_12; w_0: tilt_c * c_plus
  rom[67] = 89'h000000040200000003a0005;  // az_tilt_sq: az_c+1 (u_y<0) * tilt_c (sin_el<0)
  rom[68] = 89'h0010000e0ad801002020100;  // -> sin_a; wi_0: tilt_c+1 * c_minus
  rom[69] = 89'h009a0042114001000120003;  // -> s_plus; sin_a/2: sin_a (clamp) * 1/2
  rom[70] = 89'h009e00420d8001000120003;  // -> s_minus; arm_sq: cos_a (clamp) * 1/2
  rom[71] = 89'h002200801800010003a0000;  // -> w_0; inv_12_far_raw: inv_12 * 2^-n
  rom[72] = 89'h002400421000010000c0003;  // -> az_tilt_sq; arm_dif: sin_a (clamp) * 1/2
  rom[73] = 89'h002800421000010005c06c3;  // -> wi_0; arm_sum: sin_a (clamp) * 1/2
  rom[74] = 89'h0016000e0a0001001090230;  // -> arm_c+1 (arm_swap); i_0: tilt_c+1 * c_minus
  rom[75] = 89'h0014000d080001001340130;  // -> arm_c (arm_swap); k_0: tilt_c * s_plus
  rom[76] = 89'h001b000a240001002040008;  // -> inv_12_far; length_sq: az_tilt_sq * arm_c (arm_swap)
  rom[77] = 89'h001c000f0a0001000120000;  // -> arm_dif; kj_0: tilt_c+1 * s_minus
  rom[78] = 89'h0024000a280001000120000;  // -> arm_sum; wi_c: wi_0 * arm_c
  rom[79] = 89'h0028000f0b1801000120000;  // -> i_0; j_0: tilt_c+1 * s_minus
  rom[80] = 89'h009e000e2940010003a0000;  // -> k_0; w_1: i_0 * arm_dif
  rom[81] = 89'h00800012238000a00120000;  // i_1: w_0 * arm_sum
  rom[82] = 89'h00220080180001000120000;  // -> kj_0; inv_12_near_raw: inv_12 * 2^-n
  rom[83] = 89'h0028000d2007020003a0700;  // -> m_q; elbow_w: root_far * inv_12_far
  rom[84] = 89'h0018140a220001000020100;  // -> j_0; kj_c: kj_0 * arm_c
  rom[85] = 89'h002a0014000001001090200;  // -> w_1; inv_q': c2 * m_q
  rom[86] = 89'h002cd40e180001000224000;  // -> i_1; k_1: j_0 * arm_dif
  rom[87] = 89'h041b00121e0001002120000;  // -> inv_12_near; j_1: k_0 * arm_sum
end
