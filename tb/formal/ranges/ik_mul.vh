// SPDX-License-Identifier: Apache-2.0
// Appended to ik_mul: its registers hold the products of parts, of which there are one to four, and the result is their
// sum, any values that they may have. That the sum is a * b and fits is left to the integers.

reg signed [AW-1:0] ghost_a_1;
reg signed [BW-1:0] ghost_b_1;
reg signed [AW-1:0] ghost_a;  // two clocks ago
reg signed [BW-1:0] ghost_b;  // with SQUARE it is a

localparam integer GW = AW + BW + OW + 4;
wire signed [GW-1:0] ghost_half = (SH > 0) ? ({{(GW - 1) {1'b0}}, 1'b1} << ((SH > 0) ? SH - 1 : 0)) : {GW{1'b0}};
wire signed [GW-1:0] ghost_tiles;
wire signed [GW-1:0] ghost_long = ghost_tiles + ghost_half;
wire signed [AW+BW-1:0] ghost_sum = ghost_long[AW+BW-1:0];
wire signed [GW-1:0] ghost_value = ghost_sum >>> SH;
reg signed [GW-1:0] ghost_1;
reg signed [GW-1:0] ghost_2;
reg [1:0] ghost_age = 2'd0;  // clocks, up to 2
always @(posedge clk) begin
  ghost_a_1 <= a;
  ghost_b_1 <= (SQUARE != 0) ? a : b;
  ghost_a   <= ghost_a_1;
  ghost_b   <= ghost_b_1;
  ghost_1   <= ghost_value;
  ghost_2   <= ghost_1;
  if (ghost_age != 2'd2) ghost_age <= ghost_age + 2'd1;
end

generate
  if (AW <= 18 && BW <= 18) begin : g_ghost
    assign ghost_tiles = g_tile.product;
    always @* if (ghost_age == 2'd2) tile : assert (g_tile.product == ghost_a * ghost_b);
  end else begin : g_ghosts
    // where the module cuts its operands: at another place, its registers would hold other products
    localparam integer GAL = (AW > 18) ? 17 : (AW / 2);
    localparam integer GBL = (BW > 18) ? 17 : (BW / 2);
    wire signed [AW-GAL-1:0] ghost_a_hi = ghost_a[AW-1:GAL];
    wire signed [BW-GBL-1:0] ghost_b_hi = ghost_b[BW-1:GBL];
    wire signed [GAL:0] ghost_a_lo = {1'b0, ghost_a[GAL-1:0]};
    wire signed [GBL:0] ghost_b_lo = {1'b0, ghost_b[GBL-1:0]};
    wire [GAL+GBL-1:0] ghost_ll = g_tiles.ll;
    wire signed [AW+BW-1:0] ghost_outer = {g_tiles.hh, ghost_ll};
    wire signed [GW-1:0] ghost_hl = g_tiles.hl;
    always @* if (ghost_age == 2'd2) begin
      tile_hh : assert (g_tiles.hh == ghost_a_hi * ghost_b_hi);
      tile_hl : assert (g_tiles.hl == ghost_a_hi * ghost_b_lo);
      tile_ll : assert (g_tiles.ll == ghost_a_lo * ghost_b_lo);
    end
    if (SQUARE != 0) begin : g_ghost
      assign ghost_tiles = ghost_outer + (ghost_hl <<< (GAL + 1));
    end else begin : g_ghost
      wire signed [GW-1:0] ghost_lh = g_tiles.g_both.lh;
      assign ghost_tiles = ghost_outer + (ghost_hl <<< GAL) + (ghost_lh <<< GBL);
      always @* if (ghost_age == 2'd2) tile_lh : assert (g_tiles.g_both.lh == ghost_a_lo * ghost_b_hi);
    end
  end
endgenerate

always @* if (ghost_age == 2'd2) recombined : assert (q == $signed(ghost_2[OW-1:0]));
