// SPDX-License-Identifier: Apache-2.0
// The whole arm around the core, read with it: verilator -F rtl/ik_axis.f -F rtl/ik_arm.f
+incdir+include
ik_arm.v
ik_arm_bytes.v
ik_choose.v
lean/ik_lean_arm.v
lean/ik_lean_frame.v
lean/ik_lean_hand.v
lean/ik_lean_joints.v
fold/ik_fold_arm.v
fold/ik_fold_arm_hand.v
fold/ik_fold_arm_joints.v
fold/ik_fold_arm_results.v
fold/ik_fold_angle.v
fold/ik_fold_choose.v
fold/ik_fold_limit.v
lib/ik_double.v
lib/ik_limit.v
lib/ik_step.v
lib/ik_vector.v
