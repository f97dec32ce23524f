# SPDX-License-Identifier: Apache-2.0
"""Models: geometry and equations in double precision, bit-true dataflows, their bounds, targets and scores.

Installed with `pip install .`, this is the package cga_ik; its public functions are :func:`solve` and the others
of :mod:`model.motion.pose`.
"""

from .motion.pose import Pose, continuous, forward, hanging, solve, swivel

__all__ = ["Pose", "continuous", "forward", "hanging", "solve", "swivel"]
