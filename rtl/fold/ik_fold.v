// The lean dataflow as a program for one multiplier, bit for bit, with AXI4-Stream ports.
// SPDX-License-Identifier: Apache-2.0
//
// Results Q2.(W-2), rounded half up; inputs Q2.(W-2) and a binary angle.
// ik_fold_lap follows the targets through laps of PERIOD clocks, ik_fold_fetch supplies a step of the program each
// clock, ik_fold_datapath carries it out, and ik_fold_results collects the words of a result.
// Throughput: one target per PERIOD clocks.
// Latency: set by the program (ik_fold_program.vh), counted from the clock that accepts the target.
`default_nettype none

module ik_fold #(
    parameter integer W     = 24,  // word length, even, 20 to 32; 18 to 24 with TILE = 16
    parameter integer TAG_W = 8,   // tag width, at least 1
    parameter integer TILE  = 18   // multiplier tile width: 18 or 16
) (
    input  wire               clk,
    input  wire               rst,            // synchronous, active high: discards all targets
    // Targets
    input  wire [    6*W-1:0] s_axis_tdata,   // x, y, z, phi, d1, d2, lowest bits first
    input  wire [  TAG_W-1:0] s_axis_tuser,
    input  wire               s_axis_tvalid,
    output wire               s_axis_tready,
    // Results
    output wire [    6*W-1:0] m_axis_tdata,   // qs_w, qs_i, qs_j, qs_k, qe_w, qe_i, lowest bits first
    output wire [TAG_W+8-1:0] m_axis_tuser,
    output wire               m_axis_tvalid,
    input  wire               m_axis_tready
);

  `include "ik_fold_codes.vh"
  `include "ik_fold_formats.vh"
  `include "ik_fold_fields.vh"
  `include "ik_fold_program.vh"

  generate
    if (W % 2 != 0 || W < ((TILE == 16) ? 18 : 20) || W > ((TILE == 16) ? 24 : 32)) begin : g_no_words
      ik_fold_illegal_W u_stop ();
    end
    if (TAG_W < 1) begin : g_no_tag
      ik_fold_illegal_TAG_W u_stop ();
    end
    if (TILE != 16 && TILE != 18) begin : g_no_tile
      ik_fold_illegal_TILE u_stop ();
    end
  endgenerate

  localparam integer D = ROOT_FRAC + 4;  // width of a word: mantissa and sign
  localparam integer XW = 2 * W + 2;  // width of an exact sum

  // ---- program and laps ----

  wire [6:0] fetched, clock;  // numbers of the step that is fetched, and of the current one
  wire go, load, waits, restart, begins, last, no_step, writing;
  wire [STEP_W-1:0] step;
  reg [STEP_W-1:0] fetched_step;
  always @(posedge clk) if (load) fetched_step <= rom[fetched];
  ik_fold_fetch #(.STEP_W(STEP_W), .CLOCK_W(7), .END(END), .REGISTERS(2), .EARLY(0)) u_fetch (
      .clk(clk), .rst(rst), .go(go), .waits(waits), .restart(restart),
      .fetched(fetched), .load(load), .fetched_step(fetched_step),
      .step(step), .clock(clock), .begins(begins), .last(last), .no_step(no_step)
  );
  wire first_result = step[AT_FIRST_RESULT];
  ik_fold_lap #(.HOLD_LAP(HOLD_LAP), .FIRST_LAP(FIRST_LAP), .LAST_LAP(LAST_LAP)) u_lap (
      .clk(clk), .rst(rst),
      .begins(begins), .last(last), .last_input(step[AT_LAST_INPUT]), .hold(step[AT_HOLD]), .first_result(first_result),
      .last_result(step[AT_LAST_RESULT]),
      .s_valid(s_axis_tvalid), .s_ready(s_axis_tready), .m_valid(m_axis_tvalid), .m_ready(m_axis_tready),
      .go(go), .waits(waits), .restart(restart), .writing(writing)
  );

  // ---- datapath; a word is a field of the target, a mantissa or a sum ----

  wire [BITS_SIGN-1:0] sign = step[AT_SIGN+:BITS_SIGN];
  wire [BITS_SOURCE-1:0] source = step[AT_SOURCE+:BITS_SOURCE];
  wire [BITS_INPUT-1:0] field = step[AT_INPUT+:BITS_INPUT];
  wire [W-1:0] in = s_axis_tdata[W*field+:W];
  wire [D-1:0] in_word = {in[W-1], in, {(D - W - 1) {1'b0}}};
  wire [XW-1:0] t;
  wire [D-1:0] word, normal;
  wire [D-1:0] w = source == SOURCE_INPUT ? in_word : source == SOURCE_NORMAL ? normal : word;
  wire [W-1:0] result;
  wire clamped, elbow_closed, doubled, q_low;
  wire [7:0] flags;
  wire [D-1:0] b;
  wire [2*D-1:0] p;
  wire [5:0] w_place, n, pairs;
  wire [9:0] flag_nodes;
  ik_fold_datapath #(.W(W), .TILE(TILE), .D(D), .XW(XW), .WORDS(WORDS)) u_datapath (
      .clk(clk), .go(go),
      .a_at(step[AT_A+:BITS_A]), .b_at(step[AT_B+:BITS_B]), .r_at(step[AT_R+:BITS_R]), .b_count(step[AT_B_COUNT]),
      .b_constant(1'b0), .a_bend(step[AT_A_BEND]), .b_place(step[AT_B_PLACE+:BITS_B_PLACE]),
      .b_high(step[AT_B_HIGH]), .r_function(step[AT_R_FUNCTION+:BITS_R_FUNCTION]),
      .cut(step[AT_CUT+:BITS_CUT]), .s(step[AT_S+:BITS_S]), .carry(step[AT_CARRY]),
      .window(step[AT_WINDOW+:BITS_WINDOW]), .limit(step[AT_LIMIT]), .last(step[AT_LAST+:BITS_LAST]),
      .norm(step[AT_NORM+:BITS_NORM]),
      .n_base(step[AT_N_BASE+:BITS_N_BASE]), .n_e(step[AT_N_E+:BITS_N_E]), .n_minus(step[AT_N_MINUS]),
      .n_twice(step[AT_N_TWICE]), .e_set(step[AT_E_SET+:BITS_E_SET]),
      .sign(sign), .a_by(step[AT_A_BY+:BITS_A_BY]), .b_by(step[AT_B_BY+:BITS_B_BY]), .w_by(step[AT_W_BY+:BITS_W_BY]),
      .s_by(step[AT_S_BY+:BITS_S_BY]), .minus_by(step[AT_MINUS_BY+:BITS_MINUS_BY]),
      .w_en(source != SOURCE_NONE && !rst && !no_step), .w_at(step[AT_W+:BITS_W]), .w(w),
      .phi_loaded(source == SOURCE_INPUT && field == INPUT_PHI), .phi_below_0(in[W-1]),
      .t(t), .word(word), .normal(normal), .result(result), .clamp(clamped), .closed(elbow_closed), .flags(flags),
      .w_place(w_place), .b(b), .p(p), .n(n), .pairs(pairs), .doubled(doubled), .q_low(q_low), .flag_nodes(flag_nodes)
  );

  // ---- results ----

  wire [BITS_RESULT-1:0] result_field = step[AT_RESULT+:BITS_RESULT];
  wire [W-1:0] answer;
  ik_fold_elbow #(.W(W)) u_elbow (
      .clamp(clamped), .closed(elbow_closed), .is_w(result_field == RESULT_QE_W), .is_i(result_field == RESULT_QE_I),
      .word(result), .answer(answer)
  );
  ik_fold_results #(.W(W), .TAG_W(TAG_W)) u_results (
      .clk(clk), .go(go), .accept(s_axis_tready), .s_axis_tuser(s_axis_tuser),
      .writing(writing), .first_result(first_result), .result(result_field), .answer(answer), .flags(flags),
      .m_axis_tdata(m_axis_tdata), .m_axis_tuser(m_axis_tuser)
  );

  // ---- dataflow nodes, for waves and testbenches only ----

  wire [FRAC+2:0] p_plain = p[2*D-5-FRAC+:FRAC+3] + {{(FRAC + 2) {1'b0}}, 1'b1};  // the product, rounded like its node
  wire [FRAC+2:0] p_double = p[2*D-6-FRAC+:FRAC+3] + {{(FRAC + 2) {1'b0}}, 1'b1};
  wire unused = &{1'b0, clock, b, p, w_place, n, pairs, doubled, q_low, flag_nodes, p_plain, p_double};
  `include "ik_fold_nodes.vh"

endmodule

`default_nettype wire
