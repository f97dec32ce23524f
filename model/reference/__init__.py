# SPDX-License-Identifier: Apache-2.0
"""Double precision: conformal algebra, geometry, the paper's and the lean equations, forward kinematics."""
