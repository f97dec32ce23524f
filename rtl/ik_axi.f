// SPDX-License-Identifier: Apache-2.0
// From memory to memory, around the core: verilator -F rtl/ik_axis.f -F rtl/ik_axi.f, for example.
+incdir+include
ik_axi.v
axi/ik_axi_job.v
axi/ik_axi_read.v
axi/ik_axi_records.v
axi/ik_axi_regs.v
axi/ik_axi_result.v
axi/ik_axi_target.v
axi/ik_axi_write.v
