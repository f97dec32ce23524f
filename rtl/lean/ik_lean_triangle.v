// The triangle of shoulder, elbow and wrist from its three sides: elbow quaternion, and angle at the shoulder.
// SPDX-License-Identifier: Apache-2.0
//
// Format of each node: ik_lean_nodes.vh; rounding: products as in ik_mul3, roots faithful, shifts and halves floor.
// Qe = (sqrt A, -sqrt B)/(2 sqrt(d1 d2)) (14), and the angle a at the shoulder, cos a = K/(2 d1 |p|), sin a = sqrt(A
// B)/(2 d1 |p|), as half angle (bend_c, bend_s). d1 and d2 at clock 0, each other port at its clock T_<NODE>.
// Throughput: one target per clock.
`default_nettype none

module ik_lean_triangle #(
    parameter integer W = 32,  // word length, 16 to 32
    parameter integer N = 35,  // inner word width: FRAC + 2
    parameter integer TILE = 18  // see ik_mul3
) (
    // Clock
    input  wire                  clk,
    // Target
    input  wire signed [  W-1:0] d1,
    input  wire signed [  W-1:0] d2,
    // From guard
    input  wire signed [2*W+1:0] a_far,   // T_A_FAR
    input  wire signed [2*W+1:0] b_near,
    input  wire signed [2*W+1:0] k_law,
    input  wire                  clamp,   // T_CLAMP
    input  wire                  closed,
    input  wire                  away,
    // From direction
    input  wire        [    5:0] e_s,     // T_E_S
    input  wire signed [  N-1:0] inv_s,   // T_INV_S
    // Elbow quaternion
    output reg  signed [  W-1:0] qe_w,    // (14) T_QE_W
    output reg  signed [  W-1:0] qe_i,    // (14)
    // Angle at the shoulder
    output reg  signed [  N-1:0] bend_sq,  // T_BEND_SQ
    output reg                   bend_swap,  // T_BEND_SWAP
    output reg  signed [  N-1:0] bend_c,   // T_BEND_C
    output reg  signed [  N-1:0] bend_sum,
    output reg  signed [  N-1:0] bend_dif
);

  `include "ik_lean_nodes.vh"

  generate
    if (N != FRAC + 2) begin : g_illegal
      ik_lean_triangle_illegal_N u_stop ();
    end
  endgenerate

  localparam integer MW = ROOT_FRAC + 3;  // width of a mantissa
  localparam integer ODD = W % 2;
  localparam integer EW = W + ODD;  // width of a length, made even
  localparam integer RW = FRAC + 5;  // width of a word shifted up by 2

  // ---- roots of A, B, d1, d2 ----

  wire [5:0] e_far;
  wire [5:0] e_near;
  wire [5:0] e_1;
  wire [5:0] e_2;
  wire [MW-1:0] m_far;
  wire [MW-1:0] m_near;
  wire [MW-1:0] m_1;
  wire [MW-1:0] m_2;
  wire signed [N-1:0] inv_far;
  wire signed [N-1:0] inv_near;
  wire signed [N-1:0] inv_1;
  wire signed [N-1:0] inv_2;
  // Negative values lose their sign here; the arm is clamped then.
  wire [EW:0] d1_x = {{(ODD + 1) {d1[W-1]}}, d1};
  wire [EW:0] d2_x = {{(ODD + 1) {d2[W-1]}}, d2};
  // e_far = clz(a_far) / 2
  // m_far = a_far << 2 * e_far
  // inv_far = 1 / (2 * sqrt m_far)
  ik_lean_root #(.VW(2*W), .R(ROOT_FRAC), .N(N), .TILE(TILE)) u_far (
      .clk(clk), .v(a_far[2*W-1:0]), .e(e_far), .m(m_far), .inv(inv_far)
  );
  // e_near = clz(b_near) / 2
  // m_near = b_near << 2 * e_near
  // inv_near = 1 / (2 * sqrt m_near)
  ik_lean_root #(.VW(2*W), .R(ROOT_FRAC), .N(N), .TILE(TILE)) u_near (
      .clk(clk), .v(b_near[2*W-1:0]), .e(e_near), .m(m_near), .inv(inv_near)
  );
  // e_1 = clz(d1) / 2
  // m_1 = d1 << 2 * e_1
  // inv_1 = 1 / (2 * sqrt m_1)
  ik_lean_root #(.VW(EW), .R(ROOT_FRAC), .N(N), .TILE(TILE)) u_1 (.clk(clk), .v(d1_x[EW-1:0]), .e(e_1), .m(m_1), .inv(inv_1));
  // e_2 = clz(d2) / 2
  // m_2 = d2 << 2 * e_2
  // inv_2 = 1 / (2 * sqrt m_2)
  ik_lean_root #(.VW(EW), .R(ROOT_FRAC), .N(N), .TILE(TILE)) u_2 (.clk(clk), .v(d2_x[EW-1:0]), .e(e_2), .m(m_2), .inv(inv_2));
  wire unused = &{1'b0, a_far[2*W+1:2*W], b_near[2*W+1:2*W], d1_x[EW], d2_x[EW], m_1, m_2};

  // ---- sqrt A and sqrt B as mantissas ----

  wire signed [N-1:0] root_far;
  wire signed [N-1:0] root_near;
  localparam integer SH_ROOT = F_INV_FAR + MW - 1 - F_ROOT_FAR;
  // root_far = 2 * inv_far * m_far
  ik_mul3 #(.AW(N), .BW(MW+1), .SH(SH_ROOT), .OW(N), .DB(T_INV_FAR-T_M_FAR), .TILE(TILE)) u_root_far (
      .clk(clk), .a(inv_far), .b({1'b0, m_far}), .q(root_far)
  );
  // root_near = 2 * inv_near * m_near
  ik_mul3 #(.AW(N), .BW(MW+1), .SH(SH_ROOT), .OW(N), .DB(T_INV_NEAR-T_M_NEAR), .TILE(TILE)) u_root_near (
      .clk(clk), .a(inv_near), .b({1'b0, m_near}), .q(root_near)
  );

  // ---- 1/(2 sqrt(d1 d2)), shifted to the units of sqrt A and sqrt B ----

  wire signed [N:0] inv_12_raw;
  // inv_12_raw = inv_1 * inv_2
  ik_mul3 #(.AW(N), .BW(N), .SH(F_INV_1+F_INV_2-F_INV_12), .OW(N+1), .TILE(TILE)) u_inv_12 (
      .clk(clk), .a(inv_1), .b(inv_2), .q(inv_12_raw)
  );
  // Powers of two can give inv_12 = 1 and inv_law = 2, which saturate to the largest word.
  localparam signed [N-1:0] TOP = {1'b0, {(N - 1) {1'b1}}};
  reg signed [N-1:0] inv_12;
  always @(posedge clk) inv_12 <= (|inv_12_raw[N:N-1]) ? TOP : inv_12_raw[N-1:0];
  wire [5:0] e_1_at_e_far, e_2_at_e_far;
  reg [5:0] n_far;
  reg [5:0] n_near;
  localparam [5:0] RAISED = (ODD != 0) ? 6'd3 : 6'd2;
  ik_delay #(.W(12), .N(T_E_FAR-T_E_1)) u_e_at_e_far (.clk(clk), .d({e_2, e_1}), .q({e_2_at_e_far, e_1_at_e_far}));
  always @(posedge clk) begin
    n_far <= e_far - e_1_at_e_far - e_2_at_e_far + RAISED;
    n_near <= e_near - e_1_at_e_far - e_2_at_e_far + RAISED;
  end

  localparam integer T_INV_12_IN = T_INV_12_FAR_RAW - LAT_SHIFT;
  wire signed [RW-1:0] inv_12_far_raw;
  wire signed [RW-1:0] inv_12_near_raw;
  ik_shift #(.W(RW), .RIGHT(1), .DD(T_INV_12_IN-T_INV_12), .DC(T_INV_12_IN-T_N_FAR)) u_inv_12_far (
      .clk(clk), .d({inv_12[N-1], inv_12, 2'b00}), .count(n_far), .q(inv_12_far_raw)
  );
  ik_shift #(.W(RW), .RIGHT(1), .DD(T_INV_12_IN-T_INV_12), .DC(T_INV_12_IN-T_N_FAR)) u_inv_12_near (
      .clk(clk), .d({inv_12[N-1], inv_12, 2'b00}), .count(n_near), .q(inv_12_near_raw)
  );
  reg signed [N-1:0] inv_12_far;
  reg signed [N-1:0] inv_12_near;
  always @(posedge clk) begin
    inv_12_far  <= (|inv_12_far_raw[RW-1:N-1]) ? TOP : inv_12_far_raw[N-1:0];
    inv_12_near <= (|inv_12_near_raw[RW-1:N-1]) ? TOP : inv_12_near_raw[N-1:0];
  end

  // ---- Qe; the clamped elbow is closed (1, 0) or straight (0, -1) ----

  wire signed [N-1:0] elbow_w;
  wire signed [N-1:0] elbow_i;
  localparam integer T_ELBOW_IN = T_ELBOW_W - LAT_MUL3;
  // elbow_w = root_far * inv_12_far
  ik_mul3 #(.AW(N), .BW(N), .SH(F_ROOT_FAR+F_INV_12_FAR-F_ELBOW_W), .OW(N), .DA(T_ELBOW_IN-T_ROOT_FAR),
      .DB(T_ELBOW_IN-T_INV_12_FAR), .TILE(TILE)) u_elbow_w (
      .clk(clk), .a(root_far), .b(inv_12_far), .q(elbow_w)
  );
  // elbow_i = root_near * inv_12_near
  ik_mul3 #(.AW(N), .BW(N), .SH(F_ROOT_NEAR+F_INV_12_NEAR-F_ELBOW_I), .OW(N), .DA(T_ELBOW_IN-T_ROOT_FAR),
      .DB(T_ELBOW_IN-T_INV_12_FAR), .TILE(TILE)) u_elbow_i (
      .clk(clk), .a(root_near), .b(inv_12_near), .q(elbow_i)
  );

  wire clamp_at_elbow_w, closed_at_elbow_w;
  ik_delay #(.W(2), .N(T_ELBOW_W-T_CLAMP)) u_clamp_at_elbow_w (
      .clk(clk), .d({closed, clamp}), .q({closed_at_elbow_w, clamp_at_elbow_w})
  );
  localparam integer DROP = F_ELBOW_W - F_QE_W;
  localparam signed [N-1:0] HALF = {{(N - 1) {1'b0}}, 1'b1} << (DROP - 1);
  localparam signed [W-1:0] UNIT = {2'b01, {(W - 2) {1'b0}}};
  wire signed [N-1:0] plus_w = HALF + elbow_w;
  wire signed [N-1:0] minus_i = HALF - elbow_i;
  always @(posedge clk) begin
    qe_w <= !clamp_at_elbow_w ? plus_w[DROP+:W] : closed_at_elbow_w ? UNIT : {W{1'b0}};
    qe_i <= !clamp_at_elbow_w ? minus_i[DROP+:W] : closed_at_elbow_w ? {W{1'b0}} : -UNIT;
  end
  wire unused_el = &{1'b0, plus_w, minus_i};  // dropped by rounding

  // ---- 1/(4 d1 |p|), as a mantissa, and K in its units ----

  wire signed [N-1:0] inv_11;
  wire signed [N:0] inv_law_raw;
  // inv_11 = inv_1^2
  ik_mul3 #(.AW(N), .BW(N), .SH(F_INV_1+F_INV_1-F_INV_11), .OW(N), .SQUARE(1), .TILE(TILE)) u_inv_11 (
      .clk(clk), .a(inv_1), .b(inv_1), .q(inv_11)
  );
  // inv_law_raw = 2 * inv_11 * inv_s
  ik_mul3 #(.AW(N), .BW(N), .SH(F_INV_11+F_INV_S-1-F_INV_LAW_RAW), .OW(N+1), .DA(T_INV_S-T_INV_11),
      .TILE(TILE)) u_inv_law (
      .clk(clk), .a(inv_11), .b(inv_s), .q(inv_law_raw)
  );
  reg signed [N-1:0] inv_law;
  always @(posedge clk) inv_law <= (|inv_law_raw[N:N-1]) ? TOP : inv_law_raw[N-1:0];

  wire [5:0] e_1_at_e_s;
  reg [5:0] n_law;
  ik_delay #(.W(6), .N(T_E_S-T_E_1)) u_e_1_at_e_s (.clk(clk), .d(e_1), .q(e_1_at_e_s));
  always @(posedge clk) n_law <= {e_1_at_e_s[4:0], 1'b0} + e_s;
  wire unused_e = e_1_at_e_s[5];  // at most 15 pairs
  wire signed [N-1:0] k_scaled;
  // Short words are padded with zeros below.
  localparam integer DROP_K = (2 * W + ODD > FRAC) ? 2 * W + ODD - FRAC : 1;
  localparam integer PAD_K = DROP_K - (2 * W + ODD - FRAC);
  localparam integer KW = 2 * W + 2 + PAD_K;
  wire signed [KW-1:0] k_law_x = $signed(k_law);
  ik_shift3 #(.IW(KW), .DROP(DROP_K), .OW(N), .DD(T_N_LAW-T_K_LAW)) u_k_scaled (
      .clk(clk), .d(k_law_x <<< PAD_K), .count(n_law), .q(k_scaled)
  );
  wire signed [N-1:0] cos_a;
  // cos_a = 2 * k_scaled * inv_law
  ik_mul3 #(.AW(N), .BW(N), .SH(F_K_SCALED+F_INV_LAW-1-F_COS_A), .OW(N), .DA(T_INV_LAW-T_K_SCALED),
      .TILE(TILE)) u_cos_a (
      .clk(clk), .a(k_scaled), .b(inv_law), .q(cos_a)
  );

  // ---- sin a ----

  wire signed [N-1:0] root_ab;
  // root_ab = root_far * root_near
  ik_mul3 #(.AW(N), .BW(N), .SH(F_ROOT_FAR+F_ROOT_NEAR-F_ROOT_AB), .OW(N), .TILE(TILE)) u_root_ab (
      .clk(clk), .a(root_far), .b(root_near), .q(root_ab)
  );
  wire [5:0] e_s_at_e_far;
  reg [5:0] e_ab, e_1s;
  reg [5:0] n_ab;
  ik_delay #(.W(6), .N(T_E_FAR-T_E_S)) u_e_s_at_e_far (.clk(clk), .d(e_s), .q(e_s_at_e_far));
  always @(posedge clk) begin
    e_ab <= e_far + e_near + RAISED;
    e_1s <= {e_1_at_e_far[4:0], 1'b0} + e_s_at_e_far;
    n_ab <= e_ab - e_1s;
  end
  localparam integer T_INV_LAW_AB_IN = T_INV_LAW_AB_RAW - LAT_SHIFT;
  wire signed [RW-1:0] inv_law_ab_raw;
  ik_shift #(.W(RW), .RIGHT(1), .DD(T_INV_LAW_AB_IN-T_INV_LAW), .DC(T_INV_LAW_AB_IN-T_N_AB)) u_inv_law_ab (
      .clk(clk), .d({inv_law[N-1], inv_law, 2'b00}), .count(n_ab), .q(inv_law_ab_raw)
  );
  reg signed [N-1:0] inv_law_ab;
  always @(posedge clk) inv_law_ab <= (|inv_law_ab_raw[RW-1:N-1]) ? TOP : inv_law_ab_raw[N-1:0];

  localparam integer T_SIN_A_IN = T_SIN_A - LAT_MUL3;
  wire signed [N-1:0] sin_a;
  // sin_a = 2 * root_ab * inv_law_ab
  ik_mul3 #(.AW(N), .BW(N), .SH(F_ROOT_AB+F_INV_LAW_AB-1-F_SIN_A), .OW(N), .DA(T_SIN_A_IN-T_ROOT_AB),
      .DB(T_SIN_A_IN-T_INV_LAW_AB), .TILE(TILE)) u_sin_a (
      .clk(clk), .a(root_ab), .b(inv_law_ab), .q(sin_a)
  );

  // ---- bend: the last rotation is by -a; a clamped arm points at the target, (1, 0), or away ----

  localparam signed [N-1:0] ONE = {{(N - 1) {1'b0}}, 1'b1} << FRAC;
  wire clamp_at_cos_a, away_at_cos_a, clamp_at_sin_a, swap_at_sin_a;
  wire signed [N-1:0] bend_sq_at_sin_a;
  ik_delay #(.W(2), .N(T_COS_A-T_CLAMP)) u_clamp_at_cos_a (
      .clk(clk), .d({away, clamp}), .q({away_at_cos_a, clamp_at_cos_a})
  );
  ik_delay #(.W(1), .N(T_SIN_A-T_COS_A)) u_clamp_at_sin_a (.clk(clk), .d(clamp_at_cos_a), .q(clamp_at_sin_a));
  ik_delay #(.W(1), .N(T_SIN_A-T_BEND_SWAP)) u_swap_at_sin_a (.clk(clk), .d(bend_swap), .q(swap_at_sin_a));
  ik_delay #(.W(N), .N(T_SIN_A-T_BEND_SQ)) u_bend_sq_at_sin_a (.clk(clk), .d(bend_sq), .q(bend_sq_at_sin_a));
  wire [N-1:0] sum_bend = ONE + (cos_a ^ {N{cos_a[N-1]}});  // 1 + |cos a|, by the one's complement
  wire signed [N-1:0] half_bend = sin_a >>> 1;
  wire signed [N-1:0] small_bend = half_bend & {N{!clamp_at_sin_a}};
  reg signed [N-1:0] bend_s;  // for waves only
  always @(posedge clk) begin
    bend_sq   <= clamp_at_cos_a ? ONE : (sum_bend >> 1);
    bend_swap <= clamp_at_cos_a ? away_at_cos_a : cos_a[N-1];
    bend_c    <= swap_at_sin_a ? small_bend : bend_sq_at_sin_a;
    bend_s    <= swap_at_sin_a ? bend_sq_at_sin_a : small_bend;
    bend_sum  <= bend_sq_at_sin_a + small_bend;
    bend_dif  <= bend_sq_at_sin_a - small_bend;
  end
  wire unused_bend_s = &{1'b0, bend_s};

endmodule

`default_nettype wire
