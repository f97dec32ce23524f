// SPDX-License-Identifier: Apache-2.0
// Written by `python -m scripts.generate.headers` from model/dataflow/nodes.py; do not edit.

// For the body of a module with parameter W: fraction bits of the inner words of ik_lean and ik_fold.

localparam integer WX = (W < 16) ? 16 : W;  // the word length that formats follow
localparam integer FRAC = (WX < 17) ? 22 : (WX < 28) ? WX + 5 : 33;  // of an inner word
localparam integer ROOT_FRAC = (W < 19) ? 22 : ((FRAC < 31) ? FRAC : 31);  // of a reciprocal root
