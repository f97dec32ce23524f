// SPDX-License-Identifier: Apache-2.0
// Written by `python -m scripts.generate.headers` from model/dataflow/fold/shown.py; do not edit.

// For the body of ik_fold_arm: every node of the dataflow, in an unread register, for the testbench.

reg signed [W - 1:0] hand_x;
reg signed [W - 1:0] hand_y;
reg signed [W - 1:0] hand_z;
reg signed [W - 1:0] phi;
reg signed [W - 1:0] d1;
reg signed [W - 1:0] d2;
reg signed [W - 1:0] tool;
reg signed [W - 1:0] qh_w;
reg signed [W - 1:0] qh_i;
reg signed [W - 1:0] qh_j;
reg signed [W - 1:0] qh_k;
reg branch_shoulder;
reg branch_elbow;
reg branch_wrist;
always @(posedge clk)
  if (go) begin
    if (clock == (SHORT ? 8'd34 : 8'd29)) hand_x <= in;
    if (clock == (SHORT ? 8'd79 : 8'd65)) hand_y <= in;
    if (clock == (SHORT ? 8'd43 : 8'd68)) hand_z <= in;
    if (clock == (SHORT ? 8'd1 : 8'd24)) phi <= in;
    if (clock == (SHORT ? 8'd11 : 8'd7)) d1 <= in;
    if (clock == (SHORT ? 8'd24 : 8'd38)) d2 <= in;
    if (clock == (SHORT ? 8'd38 : 8'd72)) tool <= in;
    if (clock == (SHORT ? 8'd78 : 8'd77)) qh_w <= in;
    if (clock == (SHORT ? 8'd77 : 8'd73)) qh_i <= in;
    if (clock == (SHORT ? 8'd75 : 8'd76)) qh_j <= in;
    if (clock == (SHORT ? 8'd76 : 8'd75)) qh_k <= in;
    if (clock == (SHORT ? 8'd80 : 8'd78)) branch_shoulder <= branch_in[0];
    if (clock == (SHORT ? 8'd80 : 8'd78)) branch_elbow <= branch_in[1];
    if (clock == (SHORT ? 8'd80 : 8'd78)) branch_wrist <= branch_in[2];
  end

