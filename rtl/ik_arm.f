// SPDX-License-Identifier: Apache-2.0
// The whole arm's Verilog, around the core: verilator -F rtl/ik_axis.f -F rtl/ik_arm.f, for example.
+incdir+include
fold/ik_fold_angle.v
lib/ik_limit.v
lib/ik_vector.v
