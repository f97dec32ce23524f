// The whole arm on one multiplier: ik_fold with another program, and a serial CORDIC for the joints. AXI4-Stream ports.
// SPDX-License-Identifier: Apache-2.0
//
// Results Q2.(W-2) and binary angles, rounded half up; inputs Q2.(W-2) and a binary angle.
// A hand pose enters; Qs, Qe, Qw and seven joint angles leave. Laps, steps and datapath as in ik_fold. Codes of
// fields that both programs have are the same.
// Throughput: one target per PERIOD clocks.
// Latency: set by the program (ik_fold_arm_program.vh), counted from the clock that accepts the target. With CHOOSE, 50
// clocks more.
`default_nettype none

module ik_fold_arm #(
    parameter integer W     = 24,  // word length, even, 20 to 32; 18 to 24 with TILE = 16
    parameter integer TAG_W = 8,   // tag width, at least 1
    parameter integer TILE  = 18,  // multiplier tile width: 18 or 16
    parameter integer CHOOSE = 0,  // 1: ik_fold_choose replaces the joints by the joints of the branch nearest to a reference
    parameter integer EPS    = 16  // see ik_fold_choose
) (
    input  wire                clk,
    input  wire                rst,            // synchronous, active high: discards all targets
    // Targets
    // hand_x, _y, _z, phi, d1, d2, tool, qh_w, _i, _j, _k, lowest bits first; with CHOOSE, above them reference joints
    input  wire [(11+7*CHOOSE)*W-1:0] s_axis_tdata,
    input  wire [   TAG_W+2:0] s_axis_tuser,   // tag; above it branch: shoulder, elbow, wrist
    input  wire                s_axis_tvalid,
    output wire                s_axis_tready,
    input  wire [    14*W-1:0] limits,         // lower and upper of th1 .. th7, lowest bits first; static
    // Results
    output wire [    17*W-1:0] m_axis_tdata,   // th1 .. th7, qs_w .. qs_k, qe_w, qe_i, qw_w .. qw_k, lowest bits first
    // tag, flags of the core, bad_hand, over_limit 1 .. 7; with CHOOSE, as ik_arm's
    output wire [TAG_W+16+25*CHOOSE-1:0] m_axis_tuser,
    output wire                m_axis_tvalid,
    input  wire                m_axis_tready
);

  `include "ik_flags.vh"
  `include "ik_fold_arm_codes.vh"
  `include "ik_fold_formats.vh"
  `include "ik_fold_arm_fields.vh"
  `include "ik_fold_arm_program.vh"

  generate
    if (W % 2 != 0 || W < ((TILE == 16) ? 18 : 20) || W > ((TILE == 16) ? 24 : 32)) begin : g_no_words
      ik_fold_arm_illegal_W u_stop ();
    end
    if (TAG_W < 1) begin : g_no_tag
      ik_fold_arm_illegal_TAG_W u_stop ();
    end
    if (TILE != 16 && TILE != 18) begin : g_no_tile
      ik_fold_arm_illegal_TILE u_stop ();
    end
  endgenerate

  localparam integer D = ROOT_FRAC + 4;  // width of a word: mantissa and sign
  localparam integer XW = 2 * W + 2;  // width of an exact sum

  // ---- program and laps ----

  wire [7:0] fetched, clock;  // numbers of the step that is fetched, and of the current one
  wire go, load, waits, restart, begins, last, no_step, writing;
  wire [STEP_W-1:0] step;
  reg [STEP_W-1:0] fetched_step;
  always @(posedge clk) if (load) fetched_step <= rom[fetched];
  generate
    if (TILE == 16) begin : g_step
      initial fetched_step = 0;
    end
  endgenerate
  ik_fold_fetch #(.STEP_W(STEP_W), .CLOCK_W(8), .END(END), .REGISTERS((TILE == 16) ? 1 : 2), .EARLY(1)) u_fetch (
      .clk(clk), .rst(rst), .go(go), .waits(waits), .restart(restart),
      .fetched(fetched), .load(load), .fetched_step(fetched_step),
      .step(step), .clock(clock), .begins(begins), .last(last), .no_step(no_step)
  );
  wire first_result = step[AT_FIRST_RESULT];
  wire result_valid, result_ready;
  ik_fold_lap #(.HOLD_LAP(HOLD_LAP), .FIRST_LAP(FIRST_LAP), .LAST_LAP(LAST_LAP)) u_lap (
      .clk(clk), .rst(rst),
      .begins(begins), .last(last), .last_input(step[AT_LAST_INPUT]), .hold(step[AT_HOLD]), .first_result(first_result),
      .last_result(step[AT_LAST_RESULT]),
      .s_valid(s_axis_tvalid), .s_ready(s_axis_tready), .m_valid(result_valid), .m_ready(result_ready),
      .go(go), .waits(waits), .restart(restart), .writing(writing)
  );

  // ---- datapath; a word is a field of the pose, a mantissa, a sum, a result or the wrist ----

  wire [BITS_SIGN-1:0] sign = step[AT_SIGN+:BITS_SIGN];
  wire [BITS_B_BY-1:0] b_by = step[AT_B_BY+:BITS_B_BY];
  wire [BITS_SOURCE-1:0] source = step[AT_SOURCE+:BITS_SOURCE];
  wire [BITS_INPUT-1:0] field = step[AT_INPUT+:BITS_INPUT];
  reg [W:0] in_word;  // with sums in ik_fold_word's format: half as large
  always @*
    case (field)
      INPUT_HAND_X: in_word = {s_axis_tdata[0*W+:W], 1'b0};
      INPUT_HAND_Y: in_word = {s_axis_tdata[1*W+:W], 1'b0};
      INPUT_HAND_Z: in_word = {s_axis_tdata[2*W+:W], 1'b0};
      INPUT_PHI: in_word = {s_axis_tdata[4*W-1], s_axis_tdata[3*W+:W]};
      INPUT_D1: in_word = {s_axis_tdata[5*W-1], s_axis_tdata[4*W+:W]};
      INPUT_D2: in_word = {s_axis_tdata[6*W-1], s_axis_tdata[5*W+:W]};
      INPUT_TOOL: in_word = {s_axis_tdata[6*W+:W], 1'b0};
      INPUT_QH_W: in_word = {s_axis_tdata[7*W+:W], 1'b0};
      INPUT_QH_I: in_word = {s_axis_tdata[8*W+:W], 1'b0};
      INPUT_QH_J: in_word = {s_axis_tdata[9*W+:W], 1'b0};
      default: in_word = {s_axis_tdata[10*W+:W], 1'b0};
    endcase
  wire halved = field == INPUT_PHI || field == INPUT_D1 || field == INPUT_D2;
  wire [W-1:0] in = halved ? in_word[W-1:0] : in_word[W:1];

  wire [XW-1:0] t;
  wire [D-1:0] word, normal;
  wire [W:0] wrist;
  wire [W-1:0] answer, result;
  reg [D-1:0] w;
  always @*
    case (source)
      SOURCE_INPUT: w = {in_word, {(D - W - 1) {1'b0}}};
      SOURCE_NORMAL: w = normal;
      SOURCE_RESULT: w = {answer, {(D - W) {1'b0}}};
      SOURCE_WRIST: w = {wrist, {(D - W - 1) {1'b0}}};
      default: w = word;
    endcase
  wire clamped, elbow_closed, doubled, q_low, hand_is_bad, wrist_saturated;
  wire [7:0] flags;
  wire [D-1:0] b;
  wire [2*D-1:0] p;
  wire [5:0] w_place, n, pairs;
  wire [9:0] flag_nodes;
  // A constant replaces a word of a bad hand: 1 or 0.
  ik_fold_datapath #(.W(W), .TILE(TILE), .D(D), .XW(XW), .WORDS(WORDS)) u_datapath (
      .clk(clk), .go(go),
      .a_at(step[AT_A+:BITS_A]), .b_at(step[AT_B+:BITS_B]), .r_at(step[AT_R+:BITS_R]), .b_count(step[AT_B_COUNT]),
      .b_constant(b_by == B_BY_BAD_HAND && hand_is_bad), .a_bend(step[AT_A_BEND]),
      .b_place(step[AT_B_PLACE+:BITS_B_PLACE]), .b_high(step[AT_B_HIGH]),
      .r_function(step[AT_R_FUNCTION+:BITS_R_FUNCTION]),
      .cut(step[AT_CUT+:BITS_CUT]), .s(step[AT_S+:BITS_S]), .carry(step[AT_CARRY]),
      .window(step[AT_WINDOW+:BITS_WINDOW]), .limit(step[AT_LIMIT]), .last(step[AT_LAST+:BITS_LAST]),
      .norm(step[AT_NORM+:BITS_NORM]),
      .n_base(step[AT_N_BASE+:BITS_N_BASE]), .n_e(step[AT_N_E+:BITS_N_E]), .n_minus(step[AT_N_MINUS]),
      .n_twice(step[AT_N_TWICE]), .e_set(step[AT_E_SET+:BITS_E_SET]),
      .sign(sign), .a_by(step[AT_A_BY+:BITS_A_BY]), .b_by(b_by), .w_by(step[AT_W_BY+:BITS_W_BY]),
      .s_by(step[AT_S_BY+:BITS_S_BY]), .minus_by(step[AT_MINUS_BY+:BITS_MINUS_BY]),
      .w_en(source != SOURCE_NONE && !rst && !no_step), .w_at(step[AT_W+:BITS_W]), .w(w),
      .phi_loaded(source == SOURCE_INPUT && field == INPUT_PHI), .phi_below_0(in_word[W]),
      .t(t), .word(word), .normal(normal), .result(result), .clamp(clamped), .closed(elbow_closed), .flags(flags),
      .w_place(w_place), .b(b), .p(p), .n(n), .pairs(pairs), .doubled(doubled), .q_low(q_low), .flag_nodes(flag_nodes)
  );
  ik_fold_arm_hand #(.W(W), .XW(XW)) u_hand_flags (
      .clk(clk), .go(go), .sign(sign), .t(t), .rounded(word[D-1-:W+1]), .wrist(wrist), .bad_hand(hand_is_bad),
      .saturated(wrist_saturated)
  );

  // ---- results and joints ----

  wire [BITS_RESULT-1:0] result_field = step[AT_RESULT+:BITS_RESULT];
  ik_fold_elbow #(.W(W)) u_elbow (
      .clamp(clamped), .closed(elbow_closed), .is_w(result_field == RESULT_ELBOW_W), .is_i(result_field == RESULT_ELBOW_I),
      .word(word[D-1-:W]), .answer(answer)
  );

  reg [TAG_W-1:0] tag;
  reg [2:0] branch_in, branch;  // shoulder, elbow, wrist: of the target taken last, and of the results
  always @(posedge clk) begin
    if (s_axis_tready) {branch_in, tag} <= s_axis_tuser;
    if (go && first_result) branch <= branch_in;
  end
  wire [W-1:0] th;
  wire [W+2:0] length;
  wire [W+3:0] z_node;
  wire left, opposite, over;
  ik_fold_arm_joints #(.W(W)) u_angles (
      .clk(clk), .go(go),
      .result(result_field), .again_by(step[AT_AGAIN_BY+:BITS_AGAIN_BY]), .over(step[AT_OVER]), .to_h(step[AT_TO_H]),
      .answer(answer), .elbow_in(branch_in[1]), .branch(branch), .th(th),
      .length(length), .z_node(z_node), .left(left), .opposite(opposite)
  );
  wire [FLAG_BAD_HAND:0] head;
  assign head[FLAG_BAD_LENGTH:0] = flags[FLAG_BAD_LENGTH:0];
  assign head[FLAG_SATURATED] = wrist_saturated;
  assign head[FLAG_BAD_HAND-1:FLAG_SATURATED+1] = flags[FLAG_BAD_HAND-1:FLAG_SATURATED+1];
  assign head[FLAG_BAD_HAND] = hand_is_bad;
  wire [17*W-1:0] result_data;
  wire [TAG_W+16-1:0] result_user;
  ik_fold_arm_results #(.W(W), .TAG_W(TAG_W), .AFTER(AFTER)) u_results (
      .clk(clk), .rst(rst), .go(go), .limits(limits),
      .writing(writing), .first_result(first_result), .result(result_field), .answer(answer), .th(th),
      .head({head, tag}),
      .m_axis_tdata(result_data), .m_axis_tuser(result_user), .over(over)
  );
  generate
    if (CHOOSE == 0) begin : g_given
      assign m_axis_tdata = result_data;
      assign m_axis_tuser = result_user;
      assign m_axis_tvalid = result_valid;
      assign result_ready = m_axis_tready;
    end else begin : g_choose
      ik_fold_choose #(.W(W), .TAG_W(TAG_W), .EPS(EPS)) u_choose (
          .clk(clk), .rst(rst), .limits(limits),
          .refs(s_axis_tdata[11*W+:7*W]), .s_valid(s_axis_tvalid), .s_ready(s_axis_tready),
          .write(go && writing && result_field != RESULT_NONE && result_field <= RESULT_TH7), .joint(result_field[2:0]),
          .th(th), .ends(go && writing && step[AT_LAST_RESULT]),
          .r_words(result_data[7*W+:10*W]), .r_head(result_user[TAG_W+8:0]), .r_branch(branch),
          .r_valid(result_valid), .r_ready(result_ready),
          .m_data(m_axis_tdata), .m_user(m_axis_tuser), .m_valid(m_axis_tvalid), .m_ready(m_axis_tready)
      );
      wire unused_joints = &{1'b0, result_data, result_user};
    end
  endgenerate

  // ---- dataflow nodes, for waves and testbenches only ----

  wire [FRAC+2:0] p_plain = p[2*D-5-FRAC+:FRAC+3] + {{(FRAC + 2) {1'b0}}, 1'b1};  // the product, rounded like its node
  wire [FRAC+2:0] p_double = p[2*D-6-FRAC+:FRAC+3] + {{(FRAC + 2) {1'b0}}, 1'b1};
  wire [1:0] hand_nodes = {wrist_saturated, hand_is_bad};
  function [W+3:0] angle(input [3:0] start, input half_turn);  // of the vector in the second stage
    angle = (opposite ? {{W{1'b0}}, start} - z_node : z_node - {{W{1'b0}}, start}) ^ {half_turn, {(W + 3) {1'b0}}};
  endfunction
  wire unused = &{1'b0, PERIOD[0], clock, b, p, w_place, n, pairs, doubled, q_low, flag_nodes, p_plain, p_double, in,
      flags, result, length, z_node, left, opposite, over, hand_nodes};
  `include "ik_fold_arm_nodes.vh"

endmodule

`default_nettype wire
