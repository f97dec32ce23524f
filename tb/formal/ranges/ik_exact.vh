// SPDX-License-Identifier: Apache-2.0
// Appended to ik_exact: its registers hold the products of half words, and the result is their sum, for any values. The
// integer questions prove that the sum is a * b and fits.

reg signed [W-1:0] ghost_a_1;
reg signed [W-1:0] ghost_b_1;
reg signed [W-1:0] ghost_a;  // two clocks ago
reg signed [W-1:0] ghost_b;
wire signed [H-1:0] ghost_a_hi = ghost_a[W-1:L];
wire signed [H-1:0] ghost_b_hi = (SQUARE != 0) ? ghost_a_hi : $signed(ghost_b[W-1:L]);
wire signed [L:0] ghost_a_lo = {1'b0, ghost_a[L-1:0]};
wire signed [L:0] ghost_b_lo = (SQUARE != 0) ? ghost_a_lo : $signed({1'b0, ghost_b[L-1:0]});

wire signed [H+L:0] ghost_middle;
generate
  if (SQUARE != 0) begin : g_ghost
    assign ghost_middle = hl <<< 1;
  end else begin : g_ghost
    assign ghost_middle = hl + g_product.lh;
    always @* if (ghost_age == 2'd2) tile_lh : assert (g_product.lh == ghost_a_lo * ghost_b_hi);
  end
endgenerate
localparam integer GW = 2 * W + 4;
wire signed [2*W-1:0] ghost_outer = {hh, ll[2*L-1:0]};
wire signed [GW-1:0] ghost_inner = ghost_middle;
reg signed [GW-1:0] ghost_1;
reg signed [GW-1:0] ghost_2;
reg [1:0] ghost_age = 2'd0;  // clocks, up to 2
always @(posedge clk) begin
  ghost_a_1 <= a;
  ghost_b_1 <= b;
  ghost_a   <= ghost_a_1;
  ghost_b   <= ghost_b_1;
  ghost_1   <= ghost_outer + (ghost_inner <<< L);
  ghost_2   <= ghost_1;
  if (ghost_age != 2'd2) ghost_age <= ghost_age + 2'd1;
end

always @* if (ghost_age == 2'd2) begin
  tile_hh : assert (hh == ghost_a_hi * ghost_b_hi);
  tile_hl : assert (hl == ghost_a_hi * ghost_b_lo);
  tile_ll : assert (ll == ghost_a_lo * ghost_b_lo);
  // a square has no register between the tiles and their sum
  recombined : assert (p == $signed((SQUARE != 0) ? ghost_1[2*W-1:0] : ghost_2[2*W-1:0]));
end
