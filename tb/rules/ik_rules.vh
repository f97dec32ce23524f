// What a rule of AXI does that is broken: it says so, is kept for whoever looks, and the simulation ends.
// SPDX-License-Identifier: Apache-2.0
// A condition that is X is no: 1 it has to be. %m ends with the port.
`define IK_RULE(number, holds, name, clause) \
  if ((holds) !== 1'b1) begin \
    broken[number] = 1'b1; \
    if (STOP != 0) begin \
      $display("error: rule %0s (%0s) is broken at %m, %0d ns", name, clause, $time); \
      $finish; \
    end \
  end
