// SPDX-License-Identifier: Apache-2.0
`default_nettype none
module ik_add #(parameter W = 32) (
    input  wire                clk,
    input  wire signed [W-1:0] a,
    input  wire signed [W-1:0] b,
    output reg  signed [W:0]   s
);
    always @(posedge clk)
        s <= {a[W-1], a} + {b[W-1], b};
endmodule
`default_nettype wire
