// SPDX-License-Identifier: Apache-2.0
// Appended to ik_wide: the sum of one clock ago, with ample width.

localparam integer GW = W + 4;
wire signed [GW-1:0] ghost_value = (SUB != 0) ? (a - b) : (a + b);
reg signed [GW-1:0] ghost_1;
reg ghost_age = 1'b0;  // clocks, up to 1
always @(posedge clk) begin
  ghost_1   <= ghost_value;
  ghost_age <= 1'b1;
end

always @* if (ghost_age) begin
  guard_bits : assert (ghost_1 == q);
  modulo : assert (q == $signed(ghost_1[W-1:0]));
end