generate
  if (1) begin : u_hand
    reg signed [2*W - 1:0] hi_sq;
    reg signed [2*W - 1:0] hj_sq;
    reg signed [2*W - 1:0] hk_sq;
    reg signed [2*W - 1:0] hw_sq;
    reg signed [2*W - 1:0] hij_sq;
    reg signed [2*W - 1:0] hijk_sq;
    reg signed [2*W - 1:0] hand_sq;
    reg bad_hand;
    reg signed [W - 1:0] h_w;
    reg signed [W - 1:0] h_i;
    reg signed [W - 1:0] h_j;
    reg signed [W - 1:0] h_k;
    reg signed [W - 1:0] tool_h;
    reg signed [FRAC + 1:0] h_ik;
    reg signed [FRAC + 1:0] h_wj;
    reg signed [FRAC + 1:0] r_x;
    reg signed [FRAC + 1:0] h_jk;
    reg signed [FRAC + 1:0] h_wi;
    reg signed [FRAC + 1:0] r_y;
    reg signed [FRAC + 1:0] h_ii;
    reg signed [FRAC + 1:0] h_jj;
    reg signed [FRAC + 1:0] r_z;
    reg signed [FRAC + 1:0] off_x;
    reg signed [W - 1:0] x;
    reg signed [FRAC + 1:0] off_y;
    reg signed [W - 1:0] y;
    reg signed [FRAC + 1:0] off_z;
    reg signed [W - 1:0] z;
    reg saturated;
    always @(posedge clk)
      if (go) begin
        if (clock == (SHORT ? 8'd83 : 8'd80)) hi_sq <= t[XW-1:2];
        if (clock == (SHORT ? 8'd84 : 8'd81)) hj_sq <= p[2*D-1 -: 2*W];
        if (clock == (SHORT ? 8'd86 : 8'd83)) hk_sq <= p[2*D-1 -: 2*W];
        if (clock == (SHORT ? 8'd88 : 8'd85)) hw_sq <= p[2*D-1 -: 2*W];
        if (clock == (SHORT ? 8'd85 : 8'd82)) hij_sq <= t[XW-1:2];
        if (clock == (SHORT ? 8'd87 : 8'd84)) hijk_sq <= t[XW-1:2];
        if (clock == (SHORT ? 8'd89 : 8'd86)) hand_sq <= t[XW-1:2];
        if (clock == (SHORT ? 8'd90 : 8'd87)) bad_hand <= hand_nodes[0];
        if (clock == 8'd62) h_w <= b[D - 2 - (W - 2) +: W - 2 + 2];
        if (clock == (SHORT ? 8'd63 : 8'd60)) h_i <= b[D - 2 - (W - 2) +: W - 2 + 2];
        if (clock == (SHORT ? 8'd66 : 8'd65)) h_j <= b[D - 2 - (W - 2) +: W - 2 + 2];
        if (clock == (SHORT ? 8'd67 : 8'd61)) h_k <= b[D - 2 - (W - 2) +: W - 2 + 2];
        if (clock == (SHORT ? 8'd91 : 8'd89)) tool_h <= b[D - 2 - (W - 2) +: W - 2 + 2];
        if (clock == (SHORT ? 8'd86 : 8'd81)) h_ik <= t[XW - D - 2 + D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd87 : 8'd82)) h_wj <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd88 : 8'd83)) r_x <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd82 : 8'd88)) h_jk <= t[XW - D - 2 + D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd83 : 8'd89)) h_wi <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd84 : 8'd90)) r_y <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd91 : 8'd86)) h_ii <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd93 : 8'd88)) h_jj <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd94 : 8'd89)) r_z <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd94 : 8'd92)) off_x <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd95 : 8'd93)) x <= w[D - 3 - (W - 2) +: W - 2 + 2];
        if (clock == (SHORT ? 8'd97 : 8'd95)) off_y <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd98 : 8'd96)) y <= w[D - 3 - (W - 2) +: W - 2 + 2];
        if (clock == (SHORT ? 8'd100 : 8'd96)) off_z <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd101 : 8'd97)) z <= w[D - 3 - (W - 2) +: W - 2 + 2];
        if (clock == (SHORT ? 8'd102 : 8'd98)) saturated <= hand_nodes[1];
      end
  end
endgenerate

generate
  if (1) begin : u_guard
    reg bad_length;
    reg on_axis;
    reg at_shoulder;
    reg signed [W:0] d_sum;
    reg signed [W:0] d_dif;
    reg signed [2*W + 1:0] x_sq;
    reg signed [2*W + 1:0] y_sq;
    reg signed [2*W + 1:0] z_sq;
    reg signed [2*W + 1:0] d_sum_sq;
    reg signed [2*W + 1:0] d_dif_sq;
    reg signed [2*W + 1:0] sum_dif;
    reg signed [2*W + 1:0] rho_sq;
    reg signed [2*W + 1:0] s;
    reg signed [2*W + 1:0] a_far;
    reg signed [2*W + 1:0] b_near;
    reg signed [2*W + 1:0] k_law;
    reg too_far;
    reg too_near;
    reg clamp;
    reg closed;
    reg away;
    always @(posedge clk)
      if (go) begin
        if (clock == (SHORT ? 8'd53 : 8'd49)) bad_length <= flag_nodes[0];
        if (clock == (SHORT ? 8'd108 : 8'd105)) on_axis <= flag_nodes[1];
        if (clock == (SHORT ? 8'd110 : 8'd107)) at_shoulder <= flag_nodes[2];
        if (clock == (SHORT ? 8'd48 : 8'd49)) d_sum <= w[D - 3 - (W - 2) +: W - 2 + 3];
        if (clock == (SHORT ? 8'd49 : 8'd50)) d_dif <= w[D - 3 - (W - 2) +: W - 2 + 3];
        if (clock == (SHORT ? 8'd103 : 8'd100)) x_sq <= t;
        if (clock == (SHORT ? 8'd104 : 8'd101)) y_sq <= p[2*D-1 -: XW];
        if (clock == (SHORT ? 8'd106 : 8'd103)) z_sq <= p[2*D-1 -: XW];
        if (clock == (SHORT ? 8'd108 : 8'd105)) d_sum_sq <= p[2*D-1 -: XW];
        if (clock == (SHORT ? 8'd109 : 8'd106)) d_dif_sq <= p[2*D-1 -: XW];
        if (clock == (SHORT ? 8'd110 : 8'd107)) sum_dif <= p[2*D-1 -: XW];
        if (clock == (SHORT ? 8'd105 : 8'd102)) rho_sq <= t;
        if (clock == (SHORT ? 8'd107 : 8'd104)) s <= t;
        if (clock == (SHORT ? 8'd109 : 8'd106)) a_far <= ~t;
        if (clock == (SHORT ? 8'd110 : 8'd107)) b_near <= t;
        if (clock == (SHORT ? 8'd111 : 8'd108)) k_law <= t;
        if (clock == (SHORT ? 8'd110 : 8'd107)) too_far <= flag_nodes[3];
        if (clock == (SHORT ? 8'd111 : 8'd108)) too_near <= flag_nodes[4];
        if (clock == (SHORT ? 8'd111 : 8'd108)) clamp <= flag_nodes[5];
        if (clock == (SHORT ? 8'd111 : 8'd108)) closed <= flag_nodes[6];
        if (clock == (SHORT ? 8'd111 : 8'd108)) away <= flag_nodes[7];
      end
  end
