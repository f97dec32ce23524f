// The shoulder quaternion Qs (18), the product of four rotations divided by its length.
// SPDX-License-Identifier: Apache-2.0
//
// Format of each node: ik_lean_nodes.vh; rounding: products as in ik_mul3, root faithful, results half up.
// The rotations: azimuth plus 90 degrees about z (az), angle to the z axis about x (tilt), swivel angle about z (sin_h,
// cos_h), -a about x (bend). phi at clock 0, each other port at its clock T_<NODE>.
// Throughput: one target per clock.
`default_nettype none

module ik_lean_turn #(
    parameter integer W = 32,  // word length, 16 to 32
    parameter integer N = 35,  // inner word width: FRAC + 2
    parameter integer TILE = 18  // see ik_mul3
) (
    // Clock
    input  wire                clk,
    // Target
    input  wire signed [W-1:0] phi,
    // From direction
    input  wire signed [N-1:0] az_sq,    // T_AZ_SQ
    input  wire signed [N-1:0] az_c,     // T_AZ_C
    input  wire signed [N-1:0] az_s,
    input  wire signed [N-1:0] tilt_sq,  // T_TILT_SQ
    input  wire signed [N-1:0] tilt_c,   // T_TILT_C
    input  wire signed [N-1:0] tilt_s,
    // From triangle
    input  wire signed [N-1:0] bend_sq,   // T_BEND_SQ
    input  wire                bend_swap,  // T_BEND_SWAP
    input  wire signed [N-1:0] bend_c,    // T_BEND_C
    input  wire signed [N-1:0] bend_sum,
    input  wire signed [N-1:0] bend_dif,
    // Results
    output reg  signed [W-1:0] qs_w,     // (18) T_QS_W
    output reg  signed [W-1:0] qs_i,     // (18)
    output reg  signed [W-1:0] qs_j,     // (18)
    output reg  signed [W-1:0] qs_k      // (18)
);

  `include "ik_lean_nodes.vh"

  generate
    if (N != FRAC + 2) begin : g_illegal
      ik_lean_turn_illegal_N u_stop ();
    end
  endgenerate

  localparam integer MW = ROOT_FRAC + 3;  // width of a mantissa

  // ---- half the sum and half the difference of azimuth and swivel angle ----

  localparam integer TF = (FRAC < 31) ? FRAC : 31;  // fraction bits of sine and cosine
  wire signed [TF+1:0] sin_t, cos_t;
  wire signed [N-1:0] sin_x = {{(N - TF - 1) {sin_t[TF+1]}}, sin_t[TF:0]};
  wire signed [N-1:0] sin_h = sin_x <<< (FRAC - TF);
  wire signed [N-1:0] cos_x = {{(N - TF - 1) {cos_t[TF+1]}}, cos_t[TF:0]};
  wire signed [N-1:0] cos_h = cos_x <<< (FRAC - TF);
  // An angle shorter than WX bits is padded with zeros below.
  wire signed [WX-1:0] phi_w = {{(WX - W + 1) {phi[W-1]}}, phi[W-2:0]};
  // sin_h = sin(phi / 2)
  // cos_h = cos(phi / 2)
  ik_trig #(.W(WX), .F(TF), .TILE(TILE)) u_trig (.clk(clk), .phi(phi_w <<< (WX - W)), .sin_h(sin_t), .cos_h(cos_t));

  wire signed [N-1:0] cc;
  wire signed [N-1:0] ss;
  wire signed [N-1:0] sc;
  wire signed [N-1:0] cs;
  // cc = az_c * cos_h
  // sc = az_s * cos_h
  ik_scale #(.COUNT(2), .AW(N), .BW(N), .SH(FRAC), .OW(N), .DB(T_AZ_C-T_SIN_H), .TILE(TILE)) u_by_cos_h (
      .clk(clk), .a({az_s, az_c}), .b(cos_h), .q({sc, cc})
  );
  // cs = az_c * sin_h
  // ss = az_s * sin_h
  ik_scale #(.COUNT(2), .AW(N), .BW(N), .SH(FRAC), .OW(N), .DB(T_AZ_C-T_SIN_H), .TILE(TILE)) u_by_sin_h (
      .clk(clk), .a({az_s, az_c}), .b(sin_h), .q({ss, cs})
  );
  reg signed [N-1:0] c_plus;
  reg signed [N-1:0] c_minus;
  reg signed [N-1:0] s_plus;
  reg signed [N-1:0] s_minus;
  always @(posedge clk) begin
    c_plus <= cc - ss;
    c_minus <= cc + ss;
    s_plus <= sc + cs;
    s_minus <= sc - cs;
  end

  // ---- the first three rotations ----

  localparam integer T_0_IN = T_W_0 - LAT_MUL3;
  wire signed [N-1:0] w_0;
  wire signed [N-1:0] i_0;
  wire signed [N-1:0] j_0;
  wire signed [N-1:0] k_0;
  // w_0 = tilt_c * c_plus
  ik_mul3 #(.AW(N), .BW(N), .SH(FRAC), .OW(N), .DA(T_0_IN-T_TILT_C), .DB(T_0_IN-T_C_PLUS), .TILE(TILE)) u_w_0 (
      .clk(clk), .a(tilt_c), .b(c_plus), .q(w_0)
  );
  // i_0 = tilt_s * c_minus
  ik_mul3 #(.AW(N), .BW(N), .SH(FRAC), .OW(N), .DA(T_0_IN-T_TILT_C), .DB(T_0_IN-T_C_PLUS), .TILE(TILE)) u_i_0 (
      .clk(clk), .a(tilt_s), .b(c_minus), .q(i_0)
  );
  // j_0 = tilt_s * s_minus
  ik_mul3 #(.AW(N), .BW(N), .SH(FRAC), .OW(N), .DA(T_0_IN-T_TILT_C), .DB(T_0_IN-T_C_PLUS), .TILE(TILE)) u_j_0 (
      .clk(clk), .a(tilt_s), .b(s_minus), .q(j_0)
  );
  // k_0 = tilt_c * s_plus
  ik_mul3 #(.AW(N), .BW(N), .SH(FRAC), .OW(N), .DA(T_0_IN-T_TILT_C), .DB(T_0_IN-T_C_PLUS), .TILE(TILE)) u_k_0 (
      .clk(clk), .a(tilt_c), .b(s_plus), .q(k_0)
  );

  // ---- the fourth rotation: w c + i s = (w + i) c - i (c - s), i c - w s = (w + i) c - w (c + s); c - s
  // changes sign if the parts of bend are swapped ----

  reg signed [N-1:0] wi_0;
  reg signed [N-1:0] kj_0;
  always @(posedge clk) begin
    wi_0 <= w_0 + i_0;
    kj_0 <= k_0 + j_0;
  end

  localparam integer T_1_IN = T_WI_C - LAT_MUL3;
  wire signed [N-1:0] wi_c;
  wire signed [N-1:0] i_dif;
  wire signed [N-1:0] w_sum;
  wire signed [N-1:0] kj_c;
  wire signed [N-1:0] j_dif;
  wire signed [N-1:0] k_sum;
  // wi_c = wi_0 * bend_c
  // kj_c = kj_0 * bend_c
  ik_scale #(.COUNT(2), .AW(N), .BW(N), .SH(FRAC), .OW(N), .DA(T_1_IN-T_WI_0), .DB(T_1_IN-T_BEND_C),
      .TILE(TILE)) u_by_bend_c (
      .clk(clk), .a({kj_0, wi_0}), .b(bend_c), .q({kj_c, wi_c})
  );
  // i_dif = i_0 * bend_dif
  // j_dif = j_0 * bend_dif
  ik_scale #(.COUNT(2), .AW(N), .BW(N), .SH(FRAC), .OW(N), .DA(T_1_IN-T_I_0), .DB(T_1_IN-T_BEND_DIF),
      .TILE(TILE)) u_by_bend_dif (
      .clk(clk), .a({j_0, i_0}), .b(bend_dif), .q({j_dif, i_dif})
  );
  // w_sum = w_0 * bend_sum
  // k_sum = k_0 * bend_sum
  ik_scale #(.COUNT(2), .AW(N), .BW(N), .SH(FRAC), .OW(N), .DA(T_1_IN-T_W_0), .DB(T_1_IN-T_BEND_SUM),
      .TILE(TILE)) u_by_bend_sum (
      .clk(clk), .a({k_0, w_0}), .b(bend_sum), .q({k_sum, w_sum})
  );
  reg signed [N-1:0] w_1;
  reg signed [N-1:0] i_1;
  reg signed [N-1:0] j_1;
  reg signed [N-1:0] k_1;
  wire swap_at_wi_c;
  ik_delay #(.W(1), .N(T_WI_C-T_BEND_SWAP)) u_swap_at_wi_c (.clk(clk), .d(bend_swap), .q(swap_at_wi_c));
  // Add or subtract on one carry chain; the extra lowest bit generates the carry.
  wire take = !swap_at_wi_c;
  wire signed [N:0] w_x = {wi_c, 1'b1} + {i_dif ^ {N{take}}, take};
  wire signed [N:0] k_x = {kj_c, 1'b1} + {j_dif ^ {N{take}}, take};
  always @(posedge clk) begin
    w_1 <= w_x[N:1];
    i_1 <= wi_c - w_sum;
    j_1 <= kj_c - k_sum;
    k_1 <= k_x[N:1];
  end

  // ---- the product's squared length, in [1/8, 1], and its reciprocal root; below 1/4, of 4 times it ----

  wire signed [N-1:0] az_tilt_sq;
  wire signed [N-1:0] length_sq;
  // az_tilt_sq = az_sq * tilt_sq
  ik_mul3 #(.AW(N), .BW(N), .SH(FRAC), .OW(N), .DA(T_TILT_SQ-T_AZ_SQ), .TILE(TILE)) u_az_tilt_sq (
      .clk(clk), .a(az_sq), .b(tilt_sq), .q(az_tilt_sq)
  );
  localparam integer T_LENGTH_IN = T_LENGTH_SQ - LAT_MUL3;
  // length_sq = az_tilt_sq * bend_sq
  ik_mul3 #(.AW(N), .BW(N), .SH(FRAC), .OW(N), .DA(T_LENGTH_IN-T_AZ_TILT_SQ), .DB(T_LENGTH_IN-T_BEND_SQ),
      .TILE(TILE)) u_length_sq (
      .clk(clk), .a(az_tilt_sq), .b(bend_sq), .q(length_sq)
  );

  localparam integer UP = MW - FRAC;
  wire low = (length_sq[N-1:FRAC-2] == {(N - FRAC + 2) {1'b0}});
  wire [MW-1:0] m_q_next = length_sq[FRAC] ? {MW{1'b1}} : low ? {length_sq[FRAC-3:0], {(UP + 2) {1'b0}}}
                                                              : {length_sq[FRAC-1:0], {UP{1'b0}}};
  reg [MW-1:0] m_q;  // for waves only: ik_rsqrt has its own register
  always @(posedge clk) m_q <= m_q_next;
  wire [ROOT_FRAC:0] y_q;
  wire [N-1:0] y_q_x = {{(N - ROOT_FRAC - 1) {1'b0}}, y_q};
  wire signed [N-1:0] inv_q = y_q_x << (FRAC - ROOT_FRAC);
  wire low_at_m_q;
  ik_delay #(.W(1), .N(T_M_Q-T_LOW)) u_low_at_m_q (.clk(clk), .d(low), .q(low_at_m_q));
  // inv_q = low ? 1 / sqrt m_q : 1 / (2 * sqrt m_q)
  ik_rsqrt #(.F(ROOT_FRAC), .TILE(TILE)) u_inv_q (.clk(clk), .m_next(m_q_next), .twice(low_at_m_q), .y(y_q));

  // ---- the unit quaternion with a non-negative k part ----

  wire signed [N-1:0] w_q;
  wire signed [N-1:0] i_q;
  wire signed [N-1:0] j_q;
  wire signed [N-1:0] k_q;
  localparam integer SH_Q = F_W_1 + F_INV_Q - 1 - F_W_Q;
  localparam integer T_Q_IN = T_W_Q - LAT_MUL3;
  // w_q = 2 * w_1 * inv_q
  // i_q = 2 * i_1 * inv_q
  // j_q = 2 * j_1 * inv_q
  // k_q = 2 * k_1 * inv_q
  ik_scale #(.AW(N), .BW(N), .SH(SH_Q), .OW(N), .DA(T_Q_IN-T_W_1), .DB(T_Q_IN-T_INV_Q), .TILE(TILE)) u_by_inv_q (
      .clk(clk), .a({k_1, j_1, i_1, w_1}), .b(inv_q), .q({k_q, j_q, i_q, w_q})
  );

  localparam integer DROP = F_W_Q - F_QS_W;
  wire minus = k_1[N-1];
  wire minus_at_w_q;
  ik_delay #(.W(1), .N(T_W_Q-T_W_1)) u_minus_at_w_q (.clk(clk), .d(minus), .q(minus_at_w_q));
  // Half an LSB of the result, and the 1 of -x = ~x + 1 on the same carry chain
  wire signed [N-1:0] half = {{(N - DROP) {1'b0}}, 1'b1, {(DROP - 2) {1'b0}}, minus_at_w_q};
  wire signed [N-1:0] w_r = (w_q ^ {N{minus_at_w_q}}) + half;
  wire signed [N-1:0] i_r = (i_q ^ {N{minus_at_w_q}}) + half;
  wire signed [N-1:0] j_r = (j_q ^ {N{minus_at_w_q}}) + half;
  wire signed [N-1:0] k_r = (k_q ^ {N{minus_at_w_q}}) + half;
  always @(posedge clk) begin
    qs_w <= w_r[DROP+:W];
    qs_i <= i_r[DROP+:W];
    qs_j <= j_r[DROP+:W];
    qs_k <= k_r[DROP+:W];
  end
  wire unused = &{1'b0, m_q, w_x[0], k_x[0], w_r[DROP-1:0], i_r[DROP-1:0], j_r[DROP-1:0], k_r[DROP-1:0]};

endmodule

`default_nettype wire
