// SPDX-License-Identifier: Apache-2.0
// Appended to ik_div_row. No multiplication: q is a bit.

always @* if (r < d) begin
  in_range : assert (r_next < d);
  identity : assert ({1'b0, r, bit_in} == {2'b00, q ? d : {W{1'b0}}} + {2'b00, r_next});
end
always @* begin
  bit_1 : cover (r < d && q);
  bit_0 : cover (r < d && !q && r != 0);
end
