// SPDX-License-Identifier: Apache-2.0
// Written by `python -m scripts.pages.gen_headers` from model/dataflow/nodes.py; do not edit.

// For the body of ik_fold: as in ik_lean_nodes.vh, from W = 20 on.

localparam integer FRAC = (W < 28) ? W + 5 : 33;  // of an inner word
localparam integer ROOT_FRAC = (FRAC < 31) ? FRAC : 31;
