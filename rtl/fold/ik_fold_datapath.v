// Operands, product, sum and word of the folded datapath: one step of its program per clock, in a pipeline.
// SPDX-License-Identifier: Apache-2.0
//
// Rounding as in ik_fold_sum; words of D bits, sums of XW.
// The fields of a step belong to its clock, not to an operation: they control the reads of one operation, the product
// of another and the word of a third. Codes: ik_fold_codes.vh. The word to write, `w`, is chosen outside: `word`,
// `normal` or another.
// Throughput: one step per clock with go high.
// Latency: 5 clocks from the addresses a_at, b_at and r_at to word, 7 to normal.
`default_nettype none

module ik_fold_datapath #(
    parameter integer W    = 24,  // word length of the core
    parameter integer TILE = 18,  // multiplier tile width: 18 or 16
    parameter integer D    = 33,  // width of a word: mantissa and sign, ROOT_FRAC + 4
    parameter integer XW   = 50,  // width of an exact sum: 2 W + 2
    parameter integer WORDS = 32  // of the memory that the program uses
) (
    input  wire           clk,
    input  wire           go,
    // Step: operands
    input  wire [    6:0] a_at,
    input  wire [    6:0] b_at,
    input  wire [    5:0] r_at,
    input  wire           b_count,       // b is the power of two of the shift count
    input  wire           b_constant,    // b is the constant 64 words further
    input  wire           a_bend,        // a is c2
    input  wire [    1:0] b_place,
    input  wire           b_high,
    input  wire [    1:0] r_function,
    // Step: product, sum, word
    input  wire [    2:0] cut,
    input  wire [    3:0] s,
    input  wire           carry,
    input  wire [    1:0] window,
    input  wire           limit,
    input  wire [    1:0] last,
    input  wire [    2:0] norm,
    // Step: shift counts
    input  wire [    2:0] n_base,
    input  wire [    2:0] n_e,
    input  wire           n_minus,
    input  wire           n_twice,
    input  wire [    2:0] e_set,
    // Step: signs, and what depends on them
    input  wire [    3:0] sign,
    input  wire [    1:0] a_by,
    input  wire [    1:0] b_by,
    input  wire [    1:0] w_by,
    input  wire [    1:0] s_by,
    input  wire [    3:0] minus_by,
    // Write
    input  wire           w_en,
    input  wire [    5:0] w_at,
    input  wire [  D-1:0] w,
    input  wire           phi_loaded,    // w is phi, with this sign
    input  wire           phi_below_0,
    // Sum, and the words made of it
    output wire [ XW-1:0] t,
    output wire [  D-1:0] word,
    output wire [  D-1:0] normal,
    output wire [  W-1:0] result,
    // Elbow and flags
    output wire           clamp,         // no elbow
    output wire           closed,          // then it is closed, not straight
    output wire [    7:0] flags,         // too_far, too_near, on_axis, at_shoulder, bad_length, 0, 0, 0
    // For waves and testbenches
    output wire [    5:0] w_place,
    output wire [  D-1:0] b,
    output wire [2*D-1:0] p,
    output wire [    5:0] n,
    output wire [    5:0] pairs,
    output wire           doubled,
    output wire           q_low,
    output wire [    9:0] flag_nodes
);

  `include "ik_fold_codes.vh"
  `include "ik_fold_formats.vh"

  localparam integer TW = (XW < SINE_SUM_FRAC + 5) ? SINE_SUM_FRAC + 5 : XW;  // wide enough for half a sine too
  localparam integer INNER = FRAC + 2;
  localparam integer LAST = XW - 2 - INNER;  // position of an inner word's LSB in a sum
  localparam integer WORD = 2 * D - 2 - INNER;  // and in a product

  // ---- words ----

  localparam integer SEEN = (D < 2 * TILE) ? D : 2 * TILE - 1;  // word bits the multiplier uses
  localparam integer RW = INDEX_BITS + 2;
  localparam integer DOWN = INDEX_BITS + 2;
  wire [SEEN-1:0] a;
  wire [RW-1:0] row_word;
  wire a_zero, a_second, b_second, w_second;
  assign w_place = {w_at[5:1], w_at[0] ^ w_second};
  ik_fold_memory #(.D(D), .AD(SEEN), .DOWN(DOWN), .RW(RW), .WORDS(WORDS)) u_memory (
      .clk(clk), .go(go),
      .a_at({a_at[6] ^ a_zero, a_at[5:1], a_at[0] ^ a_second}),
      .b_at(b_count ? {1'b1, n} : {b_at[6] ^ b_constant, b_at[5:1], b_at[0] ^ b_second}), .r_at(r_at),
      .a(a), .b(b), .r(row_word),
      .w_en(w_en), .w_at(w_place), .w(w)
  );

  // ---- table rows, and the offset within a segment ----

  wire [C0_BITS-1:0] c0;
  wire [C1_BITS-1:0] c1;
  wire [C2_BITS-1:0] c2;
  ik_fold_table #(.W(W), .TILE(TILE), .RW(RW), .ROW(C0_BITS+C1_BITS+C2_BITS)) u_table (
      .clk(clk), .go(go), .word(row_word),
      .angle(r_function != R_FUNCTION_ROOT), .cosine(r_function == R_FUNCTION_COSINE), .row({c0, c1, c2})
  );
  wire [SEEN-1:0] bend = {{(SEEN - C2_BITS) {1'b0}}, c2} << (SEEN - 4 - INDEX_BITS - C2_FRAC);
  // The offset from the segment's middle: the bits below the segment number, their MSB inverted. A mantissa in [1/2, 1)
  // has one bit fewer in its segment number; a quarter turn is the end of the last segment.
  wire [D-1:0] raised = b << (INDEX_BITS + 1);
  wire upper = b[D-2] && b_place == B_PLACE_ROOT;
  wire end_ = b[D-2] && b_place != B_PLACE_ROOT;
  wire [1:0] top = upper ? {~raised[D-1], raised[D-2]} : {~raised[D-2] && !end_, ~raised[D-2]};
  wire [D-1:0] place = {top, raised[D-3:0]} & (b_high ? {D{1'b1}} << (D - TILE) : {D{1'b1}});

  // ---- product and sum ----

  wire [D-1:0] factor = b_place == B_PLACE_NONE ? b : place;
  generate
    if (D > SEEN) begin : g_unseen
      assign p[2*(D-SEEN)-1:0] = 0;
      wire unused_factor = &{1'b0, factor};
    end
  endgenerate
  ik_fold_mul #(.D(SEEN), .TILE(TILE), .WORD(WORD-2*(D-SEEN)), .ROOT(ROOT_DROP), .SINE(SINE_DROP)) u_mul (
      .clk(clk), .go(go), .a(a_bend ? bend : a), .b(factor[D-1-:SEEN]), .cut(cut), .p(p[2*D-1-:2*SEEN])
  );

  wire unscaled, s_other, minus;
  reg down_1, minus_1, carry_1;
  always @(posedge clk)
    if (go) begin
      down_1  <= cut == CUT_ROOT || cut == CUT_SINE || (cut == CUT_POWER && !unscaled);
      minus_1 <= minus;
      carry_1 <= carry == CARRY_MINUS && minus;
    end
  wire [TW-1:0] sum;
  ik_fold_sum #(
      .D(D), .XW(TW), .LAST(TW-2-INNER), .HALF(TW-5), .ANSWER(TW-3-W), .C0W(C0_BITS), .C1W(C1_BITS),
      .C0_AT(TW-4-C0_FRAC), .C1_AT(TW-4-C1_FRAC), .SLOPE(TW-4-SLOPE_FRAC), .DOWN(DOWN)
  ) u_sum (
      .clk(clk), .go(go), .choice(s), .by(s_other), .c0(c0), .c1(c1),
      .p(p), .down(down_1), .minus(minus_1), .carry(carry_1), .t(sum)
  );
  assign t = sum[TW-1-:XW];

  // ---- T as a word, a mantissa with its shift count, or a result ----

  wire none, zero, word_below_0;
  wire doubles_low = window == WINDOW_LOW && q_low;
  assign doubled = window == WINDOW_DOUBLE || doubles_low;
  ik_fold_word #(.W(W), .D(D), .XW(XW), .INNER(INNER), .ROOT(ROOT_FRAC), .SINE(SINE_FRAC), .SLOPE(SLOPE_FRAC)) u_word (
      .t(t), .doubled(doubled), .limit(limit), .last(last), .low(doubles_low), .word(word), .negative(word_below_0),
      .result(result)
  );
  ik_fold_norm #(.W(W), .D(D), .XW(XW), .LAST(LAST), .DROP(D-INNER)) u_norm (
      .clk(clk), .go(go), .t(t), .kind(norm), .n(n), .word(normal), .pairs(pairs), .zero(zero)
  );
  ik_fold_count #(.D(SEEN)) u_count (
      .clk(clk), .go(go), .base(n_base), .pair(n_e), .minus(n_minus), .twice(n_twice), .load(e_set),
      .pairs(pairs), .n(n), .none(none), .unscaled(unscaled), .low(q_low)
  );

  // ---- signs, zeros and flags ----

  ik_fold_flags u_flags (
      .clk(clk), .go(go), .sign(sign), .sum_below_0(t[XW-1]), .word_below_0(word_below_0),
      .phi_loaded(phi_loaded), .phi_below_0(phi_below_0), .e_set(e_set), .zero(zero),
      .none(none), .a_by(a_by), .b_by(b_by), .w_by(w_by), .s_by(s_by), .minus_by(minus_by),
      .a_zero(a_zero), .a_second(a_second), .b_second(b_second), .w_second(w_second), .s_other(s_other), .minus(minus),
      .clamp(clamp), .closed(closed), .nodes(flag_nodes), .flags(flags)
  );
  wire unused = &{1'b0, sum};

endmodule

`default_nettype wire
