// SPDX-License-Identifier: Apache-2.0
// Appended to ik_even: v of three clocks ago, shifted with ample width. No assumption on v.

localparam integer GW = VW + 128;
reg [VW-1:0] ghost_1;
reg [VW-1:0] ghost_2;
reg [VW-1:0] ghost_3;
reg [1:0] ghost_age = 2'd0;  // clocks, up to 3
always @(posedge clk) begin
  ghost_1 <= v;
  ghost_2 <= ghost_1;
  ghost_3 <= ghost_2;
  if (ghost_age != 2'd3) ghost_age <= ghost_age + 2'd1;
end
wire [GW-1:0] ghost_v = ghost_3;
wire [GW-1:0] ghost_shifted = ghost_v << {k, 1'b0};
wire [GW+MW-1:0] ghost_longer = {ghost_shifted, {MW{1'b0}}};

always @* if (ghost_age == 2'd3) begin
  guard_bits : assert (ghost_shifted[GW-1:VW] == 0);
  mantissa : assert (m == ghost_longer[VW+MW-1:VW]);
  count : assert (k < VW / 2);
  full : assert ((ghost_3 == 0) ? (k == VW / 2 - 1) : (ghost_shifted[VW-1:VW-2] != 0));
end
