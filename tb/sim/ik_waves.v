// With +waves=FILE, writes a VCD of the top IK_TOP, IK_DEPTH levels deep; 0 means all levels.
// SPDX-License-Identifier: Apache-2.0
module ik_waves;
  reg [8*1024-1:0] file;
  initial
    if ($value$plusargs("waves=%s", file)) begin
      $dumpfile(file);
      $dumpvars(`IK_DEPTH, `IK_TOP);
    end
endmodule
