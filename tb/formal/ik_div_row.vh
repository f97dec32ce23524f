// SPDX-License-Identifier: Apache-2.0
// Appended to ik_div_row: its invariant and its identity hold. The formula has no product: ge_next, the quotient bit,
// selects d or 0. R is the remainder of a restoring row, as in the header of ik_div_row.

wire signed [W+3:0] f_d = {4'b0000, d};
wire signed [W+3:0] f_r = {{4{~ge}}, r};
wire signed [W+3:0] f_r_next = {{4{~ge_next}}, r_next};
wire signed [W+3:0] f_bit = {{(W + 3) {1'b0}}, bit_in};
wire signed [W+3:0] f_R = ge ? f_r : (f_r + f_d);
wire signed [W+3:0] f_R_next = ge_next ? f_r_next : (f_r_next + f_d);
wire f_legal = (-f_d <= f_r) && (f_r < f_d);
always @* if (f_legal) begin
  in_range : assert (-f_d <= f_r_next && f_r_next < f_d);
  identity : assert (f_r_next == 2 * f_r + f_bit + (ge ? -f_d : f_d));
  restored : assert (2 * f_R + f_bit == (ge_next ? f_d : 0) + f_R_next && 0 <= f_R_next && f_R_next < f_d);
end
always @* begin
  subtract_1 : cover (f_legal && ge && ge_next);
  subtract_0 : cover (f_legal && ge && !ge_next && r != 0);
  add_1 : cover (f_legal && !ge && ge_next);
  add_0 : cover (f_legal && !ge && !ge_next);
end
