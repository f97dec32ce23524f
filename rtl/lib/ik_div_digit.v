// Pipelined digit recurrence with the ports and results of ik_div: q = floor(n * 2^SH / d).
// SPDX-License-Identifier: Apache-2.0
//
// Rounds down (floor), saturates; n signed NW, d signed DW, q signed QW bits.
// The rows divide n 2^SH if it is positive, its one's complement if negative: for x < 0, floor(x / d) = -1 - floor((-1
// - x) / d). Neither inversion needs a carry. For either sign, q fits if the unsigned quotient is below 2^(QW-1), that
// is, if the bits above the ones fed to the rows are less than d. So the first remainder is less than d unless ovf is
// set.
// The rows are non-restoring: a remainder is signed, and its sign is the inverse of the quotient bit found with it.
// A row's registers: divisor, remainder without sign, and one word {remaining dividend, quotient so far} that shifts
// left by one bit. The dividend's last SH bits are copies of the sign and are not stored.
// Throughput: one quotient per clock.
// Latency: LAT clocks: magnitude; rows with one quotient bit per clock, or two if LAT is too short; sign; spare clocks
// at the output. LAT is at least 2 + ceil(R/2), 2 + R for one bit per clock, with R = min(QW-1, NW-1+SH) quotient bits.
`default_nettype none

module ik_div_digit #(
    parameter integer NW  = 40,  // width of the dividend
    parameter integer DW  = 32,  // width of the divisor
    parameter integer SH  = 22,  // F(q) - F(n) + F(d)
    parameter integer QW  = 32,  // width of the quotient
    parameter integer LAT = 34   // latency, clocks
) (
    input  wire                 clk,
    // Operands
    input  wire signed [NW-1:0] n,
    input  wire signed [DW-1:0] d,
    // Quotient
    output wire signed [QW-1:0] q,
    output wire                 ovf
);

  localparam integer MB = NW - 1 + SH;  // bits of the magnitude
  localparam integer ROWS = (MB < QW - 1) ? MB : (QW - 1);  // quotient bits, also magnitude bits fed to the rows
  localparam integer STORED = (SH < ROWS) ? (ROWS - SH) : 0;  // magnitude bits that are not copies of the sign
  localparam integer BITS = (LAT >= ROWS + 2) ? 1 : 2;  // quotient bits between registers
  localparam integer STAGES = (ROWS + BITS - 1) / BITS;

  generate
    if (NW < 2 || DW < 2 || SH < 0 || QW < 2) begin : g_illegal
      ik_div_digit_illegal_width u_stop ();
    end
    if (LAT < STAGES + 2) begin : g_short
      ik_div_digit_illegal_LAT u_stop ();
    end
  endgenerate

  // ---- magnitude ----

  localparam integer HW = ((MB - ROWS > DW - 1) ? (MB - ROWS) : (DW - 1)) + 2;
  localparam integer XW = HW + ROWS;

  wire minus = n[NW-1];
  wire [XW-1:0] n_x = {{(XW - NW) {minus}}, n};
  wire [XW-1:0] magnitude = (n_x << SH) ^ {XW{minus}};
  wire [HW-1:0] high = magnitude[XW-1:ROWS];

  localparam integer FIRST = (STORED > 0) ? STORED : 1;  // at least one bit
  reg sign_1;
  reg over_1;
  reg [DW-2:0] d_1;
  reg [DW-2:0] r_1;
  reg [FIRST-1:0] word_1;
  always @(posedge clk) begin
    sign_1 <= minus;
    over_1 <= d[DW-1] || (high >= {{(HW - DW + 1) {1'b0}}, d[DW-2:0]});  // d = 0 included
    d_1    <= d[DW-2:0];
    r_1    <= high[DW-2:0];
    word_1 <= magnitude[ROWS-1:ROWS-FIRST];
  end

  // ---- rows ----

  genvar k;
  generate
    for (k = 0; k < ROWS; k = k + 1) begin : g_row
      localparam integer WW = (k > FIRST) ? k : FIRST;  // width of the word
      localparam integer NEXT = (k + 1 > FIRST) ? (k + 1) : FIRST;
      localparam integer CLOCKS = (BITS == 1 || k % 2 == 1 || k == ROWS - 1) ? 1 : 0;
      wire sign;
      wire [DW-2:0] divisor;
      wire [DW-2:0] r;
      wire [WW-1:0] word;
      wire ge;  // remainder >= 0; r is its other bits
      if (k == 0) begin : g_first
        assign {sign, divisor, r, word} = {sign_1, d_1, r_1, word_1};
        assign ge = 1'b1;
      end else begin : g_next
        assign {sign, divisor, r, word} = {
          g_row[k-1].sign_q, g_row[k-1].divisor_q, g_row[k-1].r_q, g_row[k-1].word_q
        };
        assign ge = word[0];
      end

      wire [DW-2:0] r_next;
      wire q_bit;
      ik_div_row #(
          .W(DW - 1)
      ) u_row (
          .r      (r),
          .ge     (ge),
          .d      (divisor),
          .bit_in ((k < STORED) ? word[WW-1] : sign),
          .r_next (r_next),
          .ge_next(q_bit)
      );

      wire [WW:0] word_next = {word, q_bit};
      wire sign_q;
      wire [DW-2:0] divisor_q;
      wire [DW-2:0] r_q;
      wire [NEXT-1:0] word_q;
      ik_delay #(
          .W(1 + 2 * (DW - 1) + NEXT),
          .N(CLOCKS)
      ) u_registers (
          .clk(clk),
          .d  ({sign, divisor, r_next, word_next[NEXT-1:0]}),
          .q  ({sign_q, divisor_q, r_q, word_q})
      );
      wire unused_row = &{1'b0, word_next, divisor_q, r_q};
    end
  endgenerate

  wire over;
  ik_delay #(.W(1), .N(STAGES)) u_over (.clk(clk), .d(over_1), .q(over));

  // ---- sign; all magnitude bits are set on overflow ----

  wire minus_out = g_row[ROWS-1].sign_q;
  wire [QW-1:0] quotient = {{(QW - ROWS) {1'b0}}, g_row[ROWS-1].word_q};
  wire [QW-2:0] bounded = quotient[QW-2:0] | {(QW - 1) {over}};
  ik_delay #(
      .W(QW + 1),
      .N(LAT - 1 - STAGES)
  ) u_out (
      .clk(clk),
      .d  ({over, minus_out, bounded ^ {(QW - 1) {minus_out}}}),
      .q  ({ovf, q})
  );

  wire unused = &{1'b0, magnitude, high, quotient[QW-1]};

endmodule

`default_nettype wire
