// Abstract core that replaces ik_axis: counts targets inside, offers results at any time; results are arbitrary.
// SPDX-License-Identifier: Apache-2.0
//
// Has only those properties of ik_axis that ik_axis.vh (folded core: ik_fold.vh) proves: the number of slots, ready
// while a slot is free (folded: at any time), no result offered while empty, m_axis_tvalid high until a result is
// accepted. The proof that a job ends (docs/verification.md) also uses offered_in_time of ik_axis.vh: with a target
// inside, a result is offered within T+1 clocks.
// Latency: any.
`default_nettype none

module ik_axis #(
    parameter integer W        = 32,
    parameter integer TAG_W    = 8,
    parameter integer DATAPATH = 1,
    parameter integer DIGIT    = 0,
    parameter integer TILE     = 18
) (
    input  wire               clk,
    input  wire               rst,
    input  wire [    6*W-1:0] s_axis_tdata,
    input  wire [  TAG_W-1:0] s_axis_tuser,
    input  wire               s_axis_tvalid,
    output wire               s_axis_tready,
    output wire [    6*W-1:0] m_axis_tdata,
    output wire [TAG_W+8-1:0] m_axis_tuser,
    output wire               m_axis_tvalid,
    input  wire               m_axis_tready
);

  localparam integer PLACES = (DATAPATH == 2) ? 2 : (DATAPATH != 0) ? 64 : 512;

  (* anyseq *) wire [6*W+TAG_W+7:0] f_any;
  (* anyseq *) wire f_offer;
  (* anyseq *) wire f_take;
  assign {m_axis_tuser, m_axis_tdata} = f_any;

  reg [9:0] inside;
  reg offered;
  assign s_axis_tready = !rst && inside < PLACES && (DATAPATH != 2 || f_take);
  assign m_axis_tvalid = inside != 0 && (offered || f_offer);
  always @(posedge clk) begin
    inside  <= rst ? 10'd0 : inside + (s_axis_tvalid && s_axis_tready) - (m_axis_tvalid && m_axis_tready);
    offered <= !rst && m_axis_tvalid && !m_axis_tready;
  end

`ifdef IK_COVER
  // the single path of ik_axi.vh
  always @* assume (f_offer && f_take && f_any == 0);
`endif

endmodule

`default_nettype wire
