// SPDX-License-Identifier: Apache-2.0
// Appended to ik_mul3: its registers hold the products of parts, and the result is their rounded sum, for any values.
// The integer questions prove that the sum fits.

reg signed [AW-1:0] ghost_a;  // a clock ago
reg signed [BW-1:0] ghost_b;
wire signed [AH-1:0] ghost_a_hi = ghost_a[AW-1:AL];
wire signed [BH-1:0] ghost_b_hi = ghost_b[BW-1:BL];
wire signed [AL:0] ghost_a_lo = ghost_a & ~({AW{1'b1}} << AL);
wire signed [BL:0] ghost_b_lo = ghost_b & ~({BW{1'b1}} << BL);
wire [5:0] ghost_a_two = {ghost_a_lo, 2'b00} >> AL;  // times 2^(AL-2), it is at most the low part
wire [5:0] ghost_b_two = {ghost_b_lo, 2'b00} >> BL;

localparam integer GW = AW + BW + OW + 4;
wire signed [GW-1:0] ghost_two = {{(GW - 2) {1'b0}}, 2'b10};
wire signed [GW-1:0] ghost_hh = hh;
wire signed [GW-1:0] ghost_hl = hl;
wire signed [GW-1:0] ghost_lh = lh;
wire signed [GW-1:0] ghost_outer = (((ghost_hh <<< 4) | {{(GW - 4) {1'b0}}, ll}) <<< UP) >>> (4 + DOWN);
wire signed [GW-1:0] ghost_mixed = (ghost_hl >>> (CUT - AL)) + (ghost_lh >>> (CUT - BL));
wire signed [GW-1:0] ghost_value = (ghost_outer + ghost_mixed + ghost_two) >>> 2;
reg signed [GW-1:0] ghost_1;
reg signed [GW-1:0] ghost_2;
reg [1:0] ghost_age = 2'd0;  // clocks, up to 2
always @(posedge clk) begin
  ghost_a <= a;
  ghost_b <= (SQUARE != 0) ? a : b;
  ghost_1 <= ghost_value;
  ghost_2 <= ghost_1;
  if (ghost_age != 2'd2) ghost_age <= ghost_age + 2'd1;
end

always @* if (ghost_age == 2'd2) begin
  tile_hh : assert (hh == ghost_a_hi * ghost_b_hi);
  tile_hl : assert (hl == ghost_a_hi * ghost_b_lo);
  tile_lh : assert (lh == ghost_a_lo * ghost_b_hi);
  tile_ll : assert (ll == (ghost_a_two * ghost_b_two));
  recombined : assert (q == $signed(ghost_2[OW-1:0]));
end
