// Chooses among the eight branches of a hand pose, as ik_choose does, with one angle per clock.
// SPDX-License-Identifier: Apache-2.0
//
// No rounding but of steps, which are rounded towards 0. Binary angles, one turn = 2^W; a step has 12 bits, one turn =
// 2^12, and above them a bit for an angle outside its limits.
// Reference joints are copied while a pose waits at the input, joints when the core writes them. A result of the core is
// taken at once and stays here until it leaves: first th2, th6, th1 and th5 are read, then 13 angles for each elbow bit,
// whose largest steps decide, then the joints of the chosen branch.
// Throughput: one pose per 50 clocks, which is less than a lap.
// Latency: 50 clocks from r_valid to m_valid.
`default_nettype none

module ik_fold_choose #(
    parameter integer W     = 24,  // word length
    parameter integer TAG_W = 8,   // tag width
    parameter integer EPS   = 16   // words next to 0 and half a turn within which th2 and th6 are singular
) (
    input  wire                clk,
    input  wire                rst,
    input  wire [    14*W-1:0] limits,   // lower and upper of th1 .. th7, lowest bits first; static
    // Reference joints of the pose at the input, lowest bits first; it waits there for 8 clocks or more
    input  wire [     7*W-1:0] refs,
    input  wire                s_valid,
    input  wire                s_ready,
    // Joints as the core writes them; `ends` with a result's last word
    input  wire                write,
    input  wire [         2:0] joint,    // 1 to 7
    input  wire [       W-1:0] th,
    input  wire                ends,
    // Result of the core
    input  wire [    10*W-1:0] r_words,  // qs_w .. qw_k
    input  wire [   TAG_W+8:0] r_head,   // tag, flags of the core, bad_hand
    input  wire [         2:0] r_branch, // of its joints
    input  wire                r_valid,
    output wire                r_ready,
    // Result with the chosen joints, as m_axis of ik_arm with CHOOSE = 1
    output wire [    17*W-1:0] m_data,
    output wire [TAG_W+41-1:0] m_user,
    output reg                 m_valid,
    input  wire                m_ready
);

  localparam integer STEP = 12;
  localparam [W-1:0] HALF = {1'b1, {(W - 1) {1'b0}}};

  // ---- reference joints of up to 8 poses, joints of 2 ----

  reg [2:0] pose_in, pose_out, ref_in;  // ref_in: 1 to 7, 0 writes none that is read
  reg result_in, result_out;
  reg [W-1:0] ref_word;
  always @*
    case (ref_in)
      3'd1: ref_word = refs[0*W+:W];
      3'd2: ref_word = refs[1*W+:W];
      3'd3: ref_word = refs[2*W+:W];
      3'd4: ref_word = refs[3*W+:W];
      3'd5: ref_word = refs[4*W+:W];
      3'd6: ref_word = refs[5*W+:W];
      default: ref_word = refs[6*W+:W];
    endcase
  reg [W-1:0] ref_memory[0:63];
  reg [W-1:0] joint_memory[0:15];
  reg [2:0] k;  // joint that is read
  reg [W-1:0] ref_k, th_k;
  always @(posedge clk) begin
    if (s_valid) ref_memory[{pose_in, ref_in}] <= ref_word;
    if (write) joint_memory[{result_in, joint}] <= th;
    ref_k <= ref_memory[{pose_out, k}];
    th_k  <= joint_memory[{result_out, k}];
  end

  // ---- sequence: clock n of a result ----

  localparam [5:0] STEPS = 6'd4, WAIT = 6'd30, JOINTS = 6'd38, DONE = 6'd49;
  reg [5:0] n;
  reg busy;
  assign r_ready = !busy;
  wire leaves = m_valid && m_ready;
  initial m_valid = 1'b0;
  always @(posedge clk)
    if (rst) begin
      {busy, m_valid} <= 2'b00;
      n <= 6'd0;
      ref_in <= 3'd0;
      {pose_in, pose_out, result_in, result_out} <= 8'd0;
    end else begin
      busy   <= busy ? !leaves : r_valid;
      n      <= (!busy || leaves) ? 6'd0 : (n == DONE) ? DONE : n + 6'd1;
      ref_in <= ref_in + 3'd1;
      if (s_valid && s_ready) pose_in <= pose_in + 3'd1;
      if (ends) result_in <= !result_in;
      if (n == DONE - 6'd1) begin
        m_valid    <= 1'b1;
        pose_out   <= pose_out + 3'd1;
        result_out <= !result_out;
      end else if (m_ready) m_valid <= 1'b0;
    end

  wire at_steps = n >= STEPS && n < WAIT;
  reg elbow;  // elbow bit of the angles
  reg [3:0] place;  // among 13: joints 1 2 3 twice, 4, 5 6 7 twice
  wire again = place >= 4'd10 || (place >= 4'd3 && place < 4'd6);  // shoulder or wrist with its bit set
  always @(posedge clk)
    if (!at_steps) {elbow, place} <= 5'd0;
    else {elbow, place} <= (place == 4'd12) ? {1'b1, 4'd0} : {elbow, place + 4'd1};
  always @* begin
    k = n[2:0] - JOINTS[2:0] + 3'd1;
    if (at_steps)
      k = place[2:0] + ((place < 4'd3) ? 3'd1 : (place < 4'd10) ? -3'd2 : -3'd5);
    else
      case (n)
        6'd0: k = 3'd2;
        6'd1: k = 3'd6;
        6'd2: k = 3'd1;
        6'd3: k = 3'd5;
        default: ;
      endcase
  end

  // ---- the angle of a joint with the branch changed ----

  reg turn_shoulder, turn_elbow, turn_wrist;  // the choice so far
  wire shoulder = at_steps ? again : turn_shoulder;
  wire wrist = at_steps ? again : turn_wrist;
  wire middle = at_steps ? elbow : turn_elbow;
  reg [2:0] k_1;  // th_k is of this joint
  reg change;
  always @(posedge clk) begin
    k_1 <= k;
    case (k)
      3'd1, 3'd2: change <= shoulder;
      3'd3: change <= shoulder ^ middle;
      3'd4: change <= middle;
      3'd5: change <= middle ^ wrist;
      default: change <= wrist;
    endcase
  end

  localparam [31:0] BELOW = EPS - 1;
  localparam [W-2:0] NEAR = BELOW[W-2:0];
  wire [W-2:0] near = th_k[W-2:0] + NEAR;
  reg singular_2, singular_6, opposite_2, opposite_6;
  reg [W-1:0] swing_1, swing_5;
  always @(posedge clk) begin
    if (n == 6'd1) {singular_2, opposite_2} <= {near <= {NEAR[W-3:0], 1'b0}, th_k[W-1] ^ th_k[W-2]};
    if (n == 6'd2) {singular_6, opposite_6} <= {near <= {NEAR[W-3:0], 1'b0}, th_k[W-1] ^ th_k[W-2]};
    if (n == 6'd3) swing_1 <= th_k - ref_k;
    if (n == 6'd4) swing_5 <= th_k - ref_k;
  end

  wire replaced = (k_1 == 3'd1 && singular_2) || (k_1 == 3'd5 && singular_6);
  wire rest = (k_1 == 3'd3 && singular_2) || (k_1 == 3'd7 && singular_6);
  wire minus = k_1[2] ? opposite_6 : opposite_2;
  wire negate = !k_1[0] && change;
  wire [W-1:0] swing = (k_1[2] ? swing_5 : swing_1) ^ {W{minus}};
  wire carry = negate || (rest && minus);
  wire [W-1:0] sum_k = (th_k ^ {W{negate}}) + (swing & {W{rest}}) + {{(W - 1) {1'b0}}, carry};
  reg [W-1:0] t, ref_t, low, high;
  reg [2*W-1:0] limit;
  always @*
    case (k_1)
      3'd1: limit = limits[0*W+:2*W];
      3'd2: limit = limits[2*W+:2*W];
      3'd3: limit = limits[4*W+:2*W];
      3'd4: limit = limits[6*W+:2*W];
      3'd5: limit = limits[8*W+:2*W];
      3'd6: limit = limits[10*W+:2*W];
      default: limit = limits[12*W+:2*W];
    endcase
  always @(posedge clk) begin
    t <= (replaced ? ref_k : sum_k) ^ (HALF & {W{k_1[0] && change}});
    ref_t <= ref_k;
    {high, low} <= limit;
  end

  // ---- its step from the reference, see ik_step ----

  reg [W-1:0] at, ref_at, span;
  reg out, whole;
  reg [W:0] gap;
  wire [W-1:0] size = gap[W-1:0] ^ {W{whole ? gap[W-1] : gap[W]}};
  reg [STEP:0] step;
  always @(posedge clk) begin
    at     <= t - low;
    ref_at <= ref_t - low;
    span   <= high - low;
    out    <= at > span;
    whole  <= &span;
    gap    <= {1'b0, at} - {1'b0, ref_at};
    step   <= {out, size[W-1-:STEP]} | {(STEP + 1) {out}};
  end

  // ---- largest step of shoulder, elbow, wrist; the branch with the smallest ----

  reg [5:0] of_1, of_2, of_3, of_4, of_step, of_largest;  // valid, elbow bit and place of an angle, as it passes
  reg [STEP:0] largest;  // step of the ball so far
  reg [STEP:0] ball;  // least of two
  reg [STEP:0] total;  // largest step of the elbow bit so far
  reg [STEP:0] least;  // of both elbow bits
  reg turn_ball_s, turn_ball_w;
  reg joined, compared, elbow_joined, elbow_compared;
  reg [3:0] shoulder_in, wrist_in;  // inside the limits, by elbow bit and own bit
  reg [1:0] elbow_in;
  wire [3:0] at_step = of_step[3:0], at_largest = of_largest[3:0];
  wire first = at_step == 4'd0 || at_step == 4'd3 || at_step == 4'd6 || at_step == 4'd7 || at_step == 4'd10;
  wire e = of_largest[4];
  wire fits = !largest[STEP];
  wire smaller = largest < ball;
  wire [STEP:0] other = joined ? ball : compared ? least : largest;
  wire less = total < other;
  always @(posedge clk) begin
    {of_largest, of_step, of_4, of_3, of_2, of_1} <= {of_step, of_4, of_3, of_2, of_1, at_steps, elbow, place};
    if (first || largest < step) largest <= step;
    joined <= of_largest[5] && at_largest == 4'd12;
    {compared, elbow_joined, elbow_compared} <= {joined, e, elbow_joined};
    if (of_largest[5])
      case (at_largest)
        4'd2: {ball, shoulder_in} <= {largest, fits, shoulder_in[3:1]};
        4'd5: {total, turn_ball_s, shoulder_in} <= {smaller ? largest : ball, smaller, fits, shoulder_in[3:1]};
        4'd6: {total, elbow_in} <= {less ? largest : total, fits, elbow_in[1]};
        4'd9: {ball, wrist_in} <= {largest, fits, wrist_in[3:1]};
        4'd12: {ball, turn_ball_w, wrist_in} <= {smaller ? largest : ball, smaller, fits, wrist_in[3:1]};
        default: ;
      endcase
    if (joined && less) total <= ball;
    if (compared && (!elbow_compared || less))
      {least, turn_wrist, turn_elbow, turn_shoulder} <= {total, turn_ball_w, elbow_compared, turn_ball_s};
  end

  // ---- result ----

  reg [7*W-1:0] joints;
  reg [6:0] outs;
  reg [10*W-1:0] words;
  reg [TAG_W+8:0] head;
  reg [2:0] branch;
  always @(posedge clk) begin
    if (r_valid && r_ready) {branch, head, words} <= {r_branch, r_head, r_words};
    if (n >= JOINTS + 6'd2 && n < JOINTS + 6'd9) joints <= {t, joints[7*W-1:W]};
    if (n >= JOINTS + 6'd4 && n < DONE) outs <= {out, outs[6:1]};
  end
  wire [7:0] feasible;
  genvar b;
  generate
    for (b = 0; b < 8; b = b + 1) begin : g_branch
      localparam integer S = b % 2, E = b / 2 % 2, Q = b / 4;
      assign feasible[b] = shoulder_in[2*E+S] && elbow_in[E] && wrist_in[2*E+Q];
    end
  endgenerate
  assign m_data = {words, joints};
  assign m_user = {
    singular_2 || singular_6, feasible, least, branch ^ {turn_wrist, turn_elbow, turn_shoulder}, outs, head
  };
  wire unused = &{1'b0, size};

endmodule

`default_nettype wire
