// SPDX-License-Identifier: Apache-2.0
// Appended to ik_lzc: its words, two clocks ago, shifted in more bits than they can need. No assumption on them.

localparam integer GW = W + 64;
reg [N*W-1:0] ghost_1;
reg [N*W-1:0] ghost_2;
reg [1:0] ghost_age = 2'd0;  // clocks, up to 2
always @(posedge clk) begin
  ghost_1 <= d;
  ghost_2 <= ghost_1;
  if (ghost_age != 2'd2) ghost_age <= ghost_age + 2'd1;
end
wire [N-1:0] ghost_fits;
genvar gi;
generate
  for (gi = 0; gi < N; gi = gi + 1) begin : g_ghost
    wire signed [W-1:0] word = ghost_2[gi*W+:W];
    wire signed [GW-1:0] value = word;
    wire signed [GW-1:0] shifted = value <<< count;
    wire signed [W-1:0] result = shifted[W-1:0];
    assign ghost_fits[gi] = shifted == result;
  end
endgenerate

always @* if (ghost_age == 2'd2) begin
  guard_bits : assert (&ghost_fits);
  count_fits : assert (count < W);
  none : assert (empty == (ghost_2 == {(N * W) {1'b0}}));
end
