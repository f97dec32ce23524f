# SPDX-License-Identifier: Apache-2.0
# Timing constraints of ik_axis, ik_arm or ik_axi as the top: one clock, no false or multicycle path. Inputs come from
# registers and outputs go into registers; set the delays (ns) of your surroundings.
create_clock -name clk -period 6.0 [get_ports clk]
set_input_delay 0.2 -clock clk [all_inputs]
set_output_delay 0.2 -clock clk [all_outputs]
