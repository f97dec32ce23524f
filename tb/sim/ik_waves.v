// With +waves=FILE, writes a VCD of the core and its sections, without the contents of delay lines.
// SPDX-License-Identifier: Apache-2.0
module ik_waves;
  reg [8*1024-1:0] file;
  initial
    if ($value$plusargs("waves=%s", file)) begin
      $dumpfile(file);
`ifdef IK_ARM
      $dumpvars(5, ik_arm);
`else
      $dumpvars(4, ik_axis);
`endif
    end
endmodule
