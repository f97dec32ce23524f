// Latches signs and zeros, derives the flags, and selects the one that the current step uses.
// SPDX-License-Identifier: Apache-2.0
//
// No rounding; single bits.
// Throughput: one step per clock with go high.
// Latency: 1 clock from a sign or zero to the outputs.
`default_nettype none

module ik_fold_flags (
    input  wire       clk,
    input  wire       go,
    // Signs and zeros
    input  wire [3:0] sign,         // sign to load
    input  wire       sum_below_0,  // T < 0
    input  wire       word_below_0, // written word < 0
    input  wire       phi_loaded,
    input  wire       phi_below_0,
    input  wire [2:0] e_set,        // zero to load
    input  wire       zero,
    input  wire       none,         // n = 0, from ik_fold_count
    // Selectors of the step, ik_fold_codes.vh
    input  wire [1:0] a_by,
    input  wire [1:0] b_by,
    input  wire [1:0] w_by,
    input  wire [1:0] s_by,
    input  wire [3:0] minus_by,
    // Choices of the current step
    output wire       a_zero,
    output wire       a_second,
    output wire       b_second,
    output wire       w_second,
    output wire       s_other,
    output reg        minus,
    output wire       clamp,
    output wire       closed,
    // Flags
    output wire [9:0] nodes,        // decision nodes, for waves and testbenches
    output wire [7:0] flags         // too_far, too_near, on_axis, at_shoulder, bad_length, 0, 0, 0
);

  `include "ik_fold_codes.vh"

  reg d1, d2, d_dif, a_far, b_near, u_y, sin_el, cos_a, k_1, phi;  // negative
  reg on_axis, at_shoulder, no_1, no_2;  // zero
  always @(posedge clk)
    if (go) begin
      case (sign)
        SIGN_D1: d1 <= sum_below_0;
        SIGN_D2: d2 <= sum_below_0;
        SIGN_D_DIF: d_dif <= word_below_0;
        SIGN_A_FAR: a_far <= !sum_below_0;  // T is its one's complement
        SIGN_B_NEAR: b_near <= sum_below_0;
        SIGN_U_Y: u_y <= word_below_0;
        SIGN_SIN_EL: sin_el <= word_below_0;
        SIGN_COS_A: cos_a <= word_below_0;
        SIGN_K_1: k_1 <= word_below_0;
        default: ;
      endcase
      case (e_set)
        E_SET_E_RHO: on_axis <= zero;
        E_SET_E_S: at_shoulder <= zero;
        E_SET_E_1: no_1 <= zero;
        E_SET_E_2: no_2 <= zero;
        default: ;
      endcase
      if (phi_loaded) phi <= phi_below_0;
    end

  wire bad_length = d1 || d2 || no_1 || no_2;
  wire too_far = a_far && !bad_length;
  wire too_near = b_near && !bad_length;
  assign clamp = too_far || too_near || at_shoulder || bad_length;  // no elbow
  assign closed = (too_near || at_shoulder) && !bad_length;
  wire away = too_near && d_dif;
  wire bend_swap = clamp ? away : cos_a;
  assign nodes = {k_1, bend_swap, away, closed, clamp, too_near, too_far, at_shoulder, on_axis, bad_length};
  assign flags = {3'b000, bad_length, at_shoulder, on_axis, too_near, too_far};

  assign a_zero = (a_by == A_BY_AT_SHOULDER && at_shoulder) || (a_by == A_BY_CLAMP && clamp);
  assign a_second = a_by == A_BY_U_Y && u_y;
  assign b_second = (b_by == B_BY_SIN_EL && sin_el) || (b_by == B_BY_BEND_SWAP && bend_swap);
  assign w_second = (w_by == W_BY_U_Y && u_y) || (w_by == W_BY_SIN_EL && sin_el) || (w_by == W_BY_BEND_SWAP && bend_swap);
  assign s_other = (s_by == S_BY_ON_AXIS && on_axis) || (s_by == S_BY_AT_SHOULDER && at_shoulder)
      || (s_by == S_BY_CLAMP && clamp);
  always @*
    case (minus_by)
      MINUS_BY_ALWAYS: minus = 1'b1;
      MINUS_BY_N_0: minus = none;
      MINUS_BY_PHI: minus = phi;
      MINUS_BY_U_Y: minus = u_y;
      MINUS_BY_SIN_EL_AND_NOT_AT_SHOULDER: minus = sin_el && !at_shoulder;
      MINUS_BY_COS_A_AND_NOT_CLAMP: minus = cos_a && !clamp;
      MINUS_BY_NOT_BEND_SWAP: minus = !bend_swap;
      MINUS_BY_MINUS: minus = k_1;
      default: minus = 1'b0;
    endcase

endmodule

`default_nettype wire
