// SPDX-License-Identifier: Apache-2.0
// Appended to ik_arm in every cocotb simulation: rules of its streams, for both sides.

ik_rules_channel #(
    .N     ((11 + 7 * CHOOSE) * W + 3 + TAG_W),
    .STREAM(1)
) rules_s_axis (
    .clk    (clk),
    .rst    (rst),
    .valid  (s_axis_tvalid),
    .ready  (s_axis_tready),
    .payload({s_axis_tuser, s_axis_tdata})
);
ik_rules_channel #(
    .N     (17 * W + 16 + 25 * CHOOSE + TAG_W),
    .STREAM(1)
) rules_m_axis (
    .clk    (clk),
    .rst    (rst),
    .valid  (m_axis_tvalid),
    .ready  (m_axis_tready),
    .payload({m_axis_tuser, m_axis_tdata})
);
