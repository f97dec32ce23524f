// Rounding and format of each node: ik_lean_nodes.vh; products by ik_mul3, roots faithful, shifts and halves floor.
// SPDX-License-Identifier: Apache-2.0
//
// The triangle of shoulder, elbow and wrist from its three sides: Qe = (sqrt A, -sqrt B)/(2 sqrt(d1 d2)) (14), and the
// angle a at the shoulder, cos a = K/(2 d1 |p|), sin a = sqrt(A B)/(2 d1 |p|), as half angle ha.
`default_nettype none

module ik_lean_triangle #(
    parameter integer W = 32,  // word length, 16 to 32
    parameter integer N = (W < 16) ? 23 : ((W < 28) ? W + 7 : 35)  // of an inner word: follows from W
) (
    input  wire                  clk,
    input  wire signed [  W-1:0] d1,
    input  wire signed [  W-1:0] d2,
    input  wire signed [2*W+1:0] a_far,   // T_A_FAR
    input  wire signed [2*W+1:0] b_near,
    input  wire signed [2*W+1:0] k_law,
    input  wire        [    5:0] e_s,     // T_E_S
    input  wire signed [  N-1:0] inv_s,   // T_INV_S
    input  wire                  clamp,   // T_CLAMP
    input  wire                  fold,
    input  wire                  away,
    output reg  signed [  W-1:0] qe_w,    // T_QE_W
    output reg  signed [  W-1:0] qe_i,
    output reg  signed [  N-1:0] g_a,     // T_G_A
    output reg  signed [  N-1:0] ha_c,    // T_HA_C
    output reg  signed [  N-1:0] ha_s
);

  `include "ik_lean_nodes.vh"

  generate
    if (N != FRAC + 2) begin : g_illegal
      ik_lean_triangle_N_is_FRAC_and_2 u_stop ();
    end
  endgenerate

  localparam integer MW = ROOT_FRAC + 3;  // of a mantissa
  localparam integer ODD = W % 2;
  localparam integer EW = W + ODD;  // container of a length, for even shifts
  localparam integer RW = FRAC + 5;  // of a word raised by 2

  // ---- roots of A, B, d1, d2 ----

  wire [5:0] e_a;
  wire [5:0] e_b;
  wire [5:0] e_1;
  wire [5:0] e_2;
  wire [MW-1:0] m_a;
  wire [MW-1:0] m_b;
  wire [MW-1:0] m_1;
  wire [MW-1:0] m_2;
  wire signed [N-1:0] inv_a;
  wire signed [N-1:0] inv_b;
  wire signed [N-1:0] inv_1;
  wire signed [N-1:0] inv_2;
  // of what is negative, only the low bits: the arm is clamped then
  wire [EW:0] d1_x = {{(ODD + 1) {d1[W-1]}}, d1};
  wire [EW:0] d2_x = {{(ODD + 1) {d2[W-1]}}, d2};
  ik_lean_root #(.VW(2*W), .R(ROOT_FRAC), .N(N)) u_a (.clk(clk), .v(a_far[2*W-1:0]), .e(e_a), .m(m_a), .inv(inv_a));
  ik_lean_root #(.VW(2*W), .R(ROOT_FRAC), .N(N)) u_b (.clk(clk), .v(b_near[2*W-1:0]), .e(e_b), .m(m_b), .inv(inv_b));
  ik_lean_root #(.VW(EW), .R(ROOT_FRAC), .N(N)) u_1 (.clk(clk), .v(d1_x[EW-1:0]), .e(e_1), .m(m_1), .inv(inv_1));
  ik_lean_root #(.VW(EW), .R(ROOT_FRAC), .N(N)) u_2 (.clk(clk), .v(d2_x[EW-1:0]), .e(e_2), .m(m_2), .inv(inv_2));
  wire unused = &{1'b0, a_far[2*W+1:2*W], b_near[2*W+1:2*W], d1_x[EW], d2_x[EW], m_1, m_2};

  // ---- (14) sqrt A and sqrt B as mantissas ----

  wire [MW-1:0] m_a_inv;
  wire [MW-1:0] m_b_inv;
  wire signed [N-1:0] l_a;
  wire signed [N-1:0] l_b;
  localparam integer SH_L = F_INV_A + MW - 1 - F_L_A;
  ik_delay #(.W(2*MW), .N(T_INV_A-T_M_A)) u_m_inv (.clk(clk), .d({m_b, m_a}), .q({m_b_inv, m_a_inv}));
  ik_mul3 #(.AW(N), .BW(MW+1), .SH(SH_L), .OW(N)) u_l_a (.clk(clk), .a(inv_a), .b({1'b0, m_a_inv}), .q(l_a));
  ik_mul3 #(.AW(N), .BW(MW+1), .SH(SH_L), .OW(N)) u_l_b (.clk(clk), .a(inv_b), .b({1'b0, m_b_inv}), .q(l_b));

  // ---- (14) 1/(2 sqrt(d1 d2)), brought to the units of sqrt A and sqrt B ----

  wire signed [N:0] inv_12;
  ik_mul3 #(.AW(N), .BW(N), .SH(F_INV_1+F_INV_2-F_INV_12), .OW(N+1)) u_inv_12 (
      .clk(clk), .a(inv_1), .b(inv_2), .q(inv_12)
  );
  wire [5:0] e_1_a;
  wire [5:0] e_2_a;
  reg [5:0] n_a;
  reg [5:0] n_b;
  localparam [5:0] RAISED = (ODD != 0) ? 6'd3 : 6'd2;
  ik_delay #(.W(12), .N(T_E_A-T_E_1)) u_e_12_a (.clk(clk), .d({e_2, e_1}), .q({e_2_a, e_1_a}));
  always @(posedge clk) begin
    n_a <= e_a - e_1_a - e_2_a + RAISED;
    n_b <= e_b - e_1_a - e_2_a + RAISED;
  end

  localparam integer T_V_IN = T_V_A_RAW - LAT_SHIFT;
  wire signed [N:0] inv_12_v;
  wire [5:0] n_a_v;
  wire [5:0] n_b_v;
  wire signed [RW-1:0] v_a_raw;
  wire signed [RW-1:0] v_b_raw;
  ik_delay #(.W(N+1), .N(T_V_IN-T_INV_12)) u_inv_12_v (.clk(clk), .d(inv_12), .q(inv_12_v));
  ik_delay #(.W(12), .N(T_V_IN-T_N_A)) u_n_v (.clk(clk), .d({n_b, n_a}), .q({n_b_v, n_a_v}));
  ik_shift #(.W(RW), .RIGHT(1)) u_v_a (.clk(clk), .d({inv_12_v, 2'b00}), .count(n_a_v), .q(v_a_raw));
  ik_shift #(.W(RW), .RIGHT(1)) u_v_b (.clk(clk), .d({inv_12_v, 2'b00}), .count(n_b_v), .q(v_b_raw));
  // 2, which powers of two can give, becomes the largest word
  localparam signed [N-1:0] TOP = {1'b0, {(N - 1) {1'b1}}};
  wire signed [N-1:0] v_a = (|v_a_raw[RW-1:N-1]) ? TOP : v_a_raw[N-1:0];
  wire signed [N-1:0] v_b = (|v_b_raw[RW-1:N-1]) ? TOP : v_b_raw[N-1:0];

  // ---- (14) Qe; the clamped elbow is folded (1, 0) or straight (0, -1) ----

  wire signed [N-1:0] v_a_l;
  wire signed [N-1:0] v_b_l;
  wire signed [N-1:0] el_a;
  wire signed [N-1:0] el_b;
  ik_delay #(.W(2*N), .N(T_L_A-T_V_A)) u_v_l (.clk(clk), .d({v_b, v_a}), .q({v_b_l, v_a_l}));
  ik_mul3 #(.AW(N), .BW(N), .SH(F_L_A+F_V_A-F_EL_A), .OW(N)) u_el_a (.clk(clk), .a(l_a), .b(v_a_l), .q(el_a));
  ik_mul3 #(.AW(N), .BW(N), .SH(F_L_B+F_V_B-F_EL_B), .OW(N)) u_el_b (.clk(clk), .a(l_b), .b(v_b_l), .q(el_b));

  wire clamp_el;
  wire fold_el;
  ik_delay #(.W(2), .N(T_EL_A-T_CLAMP)) u_clamp_el (.clk(clk), .d({fold, clamp}), .q({fold_el, clamp_el}));
  localparam integer DROP = F_EL_A - F_QE_W;
  localparam signed [N-1:0] HALF = {{(N - 1) {1'b0}}, 1'b1} << (DROP - 1);
  localparam signed [W-1:0] UNIT = {2'b01, {(W - 2) {1'b0}}};
  wire signed [N-1:0] plus_a = HALF + el_a;
  wire signed [N-1:0] minus_b = HALF - el_b;
  always @(posedge clk) begin
    qe_w <= !clamp_el ? plus_a[DROP+:W] : fold_el ? UNIT : {W{1'b0}};
    qe_i <= !clamp_el ? minus_b[DROP+:W] : fold_el ? {W{1'b0}} : -UNIT;
  end
  wire unused_el = &{1'b0, plus_a, minus_b};  // what the rounding drops

  // ---- (13) 1/(4 d1 |p|), as a mantissa, and K in its units ----

  wire signed [N-1:0] inv_11;
  wire signed [N-1:0] inv_11_s;
  wire signed [N:0] t_a_raw;
  ik_mul3 #(.AW(N), .BW(N), .SH(F_INV_1+F_INV_1-F_INV_11), .OW(N)) u_inv_11 (
      .clk(clk), .a(inv_1), .b(inv_1), .q(inv_11)
  );
  ik_delay #(.W(N), .N(T_INV_S-T_INV_11)) u_inv_11_s (.clk(clk), .d(inv_11), .q(inv_11_s));
  ik_mul3 #(.AW(N), .BW(N), .SH(F_INV_11+F_INV_S-1-F_T_A_RAW), .OW(N+1)) u_t_a (
      .clk(clk), .a(inv_11_s), .b(inv_s), .q(t_a_raw)
  );
  wire signed [N-1:0] t_a = (|t_a_raw[N:N-1]) ? TOP : t_a_raw[N-1:0];

  wire [5:0] e_1_s;
  reg [5:0] n_k;
  ik_delay #(.W(6), .N(T_E_S-T_E_1)) u_e_1_s (.clk(clk), .d(e_1), .q(e_1_s));
  always @(posedge clk) n_k <= {e_1_s[4:0], 1'b0} + e_s;
  wire unused_e = e_1_s[5];  // at most 15 pairs
  wire signed [2*W+1:0] k_law_n;
  wire signed [N-1:0] k_t;
  wire signed [N-1:0] k_t_t;
  ik_delay #(.W(2*W+2), .N(T_N_K-T_K_LAW)) u_k_law_n (.clk(clk), .d(k_law), .q(k_law_n));
  // short words get zeros below
  localparam integer DROP_K = (2 * W + ODD > FRAC) ? 2 * W + ODD - FRAC : 1;
  localparam integer PAD_K = DROP_K - (2 * W + ODD - FRAC);
  localparam integer KW = 2 * W + 2 + PAD_K;
  wire signed [KW-1:0] k_law_x = $signed(k_law_n);
  ik_shift3 #(.IW(KW), .DROP(DROP_K), .OW(N)) u_k_t (.clk(clk), .d(k_law_x <<< PAD_K), .count(n_k), .q(k_t));
  ik_delay #(.W(N), .N(T_T_A-T_K_T)) u_k_t_t (.clk(clk), .d(k_t), .q(k_t_t));
  wire signed [N-1:0] cos_a;
  ik_mul3 #(.AW(N), .BW(N), .SH(F_K_T+F_T_A-1-F_COS_A), .OW(N)) u_cos_a (.clk(clk), .a(k_t_t), .b(t_a), .q(cos_a));

  // ---- (13) sin a ----

  wire signed [N-1:0] l_ab;
  ik_mul3 #(.AW(N), .BW(N), .SH(F_L_A+F_L_B-F_L_AB), .OW(N)) u_l_ab (.clk(clk), .a(l_a), .b(l_b), .q(l_ab));
  wire [5:0] e_s_a;
  reg [5:0] e_ab;
  reg [5:0] e_1s;
  reg [5:0] n_ab;
  ik_delay #(.W(6), .N(T_E_A-T_E_S)) u_e_s_a (.clk(clk), .d(e_s), .q(e_s_a));
  always @(posedge clk) begin
    e_ab <= e_a + e_b + RAISED;
    e_1s <= {e_1_a[4:0], 1'b0} + e_s_a;
    n_ab <= e_ab - e_1s;
  end
  localparam integer T_V_AB_IN = T_V_AB_RAW - LAT_SHIFT;
  wire signed [N-1:0] t_a_v;
  wire [5:0] n_ab_v;
  wire signed [RW-1:0] v_ab_raw;
  ik_delay #(.W(N), .N(T_V_AB_IN-T_T_A)) u_t_a_v (.clk(clk), .d(t_a), .q(t_a_v));
  ik_delay #(.W(6), .N(T_V_AB_IN-T_N_AB)) u_n_ab_v (.clk(clk), .d(n_ab), .q(n_ab_v));
  ik_shift #(.W(RW), .RIGHT(1)) u_v_ab (.clk(clk), .d({t_a_v[N-1], t_a_v, 2'b00}), .count(n_ab_v), .q(v_ab_raw));
  wire signed [N-1:0] v_ab = (|v_ab_raw[RW-1:N-1]) ? TOP : v_ab_raw[N-1:0];

  localparam integer T_SIN_A_IN = T_SIN_A - LAT_MUL3;
  wire signed [N-1:0] l_ab_in;
  wire signed [N-1:0] v_ab_in;
  wire signed [N-1:0] sin_a;
  ik_delay #(.W(N), .N(T_SIN_A_IN-T_L_AB)) u_l_ab_in (.clk(clk), .d(l_ab), .q(l_ab_in));
  ik_delay #(.W(N), .N(T_SIN_A_IN-T_V_AB)) u_v_ab_in (.clk(clk), .d(v_ab), .q(v_ab_in));
  ik_mul3 #(.AW(N), .BW(N), .SH(F_L_AB+F_V_AB-1-F_SIN_A), .OW(N)) u_sin_a (
      .clk(clk), .a(l_ab_in), .b(v_ab_in), .q(sin_a)
  );

  // ---- ha: the last rotation turns by -a; a clamped arm lies along the line to the target, (1, 0), or away ----

  localparam signed [N-1:0] ONE = {{(N - 1) {1'b0}}, 1'b1} << FRAC;
  wire clamp_cos;
  wire clamp_sin;
  wire away_sin;
  wire sign_sin;
  wire signed [N-1:0] g_a_sin;
  ik_delay #(.W(1), .N(T_COS_A-T_CLAMP)) u_clamp_cos (.clk(clk), .d(clamp), .q(clamp_cos));
  ik_delay #(.W(2), .N(T_SIN_A-T_CLAMP)) u_clamp_sin (.clk(clk), .d({away, clamp}), .q({away_sin, clamp_sin}));
  ik_delay #(.W(1), .N(T_SIN_A-T_COS_A)) u_sign_sin (.clk(clk), .d(cos_a[N-1]), .q(sign_sin));
  ik_delay #(.W(N), .N(T_SIN_A-T_G_A)) u_g_a_sin (.clk(clk), .d(g_a), .q(g_a_sin));
  wire [N-1:0] sum_a = ONE + (cos_a ^ {N{cos_a[N-1]}});  // 1 + |cos a|, by the one's complement
  wire big_first = clamp_sin ? !away_sin : !sign_sin;
  wire signed [N-1:0] half_a = sin_a >>> 1;
  wire signed [N-1:0] small_a = half_a & {N{!clamp_sin}};
  always @(posedge clk) begin
    g_a  <= clamp_cos ? ONE : (sum_a >> 1);
    ha_c <= big_first ? g_a_sin : small_a;
    ha_s <= big_first ? small_a : g_a_sin;
  end

endmodule

`default_nettype wire
