// Inputs Q2.30 and a binary angle; results Q2.30.
// SPDX-License-Identifier: Apache-2.0
//
// Small design around ik_axis: one arm of fixed lengths. `go` high for one clock sends a target; `done` is high for one
// clock with its result. Throughput: one target per clock.
`default_nettype none

module arm_top #(
    parameter [31:0] D1 = 32'd354334802,  // upper arm: 0.33 (1.0 = 2^30)
    parameter [31:0] D2 = 32'd289910292   // forearm: 0.27
) (
    input  wire               clk,
    input  wire               rst,
    input  wire               go,
    input  wire signed [31:0] x,
    input  wire signed [31:0] y,
    input  wire signed [31:0] z,
    input  wire        [31:0] phi,   // one turn = 2^32
    output wire               done,
    output wire signed [31:0] qs_w,  // shoulder quaternion
    output wire signed [31:0] qs_i,
    output wire signed [31:0] qs_j,
    output wire signed [31:0] qs_k,
    output wire signed [31:0] qe_w,  // elbow quaternion
    output wire signed [31:0] qe_i,
    output wire        [ 7:0] flags
);

  // The receiver never stalls, so s_axis_tready is 1 from the first clock after reset. Tags are not needed.
  wire ready_unused;
  wire tag_unused;

  ik_axis #(
      .W       (32),
      .TAG_W   (1),
      .DATAPATH(1)
  ) u_ik (
      .clk          (clk),
      .rst          (rst),
      .s_axis_tdata ({D2, D1, phi, z, y, x}),
      .s_axis_tuser (1'b0),
      .s_axis_tvalid(go),
      .s_axis_tready(ready_unused),
      .m_axis_tdata ({qe_i, qe_w, qs_k, qs_j, qs_i, qs_w}),
      .m_axis_tuser ({flags, tag_unused}),
      .m_axis_tvalid(done),
      .m_axis_tready(1'b1)
  );

endmodule

`default_nettype wire
