// SPDX-License-Identifier: Apache-2.0
// Appended to ik_root_row. As root_next = 2 root + ge_next, root_next^2 = 4 root^2 + ge_next (4 root + 1). So the
// identity 4 (root^2 + R) + pair == root_next^2 + R_next follows from `restored`, which has no square. R is the
// remainder of a restoring row, as in the header of ik_root_row.

wire signed [K+5:0] f_root = {5'b00000, root};
wire signed [K+5:0] f_root_next = {4'b0000, root, ge_next};
wire signed [K+5:0] f_r = {{5{~ge}}, r};
wire signed [K+5:0] f_r_next = {{4{~ge_next}}, r_next};
wire signed [K+5:0] f_pair = {{(K + 4) {1'b0}}, pair};
wire signed [K+5:0] f_R = ge ? f_r : (f_r + 2 * f_root + 1);
wire signed [K+5:0] f_R_next = ge_next ? f_r_next : (f_r_next + 2 * f_root_next + 1);
wire f_legal = !root[K] && (-(2 * f_root + 1) <= f_r) && (f_r <= 2 * f_root);
always @* if (f_legal) begin
  in_range : assert (-(2 * f_root_next + 1) <= f_r_next && f_r_next <= 2 * f_root_next);
  root_fits : assert (f_root_next < (1 << (K + 1)));
  identity : assert (f_r_next == 4 * f_r + f_pair + (ge ? -(4 * f_root + 1) : 4 * f_root + 3));
  // after a negative difference the root's last bit is 0, see ge in ik_root_digit
  restored : assert ((!ge && root[0]) || (4 * f_R + f_pair == (ge_next ? 4 * f_root + 1 : 0) + f_R_next
                                          && 0 <= f_R_next && f_R_next <= 2 * f_root_next));
end
always @* begin
  subtract_1 : cover (f_legal && ge && ge_next);
  subtract_0 : cover (f_legal && ge && !ge_next);
  add_1 : cover (f_legal && !ge && ge_next);
  add_0 : cover (f_legal && !ge && !ge_next);
end