endgenerate

generate
  if (1) begin : u_direction
    reg [5:0] e_rho;
    reg [ROOT_FRAC + 2:0] m_rho;
    reg signed [FRAC + 1:0] inv_rho;
    reg [5:0] e_s;
    reg [ROOT_FRAC + 2:0] m_s;
    reg signed [FRAC + 1:0] inv_s;
    reg signed [WX:0] x_n;
    reg signed [WX:0] y_n;
    reg signed [WX:0] z_n;
    reg signed [FRAC + 1:0] u_x;
    reg signed [FRAC + 1:0] u_y;
    reg signed [FRAC + 1:0] sin_el;
    reg signed [FRAC + 1:0] root_rho;
    reg [5:0] n_el;
    reg signed [FRAC + 1:0] inv_s_el;
    reg signed [FRAC + 1:0] cos_el;
    reg signed [FRAC + 1:0] az_sq;
    reg signed [FRAC + 1:0] az_c;
    reg signed [FRAC + 1:0] az_s;
    reg signed [FRAC + 1:0] tilt_sq;
    reg signed [FRAC + 1:0] tilt_c;
    reg signed [FRAC + 1:0] tilt_s;
    always @(posedge clk)
      if (go) begin
        if (clock == (SHORT ? 8'd107 : 8'd104)) e_rho <= pairs;
        if (clock == (SHORT ? 8'd107 : 8'd104)) m_rho <= normal[D - 1 - (ROOT_FRAC + 3) +: ROOT_FRAC + 3 + 0];
        if (clock == (SHORT ? 8'd123 : 8'd118)) inv_rho <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd109 : 8'd106)) e_s <= pairs;
        if (clock == (SHORT ? 8'd109 : 8'd106)) m_s <= normal[D - 1 - (ROOT_FRAC + 3) +: ROOT_FRAC + 3 + 0];
        if (clock == (SHORT ? 8'd125 : 8'd126)) inv_s <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd117 : 8'd119)) x_n <= normal[D - 1 - (WX) +: WX + 1];
        if (clock == (SHORT ? 8'd122 : 8'd123)) y_n <= normal[D - 1 - (WX) +: WX + 1];
        if (clock == (SHORT ? 8'd128 : 8'd114)) z_n <= normal[D - 1 - (WX) +: WX + 1];
        if (clock == (SHORT ? 8'd129 : 8'd128)) u_x <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd132 : 8'd131)) u_y <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 8'd134) sin_el <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd139 : 8'd129)) root_rho <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd131 : 8'd127)) n_el <= n - 6'd1;
        if (clock == (SHORT ? 8'd136 : 8'd132)) inv_s_el <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd5 : 8'd139)) cos_el <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd0 : 8'd137)) az_sq <= t[XW - D - 2 + D - 2 - (FRAC) +: FRAC + 2];
        if ((clock == (SHORT ? 8'd135 : 8'd137) || clock == (SHORT ? 8'd0 : 8'd138)) && !w_place[0]) az_c <= w[D - 2 - (FRAC) +: FRAC + 2];
        if ((clock == (SHORT ? 8'd135 : 8'd137) || clock == (SHORT ? 8'd0 : 8'd138)) && w_place[0]) az_s <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd2 : 8'd141)) tilt_sq <= t[XW - D - 2 + D - 2 - (FRAC) +: FRAC + 2];
        if ((clock == (SHORT ? 8'd2 : 8'd141) || clock == (SHORT ? 8'd12 : 8'd2)) && !w_place[0]) tilt_c <= w[D - 2 - (FRAC) +: FRAC + 2];
        if ((clock == (SHORT ? 8'd2 : 8'd141) || clock == (SHORT ? 8'd12 : 8'd2)) && w_place[0]) tilt_s <= w[D - 2 - (FRAC) +: FRAC + 2];
      end
  end
