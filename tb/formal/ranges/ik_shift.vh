// SPDX-License-Identifier: Apache-2.0
// Appended to ik_shift: the shifted word of two clocks ago, with ample width.

localparam integer GW = W + 64;
wire signed [GW-1:0] ghost_d = d;
wire signed [GW-1:0] ghost_value = (RIGHT != 0) ? (ghost_d >>> count) : (ghost_d <<< count);
reg signed [GW-1:0] ghost_1;
reg signed [GW-1:0] ghost_2;
reg [1:0] ghost_age = 2'd0;  // clocks, up to 2
always @(posedge clk) begin
  ghost_1 <= ghost_value;
  ghost_2 <= ghost_1;
  if (ghost_age != 2'd2) ghost_age <= ghost_age + 2'd1;
end

always @* if (ghost_age == 2'd2) begin
  guard_bits : assert (ghost_2 == q);
  modulo : assert (q == $signed(ghost_2[W-1:0]));
end
