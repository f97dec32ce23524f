-- SPDX-License-Identifier: Apache-2.0
-- hand_top.v in VHDL: ik_arm for a robot of fixed lengths and joint limits, here an LBR iiwa 14.

library ieee;
use ieee.std_logic_1164.all;
use ieee.numeric_std.all;
use work.ik_axis_pkg.all;

entity hand_top is
  port (
    clk      : in  std_logic;
    rst      : in  std_logic;  -- synchronous, active high
    go       : in  std_logic;  -- high for one clock: sends a pose
    x, y, z  : in  signed(31 downto 0);  -- point of the hand, Q2.30
    hand     : in  std_logic_vector(127 downto 0);  -- k, j, i, w of a unit quaternion, w in the lowest bits
    phi      : in  unsigned(31 downto 0);  -- swivel angle, one turn = 2^32
    branch   : in  std_logic_vector(2 downto 0);  -- wrist, elbow, shoulder
    done     : out std_logic;  -- high for one clock, with the results
    joints   : out std_logic_vector(223 downto 0);  -- th1 .. th7, lowest bits first, one turn = 2^32
    flags    : out std_logic_vector(7 downto 0);  -- of the reach
    bad_hand : out std_logic;  -- the quaternion's length is not 1
    over     : out std_logic_vector(6 downto 0)  -- th1 .. th7: the joint is outside its limits
  );
end entity;

architecture rtl of hand_top is
  constant D1   : signed(31 downto 0) := to_signed(450971566, 32);  -- 0.42 (1.0 = 2^30)
  constant D2   : signed(31 downto 0) := to_signed(429496730, 32);  -- 0.40
  constant TOOL : signed(31 downto 0) := to_signed(135291470, 32);  -- 0.126
  type angles is array (1 to 7) of integer;
  -- largest angle of th1 .. th7; the least is its negative: 170 and 120 degrees, th7 175
  constant MOST : angles := (2028179001, 1431655765, 2028179001, 1431655765, 2028179001, 1431655765, 2087831324);

  signal limits        : std_logic_vector(447 downto 0);
  signal pose          : std_logic_vector(351 downto 0);
  signal result        : std_logic_vector(543 downto 0);
  signal flags_and_tag : std_logic_vector(16 downto 0);
begin
  each_joint : for k in 1 to 7 generate
    limits(64 * k - 33 downto 64 * k - 64) <= std_logic_vector(to_signed(-MOST(k), 32));
    limits(64 * k - 1 downto 64 * k - 32)  <= std_logic_vector(to_signed(MOST(k), 32));
  end generate;

  pose <= hand & std_logic_vector(TOOL) & std_logic_vector(D2) & std_logic_vector(D1) & std_logic_vector(phi)
          & std_logic_vector(z) & std_logic_vector(y) & std_logic_vector(x);

  u_ik : ik_arm
    generic map (W => 32, TAG_W => 1, DATAPATH => 1)
    port map (
      clk                    => clk,
      rst                    => rst,
      limits                 => limits,
      s_axis_tdata           => pose,
      s_axis_tuser(0)        => '0',  -- no tag
      s_axis_tuser(3 downto 1) => branch,
      s_axis_tvalid          => go,
      s_axis_tready          => open,  -- 1 from the first clock after reset: the receiver never stalls
      m_axis_tdata           => result,
      m_axis_tuser           => flags_and_tag,
      m_axis_tvalid          => done,
      m_axis_tready          => '1'
    );

  joints   <= result(223 downto 0);
  flags    <= flags_and_tag(8 downto 1);
  bad_hand <= flags_and_tag(9);
  over     <= flags_and_tag(16 downto 10);
end architecture;