endgenerate

generate
  if (1) begin : u_triangle
    reg [5:0] e_far;
    reg [ROOT_FRAC + 2:0] m_far;
    reg signed [FRAC + 1:0] inv_far;
    reg [5:0] e_near;
    reg [ROOT_FRAC + 2:0] m_near;
    reg signed [FRAC + 1:0] inv_near;
    reg [5:0] e_1;
    reg [ROOT_FRAC + 2:0] m_1;
    reg signed [FRAC + 1:0] inv_1;
    reg [5:0] e_2;
    reg [ROOT_FRAC + 2:0] m_2;
    reg signed [FRAC + 1:0] inv_2;
    reg signed [FRAC + 1:0] root_far;
    reg signed [FRAC + 1:0] root_near;
    reg signed [FRAC + 2:0] inv_12_raw;
    reg signed [FRAC + 1:0] inv_12;
    reg [5:0] n_far;
    reg signed [FRAC + 4:0] inv_12_far_raw;
    reg signed [FRAC + 1:0] inv_12_far;
    reg signed [FRAC + 1:0] elbow_w;
    reg [5:0] n_near;
    reg signed [FRAC + 4:0] inv_12_near_raw;
    reg signed [FRAC + 1:0] inv_12_near;
    reg signed [FRAC + 1:0] elbow_i;
    reg signed [W - 1:0] qe_w;
    reg signed [W - 1:0] qe_i;
    reg signed [FRAC + 1:0] inv_11;
    reg signed [FRAC + 2:0] inv_law_raw;
    reg signed [FRAC + 1:0] inv_law;
    reg [5:0] n_law;
    reg signed [FRAC + 1:0] k_scaled;
    reg signed [FRAC + 1:0] cos_a;
    reg signed [FRAC + 1:0] root_ab;
    reg [5:0] n_ab;
    reg signed [FRAC + 4:0] inv_law_ab_raw;
    reg signed [FRAC + 1:0] inv_law_ab;
    reg signed [FRAC + 1:0] sin_a;
    reg signed [FRAC + 1:0] bend_sq;
    reg signed [FRAC + 1:0] bend_c;
    reg signed [FRAC + 1:0] bend_s;
    reg bend_swap;
    reg signed [FRAC + 1:0] bend_dif;
    reg signed [FRAC + 1:0] bend_sum;
    always @(posedge clk)
      if (go) begin
        if (clock == (SHORT ? 8'd111 : 8'd108)) e_far <= pairs;
        if (clock == (SHORT ? 8'd111 : 8'd108)) m_far <= normal[D - 1 - (ROOT_FRAC + 3) +: ROOT_FRAC + 3 + 0];
        if (clock == (SHORT ? 8'd131 : 8'd127)) inv_far <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd112 : 8'd109)) e_near <= pairs;
        if (clock == (SHORT ? 8'd112 : 8'd109)) m_near <= normal[D - 1 - (ROOT_FRAC + 3) +: ROOT_FRAC + 3 + 0];
        if (clock == (SHORT ? 8'd127 : 8'd130)) inv_near <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd46 : 8'd47)) e_1 <= pairs - 6'd1;
        if (clock == (SHORT ? 8'd46 : 8'd47)) m_1 <= normal[D - 1 - (ROOT_FRAC + 3) +: ROOT_FRAC + 3 + 0];
        if (clock == (SHORT ? 8'd64 : 8'd62)) inv_1 <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd52 : 8'd48)) e_2 <= pairs - 6'd1;
        if (clock == (SHORT ? 8'd52 : 8'd48)) m_2 <= normal[D - 1 - (ROOT_FRAC + 3) +: ROOT_FRAC + 3 + 0];
        if (clock == (SHORT ? 8'd65 : 8'd63)) inv_2 <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd137 : 8'd135)) root_far <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd133 : 8'd136)) root_near <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd116 : 8'd98)) inv_12_raw <= t[XW - D - 3 + D - 1 - (FRAC + 1) +: FRAC + 1 + 2];
        if (clock == (SHORT ? 8'd116 : 8'd98)) inv_12 <= w[D - 1 - (FRAC + 1) +: FRAC + 1 + 1];
        if (clock == (SHORT ? 8'd10 : 8'd8)) n_far <= n - 6'd0;
        if (clock == (SHORT ? 8'd15 : 8'd13)) inv_12_far_raw <= t[XW - D - 3 + D - 2 - (FRAC) +: FRAC + 5];
        if (clock == (SHORT ? 8'd15 : 8'd13)) inv_12_far <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd30 : 8'd21)) elbow_w <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd17 : 8'd1)) n_near <= n - 6'd0;
        if (clock == (SHORT ? 8'd22 : 8'd6)) inv_12_near_raw <= t[XW - D - 3 + D - 2 - (FRAC) +: FRAC + 5];
        if (clock == (SHORT ? 8'd22 : 8'd6)) inv_12_near <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd28 : 8'd16)) elbow_i <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd31 : 8'd22)) qe_w <= w[D - 2 - (W - 2) +: W - 2 + 2];  // (14)
        if (clock == (SHORT ? 8'd29 : 8'd17)) qe_i <= w[D - 2 - (W - 2) +: W - 2 + 2];  // (14)
        if (clock == (SHORT ? 8'd108 : 8'd92)) inv_11 <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd138 : 8'd133)) inv_law_raw <= t[XW - D - 3 + D - 2 - (FRAC) +: FRAC + 3];
        if (clock == (SHORT ? 8'd138 : 8'd133)) inv_law <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd111 : 8'd108)) n_law <= n - 6'd0;
        if (clock == (SHORT ? 8'd113 : 8'd110)) k_scaled <= normal[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd7 : 8'd0)) cos_a <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd3 : 8'd142)) root_ab <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd139 : 8'd135)) n_ab <= n - 6'd0;
        if (clock == (SHORT ? 8'd4 : 8'd140)) inv_law_ab_raw <= t[XW - D - 3 + D - 2 - (FRAC) +: FRAC + 5];
        if (clock == (SHORT ? 8'd4 : 8'd140)) inv_law_ab <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd10 : 8'd5)) sin_a <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd17 : 8'd12)) bend_sq <= t[XW - D - 2 + D - 2 - (FRAC) +: FRAC + 2];
        if ((clock == (SHORT ? 8'd16 : 8'd11) || clock == (SHORT ? 8'd17 : 8'd12)) && !w_place[0]) bend_c <= w[D - 2 - (FRAC) +: FRAC + 2];
        if ((clock == (SHORT ? 8'd16 : 8'd11) || clock == (SHORT ? 8'd17 : 8'd12)) && w_place[0]) bend_s <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd8 : 8'd1)) bend_swap <= flag_nodes[8];
        if (clock == (SHORT ? 8'd19 : 8'd14)) bend_dif <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd20 : 8'd15)) bend_sum <= w[D - 2 - (FRAC) +: FRAC + 2];
      end
  end
