// Assertions about one row of a divider or root. In a module, their full names differ between rows.
// SPDX-License-Identifier: Apache-2.0
module ik_checks (
    input wire on,
    input wire in_range,
    input wire identity,
    input wire to_come,
    input wire result
);
  always @* if (on) begin
    in_range_ : assert (in_range);
    identity_ : assert (identity);
    to_come_ : assert (to_come);
    result_ : assert (result);
  end
endmodule
