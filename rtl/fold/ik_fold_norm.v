// T as a mantissa, shifted left until it fills its word, or T shifted left by a count.
// SPDX-License-Identifier: Apache-2.0
//
// Rounds down: bits of T below the word are dropped; T has XW bits, the word D.
// A mantissa is shifted by pairs of bits until one of its two highest bits is set.
// Throughput: one step per clock with go high.
// Latency: 2 clocks.
`default_nettype none

module ik_fold_norm #(
    parameter integer W    = 24,  // word length of the core
    parameter integer D    = 33,  // width of a word
    parameter integer XW   = 50,  // width of a sum
    parameter integer LAST = 17,  // position of an inner word's LSB in a sum
    parameter integer DROP = 2    // word bits below an inner word's LSB
) (
    input  wire          clk,
    input  wire          go,
    // Sum, kind of shift, count
    input  wire [XW-1:0] t,
    input  wire [   2:0] kind,
    input  wire [   5:0] n,
    // Word, pairs shifted, T = 0
    output wire [ D-1:0] word,
    output wire [   5:0] pairs,
    output wire          zero
);

  `include "ik_fold_codes.vh"

  localparam [XW-1:0] ONE = {{(XW - 1) {1'b0}}, 1'b1};

  wire by_count = kind == NORM_COUNT;
  wire unit = kind == NORM_UNIT;
  wire arm = kind == NORM_ARM;

  // ---- shift by 32, and the count's lowest bit ----

  wire [XW-1:0] kept = unit ? t & ~((ONE << LAST) - ONE) : t ^ {XW{kind == NORM_INVERSE}};
  wire [XW-1:0] v5 = by_count ? (n[0] ? t << 1 : t) : {arm ? 2'b00 : kept[2*W-1-:2], kept[2*W-3:0], 2'b00};
  wire s5 = by_count ? n[5] : v5[XW-1-:32] == 0;
  reg [XW-1:0] v4;
  reg s5_1, counted_1, arm_1, most_1;
  always @(posedge clk)
    if (go) begin
      v4        <= s5 ? v5 << 32 : v5;
      s5_1      <= s5;
      counted_1 <= by_count;
      arm_1     <= arm;
      most_1    <= unit && t[2*W-2];  // T >= 1
    end

  // ---- shift by 16 and 8; the zero checks run in parallel with the shift by 16 ----

  wire [2:0] none_of_8 = {v4[XW-1-:8] == 0, v4[XW-9-:8] == 0, v4[XW-17-:8] == 0};
  wire s4 = counted_1 ? n[4] : none_of_8[2] && none_of_8[1];
  wire s3 = counted_1 ? n[3] : s4 ? none_of_8[0] : none_of_8[2];
  wire [XW-1:0] v3 = v4 << {s4, s3, 3'b000};
  reg [XW-1:0] v2;
  reg [2:0] none_of_2;
  reg [2:0] high;
  reg counted, of_arm, most;
  always @(posedge clk)
    if (go) begin
      v2 <= v3;
      none_of_2 <= {v3[XW-1-:2] == 0, v3[XW-3-:2] == 0, v3[XW-5-:2] == 0};
      high    <= {s5_1, s4, s3};
      counted <= counted_1;
      of_arm  <= arm_1;
      most    <= most_1;
    end

  // ---- shift by 4 and 2 ----

  wire s2 = counted ? n[2] : none_of_2[2] && none_of_2[1];
  wire s1 = counted ? n[1] : s2 ? none_of_2[0] : none_of_2[2];
  wire [XW-1:0] v0 = v2 << {s2, s1, 1'b0};
  assign word = counted ? v0[XW-1-:D] & ({D{1'b1}} << DROP) : {1'b0, v0[XW-1-:D-1] | {(D - 1) {most}}};
  assign zero = v0[XW-1-:2] == 0;
  localparam integer MOST = W - 1;
  localparam integer HALF = W / 2;
  assign pairs = !zero ? {1'b0, high, s2, s1} : of_arm ? HALF[5:0] : MOST[5:0];
  wire unused = &{1'b0, kept, v0};

endmodule

`default_nettype wire
