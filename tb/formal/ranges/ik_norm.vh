// SPDX-License-Identifier: Apache-2.0
// Appended to ik_norm: its words, three clocks ago, shifted in more bits than they can need. No assumption on them.

localparam integer GW = W + 64;
reg [N*W-1:0] ghost_1;
reg [N*W-1:0] ghost_2;
reg [N*W-1:0] ghost_3;
reg [1:0] ghost_age = 2'd0;  // clocks, up to 3
always @(posedge clk) begin
  ghost_1 <= d;
  ghost_2 <= ghost_1;
  ghost_3 <= ghost_2;
  if (ghost_age != 2'd3) ghost_age <= ghost_age + 2'd1;
end
wire [N-1:0] ghost_fits;
genvar gi;
generate
  for (gi = 0; gi < N; gi = gi + 1) begin : g_ghost
    wire signed [W-1:0] word = ghost_3[gi*W+:W];
    wire signed [W-1:0] result = q[gi*W+:W];
    wire signed [GW-1:0] value = word;
    assign ghost_fits[gi] = (value <<< count) == result;
  end
endgenerate
wire ghost_none = ghost_3 == {(N * W) {1'b0}};

always @* if (ghost_age == 2'd3) begin
  guard_bits : assert (ghost_none || &ghost_fits);
  none : assert (!ghost_none || q == {{(N * W - 1) {1'b0}}, 1'b1} << (W - 2));
  count_fits : assert (count < W);
end
