// Ghost of a queue of bursts on one channel: the number of open bursts, and the sizes of the oldest and the newest.
// SPDX-License-Identifier: Apache-2.0
//
// Sizes are in records. They are exact as long as `middle` holds: all bursts between the oldest and the newest have
// WHOLE records. `pop` removes one record of the oldest burst, `drop` removes the oldest burst.
`default_nettype none

module ik_bursts #(
    parameter integer N     = 4,   // width of the number of records of a burst
    parameter integer S     = 8,   // width of the total number of records, and of the number of bursts
    parameter [N-1:0] WHOLE = 8
) (
    input  wire         clk,
    input  wire         clear,
    input  wire         push,
    input  wire [N-1:0] size,
    input  wire         pop,
    input  wire         drop,
    output reg  [S-1:0] n,
    output reg  [N-1:0] oldest,
    output reg  [N-1:0] newest,
    output wire [S-1:0] sum,
    output wire         middle
);

  wire gone = (pop && oldest == 1) || drop;
  wire [S-1:0] stay = n - gone;
  assign middle = !push || n < 2 || newest == WHOLE;
  assign sum = (n == 0) ? {S{1'b0}} : (n == 1) ? {{(S - N) {1'b0}}, oldest} :
               {{(S - N) {1'b0}}, oldest} + {{(S - N) {1'b0}}, newest} + (n - 2'd2) * {{(S - N) {1'b0}}, WHOLE};
  always @(posedge clk) begin
    n <= clear ? {S{1'b0}} : stay + push;
    if (push) newest <= size;
    if (push && stay == 0) oldest <= size;
    else if (gone) oldest <= (n == 2) ? newest : WHOLE;
    else if (pop) oldest <= oldest - 1'b1;
  end

endmodule

`default_nettype wire
