// Results Q2.(W-2), rounded half up; inputs Q2.(W-2) and a binary angle.
// SPDX-License-Identifier: Apache-2.0
//
// Folded datapath with AXI4-Stream ports: the lean dataflow as a program for one multiplier, bit for bit.
//
// A lap of the program takes PERIOD clocks. A target present when a lap begins is loaded in the lap's first clocks. Its
// results leave in this lap or in the next, where its last steps overlap the first steps of another target. Without a
// target the datapath waits in the first clock. It stalls as a whole rather than overwrite a waiting result.
// A program word, `step`, belongs to a clock, not to an operation: it controls the reads of one operation, the
// multiplication of another and the write of a third.
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
    output reg  [    6*W-1:0] m_axis_tdata,   // qs_w, qs_i, qs_j, qs_k, qe_w, qe_i, lowest bits first
    output reg  [TAG_W+8-1:0] m_axis_tuser,
    output reg                m_axis_tvalid,
    input  wire               m_axis_tready
);

  `include "ik_fold_codes.vh"
  `include "ik_fold_formats.vh"

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

  localparam integer XW = 2 * W + 2;  // width of an exact sum
  localparam integer TW = (XW < SINE_SUM_FRAC + 5) ? SINE_SUM_FRAC + 5 : XW;  // wide enough for half a sine too
  localparam integer INNER = FRAC + 2;
  localparam integer D = ROOT_FRAC + 4;  // word width: mantissa and sign
  localparam integer LAST = XW - 2 - INNER;  // position of an inner word's LSB in a sum
  localparam integer WORD = 2 * D - 2 - INNER;  // and in a product

  // ---- the lap ----

  reg go;
  reg [6:0] fetched, read, clock;  // step numbers: ROM address, ROM output, current step
  reg [STEP_W-1:0] step_read, step;
  // Accept no target and write no word before the first step arrives, or under reset: some words must stay 0.
  initial {go, step} = 0;
  `include "ik_fold_program.vh"
  `include "ik_fold_fields.vh"

  reg current, previous;  // this lap's target is in progress; the previous lap's is
  wire begins = clock == 7'd0;
  wire here = begins ? s_axis_tvalid : current;
  wire last = clock == END;
  wire waits = begins && !here && !previous;
  wire back = f_last_result && previous && !here;  // no target is left in the datapath
  always @(posedge clk) begin
    if (rst) begin  // no valid step number until the first step arrives
      read  <= 7'd127;
      clock <= 7'd127;
    end
    if (rst || (go && back) || (go && !waits && fetched == END)) fetched <= 7'd0;
    else if (go && !waits) fetched <= fetched + 7'd1;
    if (go && !waits && !rst) begin
      read  <= fetched;
      clock <= read;
    end
    if (go && !waits) step_read <= rom[fetched];
    if (rst || read == 7'd127) step <= 0;  // step_read holds no step yet
    else if (go && !waits) step <= step_read;
  end

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
      given         <= 1'b0;
      m_axis_tvalid <= 1'b0;
    end else begin
      go <= !full || (go && !(f_hold && of_hold));
      if (go) begin
        current <= here && !last;
        if (last) previous <= (LAST_LAP != 0) && here;
        else if (f_last_result) previous <= 1'b0;
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
  wire a_second, b_second, w_second;
  wire [5:0] w_place = {f_w[5:1], f_w[0] ^ w_second};
  wire [5:0] n;
  ik_fold_memory #(.D(D), .AD(SEEN), .DOWN(DOWN), .RW(RW)) u_memory (
      .clk(clk), .go(go),
      .a_at({f_a[6:1], f_a[0] ^ a_second}), .b_at(f_b_count ? {1'b1, n} : {f_b[6:1], f_b[0] ^ b_second}), .r_at(f_r),
      .a(a), .b(b), .r(row_word),
      .w_en(f_source != SOURCE_NONE && !rst), .w_at(w_place), .w(w)
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
  reg down, less, carry;
  always @(posedge clk)
    if (go) begin
      down  <= f_cut == CUT_ROOT || f_cut == CUT_SINE || (f_cut == CUT_POWER && !few);
      less  <= taken;
      carry <= f_carry == CARRY_MINUS && taken;
    end
  wire [TW-1:0] sum;
  ik_fold_sum #(
      .D(D), .XW(TW), .LAST(TW-2-INNER), .HALF(TW-5), .ANSWER(TW-3-W), .C0W(C0_BITS), .C1W(C1_BITS),
      .C0_AT(TW-4-C0_FRAC), .C1_AT(TW-4-C1_FRAC), .SLOPE(TW-4-SLOPE_FRAC), .DOWN(DOWN)
  ) u_sum (
      .clk(clk), .go(go), .choice(f_s), .by(s_other), .c0(c0), .c1(c1),
      .p(p), .down(down), .minus(less), .carry(carry), .t(sum)
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
  wire [W-1:0] in = s_axis_tdata[W*f_input+:W];
  wire [D-1:0] in_word = {in[W-1], in, {(D - W - 1) {1'b0}}};
  assign w = f_source == SOURCE_INPUT ? in_word : f_source == SOURCE_NORMAL ? normal : word;

  wire clamped, folded;
  wire [7:0] flags;
  wire [9:0] flag_nodes;
  ik_fold_flags u_flags (
      .clk(clk), .go(go), .sign(f_sign), .sum_below_0(t[XW-1]), .word_below_0(word_below_0),
      .phi_loaded(f_source == SOURCE_INPUT && f_input == INPUT_PHI), .phi_below_0(in[W-1]), .e_set(f_e_set), .zero(zero),
      .none(none), .a_by(f_a_by), .b_by(f_b_by), .w_by(f_w_by), .s_by(f_s_by), .minus_by(f_minus_by),
      .a_second(a_second), .b_second(b_second), .w_second(w_second), .s_other(s_other), .minus(taken),
      .clamp(clamped), .fold(folded), .nodes(flag_nodes), .flags(flags)
  );

  // ---- results ----

  localparam [W-1:0] UNIT = {2'b01, {(W - 2) {1'b0}}};
  // A clamped elbow is folded (1, 0) or straight (0, -1).
  wire of_w = clamped && f_result == RESULT_QE_W;
  wire of_i = clamped && f_result == RESULT_QE_I;
  wire [W-1:0] answer = of_w ? (folded ? UNIT : {W{1'b0}}) : of_i ? (folded ? {W{1'b0}} : -UNIT) : result;
  reg [TAG_W-1:0] tag;
  always @(posedge clk) begin
    if (s_axis_tready) tag <= s_axis_tuser;
    if (go && giving) begin
      if (f_first_result) m_axis_tuser <= {flags, tag};
      case (f_result)
        RESULT_QS_W: m_axis_tdata[0*W+:W] <= answer;
        RESULT_QS_I: m_axis_tdata[1*W+:W] <= answer;
        RESULT_QS_J: m_axis_tdata[2*W+:W] <= answer;
        RESULT_QS_K: m_axis_tdata[3*W+:W] <= answer;
        RESULT_QE_W: m_axis_tdata[4*W+:W] <= answer;
        RESULT_QE_I: m_axis_tdata[5*W+:W] <= answer;
        default: ;
      endcase
    end
  end

  // ---- dataflow nodes, for waves and testbenches only ----

  wire [FRAC+2:0] p_plain = p[2*D-5-FRAC+:FRAC+3] + {{(FRAC + 2) {1'b0}}, 1'b1};  // the product, rounded like its node
  wire [FRAC+2:0] p_double = p[2*D-6-FRAC+:FRAC+3] + {{(FRAC + 2) {1'b0}}, 1'b1};
  wire unused = &{1'b0, p_plain, p_double, f_r_function, n, sum};
  `include "ik_fold_nodes.vh"

endmodule

`default_nettype wire