endgenerate

generate
  if (1) begin : u_turn
    reg signed [FRAC + 1:0] sin_h;
    reg signed [FRAC + 1:0] cos_h;
    reg signed [FRAC + 1:0] cc;
    reg signed [FRAC + 1:0] ss;
    reg signed [FRAC + 1:0] sc;
    reg signed [FRAC + 1:0] cs;
    reg signed [FRAC + 1:0] c_plus;
    reg signed [FRAC + 1:0] s_plus;
    reg signed [FRAC + 1:0] c_minus;
    reg signed [FRAC + 1:0] s_minus;
    reg signed [FRAC + 1:0] w_0;
    reg signed [FRAC + 1:0] i_0;
    reg signed [FRAC + 1:0] j_0;
    reg signed [FRAC + 1:0] k_0;
    reg signed [FRAC + 1:0] wi_0;
    reg signed [FRAC + 1:0] wi_c;
    reg signed [FRAC + 1:0] i_dif;
    reg signed [FRAC + 1:0] w_1;
    reg signed [FRAC + 1:0] w_sum;
    reg signed [FRAC + 1:0] i_1;
    reg signed [FRAC + 1:0] kj_0;
    reg signed [FRAC + 1:0] kj_c;
    reg signed [FRAC + 1:0] j_dif;
    reg signed [FRAC + 1:0] k_1;
    reg signed [FRAC + 1:0] k_sum;
    reg signed [FRAC + 1:0] j_1;
    reg signed [FRAC + 1:0] az_tilt_sq;
    reg signed [FRAC + 1:0] length_sq;
    reg low;
    reg [ROOT_FRAC + 2:0] m_q;
    reg signed [FRAC + 1:0] inv_q;
    reg minus;
    reg signed [FRAC + 1:0] w_q;
    reg signed [W - 1:0] qs_w;
    reg signed [FRAC + 1:0] i_q;
    reg signed [W - 1:0] qs_i;
    reg signed [FRAC + 1:0] j_q;
    reg signed [W - 1:0] qs_j;
    reg signed [FRAC + 1:0] k_q;
    reg signed [W - 1:0] qs_k;
    always @(posedge clk)
      if (go) begin
        if (clock == (SHORT ? 8'd97 : 8'd60)) sin_h <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd58 : 8'd51)) cos_h <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd6 : 8'd7)) cc <= t[XW - D - 2 + D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd7 : 8'd8)) ss <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd11 : 8'd1)) sc <= t[XW - D - 2 + D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd12 : 8'd2)) cs <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd8 : 8'd9)) c_plus <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd13 : 8'd3)) s_plus <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd9 : 8'd10)) c_minus <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd14 : 8'd4)) s_minus <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd21 : 8'd19)) w_0 <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd22 : 8'd16)) i_0 <= SHORT ? p_plain[FRAC+2:1] : w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd26 : 8'd24)) j_0 <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd25 : 8'd23)) k_0 <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd23 : 8'd21)) wi_0 <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd34 : 8'd28)) wi_c <= t[XW - D - 2 + D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd35 : 8'd29)) i_dif <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd36 : 8'd30)) w_1 <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd36 : 8'd30)) w_sum <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd37 : 8'd31)) i_1 <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd27 : 8'd25)) kj_0 <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd38 : 8'd32)) kj_c <= t[XW - D - 2 + D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd39 : 8'd33)) j_dif <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd40 : 8'd34)) k_1 <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd40 : 8'd34)) k_sum <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd41 : 8'd35)) j_1 <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd18 : 8'd8)) az_tilt_sq <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd24 : 8'd18)) length_sq <= t[XW - D - 2 + D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd28 : 8'd22)) low <= q_low;
        if (clock == (SHORT ? 8'd26 : 8'd20)) m_q <= normal[D - 1 - (ROOT_FRAC + 3) +: ROOT_FRAC + 3 + 0];
        if (clock == (SHORT ? 8'd39 : 8'd33)) inv_q <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd41 : 8'd35)) minus <= flag_nodes[9];
        if (clock == (SHORT ? 8'd59 : 8'd57)) w_q <= p_double[FRAC+2:1];
        if (clock == (SHORT ? 8'd60 : 8'd58)) qs_w <= w[D - 2 - (W - 2) +: W - 2 + 2];  // (18)
        if (clock == (SHORT ? 8'd44 : 8'd38)) i_q <= p_double[FRAC+2:1];
        if (clock == (SHORT ? 8'd45 : 8'd39)) qs_i <= w[D - 2 - (W - 2) +: W - 2 + 2];  // (18)
        if (clock == (SHORT ? 8'd46 : 8'd40)) j_q <= p_double[FRAC+2:1];
        if (clock == (SHORT ? 8'd47 : 8'd41)) qs_j <= w[D - 2 - (W - 2) +: W - 2 + 2];  // (18)
        if (clock == (SHORT ? 8'd61 : 8'd60)) k_q <= p_double[FRAC+2:1];
        if (clock == (SHORT ? 8'd62 : 8'd61)) qs_k <= w[D - 2 - (W - 2) +: W - 2 + 2];  // (18)
      end
  end
