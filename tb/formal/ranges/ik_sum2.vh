// SPDX-License-Identifier: Apache-2.0
// Appended to ik_sum2: the rounded sum in more bits than it can need, two clocks ago. Without
// saturation q has its low bits, and it is guard_bits alone that says that these are all of it.

localparam integer GW = IW + SH + OW + 4;
wire signed [GW-1:0] ghost_half = (SH > 0) ? ({{(GW - 1) {1'b0}}, 1'b1} << ((SH > 0) ? SH - 1 : 0)) : {GW{1'b0}};
wire signed [GW-1:0] ghost_sum = (SUB_B != 0) ? (a - b) : (a + b);
wire signed [GW-1:0] ghost_value = (ghost_sum + ghost_half) >>> SH;
wire signed [GW-1:0] ghost_most = {{(GW - OW + 1) {1'b0}}, {(OW - 1) {1'b1}}};
reg signed [GW-1:0] ghost_1;
reg signed [GW-1:0] ghost_2;
reg [1:0] ghost_age = 2'd0;  // clocks, up to 2
always @(posedge clk) begin
  ghost_1 <= ghost_value;
  ghost_2 <= ghost_1;
  if (ghost_age != 2'd2) ghost_age <= ghost_age + 2'd1;
end
wire ghost_over = ghost_2 > ghost_most;
wire ghost_under = ghost_2 < ~ghost_most;

always @* if (ghost_age == 2'd2) begin
  guard_bits : assert (!ovf && ghost_2 == q);
  saturates : assert (ovf == (SAT != 0 && (ghost_over || ghost_under)));
end
generate
  if (SAT != 0) begin : g_ghost
    always @* if (ghost_age == 2'd2) begin
      bound : assert (q == (ghost_over ? ghost_most : ghost_under ? ~ghost_most : ghost_2));
    end
  end else begin : g_ghost
    always @* if (ghost_age == 2'd2) modulo : assert (q == $signed(ghost_2[OW-1:0]));
  end
endgenerate
