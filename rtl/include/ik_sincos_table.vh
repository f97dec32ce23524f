// SPDX-License-Identifier: Apache-2.0
// Written by `python -m scripts.generate.headers` from model/dataflow/fixed.py; do not edit.

// For the body of ik_sincos: atan(2^-i)/pi and the CORDIC's gain as fractions with TABLE_BITS bits.

localparam integer TABLE_BITS = 48;
localparam integer SINCOS_GUARD = 6;
localparam [47:0] GAIN = 48'd170926505739102;

function [47:0] atan_turn(input integer k);
  begin
    case (k)
       0: atan_turn = 48'd70368744177664;
       1: atan_turn = 48'd41541095341030;
       2: atan_turn = 48'd21949173906887;
       3: atan_turn = 48'd11141743393723;
       4: atan_turn = 48'd5592492416177;
       5: atan_turn = 48'd2798972482057;
       6: atan_turn = 48'd1399827773520;
       7: atan_turn = 48'd699956601769;
       8: atan_turn = 48'd349983640994;
       9: atan_turn = 48'd174992488033;
      10: atan_turn = 48'd87496327459;
      11: atan_turn = 48'd43748174160;
      12: atan_turn = 48'd21874088384;
      13: atan_turn = 48'd10937044355;
      14: atan_turn = 48'd5468522198;
      15: atan_turn = 48'd2734261101;
      16: atan_turn = 48'd1367130551;
      17: atan_turn = 48'd683565276;
      18: atan_turn = 48'd341782638;
      19: atan_turn = 48'd170891319;
      20: atan_turn = 48'd85445659;
      21: atan_turn = 48'd42722830;
      22: atan_turn = 48'd21361415;
      23: atan_turn = 48'd10680707;
      24: atan_turn = 48'd5340354;
      25: atan_turn = 48'd2670177;
      26: atan_turn = 48'd1335088;
      27: atan_turn = 48'd667544;
      28: atan_turn = 48'd333772;
      29: atan_turn = 48'd166886;
      30: atan_turn = 48'd83443;
      31: atan_turn = 48'd41722;
      default: atan_turn = 48'd0;
    endcase
  end
endfunction