endgenerate

generate
  if (1) begin : u_frame
    reg signed [FRAC + 1:0] g_ww;
    reg signed [FRAC + 1:0] g_ii;
    reg signed [FRAC + 1:0] g_jj;
    reg signed [FRAC + 1:0] g_kk;
    reg signed [FRAC + 1:0] g_w;
    reg signed [FRAC + 1:0] g_wi;
    reg signed [FRAC + 1:0] g_iw;
    reg signed [FRAC + 1:0] g_jk;
    reg signed [FRAC + 1:0] g_kj;
    reg signed [FRAC + 1:0] g_i;
    reg signed [FRAC + 1:0] g_wj;
    reg signed [FRAC + 1:0] g_jw;
    reg signed [FRAC + 1:0] g_ki;
    reg signed [FRAC + 1:0] g_ik;
    reg signed [FRAC + 1:0] g_j;
    reg signed [FRAC + 1:0] g_wk;
    reg signed [FRAC + 1:0] g_kw;
    reg signed [FRAC + 1:0] g_ij;
    reg signed [FRAC + 1:0] g_ji;
    reg signed [FRAC + 1:0] g_k;
    reg signed [FRAC + 1:0] f_ww;
    reg signed [FRAC + 1:0] f_wi;
    reg signed [W - 1:0] qw_w;
    reg signed [FRAC + 1:0] f_ii;
    reg signed [FRAC + 1:0] f_iw;
    reg signed [W - 1:0] qw_i;
    reg signed [FRAC + 1:0] f_jj;
    reg signed [FRAC + 1:0] f_jk;
    reg signed [W - 1:0] qw_j;
    reg signed [FRAC + 1:0] f_kk;
    reg signed [FRAC + 1:0] f_kj;
    reg signed [W - 1:0] qw_k;
    always @(posedge clk)
      if (go) begin
        if (clock == (SHORT ? 8'd66 : 8'd73)) g_ww <= t[XW - D - 2 + D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd67 : 8'd74)) g_ii <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd69 : 8'd76)) g_jj <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd71 : 8'd78)) g_kk <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd72 : 8'd79)) g_w <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd67 : 8'd64)) g_wi <= t[XW - D - 2 + D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd68 : 8'd65)) g_iw <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd70 : 8'd67)) g_jk <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd72 : 8'd69)) g_kj <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd73 : 8'd70)) g_i <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd74 : 8'd72)) g_wj <= t[XW - D - 2 + D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd75 : 8'd73)) g_jw <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd77 : 8'd75)) g_ki <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd79 : 8'd77)) g_ik <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd80 : 8'd78)) g_j <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd75 : 8'd65)) g_wk <= t[XW - D - 2 + D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd76 : 8'd66)) g_kw <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd78 : 8'd68)) g_ij <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd80 : 8'd70)) g_ji <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd81 : 8'd71)) g_k <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == (SHORT ? 8'd116 : 8'd119)) f_ww <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd118 : 8'd121)) f_wi <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd119 : 8'd122)) qw_w <= answer;
        if (clock == (SHORT ? 8'd99 : 8'd98)) f_ii <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd101 : 8'd100)) f_iw <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd102 : 8'd101)) qw_i <= answer;
        if (clock == (SHORT ? 8'd103 : 8'd102)) f_jj <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd105 : 8'd104)) f_jk <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd106 : 8'd105)) qw_j <= answer;
        if (clock == (SHORT ? 8'd127 : 8'd122)) f_kk <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd129 : 8'd124)) f_kj <= p_plain[FRAC+2:1];
        if (clock == (SHORT ? 8'd130 : 8'd125)) qw_k <= answer;
      end
  end
