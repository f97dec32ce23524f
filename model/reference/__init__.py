# SPDX-License-Identifier: Apache-2.0
"""Reference models in double precision: conformal algebra, geometry, paper and lean equations, kinematics."""
