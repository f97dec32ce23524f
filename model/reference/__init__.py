# SPDX-License-Identifier: Apache-2.0
"""Double precision: conformal algebra, the geometry, the paper's and the lean equations, forward kinematics."""
