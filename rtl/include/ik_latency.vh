// SPDX-License-Identifier: Apache-2.0
// Written by `python -m scripts.generate.headers` from model/dataflow/paper.py and model/dataflow/lean.py; do not edit.

// For the body of ik_axis: clocks of a datapath, T_OUT of its own header. lean: 1 for the lean one, 0 for the paper's,
// which ignores the tile.

function integer datapath_latency(input integer lean, input integer w, input integer tile);
  begin
    case (100 * lean + w + ((lean == 1 && tile < 18) ? 1000 : 0))
      103: datapath_latency = 36;
      104: datapath_latency = 36;
      105: datapath_latency = 36;
      106: datapath_latency = 36;
      107: datapath_latency = 36;
      108: datapath_latency = 36;
      109: datapath_latency = 36;
      110: datapath_latency = 36;
      111: datapath_latency = 36;
      112: datapath_latency = 36;
      113: datapath_latency = 36;
      114: datapath_latency = 36;
      115: datapath_latency = 36;
      116: datapath_latency = 36;
      117: datapath_latency = 36;
      118: datapath_latency = 36;
      119: datapath_latency = 42;
      120: datapath_latency = 42;
      121: datapath_latency = 42;
      122: datapath_latency = 42;
      123: datapath_latency = 42;
      124: datapath_latency = 42;
      125: datapath_latency = 42;
      126: datapath_latency = 42;
      127: datapath_latency = 42;
      128: datapath_latency = 42;
      129: datapath_latency = 42;
      130: datapath_latency = 42;
      131: datapath_latency = 42;
      132: datapath_latency = 42;
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
      1116: datapath_latency = 42;
      1117: datapath_latency = 42;
      1118: datapath_latency = 42;
      1119: datapath_latency = 42;
      1120: datapath_latency = 42;
      1121: datapath_latency = 42;
      1122: datapath_latency = 42;
      1123: datapath_latency = 42;
      1124: datapath_latency = 42;
      default: datapath_latency = 0;
    endcase
  end
endfunction
