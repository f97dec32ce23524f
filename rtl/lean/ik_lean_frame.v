// The wrist's orientation Qw, from Qs, Qe and the hand.
// SPDX-License-Identifier: Apache-2.0
//
// Format of each node: ik_arm_nodes.vh; rounding: products as in ik_mul3, results half up.
// Qw = (Qs Rx(th4))~ Qh, as two quaternion products: G = Qs~ h, then (-qe_i + qe_w i)~ G. h, qs and qe are valid at
// clock T_QS_W, each output at its clock T_<NODE>.
// Throughput: one pose per clock.
`default_nettype none

module ik_lean_frame #(
    parameter integer W = 32,  // word length, 16 to 32
    parameter integer N = 35,  // inner word width: FRAC + 2
    parameter integer TILE = 18  // see ik_mul3
) (
    // Clock
    input  wire                clk,
    // Orientation of the hand
    input  wire signed [W-1:0] h_w,
    input  wire signed [W-1:0] h_i,
    input  wire signed [W-1:0] h_j,
    input  wire signed [W-1:0] h_k,
    // Shoulder and elbow
    input  wire signed [W-1:0] qs_w,
    input  wire signed [W-1:0] qs_i,
    input  wire signed [W-1:0] qs_j,
    input  wire signed [W-1:0] qs_k,
    input  wire signed [W-1:0] qe_w,
    input  wire signed [W-1:0] qe_i,
    // Results
    output reg  signed [W-1:0] qw_w,  // T_QW_W
    output reg  signed [W-1:0] qw_i,
    output reg  signed [W-1:0] qw_j,
    output reg  signed [W-1:0] qw_k
);

  `include "ik_arm_nodes.vh"

  generate
    if (N != FRAC + 2) begin : g_illegal
      ik_lean_frame_illegal_N u_stop ();
    end
  endgenerate

  // ---- G = Qs~ h ----

  localparam integer SH_G = F_QS_W + F_H_W - F_G_WW;
  localparam integer FAR = T_G_WW - LAT_MUL3 - T_QS_W;
  wire signed [W-1:0] qs_w_q, qs_i_q, qs_j_q, qs_k_q, h_w_q, h_i_q, h_j_q, h_k_q;
  ik_delay #(.W(8*W), .N(FAR)) u_q (
      .clk(clk), .d({h_k, h_j, h_i, h_w, qs_k, qs_j, qs_i, qs_w}),
      .q({h_k_q, h_j_q, h_i_q, h_w_q, qs_k_q, qs_j_q, qs_i_q, qs_w_q})
  );
  wire signed [N-1:0] g_ww;
  wire signed [N-1:0] g_ii;
  wire signed [N-1:0] g_jj;
  wire signed [N-1:0] g_kk;
  wire signed [N-1:0] g_wi;
  wire signed [N-1:0] g_iw;
  wire signed [N-1:0] g_jk;
  wire signed [N-1:0] g_kj;
  wire signed [N-1:0] g_wj;
  wire signed [N-1:0] g_jw;
  wire signed [N-1:0] g_ki;
  wire signed [N-1:0] g_ik;
  wire signed [N-1:0] g_wk;
  wire signed [N-1:0] g_kw;
  wire signed [N-1:0] g_ij;
  wire signed [N-1:0] g_ji;
  // g_ww = qs_w * h_w
  // g_iw = qs_i * h_w
  // g_jw = qs_j * h_w
  // g_kw = qs_k * h_w
  ik_scale #(.AW(W), .BW(W), .SH(SH_G), .OW(N), .TILE(TILE)) u_by_h_w (
      .clk(clk), .a({qs_k_q, qs_j_q, qs_i_q, qs_w_q}), .b(h_w_q), .q({g_kw, g_jw, g_iw, g_ww})
  );
  // g_wi = qs_w * h_i
  // g_ii = qs_i * h_i
  // g_ji = qs_j * h_i
  // g_ki = qs_k * h_i
  ik_scale #(.AW(W), .BW(W), .SH(SH_G), .OW(N), .TILE(TILE)) u_by_h_i (
      .clk(clk), .a({qs_k_q, qs_j_q, qs_i_q, qs_w_q}), .b(h_i_q), .q({g_ki, g_ji, g_ii, g_wi})
  );
  // g_wj = qs_w * h_j
  // g_ij = qs_i * h_j
  // g_jj = qs_j * h_j
  // g_kj = qs_k * h_j
  ik_scale #(.AW(W), .BW(W), .SH(SH_G), .OW(N), .TILE(TILE)) u_by_h_j (
      .clk(clk), .a({qs_k_q, qs_j_q, qs_i_q, qs_w_q}), .b(h_j_q), .q({g_kj, g_jj, g_ij, g_wj})
  );
  // g_wk = qs_w * h_k
  // g_ik = qs_i * h_k
  // g_jk = qs_j * h_k
  // g_kk = qs_k * h_k
  ik_scale #(.AW(W), .BW(W), .SH(SH_G), .OW(N), .TILE(TILE)) u_by_h_k (
      .clk(clk), .a({qs_k_q, qs_j_q, qs_i_q, qs_w_q}), .b(h_k_q), .q({g_kk, g_jk, g_ik, g_wk})
  );

  reg signed [N-1:0] g_w_1, g_w_2, g_i_1, g_i_2, g_j_1, g_j_2, g_k_1, g_k_2;
  reg signed [N-1:0] g_w;
  reg signed [N-1:0] g_i;
  reg signed [N-1:0] g_j;
  reg signed [N-1:0] g_k;
  always @(posedge clk) begin
    g_w_1 <= g_ww + g_ii;
    g_w_2 <= g_jj + g_kk;
    g_i_1 <= g_wi - g_iw;
    g_i_2 <= g_kj - g_jk;
    g_j_1 <= g_wj - g_jw;
    g_j_2 <= g_ik - g_ki;
    g_k_1 <= g_wk - g_kw;
    g_k_2 <= g_ji - g_ij;
    g_w   <= g_w_1 + g_w_2;
    g_i   <= g_i_1 + g_i_2;
    g_j   <= g_j_1 + g_j_2;
    g_k   <= g_k_1 + g_k_2;
  end

  // ---- Qw = (-qe_i + qe_w i)~ G ----

  localparam integer SH_F = F_G_W + F_QE_W - F_F_WW;
  localparam integer T_F_IN = T_F_WW - LAT_MUL3;
  wire signed [W-1:0] qe_w_at_f, qe_i_at_f;
  ik_delay #(.W(2*W), .N(T_F_IN-T_QS_W)) u_qe_at_f (.clk(clk), .d({qe_i, qe_w}), .q({qe_i_at_f, qe_w_at_f}));
  wire signed [N-1:0] f_ww;
  wire signed [N-1:0] f_wi;
  wire signed [N-1:0] f_ii;
  wire signed [N-1:0] f_iw;
  wire signed [N-1:0] f_jj;
  wire signed [N-1:0] f_jk;
  wire signed [N-1:0] f_kk;
  wire signed [N-1:0] f_kj;
  // f_ww = g_w * qe_i
  // f_ii = g_i * qe_i
  // f_jj = g_j * qe_i
  // f_kk = g_k * qe_i
  ik_scale #(.AW(N), .BW(W), .SH(SH_F), .OW(N), .DA(T_F_IN-T_G_W), .TILE(TILE)) u_by_qe_i (
      .clk(clk), .a({g_k, g_j, g_i, g_w}), .b(qe_i_at_f), .q({f_kk, f_jj, f_ii, f_ww})
  );
  // f_iw = g_w * qe_w
  // f_wi = g_i * qe_w
  // f_kj = g_j * qe_w
  // f_jk = g_k * qe_w
  ik_scale #(.AW(N), .BW(W), .SH(SH_F), .OW(N), .DA(T_F_IN-T_G_W), .TILE(TILE)) u_by_qe_w (
      .clk(clk), .a({g_k, g_j, g_i, g_w}), .b(qe_w_at_f), .q({f_jk, f_kj, f_wi, f_iw})
  );

  localparam integer DROP = F_F_WW - F_QW_W;
  localparam signed [N-1:0] HALF = {{(N - 1) {1'b0}}, 1'b1} << (DROP - 1);
  reg signed [N-1:0] dif_w, sum_i, dif_j, sum_k;
  wire signed [N-1:0] w_r = HALF + dif_w;
  wire signed [N-1:0] i_r = HALF - sum_i;
  wire signed [N-1:0] j_r = HALF + dif_j;
  wire signed [N-1:0] k_r = HALF - sum_k;
  always @(posedge clk) begin
    dif_w <= f_wi - f_ww;
    sum_i <= f_iw + f_ii;
    dif_j <= f_jk - f_jj;
    sum_k <= f_kj + f_kk;
    qw_w  <= w_r[DROP+:W];
    qw_i  <= i_r[DROP+:W];
    qw_j  <= j_r[DROP+:W];
    qw_k  <= k_r[DROP+:W];
  end
  wire unused = &{1'b0, w_r[DROP-1:0], i_r[DROP-1:0], j_r[DROP-1:0], k_r[DROP-1:0]};

endmodule

`default_nettype wire
