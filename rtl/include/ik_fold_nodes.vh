// SPDX-License-Identifier: Apache-2.0
// Written by `python -m scripts.generate.headers` from model/dataflow/fold/shown.py; do not edit.

// For the body of ik_fold: every node of the dataflow, in an unread register, for the testbench.

reg signed [W - 1:0] x;
reg signed [W - 1:0] y;
reg signed [W - 1:0] z;
reg signed [W - 1:0] phi;
reg signed [W - 1:0] d1;
reg signed [W - 1:0] d2;
always @(posedge clk)
  if (go) begin
    if (clock == 7'd5) x <= in;
    if (clock == 7'd7) y <= in;
    if (clock == 7'd6) z <= in;
    if (clock == 7'd11) phi <= in;
    if (clock == 7'd1) d1 <= in;
    if (clock == 7'd0) d2 <= in;
  end

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
        if (clock == 7'd29) bad_length <= flag_nodes[0];
        if (clock == 7'd16) on_axis <= flag_nodes[1];
        if (clock == 7'd18) at_shoulder <= flag_nodes[2];
        if (clock == 7'd9) d_sum <= w[D - 3 - (W - 2) +: W - 2 + 3];
        if (clock == 7'd10) d_dif <= w[D - 3 - (W - 2) +: W - 2 + 3];
        if (clock == 7'd11) x_sq <= t;
        if (clock == 7'd12) y_sq <= p[2*D-1 -: XW];
        if (clock == 7'd14) z_sq <= p[2*D-1 -: XW];
        if (clock == 7'd16) d_sum_sq <= p[2*D-1 -: XW];
        if (clock == 7'd17) d_dif_sq <= p[2*D-1 -: XW];
        if (clock == 7'd18) sum_dif <= p[2*D-1 -: XW];
        if (clock == 7'd13) rho_sq <= t;
        if (clock == 7'd15) s <= t;
        if (clock == 7'd17) a_far <= ~t;
        if (clock == 7'd18) b_near <= t;
        if (clock == 7'd19) k_law <= t;
        if (clock == 7'd29) too_far <= flag_nodes[3];
        if (clock == 7'd29) too_near <= flag_nodes[4];
        if (clock == 7'd29) clamp <= flag_nodes[5];
        if (clock == 7'd29) closed <= flag_nodes[6];
        if (clock == 7'd29) away <= flag_nodes[7];
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
        if (clock == 7'd15) e_rho <= pairs;
        if (clock == 7'd15) m_rho <= normal[D - 1 - (ROOT_FRAC + 3) +: ROOT_FRAC + 3 + 0];
        if (clock == 7'd29) inv_rho <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd17) e_s <= pairs;
        if (clock == 7'd17) m_s <= normal[D - 1 - (ROOT_FRAC + 3) +: ROOT_FRAC + 3 + 0];
        if (clock == 7'd34) inv_s <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd30) x_n <= normal[D - 1 - (WX) +: WX + 1];
        if (clock == 7'd26) y_n <= normal[D - 1 - (WX) +: WX + 1];
        if (clock == 7'd35) z_n <= normal[D - 1 - (WX) +: WX + 1];
        if (clock == 7'd39) u_x <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd36) u_y <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd50) sin_el <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd40) root_rho <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd46) n_el <= n - 6'd1;
        if (clock == 7'd51) inv_s_el <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd58) cos_el <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd48) az_sq <= t[XW - D - 2 + D - 2 - (FRAC) +: FRAC + 2];
        if ((clock == 7'd48 || clock == 7'd54) && !w_place[0]) az_c <= w[D - 2 - (FRAC) +: FRAC + 2];
        if ((clock == 7'd48 || clock == 7'd54) && w_place[0]) az_s <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd57) tilt_sq <= t[XW - D - 2 + D - 2 - (FRAC) +: FRAC + 2];
        if ((clock == 7'd57 || clock == 7'd65) && !w_place[0]) tilt_c <= w[D - 2 - (FRAC) +: FRAC + 2];
        if ((clock == 7'd57 || clock == 7'd65) && w_place[0]) tilt_s <= w[D - 2 - (FRAC) +: FRAC + 2];
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
        if (clock == 7'd19) e_far <= pairs;
        if (clock == 7'd19) m_far <= normal[D - 1 - (ROOT_FRAC + 3) +: ROOT_FRAC + 3 + 0];
        if (clock == 7'd46) inv_far <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd20) e_near <= pairs;
        if (clock == 7'd20) m_near <= normal[D - 1 - (ROOT_FRAC + 3) +: ROOT_FRAC + 3 + 0];
        if (clock == 7'd43) inv_near <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd14) e_1 <= pairs - 6'd1;
        if (clock == 7'd14) m_1 <= normal[D - 1 - (ROOT_FRAC + 3) +: ROOT_FRAC + 3 + 0];
        if (clock == 7'd31) inv_1 <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd28) e_2 <= pairs - 6'd1;
        if (clock == 7'd28) m_2 <= normal[D - 1 - (ROOT_FRAC + 3) +: ROOT_FRAC + 3 + 0];
        if (clock == 7'd44) inv_2 <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd53) root_far <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd49) root_near <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd66) inv_12_raw <= t[XW - D - 3 + D - 1 - (FRAC + 1) +: FRAC + 1 + 2];
        if (clock == 7'd66) inv_12 <= w[D - 1 - (FRAC + 1) +: FRAC + 1 + 1];
        if (clock == 7'd71) n_far <= n - 6'd0;
        if (clock == 7'd76) inv_12_far_raw <= t[XW - D - 3 + D - 2 - (FRAC) +: FRAC + 5];
        if (clock == 7'd76) inv_12_far <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd87) elbow_w <= p_plain[FRAC+2:1];
        if (clock == 7'd82) n_near <= n - 6'd0;
        if (clock == 7'd87) inv_12_near_raw <= t[XW - D - 3 + D - 2 - (FRAC) +: FRAC + 5];
        if (clock == 7'd87) inv_12_near <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd4) elbow_i <= p_plain[FRAC+2:1];
        if (clock == 7'd0) qe_w <= answer;  // (14)
        if (clock == 7'd5) qe_i <= answer;  // (14)
        if (clock == 7'd45) inv_11 <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd55) inv_law_raw <= t[XW - D - 3 + D - 2 - (FRAC) +: FRAC + 3];
        if (clock == 7'd55) inv_law <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd19) n_law <= n - 6'd0;
        if (clock == 7'd21) k_scaled <= normal[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd64) cos_a <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd59) root_ab <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd56) n_ab <= n - 6'd0;
        if (clock == 7'd61) inv_law_ab_raw <= t[XW - D - 3 + D - 2 - (FRAC) +: FRAC + 5];
        if (clock == 7'd61) inv_law_ab <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd68) sin_a <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd75) bend_sq <= t[XW - D - 2 + D - 2 - (FRAC) +: FRAC + 2];
        if ((clock == 7'd74 || clock == 7'd75) && !w_place[0]) bend_c <= w[D - 2 - (FRAC) +: FRAC + 2];
        if ((clock == 7'd74 || clock == 7'd75) && w_place[0]) bend_s <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd65) bend_swap <= flag_nodes[8];
        if (clock == 7'd77) bend_dif <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd78) bend_sum <= w[D - 2 - (FRAC) +: FRAC + 2];
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
        if (clock == 7'd56) sin_h <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd52) cos_h <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd60) cc <= t[XW - D - 2 + D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd61) ss <= p_plain[FRAC+2:1];
        if (clock == 7'd67) sc <= t[XW - D - 2 + D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd68) cs <= p_plain[FRAC+2:1];
        if (clock == 7'd62) c_plus <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd69) s_plus <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd63) c_minus <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd70) s_minus <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd71) w_0 <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd72) i_0 <= p_plain[FRAC+2:1];
        if (clock == 7'd81) j_0 <= p_plain[FRAC+2:1];
        if (clock == 7'd80) k_0 <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd73) wi_0 <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd83) wi_c <= t[XW - D - 2 + D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd84) i_dif <= p_plain[FRAC+2:1];
        if (clock == 7'd85) w_1 <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd85) w_sum <= p_plain[FRAC+2:1];
        if (clock == 7'd86) i_1 <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd82) kj_0 <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd1) kj_c <= t[XW - D - 2 + D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd2) j_dif <= p_plain[FRAC+2:1];
        if (clock == 7'd3) k_1 <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd3) k_sum <= p_plain[FRAC+2:1];
        if (clock == 7'd4) j_1 <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd72) az_tilt_sq <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd81) length_sq <= t[XW - D - 2 + D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd85) low <= q_low;
        if (clock == 7'd83) m_q <= normal[D - 1 - (ROOT_FRAC + 3) +: ROOT_FRAC + 3 + 0];
        if (clock == 7'd8) inv_q <= w[D - 2 - (FRAC) +: FRAC + 2];
        if (clock == 7'd4) minus <= flag_nodes[9];
        if (clock == 7'd20) w_q <= p_double[FRAC+2:1];
        if (clock == 7'd21) qs_w <= answer;  // (18)
        if (clock == 7'd19) i_q <= p_double[FRAC+2:1];
        if (clock == 7'd20) qs_i <= answer;  // (18)
        if (clock == 7'd15) j_q <= p_double[FRAC+2:1];
        if (clock == 7'd16) qs_j <= answer;  // (18)
        if (clock == 7'd13) k_q <= p_double[FRAC+2:1];
        if (clock == 7'd14) qs_k <= answer;  // (18)
      end
  end
endgenerate
