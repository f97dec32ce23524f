// SPDX-License-Identifier: Apache-2.0
// Appended to ik_fifo for a proof: a look at one word of its memory, at an address that the proof chooses.
// Changes nothing: neither signal is read by the design.
wire [LOG2-1:0] f_addr;
wire [W-1:0] f_word = mem[f_addr];
