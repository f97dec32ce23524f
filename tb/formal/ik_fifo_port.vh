// SPDX-License-Identifier: Apache-2.0
// Appended to ik_fifo in proofs: f_word is the word in the FIFO's memory at address f_addr, which the proof sets. The
// design uses neither signal.
wire [LOG2-1:0] f_addr;
wire [W-1:0] f_word = mem[f_addr];
