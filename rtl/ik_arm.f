// SPDX-License-Identifier: Apache-2.0
// Operators of the whole arm, which has no top module yet; with the core: verilator -F rtl/ik_axis.f -F rtl/ik_arm.f
+incdir+include
fold/ik_fold_angle.v
lib/ik_limit.v
lib/ik_vector.v
