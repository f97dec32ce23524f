# SPDX-License-Identifier: Apache-2.0
"""The models: geometry and equations in double precision, the bit-true dataflows, their bounds, targets and scores.

Installed (`pip install .`) this is the package cga_ik, and what it is used for is here: :func:`solve` and its relatives
of :mod:`model.motion.pose`.
"""

from .motion.pose import Pose, continuous, forward, hanging, solve, swivel

__all__ = ["Pose", "continuous", "forward", "hanging", "solve", "swivel"]
