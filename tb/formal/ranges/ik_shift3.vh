// SPDX-License-Identifier: Apache-2.0
// Appended to ik_shift3: the shifted word of three clocks ago, with ample width.

localparam integer GW = IW + DROP + OW + 64;
wire signed [GW-1:0] ghost_d = d;
wire signed [GW-1:0] ghost_value = (ghost_d <<< count) >>> DROP;
reg signed [GW-1:0] ghost_1;
reg signed [GW-1:0] ghost_2;
reg signed [GW-1:0] ghost_3;
reg [1:0] ghost_age = 2'd0;  // clocks, up to 3
always @(posedge clk) begin
  ghost_1 <= ghost_value;
  ghost_2 <= ghost_1;
  ghost_3 <= ghost_2;
  if (ghost_age != 2'd3) ghost_age <= ghost_age + 2'd1;
end

always @* if (ghost_age == 2'd3) begin
  guard_bits : assert (ghost_3 == q);
  modulo : assert (q == $signed(ghost_3[OW-1:0]));
end
