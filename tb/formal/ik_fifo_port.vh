// SPDX-License-Identifier: Apache-2.0
// Appended to ik_fifo for a proof: reads one word of its memory at an address set by the proof. The design uses neither
// signal.
wire [LOG2-1:0] f_addr;
wire [W-1:0] f_word = mem[f_addr];
