// Pipelined digit recurrence with the ports and results of ik_root: q = floor(sqrt(n * 2^SH)), 0 if n < 0.
// SPDX-License-Identifier: Apache-2.0
//
// Rounds down (floor); n signed NW bits, q signed QW bits, never negative.
// A root that does not fit saturates.
// The rows are non-restoring: a remainder is signed, and its sign is the inverse of the result bit found with it.
// A row's registers: remainder without sign, and one word {remaining radicand, root so far} that loses two bits on the
// left and gains one on the right. The zeros that end n 2^SH are not stored.
// Throughput: one root per clock.
// Latency: LAT clocks: rows with one result bit per clock, or two if LAT is too short; output; spare clocks at the
// output. LAT is at least 1 + ceil(R/2), 1 + R for one bit per clock, with R = min(QW-1, ceil((NW-1+SH)/2)) result
// bits.
`default_nettype none

module ik_root_digit #(
    parameter integer NW  = 32,  // width of the radicand
    parameter integer SH  = 30,  // 2 F(q) - F(n)
    parameter integer QW  = 32,  // width of the root
    parameter integer LAT = 32   // latency, clocks
) (
    input  wire                 clk,
    input  wire signed [NW-1:0] n,
    output wire signed [QW-1:0] q,
    output wire                 neg
);

  localparam integer VB = NW - 1 + SH;  // bits of the radicand
  localparam integer ROWS = ((VB + 1) / 2 < QW - 1) ? ((VB + 1) / 2) : (QW - 1);  // result bits
  localparam integer PAIRS = (SH / 2 < ROWS) ? (ROWS - SH / 2) : 0;  // bit pairs of the radicand that are not padding
  localparam integer BITS = (LAT >= ROWS + 1) ? 1 : 2;  // result bits between registers
  localparam integer STAGES = (ROWS + BITS - 1) / BITS;

  generate
    if (NW < 2 || SH < 0 || QW < 2) begin : g_illegal
      ik_root_digit_illegal_width u_stop ();
    end
    if (LAT < STAGES + 1) begin : g_short
      ik_root_digit_illegal_LAT u_stop ();
    end
  endgenerate

  localparam integer XW = ((VB > 2 * ROWS) ? VB : (2 * ROWS)) + 1;
  wire minus = n[NW-1];
  wire [XW-1:0] v = {{(XW - NW + 1) {1'b0}}, n[NW-2:0]} << SH;
  wire over;
  wire minus_out;
  ik_delay #(.W(2), .N(STAGES)) u_flags (.clk(clk), .d({minus, |v[XW-1:2*ROWS]}), .q({minus_out, over}));

  // ---- rows ----

  localparam integer FIRST = (PAIRS > 0) ? (2 * PAIRS) : 1;  // at least one bit

  genvar k;
  generate
    for (k = 0; k < ROWS; k = k + 1) begin : g_row
      localparam integer WW = (k == 0) ? FIRST : (k > PAIRS) ? k : (2 * PAIRS - k);  // width of the word
      localparam integer NEXT = (k + 1 > PAIRS) ? (k + 1) : (2 * PAIRS - k - 1);
      localparam integer CLOCKS = (BITS == 1 || k % 2 == 1 || k == ROWS - 1) ? 1 : 0;
      wire [k:0] r;
      wire [k:0] root;
      wire [WW-1:0] word;
      wire ge;  // remainder >= 0; r is its other bits
      if (k == 0) begin : g_first
        assign r = 1'b0;
        assign ge = 1'b1;
        assign root = 1'b0;
        assign word = v[2*ROWS-1:2*ROWS-FIRST];
      end else begin : g_next
        assign r = g_row[k-1].r_q;
        assign ge = word[0];
        assign root = {1'b0, word[k-1:0]};
        assign word = g_row[k-1].word_q;
      end
      wire [1:0] pair;
      if (k < PAIRS) begin : g_stored
        assign pair = word[WW-1:WW-2];
      end else begin : g_zeros
        assign pair = 2'b00;
      end

      wire [k+1:0] r_next;
      wire q_bit;
      ik_root_row #(
          .K(k)
      ) u_row (
          .r      (r),
          .ge     (ge),
          .root   (root),
          .pair   (pair),
          .r_next (r_next),
          .ge_next(q_bit)
      );

      wire [WW:0] word_next = {word, q_bit};
      wire [k+1:0] r_q;
      wire [NEXT-1:0] word_q;
      ik_delay #(
          .W(k + 2 + NEXT),
          .N(CLOCKS)
      ) u_registers (
          .clk(clk),
          .d  ({r_next, word_next[NEXT-1:0]}),
          .q  ({r_q, word_q})
      );
      wire unused_row = &{1'b0, word_next, r_q};
    end
  endgenerate

  // ---- output ----

  wire [QW-1:0] result = {{(QW - ROWS) {1'b0}}, g_row[ROWS-1].word_q};
  wire [QW-2:0] bounded = (result[QW-2:0] | {(QW - 1) {over}}) & ~{(QW - 1) {minus_out}};
  ik_delay #(
      .W(QW + 1),
      .N(LAT - STAGES)
  ) u_out (
      .clk(clk),
      .d  ({minus_out, 1'b0, bounded}),
      .q  ({neg, q})
  );

  wire unused = &{1'b0, v, result[QW-1]};

endmodule

`default_nettype wire
