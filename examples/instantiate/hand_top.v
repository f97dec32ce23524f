// Inputs Q2.30 and binary angles; results binary angles, one turn = 2^32.
// SPDX-License-Identifier: Apache-2.0
//
// Small design around ik_arm: a robot of fixed lengths and joint limits, here an LBR iiwa 14. `go` high for
// one clock sends a hand pose; `done` is high for one clock with its joints. Throughput: one pose per clock.
`default_nettype none

module hand_top #(
    parameter [31:0] D1   = 32'd450971566,  // upper arm: 0.42 (1.0 = 2^30)
    parameter [31:0] D2   = 32'd429496730,  // forearm: 0.40
    parameter [31:0] TOOL = 32'd135291470,  // wrist to hand: 0.126
    // Largest angle of th1 .. th7, lowest bits first; the least is its negative: 170 and 120 degrees, th7 175
    parameter [7*32-1:0] MOST = {32'd2087831324, 32'd1431655765, 32'd2028179001, 32'd1431655765, 32'd2028179001,
                                 32'd1431655765, 32'd2028179001}
) (
    input  wire                 clk,
    input  wire                 rst,
    input  wire                 go,
    input  wire signed [  31:0] x,          // point of the hand
    input  wire signed [  31:0] y,
    input  wire signed [  31:0] z,
    input  wire signed [4*32-1:0] hand,     // orientation: k, j, i, w of a unit quaternion, w in the lowest bits
    input  wire        [  31:0] phi,        // swivel angle
    input  wire        [   2:0] branch,     // wrist, elbow, shoulder: a set bit selects the other solution
    output wire                 done,
    output wire        [7*32-1:0] joints,   // th1 .. th7, lowest bits first
    output wire        [   7:0] flags,      // of the reach, see docs/core.md
    output wire                 bad_hand,   // the quaternion's length is not 1
    output wire        [   6:0] over        // th1 .. th7: the joint is outside its limits
);

  wire [14*32-1:0] limits;  // least and largest angle of th1, .. th7
  genvar k;
  generate
    for (k = 0; k < 7; k = k + 1) begin : g_joint
      assign limits[64*k+:64] = {MOST[32*k+:32], -MOST[32*k+:32]};
    end
  endgenerate

  // The receiver never stalls, so s_axis_tready is 1 from the first clock after reset. Neither tags nor quaternions are
  // needed.
  wire ready_unused;
  wire tag_unused;
  wire [10*32-1:0] quaternions_unused;

  ik_arm #(
      .W       (32),
      .TAG_W   (1),
      .DATAPATH(1)
  ) u_ik (
      .clk          (clk),
      .rst          (rst),
      .limits       (limits),
      .s_axis_tdata ({hand, TOOL, D2, D1, phi, z, y, x}),
      .s_axis_tuser ({branch, 1'b0}),
      .s_axis_tvalid(go),
      .s_axis_tready(ready_unused),
      .m_axis_tdata ({quaternions_unused, joints}),
      .m_axis_tuser ({over, bad_hand, flags, tag_unused}),
      .m_axis_tvalid(done),
      .m_axis_tready(1'b1)
  );

endmodule

`default_nettype wire