endgenerate

generate
  if (1) begin : u_joints
    reg [W + 2:0] qs_ij;
    reg signed [W + 3:0] qs_d;
    reg [W + 2:0] qs_wk;
    reg signed [W + 3:0] qs_s;
    reg signed [W + 3:0] qs_b;
    reg signed [W - 1:0] th1;
    reg signed [W - 1:0] th3;
    reg signed [W - 1:0] th2;
    reg signed [W + 3:0] qe_e;
    reg signed [W - 1:0] th4;
    reg [W + 2:0] qw_ij;
    reg signed [W + 3:0] qw_d;
    reg [W + 2:0] qw_wk;
    reg signed [W + 3:0] qw_s;
    reg signed [W + 3:0] qw_b;
    reg signed [W - 1:0] th5;
    reg signed [W - 1:0] th7;
    reg signed [W - 1:0] th6;
    reg over_1;
    reg over_2;
    reg over_3;
    reg over_4;
    reg over_5;
    reg over_6;
    reg over_7;
    always @(posedge clk)
      if (go) begin
        if (clock == (SHORT ? 8'd59 : 8'd57)) qs_ij <= length;
        if (clock == 8'd74) qs_d <= angle(4'd0, left);
        if (clock == (SHORT ? 8'd78 : 8'd81)) qs_wk <= length;
        if (clock == (SHORT ? 8'd93 : 8'd98)) qs_s <= angle(4'd8, left);
        if (clock == (SHORT ? 8'd109 : 8'd116)) qs_b <= angle(4'd4, 1'b0);
        if (clock == (SHORT ? 8'd93 : 8'd98)) th1 <= th;
        if (clock == (SHORT ? 8'd94 : 8'd99)) th3 <= th;
        if (clock == (SHORT ? 8'd110 : 8'd117)) th2 <= th;
        if (clock == (SHORT ? 8'd58 : 8'd55)) qe_e <= angle(4'd4, left);
        if (clock == (SHORT ? 8'd59 : 8'd56)) th4 <= th;
        if (clock == (SHORT ? 8'd118 : 8'd121)) qw_ij <= length;
        if (clock == (SHORT ? 8'd133 : 8'd138)) qw_d <= angle(4'd0, left);
        if (clock == (SHORT ? 8'd2 : 8'd141)) qw_wk <= length;
        if (clock == (SHORT ? 8'd17 : 8'd15)) qw_s <= angle(4'd8, left);
        if (clock == 8'd33) qw_b <= angle(4'd4, 1'b0);
        if (clock == (SHORT ? 8'd17 : 8'd15)) th5 <= th;
        if (clock == (SHORT ? 8'd18 : 8'd16)) th7 <= th;
        if (clock == 8'd34) th6 <= th;
        if (clock == (SHORT ? 8'd95 : 8'd100)) over_1 <= over;
        if (clock == (SHORT ? 8'd112 : 8'd119)) over_2 <= over;
        if (clock == (SHORT ? 8'd96 : 8'd101)) over_3 <= over;
        if (clock == (SHORT ? 8'd61 : 8'd58)) over_4 <= over;
        if (clock == (SHORT ? 8'd19 : 8'd17)) over_5 <= over;
        if (clock == 8'd36) over_6 <= over;
        if (clock == (SHORT ? 8'd20 : 8'd18)) over_7 <= over;
      end
  end
endgenerate
