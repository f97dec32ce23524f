// SPDX-License-Identifier: Apache-2.0
// Appended to ik_half: 1 + c or 1 - c, a clock ago, limited to [0, 1]. No assumption on c.

localparam integer GW = W + 4;
wire signed [GW-1:0] ghost_one = {{(GW - 1) {1'b0}}, 1'b1} << (W - 2);
wire signed [GW-1:0] ghost_value = (MINUS != 0) ? (ghost_one - c) : (ghost_one + c);
reg signed [GW-1:0] ghost_1;
reg ghost_age = 1'b0;
always @(posedge clk) begin
  ghost_1   <= ghost_value;
  ghost_age <= 1'b1;
end
wire signed [GW-1:0] ghost_most = ghost_one <<< 1;
wire signed [GW-1:0] ghost_q = q;

always @* if (ghost_age) limited : assert (ghost_q == (ghost_1 < 0 ? 0 : ghost_1 > ghost_most ? ghost_most : ghost_1));
