// SPDX-License-Identifier: Apache-2.0
// Written by `python -m scripts.pages.gen_headers` from model/dataflow/paper.py and model/dataflow/lean.py; do not edit.

// For the body of ik_axis: clocks of a datapath, T_OUT of its own header. lean: 1 for the lean one, 0 for the paper's.

function integer datapath_latency(input integer lean, input integer w);
  begin
    case (100 * lean + w)
      103: datapath_latency = 38;
      104: datapath_latency = 38;
      105: datapath_latency = 38;
      106: datapath_latency = 38;
      107: datapath_latency = 38;
      108: datapath_latency = 38;
      109: datapath_latency = 38;
      110: datapath_latency = 38;
      111: datapath_latency = 38;
      112: datapath_latency = 38;
      113: datapath_latency = 38;
      114: datapath_latency = 38;
      115: datapath_latency = 38;
      116: datapath_latency = 38;
      117: datapath_latency = 38;
      118: datapath_latency = 38;
      119: datapath_latency = 40;
      120: datapath_latency = 40;
      121: datapath_latency = 40;
      122: datapath_latency = 40;
      123: datapath_latency = 40;
      124: datapath_latency = 40;
      125: datapath_latency = 40;
      126: datapath_latency = 40;
      127: datapath_latency = 40;
      128: datapath_latency = 40;
      129: datapath_latency = 40;
      130: datapath_latency = 40;
      131: datapath_latency = 40;
      132: datapath_latency = 40;
      16: datapath_latency = 206;
      17: datapath_latency = 213;
      18: datapath_latency = 220;
      19: datapath_latency = 227;
      20: datapath_latency = 234;
      21: datapath_latency = 241;
      22: datapath_latency = 248;
      23: datapath_latency = 255;
      24: datapath_latency = 262;
      25: datapath_latency = 269;
      26: datapath_latency = 276;
      27: datapath_latency = 283;
      28: datapath_latency = 290;
      29: datapath_latency = 297;
      30: datapath_latency = 304;
      31: datapath_latency = 311;
      32: datapath_latency = 318;
      default: datapath_latency = 0;
    endcase
  end
endfunction
