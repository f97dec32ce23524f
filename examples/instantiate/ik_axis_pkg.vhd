-- SPDX-License-Identifier: Apache-2.0
-- ik_axis for VHDL: the component; ports and generics are those of rtl/ik_axis.v.

library ieee;
use ieee.std_logic_1164.all;

package ik_axis_pkg is

  component ik_axis is
    generic (
      W        : integer := 32;  -- word length, 16 to 32; limits in ik_axis.v
      TAG_W    : integer := 8;   -- tag width, at least 1
      DATAPATH : integer := 1;   -- 0 paper, 1 lean, 2 fold (lean on one multiplier)
      DIGIT    : integer := 0;   -- paper dividers and roots: 1 digit recurrence, for synthesis; 0 behavioural
      TILE     : integer := 18   -- lean and fold: longer operand of the multiplier blocks, bits: 18, 25 or 16
    );
    port (
      clk           : in  std_logic;
      rst           : in  std_logic;  -- synchronous, active high
      -- x, y, z, phi, d1, d2, lowest bits first: Q2.(W-2), phi one turn = 2^W
      s_axis_tdata  : in  std_logic_vector(6 * W - 1 downto 0);
      s_axis_tuser  : in  std_logic_vector(TAG_W - 1 downto 0);
      s_axis_tvalid : in  std_logic;
      s_axis_tready : out std_logic;
      -- qs_w, qs_i, qs_j, qs_k, qe_w, qe_i, lowest bits first: Q2.(W-2)
      m_axis_tdata  : out std_logic_vector(6 * W - 1 downto 0);
      m_axis_tuser  : out std_logic_vector(TAG_W + 7 downto 0);  -- tag; above it the flags
      m_axis_tvalid : out std_logic;
      m_axis_tready : in  std_logic
    );
  end component;

end package;
