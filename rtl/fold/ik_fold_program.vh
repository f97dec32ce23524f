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
  rom[0] = 97'h0818000d2600b700138010000;  // d2 loaded; -> qe_w; elbow_i: root_near * inv_12_near
  rom[1] = 97'h001a0000000013000290a0000;  // d1 loaded
  rom[2] = 97'h001c00421a000101001010000;  // d1/2: d1 * 1/2; -> inv_q'
  rom[3] = 97'h002200141c000112011010000;  // -> k_1; inv_q: inv_q' * m_q
  rom[4] = 97'h0026144218000100000400000;  // d_sum: d2 * 1/2; -> j_1
  rom[5] = 97'h001c00421800c300008000000;  // x loaded; d_dif: d2 * 1/2; -> qe_i
  rom[6] = 97'h001e000e1c000b00144010000;  // z loaded; x_sq: x * x
  rom[7] = 97'h002000421a000700020000000;  // y loaded; d1: d1 * 1/2
  rom[8] = 97'h0028001020000100f00010000;  // rho_sq: y * y; -> inv_q
  rom[9] = 97'h001a001422000100208000000;  // -> d_sum; k_q: k_1 * inv_q
  rom[10] = 97'h0022000f1e000106208000000;  // -> d_dif; s: z * z
  rom[11] = 97'h0224001426000f00020000000;  // phi loaded; j_q: j_1 * inv_q
  rom[12] = 97'h0000000d1a00006201a090000;  // a_far: d_sum * d_sum
  rom[13] = 97'h0000001122000020020000000;  // b_near: d_dif * d_dif
  rom[14] = 97'h002600111a05820021a090000;  // -> m_1; k_law: d_sum * d_dif; -> qs_k
  rom[15] = 97'h001a00142c010220020010000;  // -> m_rho; i_q: i_1 * inv_q
  rom[16] = 97'h00000d142a006000300010000;  // -> qs_j; w_q: w_1 * inv_q
  rom[17] = 97'h0122130d01620248000000000;  // -> m_s; inv_rho': c2 * m_rho
  rom[18] = 97'h0000cd130080002a01a490000;  // inv_1': c2 * m_1
  rom[19] = 97'h0028d3412003028001a490000;  // -> m_far; y_n: y * 1
  rom[20] = 97'h0020004124044200338010000;  // -> m_near; |phi|: phi * 1; -> qs_i
  rom[21] = 97'h1024114218002200338010000;  // -> k_scaled; d2: d2 * 1/2; -> qs_w
  rom[22] = 97'h0018001100000101008000000;  // -> inv_rho'; inv_s': c2 * m_s
  rom[23] = 97'h002ad1411c500101108480000;  // -> inv_1'; x_n: x * 1
  rom[24] = 97'h0000000d18000080008000000;  // inv_rho: inv_rho' * m_rho
  rom[25] = 97'h00180d0000000100138410000;  // -> |phi|
  rom[26] = 97'h001c10132a000264008000000;  // -> y_n; inv_1: inv_1' * m_1
  rom[27] = 97'h002a131000500101144410000;  // -> inv_s'; inv_near': c2 * m_near
  rom[28] = 97'h0026d0411e060280000400000;  // -> m_2; z_n: z * 1
  rom[29] = 97'h001e00112a000100944010000;  // -> inv_rho; inv_s: inv_s' * m_s
  rom[30] = 97'h002a110000000200138410000;  // -> x_n
  rom[31] = 97'h0022130f1c000100808000000;  // -> inv_1; u_y: y_n * inv_rho
  rom[32] = 97'h001c141300900101144010000;  // -> inv_near'; inv_2': c2 * m_2
  rom[33] = 97'h0000d31400000080000400000;  // inv_far': c2 * m_far
  rom[34] = 97'h002cd40f2a000100811400000;  // -> inv_s; u_x: x_n * inv_rho
  rom[35] = 97'h002a0c0d1e000200138010000;  // -> z_n; root_rho: inv_rho * m_rho
  rom[36] = 97'h001a0c0c0000010c138110000;  // -> u_y; |sin_h|': c2 * |phi|
  rom[37] = 97'h001ecc0c00000101011a00000;  // -> inv_2'; cos_h': c2 * |phi|
  rom[38] = 97'h002ecc101c000101011900000;  // -> inv_far'; inv_near: inv_near' * m_near
  rom[39] = 97'h001c10131e000100138610000;  // -> u_x; inv_2: inv_2' * m_2
  rom[40] = 97'h001e131122000100130400000;  // -> root_rho; inv_11: inv_1 * inv_1
  rom[41] = 97'h002600142e000101144010000;  // -> |sin_h|'; inv_far: inv_far' * m_far
  rom[42] = 97'h002e140c26000101144410000;  // -> cos_h'; |sin_h|: |sin_h|' * |phi|
  rom[43] = 97'h00260c421a000100811800000;  // -> inv_near; az_sq: u_y * 1/2
  rom[44] = 97'h001a001026480100944110000;  // -> inv_2; root_near: inv_near * m_near
  rom[45] = 97'h00a000162a800100145000000;  // -> inv_11; sin_el: z_n * inv_s
  rom[46] = 97'h002600802c00010084b020000;  // -> inv_far; inv_s_el: inv_s * 2^-n
  rom[47] = 97'h002a000c2e000100a11000000;  // -> |sin_h|; cos_h: cos_h' * |phi|
  rom[48] = 97'h00020c1426000100011800200;  // -> az_c+1 (u_y<0); root_far: inv_far * m_far
  rom[49] = 97'h002600421c0001001082d0000;  // -> root_near; u_x/2: u_x * 1/2
  rom[50] = 97'h000400162000010e145010000;  // -> sin_el; inv_law_raw: inv_11 * inv_s
  rom[51] = 97'h001800412a000100011000000;  // -> inv_s_el; sin_h: |sin_h| * 1
  rom[52] = 97'h001c004204d80100a53007005;  // -> cos_h; tilt_sq: sin_el (at_shoulder) * 1/2
  rom[53] = 97'h0020000c1f00010001a000000;  // -> root_far; cos_el: root_rho * inv_s_el
  rom[54] = 97'h0180001321400100108080200;  // -> az_c (u_y<0); root_ab: root_far * root_near
  rom[55] = 97'h0099000e0080010024b0b5000;  // -> inv_law; cc: az_c * cos_h
  rom[56] = 97'h001e00801800010001a000000;  // -> sin_h; inv_law_ab_raw: inv_law * 2^-n
  rom[57] = 97'h0008000f02000100011000300;  // -> tilt_c (sin_el<0); c_plus: az_c+1 * sin_h
  rom[58] = 97'h0028000f02000100211000000;  // -> cos_el; c_minus: az_c+1 * sin_h
  rom[59] = 97'h002a000c240001001080d0000;  // -> root_ab; cos_a: k_scaled * inv_law
  rom[60] = 97'h0000004228000000029010000;  // cos_el/2: cos_el * 1/2
  rom[61] = 97'h0019000d22000100401000000;  // -> inv_law_ab; inv_12_raw: inv_1 * inv_2
  rom[62] = 97'h001a000e0200010001a000000;  // -> c_plus; sc: az_c+1 * cos_h
  rom[63] = 97'h001c000c2a00010000b000000;  // -> c_minus; sin_a: root_ab * inv_law_ab
  rom[64] = 97'h000c000f0000011021a000000;  // -> cos_a; s_plus: az_c * sin_h
  rom[65] = 97'h000a000f00000100011000300;  // -> tilt_c+1 (sin_el<0); s_minus: az_c * sin_h
  rom[66] = 97'h0019000d0800010021a000000;  // -> inv_12; w_0: tilt_c * c_plus
  rom[67] = 97'h0000000402000000029000032;  // az_tilt_sq: az_c+1 (u_y<0) * tilt_c (sin_el<0)
  rom[68] = 97'h0010000e0ad80100201010000;  // -> sin_a; wi_0: tilt_c+1 * c_minus
  rom[69] = 97'h009a004211400100011000006;  // -> s_plus; sin_a/2: sin_a (clamp) * 1/2
  rom[70] = 97'h009e00420d800100011000006;  // -> s_minus; arm_sq: cos_a (clamp) * 1/2
  rom[71] = 97'h0022008018000100029000000;  // -> w_0; inv_12_far_raw: inv_12 * 2^-n
  rom[72] = 97'h002400421000010000b000006;  // -> az_tilt_sq; arm_dif: sin_a (clamp) * 1/2
  rom[73] = 97'h002800421000010004b0c6006;  // -> wi_0; arm_sum: sin_a (clamp) * 1/2
  rom[74] = 97'h0016000e0a0001001080d0400;  // -> arm_c+1 (arm_swap); i_0: tilt_c+1 * c_minus
  rom[75] = 97'h0014000d08000100123010400;  // -> arm_c (arm_swap); k_0: tilt_c * s_plus
  rom[76] = 97'h001b000a24000100403000040;  // -> inv_12_far; length_sq: az_tilt_sq * arm_c (arm_swap)
  rom[77] = 97'h001c000f0a000100011000000;  // -> arm_dif; kj_0: tilt_c+1 * s_minus
  rom[78] = 97'h0024000a28000100011000000;  // -> arm_sum; wi_c: wi_0 * arm_c
  rom[79] = 97'h0028000f0b180100011000000;  // -> i_0; j_0: tilt_c+1 * s_minus
  rom[80] = 97'h009e000e29400100029000000;  // -> k_0; w_1: i_0 * arm_dif
  rom[81] = 97'h00800012238000a0011000000;  // i_1: w_0 * arm_sum
  rom[82] = 97'h0022008018000100011000000;  // -> kj_0; inv_12_near_raw: inv_12 * 2^-n
  rom[83] = 97'h0028000d200702000290a0000;  // -> m_q; elbow_w: root_far * inv_12_far
  rom[84] = 97'h0018140a22000100001010000;  // -> j_0; kj_c: kj_0 * arm_c
  rom[85] = 97'h002a0014000001001080d0000;  // -> w_1; inv_q': c2 * m_q
  rom[86] = 97'h002cd40e18000100011400000;  // -> i_1; k_1: j_0 * arm_dif
  rom[87] = 97'h041b00121e000100411000000;  // -> inv_12_near; j_1: k_0 * arm_sum
end
