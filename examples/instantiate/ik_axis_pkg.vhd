-- SPDX-License-Identifier: Apache-2.0
-- Components of the tops for VHDL; ports and generics are those of the modules in rtl/.

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
      m_axis_tuser  : out std_logic_vector(TAG_W + 8 - 1 downto 0);  -- tag; above it the flags
      m_axis_tvalid : out std_logic;
      m_axis_tready : in  std_logic
    );
  end component;

  component ik_axis_bytes is
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
      -- x, y, z, phi, d1, d2, lowest bits first, each in the lowest W bits of whole bytes
      s_axis_tdata  : in  std_logic_vector(48 * ((W + 7) / 8) - 1 downto 0);
      s_axis_tuser  : in  std_logic_vector(TAG_W - 1 downto 0);
      s_axis_tvalid : in  std_logic;
      s_axis_tready : out std_logic;
      -- qs_w, qs_i, qs_j, qs_k, qe_w, qe_i, lowest bits first, each sign-extended to whole bytes
      m_axis_tdata  : out std_logic_vector(48 * ((W + 7) / 8) - 1 downto 0);
      m_axis_tuser  : out std_logic_vector(TAG_W + 8 - 1 downto 0);  -- tag; above it the flags
      m_axis_tvalid : out std_logic;
      m_axis_tready : in  std_logic
    );
  end component;

  component ik_arm is
    generic (
      W        : integer := 32;  -- word length, 16 to 32; limits in ik_arm.v
      TAG_W    : integer := 8;   -- tag width, at least 1
      DATAPATH : integer := 1;   -- 1 lean, 2 fold (lean on one multiplier)
      TILE     : integer := 18;  -- longer operand of the multiplier blocks, bits: 18, 25 or 16
      CHOOSE   : integer := 0    -- 1: of the eight branches, answer with the one nearest to reference joints
    );
    port (
      clk           : in  std_logic;
      rst           : in  std_logic;  -- synchronous, active high
      -- lower and upper limit of th1, .. th7, lowest bits first, one turn = 2^W; static
      limits        : in  std_logic_vector(14 * W - 1 downto 0);
      -- x, y, z of the hand, phi, d1, d2, tool, qh_w, qh_i, qh_j, qh_k, lowest bits first: Q2.(W-2), phi one turn = 2^W
      -- with CHOOSE = 1, above them the reference joints
      s_axis_tdata  : in  std_logic_vector((11 + 7 * CHOOSE) * W - 1 downto 0);
      s_axis_tuser  : in  std_logic_vector(TAG_W + 3 - 1 downto 0);  -- tag; above it the branch: shoulder, elbow, wrist
      s_axis_tvalid : in  std_logic;
      s_axis_tready : out std_logic;
      -- th1 to th7, one turn = 2^W; qs_w .. qs_k, qe_w, qe_i, qw_w .. qw_k: Q2.(W-2); lowest bits first
      m_axis_tdata  : out std_logic_vector(17 * W - 1 downto 0);
      m_axis_tuser  : out std_logic_vector(TAG_W + 16 + 25 * CHOOSE - 1 downto 0);  -- tag; above it the flags, choice
      m_axis_tvalid : out std_logic;
      m_axis_tready : in  std_logic
    );
  end component;

  component ik_arm_bytes is
    generic (
      W        : integer := 32;  -- word length, 16 to 32; limits in ik_arm.v
      TAG_W    : integer := 8;   -- tag width, at least 1
      DATAPATH : integer := 1;   -- 1 lean, 2 fold (lean on one multiplier)
      TILE     : integer := 18;  -- longer operand of the multiplier blocks, bits: 18, 25 or 16
      CHOOSE   : integer := 0    -- 1: of the eight branches, answer with the one nearest to reference joints
    );
    port (
      clk           : in  std_logic;
      rst           : in  std_logic;  -- synchronous, active high
      -- lower and upper limit of th1, .. th7, lowest bits first, one turn = 2^W; static
      limits        : in  std_logic_vector(14 * W - 1 downto 0);
      -- words as in ik_arm, each in the lowest W bits of whole bytes
      s_axis_tdata  : in  std_logic_vector((11 + 7 * CHOOSE) * 8 * ((W + 7) / 8) - 1 downto 0);
      s_axis_tuser  : in  std_logic_vector(TAG_W + 3 - 1 downto 0);  -- tag; above it the branch: shoulder, elbow, wrist
      s_axis_tvalid : in  std_logic;
      s_axis_tready : out std_logic;
      -- words as in ik_arm, each sign-extended to whole bytes
      m_axis_tdata  : out std_logic_vector(17 * 8 * ((W + 7) / 8) - 1 downto 0);
      m_axis_tuser  : out std_logic_vector(TAG_W + 16 + 25 * CHOOSE - 1 downto 0);  -- tag; above it the flags, choice
      m_axis_tvalid : out std_logic;
      m_axis_tready : in  std_logic
    );
  end component;

  component ik_axi is
    generic (
      W          : integer := 32;  -- word length, 16 to 32; limits in ik_axis.v
      DATAPATH   : integer := 1;   -- 0 paper, 1 lean, 2 fold
      DIGIT      : integer := 0;   -- paper dividers and roots: 1 digit recurrence, for synthesis; 0 behavioural
      TILE       : integer := 18;  -- lean: longer operand of the multiplier blocks, bits: 18, 25 or 16
      ADDR_W     : integer := 32;  -- address width, 12 to 64
      DATA_W     : integer := 64;  -- data bus width: 32, 64 or 128
      LOG2_BURST : integer := 3;   -- log2 of records per full burst, 1 to 5; at most 256 beats
      ARM        : integer := 0    -- 1: hand pose to joint angles, with DATAPATH 1 or 2
    );
    port (
      clk           : in  std_logic;
      rst           : in  std_logic;  -- synchronous, active high
      irq           : out std_logic;
      -- registers: docs/generated/registers.md
      s_axi_awaddr  : in  std_logic_vector(11 downto 0);
      s_axi_awprot  : in  std_logic_vector(2 downto 0);
      s_axi_awvalid : in  std_logic;
      s_axi_awready : out std_logic;
      s_axi_wdata   : in  std_logic_vector(31 downto 0);
      s_axi_wstrb   : in  std_logic_vector(3 downto 0);
      s_axi_wvalid  : in  std_logic;
      s_axi_wready  : out std_logic;
      s_axi_bresp   : out std_logic_vector(1 downto 0);
      s_axi_bvalid  : out std_logic;
      s_axi_bready  : in  std_logic;
      s_axi_araddr  : in  std_logic_vector(11 downto 0);
      s_axi_arprot  : in  std_logic_vector(2 downto 0);
      s_axi_arvalid : in  std_logic;
      s_axi_arready : out std_logic;
      s_axi_rdata   : out std_logic_vector(31 downto 0);
      s_axi_rresp   : out std_logic_vector(1 downto 0);
      s_axi_rvalid  : out std_logic;
      s_axi_rready  : in  std_logic;
      -- memory, read
      m_axi_arid    : out std_logic_vector(0 downto 0);
      m_axi_araddr  : out std_logic_vector(ADDR_W - 1 downto 0);
      m_axi_arlen   : out std_logic_vector(7 downto 0);
      m_axi_arsize  : out std_logic_vector(2 downto 0);
      m_axi_arburst : out std_logic_vector(1 downto 0);
      m_axi_arcache : out std_logic_vector(3 downto 0);
      m_axi_arprot  : out std_logic_vector(2 downto 0);
      m_axi_arvalid : out std_logic;
      m_axi_arready : in  std_logic;
      m_axi_rid     : in  std_logic_vector(0 downto 0);
      m_axi_rdata   : in  std_logic_vector(DATA_W - 1 downto 0);
      m_axi_rresp   : in  std_logic_vector(1 downto 0);
      m_axi_rlast   : in  std_logic;
      m_axi_rvalid  : in  std_logic;
      m_axi_rready  : out std_logic;
      -- memory, write
      m_axi_awid    : out std_logic_vector(0 downto 0);
      m_axi_awaddr  : out std_logic_vector(ADDR_W - 1 downto 0);
      m_axi_awlen   : out std_logic_vector(7 downto 0);
      m_axi_awsize  : out std_logic_vector(2 downto 0);
      m_axi_awburst : out std_logic_vector(1 downto 0);
      m_axi_awcache : out std_logic_vector(3 downto 0);
      m_axi_awprot  : out std_logic_vector(2 downto 0);
      m_axi_awvalid : out std_logic;
      m_axi_awready : in  std_logic;
      m_axi_wdata   : out std_logic_vector(DATA_W - 1 downto 0);
      m_axi_wstrb   : out std_logic_vector(DATA_W / 8 - 1 downto 0);
      m_axi_wlast   : out std_logic;
      m_axi_wvalid  : out std_logic;
      m_axi_wready  : in  std_logic;
      m_axi_bid     : in  std_logic_vector(0 downto 0);
      m_axi_bresp   : in  std_logic_vector(1 downto 0);
      m_axi_bvalid  : in  std_logic;
      m_axi_bready  : out std_logic
    );
  end component;

end package;
