// SPDX-License-Identifier: Apache-2.0
// Appended to ik_root_row. root_next = 2 root + q, so root_next^2 = 4 root^2 + q (4 root + 1), and the identity
// 4 (root^2 + r) + pair == root_next^2 + r_next is the linear one below, without a square.

wire [K+3:0] f_root = root;
wire [K+3:0] f_r = r;
wire [K+3:0] f_r_next = r_next;
always @* if (!root[K] && f_r <= 2 * f_root) begin
  in_range : assert (f_r_next <= 2 * (2 * f_root + q));
  root_fits : assert (2 * f_root + q < (1 << (K + 1)));
  identity : assert (4 * f_r + pair == (q ? 4 * f_root + 1 : 0) + f_r_next);
end
always @* begin
  bit_1 : cover (!root[K] && f_r <= 2 * f_root && q);
  bit_0 : cover (!root[K] && f_r <= 2 * f_root && !q);
end
