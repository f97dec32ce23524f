// Action on a broken AXI rule: set its bit in `broken`; with STOP, print it and end the simulation.
// SPDX-License-Identifier: Apache-2.0
// A condition must be 1: X counts as broken. %m ends with the port.
`define IK_RULE(number, holds, name, clause) \
  if ((holds) !== 1'b1) begin \
    broken[number] = 1'b1; \
    if (STOP != 0) begin \
      $display("error: rule %0s (%0s) is broken at %m, %0d ns", name, clause, $time); \
      $finish; \
    end \
  end
