// Rounding and format of each node: ik_lean_nodes.vh; products by ik_mul3, root faithful, results half up.
// SPDX-License-Identifier: Apache-2.0
//
// The shoulder quaternion Qs (18): four rotations multiplied, by azimuth and 90 degrees about z (h1), by the angle to the z
// axis about x (ht), by the swivel angle about z (sin_h, cos_h), by -a about x (ha), and divided by their length.
`default_nettype none

module ik_lean_turn #(
    parameter integer W = 32,  // word length, 16 to 32
    parameter integer N = (W < 16) ? 23 : ((W < 28) ? W + 7 : 35)  // of an inner word: follows from W
) (
    input  wire                clk,
    input  wire signed [W-1:0] phi,
    input  wire signed [N-1:0] g_1,   // T_G_1
    input  wire signed [N-1:0] h1_c,  // T_H1_C
    input  wire signed [N-1:0] h1_s,
    input  wire signed [N-1:0] g_t,   // T_G_T
    input  wire signed [N-1:0] ht_c,  // T_HT_C
    input  wire signed [N-1:0] ht_s,
    input  wire signed [N-1:0] g_a,   // T_G_A
    input  wire signed [N-1:0] ha_c,  // T_HA_C
    input  wire signed [N-1:0] ha_s,
    output reg  signed [W-1:0] qs_w,  // T_QS_W
    output reg  signed [W-1:0] qs_i,
    output reg  signed [W-1:0] qs_j,
    output reg  signed [W-1:0] qs_k
);

  `include "ik_lean_nodes.vh"

  generate
    if (N != FRAC + 2) begin : g_illegal
      ik_lean_turn_N_is_FRAC_and_2 u_stop ();
    end
  endgenerate

  localparam integer MW = ROOT_FRAC + 3;  // of a mantissa

  // ---- (17) half the sum and half the difference of azimuth and swivel angle ----

  localparam integer TF = (FRAC < 31) ? FRAC : 31;  // fraction bits of sine and cosine
  wire signed [TF+1:0] sin_t;
  wire signed [TF+1:0] cos_t;
  wire signed [N-1:0] sin_x = {{(N - TF - 1) {sin_t[TF+1]}}, sin_t[TF:0]};
  wire signed [N-1:0] sin_h = sin_x <<< (FRAC - TF);
  wire signed [N-1:0] cos_x = {{(N - TF - 1) {cos_t[TF+1]}}, cos_t[TF:0]};
  wire signed [N-1:0] cos_h = cos_x <<< (FRAC - TF);
  wire signed [N-1:0] sin_h1;
  wire signed [N-1:0] cos_h1;
  // an angle of fewer than 16 bits is one of 16 that ends in zeros
  localparam integer PW = (W < 16) ? 16 : W;
  wire signed [PW-1:0] phi_w = {{(PW - W + 1) {phi[W-1]}}, phi[W-2:0]};
  ik_trig #(.W(PW), .F(TF)) u_trig (.clk(clk), .phi(phi_w <<< (PW - W)), .sin_h(sin_t), .cos_h(cos_t));
  ik_delay #(.W(2*N), .N(T_H1_C-T_SIN_H)) u_trig_h1 (.clk(clk), .d({cos_h, sin_h}), .q({cos_h1, sin_h1}));

  wire signed [N-1:0] cc;
  wire signed [N-1:0] ss;
  wire signed [N-1:0] sc;
  wire signed [N-1:0] cs;
  ik_mul3 #(.AW(N), .BW(N), .SH(FRAC), .OW(N)) u_cc (.clk(clk), .a(h1_c), .b(cos_h1), .q(cc));
  ik_mul3 #(.AW(N), .BW(N), .SH(FRAC), .OW(N)) u_ss (.clk(clk), .a(h1_s), .b(sin_h1), .q(ss));
  ik_mul3 #(.AW(N), .BW(N), .SH(FRAC), .OW(N)) u_sc (.clk(clk), .a(h1_s), .b(cos_h1), .q(sc));
  ik_mul3 #(.AW(N), .BW(N), .SH(FRAC), .OW(N)) u_cs (.clk(clk), .a(h1_c), .b(sin_h1), .q(cs));
  reg signed [N-1:0] c_p;
  reg signed [N-1:0] c_m;
  reg signed [N-1:0] s_p;
  reg signed [N-1:0] s_m;
  always @(posedge clk) begin
    c_p <= cc - ss;
    c_m <= cc + ss;
    s_p <= sc + cs;
    s_m <= sc - cs;
  end

  // ---- (17) the first three rotations ----

  localparam integer T_0_IN = T_W_0 - LAT_MUL3;
  wire signed [N-1:0] ht_c_0;
  wire signed [N-1:0] ht_s_0;
  wire signed [N-1:0] c_p_0;
  wire signed [N-1:0] c_m_0;
  wire signed [N-1:0] s_p_0;
  wire signed [N-1:0] s_m_0;
  ik_delay #(.W(2*N), .N(T_0_IN-T_HT_C)) u_ht_0 (.clk(clk), .d({ht_s, ht_c}), .q({ht_s_0, ht_c_0}));
  ik_delay #(.W(4*N), .N(T_0_IN-T_C_P)) u_c_0 (
      .clk(clk), .d({s_m, s_p, c_m, c_p}), .q({s_m_0, s_p_0, c_m_0, c_p_0})
  );
  wire signed [N-1:0] w_0;
  wire signed [N-1:0] i_0;
  wire signed [N-1:0] j_0;
  wire signed [N-1:0] k_0;
  ik_mul3 #(.AW(N), .BW(N), .SH(FRAC), .OW(N)) u_w_0 (.clk(clk), .a(ht_c_0), .b(c_p_0), .q(w_0));
  ik_mul3 #(.AW(N), .BW(N), .SH(FRAC), .OW(N)) u_i_0 (.clk(clk), .a(ht_s_0), .b(c_m_0), .q(i_0));
  ik_mul3 #(.AW(N), .BW(N), .SH(FRAC), .OW(N)) u_j_0 (.clk(clk), .a(ht_s_0), .b(s_m_0), .q(j_0));
  ik_mul3 #(.AW(N), .BW(N), .SH(FRAC), .OW(N)) u_k_0 (.clk(clk), .a(ht_c_0), .b(s_p_0), .q(k_0));

  // ---- (18) and the fourth ----

  wire signed [N-1:0] w_0_a;
  wire signed [N-1:0] i_0_a;
  wire signed [N-1:0] j_0_a;
  wire signed [N-1:0] k_0_a;
  ik_delay #(.W(4*N), .N(T_HA_C-T_W_0)) u_0_a (
      .clk(clk), .d({k_0, j_0, i_0, w_0}), .q({k_0_a, j_0_a, i_0_a, w_0_a})
  );
  wire signed [N-1:0] w_c;
  wire signed [N-1:0] w_s;
  wire signed [N-1:0] i_c;
  wire signed [N-1:0] i_s;
  wire signed [N-1:0] j_c;
  wire signed [N-1:0] j_s;
  wire signed [N-1:0] k_c;
  wire signed [N-1:0] k_s;
  ik_mul3 #(.AW(N), .BW(N), .SH(FRAC), .OW(N)) u_w_c (.clk(clk), .a(w_0_a), .b(ha_c), .q(w_c));
  ik_mul3 #(.AW(N), .BW(N), .SH(FRAC), .OW(N)) u_w_s (.clk(clk), .a(w_0_a), .b(ha_s), .q(w_s));
  ik_mul3 #(.AW(N), .BW(N), .SH(FRAC), .OW(N)) u_i_c (.clk(clk), .a(i_0_a), .b(ha_c), .q(i_c));
  ik_mul3 #(.AW(N), .BW(N), .SH(FRAC), .OW(N)) u_i_s (.clk(clk), .a(i_0_a), .b(ha_s), .q(i_s));
  ik_mul3 #(.AW(N), .BW(N), .SH(FRAC), .OW(N)) u_j_c (.clk(clk), .a(j_0_a), .b(ha_c), .q(j_c));
  ik_mul3 #(.AW(N), .BW(N), .SH(FRAC), .OW(N)) u_j_s (.clk(clk), .a(j_0_a), .b(ha_s), .q(j_s));
  ik_mul3 #(.AW(N), .BW(N), .SH(FRAC), .OW(N)) u_k_c (.clk(clk), .a(k_0_a), .b(ha_c), .q(k_c));
  ik_mul3 #(.AW(N), .BW(N), .SH(FRAC), .OW(N)) u_k_s (.clk(clk), .a(k_0_a), .b(ha_s), .q(k_s));
  reg signed [N-1:0] w_1;
  reg signed [N-1:0] i_1;
  reg signed [N-1:0] j_1;
  reg signed [N-1:0] k_1;
  always @(posedge clk) begin
    w_1 <= w_c + i_s;
    i_1 <= i_c - w_s;
    j_1 <= j_c - k_s;
    k_1 <= k_c + j_s;
  end

  // ---- (18) the product's squared length, in [1/8, 1], and its root; four times the length where it is below 1/4 ----

  wire signed [N-1:0] g_1_t;
  wire signed [N-1:0] g_1t;
  wire signed [N-1:0] g_1t_a;
  wire signed [N-1:0] length_sq;
  ik_delay #(.W(N), .N(T_G_T-T_G_1)) u_g_1_t (.clk(clk), .d(g_1), .q(g_1_t));
  ik_mul3 #(.AW(N), .BW(N), .SH(FRAC), .OW(N)) u_g_1t (.clk(clk), .a(g_1_t), .b(g_t), .q(g_1t));
  localparam integer T_LENGTH_IN = T_LENGTH_SQ - LAT_MUL3;
  wire signed [N-1:0] g_a_in;
  ik_delay #(.W(N), .N(T_LENGTH_IN-T_G_1T)) u_g_1t_a (.clk(clk), .d(g_1t), .q(g_1t_a));
  ik_delay #(.W(N), .N(T_LENGTH_IN-T_G_A)) u_g_a_in (.clk(clk), .d(g_a), .q(g_a_in));
  ik_mul3 #(.AW(N), .BW(N), .SH(FRAC), .OW(N)) u_length_sq (.clk(clk), .a(g_1t_a), .b(g_a_in), .q(length_sq));

  localparam integer UP = MW - FRAC;
  wire low = (length_sq[N-1:FRAC-2] == {(N - FRAC + 2) {1'b0}});
  wire [MW-1:0] m_q_next = length_sq[FRAC] ? {MW{1'b1}} : low ? {length_sq[FRAC-3:0], {(UP + 2) {1'b0}}}
                                                              : {length_sq[FRAC-1:0], {UP{1'b0}}};
  reg [MW-1:0] m_q;  // the node, watched only: the root has a register of its own
  always @(posedge clk) m_q <= m_q_next;
  wire [ROOT_FRAC:0] y_q;
  wire [N-1:0] y_q_x = {{(N - ROOT_FRAC - 1) {1'b0}}, y_q};
  wire signed [N-1:0] inv_q = y_q_x << (FRAC - ROOT_FRAC);
  ik_rsqrt #(.F(ROOT_FRAC)) u_inv_q (.clk(clk), .m_next(m_q_next), .y(y_q));

  // ---- (18) the quaternion of length 1 whose k part is not negative ----

  localparam integer T_N_IN = T_W_N - LAT_MUX;
  wire low_n;
  ik_delay #(.W(1), .N(T_N_IN-T_LOW)) u_low_n (.clk(clk), .d(low), .q(low_n));
  reg signed [N-1:0] w_n;
  reg signed [N-1:0] i_n;
  reg signed [N-1:0] j_n;
  reg signed [N-1:0] k_n;
  wire minus = k_1[N-1];
  wire signed [N-1:0] one = {{(N - 1) {1'b0}}, minus};  // -x = ~x + 1, by one carry chain
  always @(posedge clk) begin
    w_n <= ((low_n ? (w_1 <<< 1) : w_1) ^ {N{minus}}) + one;
    i_n <= ((low_n ? (i_1 <<< 1) : i_1) ^ {N{minus}}) + one;
    j_n <= ((low_n ? (j_1 <<< 1) : j_1) ^ {N{minus}}) + one;
    k_n <= ((low_n ? (k_1 <<< 1) : k_1) ^ {N{minus}}) + one;
  end

  localparam integer T_Q_IN = T_W_Q - LAT_MUL3;
  wire signed [N-1:0] w_n_q;
  wire signed [N-1:0] i_n_q;
  wire signed [N-1:0] j_n_q;
  wire signed [N-1:0] k_n_q;
  wire signed [N-1:0] inv_q_q;
  ik_delay #(.W(4*N), .N(T_Q_IN-T_W_N)) u_n_q (
      .clk(clk), .d({k_n, j_n, i_n, w_n}), .q({k_n_q, j_n_q, i_n_q, w_n_q})
  );
  ik_delay #(.W(N), .N(T_Q_IN-T_INV_Q)) u_inv_q_q (.clk(clk), .d(inv_q), .q(inv_q_q));
  wire signed [N-1:0] w_q;
  wire signed [N-1:0] i_q;
  wire signed [N-1:0] j_q;
  wire signed [N-1:0] k_q;
  localparam integer SH_Q = F_W_N + F_INV_Q - 1 - F_W_Q;
  ik_mul3 #(.AW(N), .BW(N), .SH(SH_Q), .OW(N)) u_w_q (.clk(clk), .a(w_n_q), .b(inv_q_q), .q(w_q));
  ik_mul3 #(.AW(N), .BW(N), .SH(SH_Q), .OW(N)) u_i_q (.clk(clk), .a(i_n_q), .b(inv_q_q), .q(i_q));
  ik_mul3 #(.AW(N), .BW(N), .SH(SH_Q), .OW(N)) u_j_q (.clk(clk), .a(j_n_q), .b(inv_q_q), .q(j_q));
  ik_mul3 #(.AW(N), .BW(N), .SH(SH_Q), .OW(N)) u_k_q (.clk(clk), .a(k_n_q), .b(inv_q_q), .q(k_q));

  localparam integer DROP = F_W_Q - F_QS_W;
  localparam signed [N-1:0] HALF = {{(N - 1) {1'b0}}, 1'b1} << (DROP - 1);
  wire signed [N-1:0] w_r = w_q + HALF;
  wire signed [N-1:0] i_r = i_q + HALF;
  wire signed [N-1:0] j_r = j_q + HALF;
  wire signed [N-1:0] k_r = k_q + HALF;
  always @(posedge clk) begin
    qs_w <= w_r[DROP+:W];
    qs_i <= i_r[DROP+:W];
    qs_j <= j_r[DROP+:W];
    qs_k <= k_r[DROP+:W];
  end
  wire unused = &{1'b0, m_q, w_r[DROP-1:0], i_r[DROP-1:0], j_r[DROP-1:0], k_r[DROP-1:0]};

endmodule

`default_nettype wire
