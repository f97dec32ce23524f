// Results Q2.(W-2), rounded half up; binary angles, rounded half up; inputs Q2.(W-2) and a binary angle.
// SPDX-License-Identifier: Apache-2.0
//
// The whole arm on one multiplier, AXI4-Stream ports: ik_fold with another program, and the serial CORDIC of
// ik_fold_angle, which takes result words as they are made. A hand pose enters; Qs, Qe, Qw and seven joint angles leave.
// Lap, stalls and steps work as in ik_fold. Codes of fields that both programs have are the same.
// Throughput: one target per PERIOD clocks.
// Latency: set by the program (ik_fold_arm_program.vh), counted from the clock that accepts the target.
`default_nettype none

module ik_fold_arm #(
    parameter integer W     = 24,  // word length, even, 20 to 32; 18 to 24 with TILE = 16
    parameter integer TAG_W = 8,   // tag width, at least 1
    parameter integer TILE  = 18   // multiplier tile width: 18 or 16
) (
    input  wire                clk,
    input  wire                rst,            // synchronous, active high: discards all targets
    // Targets
    input  wire [    11*W-1:0] s_axis_tdata,   // hand_x, _y, _z, phi, d1, d2, tool, qh_w, _i, _j, _k, lowest bits first
    input  wire [   TAG_W+2:0] s_axis_tuser,   // tag; above it branch: shoulder, elbow, wrist
    input  wire                s_axis_tvalid,
    output wire                s_axis_tready,
    input  wire [    14*W-1:0] limits,         // lower and upper of th1 .. th7, lowest bits first; static
    // Results
    output wire [    17*W-1:0] m_axis_tdata,   // th1 .. th7, qs_w .. qs_k, qe_w, qe_i, qw_w .. qw_k, lowest bits first
    output wire [TAG_W+16-1:0] m_axis_tuser,   // tag, flags of the core, bad_hand, over_limit 1 .. 7
    output reg                 m_axis_tvalid,
    input  wire                m_axis_tready
);

  `include "ik_fold_arm_codes.vh"
  `include "ik_fold_formats.vh"

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

  localparam integer XW = 2 * W + 2;  // width of an exact sum
  localparam integer TW = (XW < SINE_SUM_FRAC + 5) ? SINE_SUM_FRAC + 5 : XW;  // wide enough for half a sine too
  localparam integer INNER = FRAC + 2;
  localparam integer D = ROOT_FRAC + 4;  // word width: mantissa and sign
  localparam integer LAST = XW - 2 - INNER;  // position of an inner word's LSB in a sum
  localparam integer WORD = 2 * D - 2 - INNER;  // and in a product

  // ---- the lap ----

  reg go;
  reg [7:0] fetched, read, clock;  // step numbers: next but one, next, current; with TILE = 16 next, -, current
  wire [7:0] next = (TILE == 16) ? fetched : read;
  reg begins, last;  // the current step is the first, the last
  wire [STEP_W-1:0] step;
  // Accept no target and write no word before the first step arrives, or under reset: some words must stay 0.
  initial {go, fetched, read} = {1'b0, 8'd255, 8'd255};
  `include "ik_fold_arm_program.vh"
  `include "ik_fold_arm_fields.vh"

  reg current, previous, earlier;  // this lap's target is in progress; the previous lap's is; that of the lap before
  wire here = begins ? s_axis_tvalid : current;
  wire waits = begins && !here && !previous && !earlier;
  wire oldest = (LAST_LAP == 2) ? earlier : previous;
  wire younger = here || (LAST_LAP == 2 && previous);
  wire back = f_last_result && oldest && !younger;  // no target is left in the datapath
  always @(posedge clk) begin
    if (rst) begin  // no valid step number until the first step arrives
      read   <= 8'd255;
      clock  <= 8'd255;
      begins <= 1'b0;
      last   <= 1'b0;
    end
    if (rst) fetched <= (TILE == 16) ? 8'd255 : 8'd0;
    else if (go && (back || (!waits && fetched == END))) fetched <= 8'd0;
    else if (go && !waits) fetched <= fetched + 8'd1;
    if (go && !waits && !rst) begin
      read   <= fetched;
      clock  <= next;
      begins <= next == 8'd0;
      last   <= next == END;
    end
  end

  // Registers behind the memory of small chips cost logic cells. Number 255 is a step that does nothing. With TILE = 16,
  // any step may follow the first clock of a reset, and then writes nothing; the number after it is then 255.
  wire stale = TILE == 16 && fetched[7:6] == 2'b11;
  generate
    if (TILE == 16) begin : g_step
      reg [STEP_W-1:0] read_step;
      initial read_step = 0;
      always @(posedge clk) if (rst || (go && !waits)) read_step <= rom[fetched];
      assign step = read_step;
    end else begin : g_steps
      reg [STEP_W-1:0] next_step, this_step;
      initial this_step = 0;
      always @(posedge clk) begin
        if (go && !waits) next_step <= rom[fetched];
        if (rst || read == 8'd255) this_step <= 0;  // next_step holds no step yet
        else if (go && !waits) this_step <= next_step;
      end
      assign step = this_step;
    end
  endgenerate

  wire of_hold = (HOLD_LAP != 0) ? previous : here;
  wire of_first = (FIRST_LAP != 0) ? previous : here;
  wire full = m_axis_tvalid && !m_axis_tready;
  reg given;  // results of a target are being written
  wire giving = f_first_result ? of_first : given;
  initial m_axis_tvalid = 1'b0;
  always @(posedge clk)
    if (rst) begin
      go            <= 1'b1;
      current       <= 1'b0;
      previous      <= 1'b0;
      earlier       <= 1'b0;
      given         <= 1'b0;
      m_axis_tvalid <= 1'b0;
    end else begin
      go <= !full || (go && !(f_hold && of_hold));
      if (go) begin
        current <= here && !last;
        if (last) begin
          previous <= (LAST_LAP != 0) && here;
          earlier  <= (LAST_LAP == 2) && previous;
        end else if (f_last_result) begin
          earlier <= 1'b0;
          if (LAST_LAP != 2) previous <= 1'b0;
        end
        given <= giving && !f_last_result;
      end
      if (go && f_last_result && giving) m_axis_tvalid <= 1'b1;
      else if (m_axis_tready) m_axis_tvalid <= 1'b0;
    end
  // `current`, not `here`: tready must not depend on tvalid
  assign s_axis_tready = go && current && f_last_input && !rst;

  // ---- words ----

  localparam integer SEEN = (D < 2 * TILE) ? D : 2 * TILE - 1;  // word bits the multiplier uses
  localparam integer RW = INDEX_BITS + 2;
  localparam integer DOWN = INDEX_BITS + 2;
  wire [SEEN-1:0] a;
  wire [D-1:0] b, w;
  wire [RW-1:0] row_word;
  wire a_second, b_second, w_second, b_constant;
  wire [5:0] w_place = {f_w[5:1], f_w[0] ^ w_second};
  wire [5:0] n;
  ik_fold_memory #(.D(D), .AD(SEEN), .DOWN(DOWN), .RW(RW)) u_memory (
      .clk(clk), .go(go),
      .a_at({f_a[6:1], f_a[0] ^ a_second}), .b_at(f_b_count ? {1'b1, n} : {f_b[6] ^ b_constant, f_b[5:1], f_b[0] ^ b_second}), .r_at(f_r),
      .a(a), .b(b), .r(row_word),
      .w_en(f_source != SOURCE_NONE && !rst && !stale), .w_at(w_place), .w(w)
  );

  // ---- table rows, and the offset within a segment ----

  wire [C0_BITS-1:0] c0;
  wire [C1_BITS-1:0] c1;
  wire [C2_BITS-1:0] c2;
  ik_fold_table #(.W(W), .TILE(TILE), .RW(RW), .ROW(C0_BITS+C1_BITS+C2_BITS)) u_table (
      .clk(clk), .go(go), .word(row_word),
      .angle(f_r_function != R_FUNCTION_ROOT), .cosine(f_r_function == R_FUNCTION_COSINE), .row({c0, c1, c2})
  );
  wire [SEEN-1:0] bend = {{(SEEN - C2_BITS) {1'b0}}, c2} << (SEEN - 4 - INDEX_BITS - C2_FRAC);
  // The offset from the segment's middle: the bits below the segment number, their MSB inverted. A mantissa in [1/2, 1)
  // has one bit fewer in its segment number; a quarter turn is the end of the last segment.
  wire [D-1:0] raised = b << (INDEX_BITS + 1);
  wire upper = b[D-2] && f_b_place == B_PLACE_ROOT;
  wire end_ = b[D-2] && f_b_place != B_PLACE_ROOT;
  wire [1:0] top = upper ? {~raised[D-1], raised[D-2]} : {~raised[D-2] && !end_, ~raised[D-2]};
  wire [D-1:0] place = {top, raised[D-3:0]} & (f_b_high ? {D{1'b1}} << (D - TILE) : {D{1'b1}});

  // ---- product and sum ----

  wire [D-1:0] factor = f_b_place == B_PLACE_NONE ? b : place;
  wire [2*D-1:0] p;
  generate
    if (D > SEEN) begin : g_unseen
      assign p[2*(D-SEEN)-1:0] = 0;
      wire unused_factor = &{1'b0, factor};
    end
  endgenerate
  ik_fold_mul #(.D(SEEN), .TILE(TILE), .WORD(WORD-2*(D-SEEN)), .ROOT(ROOT_DROP), .SINE(SINE_DROP)) u_mul (
      .clk(clk), .go(go), .a(f_a_bend ? bend : a), .b(factor[D-1-:SEEN]), .cut(f_cut), .p(p[2*D-1-:2*SEEN])
  );

  wire few, s_other, taken;
  reg down, subtract, carry;
  always @(posedge clk)
    if (go) begin
      down  <= f_cut == CUT_ROOT || f_cut == CUT_SINE || (f_cut == CUT_POWER && !few);
      subtract <= taken;
      carry <= f_carry == CARRY_MINUS && taken;
    end
  wire [TW-1:0] sum;
  ik_fold_sum #(
      .D(D), .XW(TW), .LAST(TW-2-INNER), .HALF(TW-5), .ANSWER(TW-3-W), .C0W(C0_BITS), .C1W(C1_BITS),
      .C0_AT(TW-4-C0_FRAC), .C1_AT(TW-4-C1_FRAC), .SLOPE(TW-4-SLOPE_FRAC), .DOWN(DOWN)
  ) u_sum (
      .clk(clk), .go(go), .choice(f_s), .by(s_other), .c0(c0), .c1(c1),
      .p(p), .down(down), .minus(subtract), .carry(carry), .t(sum)
  );
  wire [XW-1:0] t = sum[TW-1-:XW];

  // ---- T as a word, a mantissa with its shift count, or a result ----

  wire none, q_low, zero, word_below_0;
  wire [D-1:0] word, normal;
  wire [5:0] pairs;
  wire [W-1:0] result;
  wire doubles_low = f_window == WINDOW_LOW && q_low;
  wire doubled = f_window == WINDOW_DOUBLE || doubles_low;
  ik_fold_word #(.W(W), .D(D), .XW(XW), .INNER(INNER), .ROOT(ROOT_FRAC), .SINE(SINE_FRAC), .SLOPE(SLOPE_FRAC)) u_word (
      .t(t), .doubled(doubled), .limit(f_limit), .last(f_last), .low(doubles_low), .word(word), .negative(word_below_0),
      .result(result)
  );
  ik_fold_norm #(.W(W), .D(D), .XW(XW), .LAST(LAST), .DROP(D-INNER)) u_norm (
      .clk(clk), .go(go), .t(t), .kind(f_norm), .n(n), .word(normal), .pairs(pairs), .zero(zero)
  );
  ik_fold_count #(.D(SEEN)) u_count (
      .clk(clk), .go(go), .base(f_n_base), .of(f_n_e), .minus(f_n_minus), .twice(f_n_twice), .set(f_e_set),
      .pairs(pairs), .n(n), .none(none), .few(few), .low(q_low)
  );
  wire [7:0] flags;
  wire [9:0] flag_nodes;
  wire clamped, folded;
  reg [W:0] in_word;  // with sums in ik_fold_word's format: half as large
  always @*
    case (f_input)
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
  wire halved = f_input == INPUT_PHI || f_input == INPUT_D1 || f_input == INPUT_D2;
  wire [W-1:0] in = halved ? in_word[W-1:0] : in_word[W:1];

  // A result is the highest bits of the word; a clamped elbow is folded (1, 0) or straight (0, -1).
  localparam [W-1:0] UNIT = {2'b01, {(W - 2) {1'b0}}};
  wire of_w = clamped && f_result == RESULT_ELBOW_W;
  wire of_i = clamped && f_result == RESULT_ELBOW_I;
  wire [W-1:0] elbow = of_w ? (folded ? UNIT : {W{1'b0}}) : (folded ? {W{1'b0}} : -UNIT);
  wire [W-1:0] answer = (of_w || of_i) ? elbow : word[D-1-:W];
  // T is half a wrist coordinate, which saturates.
  wire below = t[XW-1];
  wire outside = t[XW-2-:3] != {3{below}};
  wire [W:0] wrist = outside ? {below, below, {(W - 1) {!below}}} : word[D-1-:W+1];
  reg [D-1:0] source;
  always @*
    case (f_source)
      SOURCE_INPUT: source = {in_word, {(D - W - 1) {1'b0}}};
      SOURCE_NORMAL: source = normal;
      SOURCE_RESULT: source = {answer, {(D - W) {1'b0}}};
      SOURCE_WRIST: source = {wrist, {(D - W - 1) {1'b0}}};
      default: source = word;
    endcase
  assign w = source;

  // ---- flags of the hand ----

  // |Qh|^2, T's highest bits in units of 2^-16, lies from 1 - 2^-7 + 2^-16 to 1 + 2^-7.
  wire no_more = t[XW-12-:9] == 9'd0;
  wire above_1 = t[XW-4] && t[XW-5-:6] == 6'h00 && (!t[XW-11] || no_more);
  wire below_1 = !t[XW-4] && t[XW-5-:7] == 7'h7f && !no_more;
  reg not_unit, outside_x, outside_y, outside_z;
  always @(posedge clk)
    if (go)
      case (f_sign)
        SIGN_HAND_SQ:
        not_unit <= t[XW-1-:3] != 3'd0 || !(above_1 || below_1);
        SIGN_X: outside_x <= outside;
        SIGN_Y: outside_y <= outside;
        SIGN_Z: outside_z <= outside;
        default: ;
      endcase
  // The constant 64 places further replaces a word of a bad hand: 1 or 0.
  assign b_constant = f_b_by == B_BY_BAD_HAND && not_unit;
  wire [1:0] hand_nodes = {outside_x || outside_y || outside_z, not_unit};

  ik_fold_flags u_flags (
      .clk(clk), .go(go), .sign(f_sign), .sum_below_0(t[XW-1]), .word_below_0(word_below_0),
      .phi_loaded(f_source == SOURCE_INPUT && f_input == INPUT_PHI), .phi_below_0(in_word[W]), .e_set(f_e_set), .zero(zero),
      .none(none), .a_by(f_a_by), .b_by(f_b_by), .w_by(f_w_by), .s_by(f_s_by), .minus_by(f_minus_by),
      .a_second(a_second), .b_second(b_second), .w_second(w_second), .s_other(s_other), .minus(taken),
      .clamp(clamped), .fold(folded), .nodes(flag_nodes), .flags(flags)
  );

  // ---- results ----

  reg [TAG_W-1:0] tag;
  reg [2:0] branch_in, branch;  // shoulder, elbow, wrist: of the target taken last, and of the results
  always @(posedge clk) begin
    if (s_axis_tready) {branch_in, tag} <= s_axis_tuser;
    if (go && f_first_result) branch <= branch_in;
  end

  // ---- angles ----

  // Vectors of two results, x and then y, and of two lengths; angles. The sign is that of th2, th4 or th6.
  wire again = f_again_by != AGAIN_BY_NONE;
  reg load_x, load_y, less, negative, half;
  reg [1:0] rounding;
  wire [2:0] joint = f_result[2:0];  // TH1 to TH7 are 1 to 7
  always @* begin
    {load_x, load_y, less, half} = 4'b0000;
    negative = f_again_by == AGAIN_BY_SHOULDER ? branch[0] : f_again_by == AGAIN_BY_WRIST && branch[2];
    rounding = {1'b0, again};
    case (f_result)
      RESULT_ELBOW_I, RESULT_QS_I, RESULT_QS_W, RESULT_QW_I, RESULT_QW_W: load_x = 1'b1;
      RESULT_QS_J, RESULT_QW_J: load_y = 1'b1;
      RESULT_QS_K, RESULT_QW_K: {load_y, rounding} = 3'b110;
      RESULT_ELBOW_W: {load_y, rounding, negative} = {3'b101, branch_in[1]};
      RESULT_TH1: half = branch[0];
      RESULT_TH3: {half, less} = {branch[0] ^ branch[1], 1'b1};
      RESULT_TH5: half = branch[1] ^ branch[2];
      RESULT_TH7: {half, less} = {branch[2], 1'b1};
      default: ;
    endcase
  end
  wire [W-1:0] th;
  wire [W+2:0] length;
  wire [W+3:0] z_node;
  wire left, opposite;
  ik_fold_angle #(.W(W)) u_angle (
      .clk(clk), .go(go),
      .word(answer), .load_x(load_x), .load_y(load_y), .opposite(f_result == RESULT_ELBOW_W), .rounding(rounding),
      .negative(negative), .over(f_over), .again(again), .to_h(f_to_h), .minus(less), .half(half), .th(th),
      .length(length), .z_node(z_node), .left_node(left), .negative_node(opposite)
  );

  // ---- output ----

  // Results in the order in which they are written, the last one lowest, and the comparisons with the joints' limits.
  reg [17*W-1:0] words;
  reg [6:0] overs;
  reg [2:0] joint_1;  // joint of the last word
  reg angle_1, angle_2;  // an angle was written in the last clock, in the one before
  reg [TAG_W+8:0] head;  // tag and flags that leave with the first result
  wire over;
  ik_fold_limit #(.W(W)) u_limit (.clk(clk), .joint(joint_1), .th(words[W-1:0]), .limits(limits), .over(over));

  wire writes = go && giving && f_result != RESULT_NONE && f_result <= RESULT_QW_K;
  wire of_angle = f_result <= RESULT_TH7;
  always @(posedge clk) begin
    joint_1 <= joint;
    angle_1 <= writes && of_angle && !rst;
    angle_2 <= angle_1 && !rst;
    if (writes) words <= {words[16*W-1:0], of_angle ? th : answer};
    if (angle_2) overs <= {overs[5:0], over};
    if (go && giving && f_first_result) head <= {not_unit, flags[7:6], hand_nodes[1], flags[4:0], tag};
  end

  function integer angles_after(input integer one);  // angles written after th1 (0) to th7 (6)
    integer m;
    begin
      angles_after = 0;
      for (m = 0; m < 7; m = m + 1) if (AFTER[8*m+:8] < AFTER[8*one+:8]) angles_after = angles_after + 1;
    end
  endfunction
  assign m_axis_tuser[TAG_W+8:0] = head;
  genvar k;
  generate
    for (k = 0; k < 17; k = k + 1) begin : g_word
      assign m_axis_tdata[W*k+:W] = words[W*AFTER[8*k+:8]+:W];
      if (k < 7) begin : g_over
        localparam integer PLACE = angles_after(k);
        assign m_axis_tuser[TAG_W+9+k] = overs[PLACE];
      end
    end
  endgenerate

  // ---- dataflow nodes, for waves and testbenches only ----

  wire [FRAC+2:0] p_plain = p[2*D-5-FRAC+:FRAC+3] + {{(FRAC + 2) {1'b0}}, 1'b1};  // the product, rounded like its node
  wire [FRAC+2:0] p_double = p[2*D-6-FRAC+:FRAC+3] + {{(FRAC + 2) {1'b0}}, 1'b1};
  function [W+3:0] angle(input [3:0] start, input half_turn);  // of the vector in the second stage
    angle = (opposite ? {{W{1'b0}}, start} - z_node : z_node - {{W{1'b0}}, start}) ^ {half_turn, {(W + 3) {1'b0}}};
  endfunction
  wire unused = &{1'b0, PERIOD[0], p_plain, p_double, f_r_function, n, sum, in, flags, result, length, z_node, left, opposite};
  `include "ik_fold_arm_nodes.vh"

endmodule

`default_nettype wire
