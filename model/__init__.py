# SPDX-License-Identifier: Apache-2.0
"""Models of the core: equations in double precision, bit-true dataflows, bounds, targets, scores and poses.

Installed with `pip install .`, this is the package cga_ik; `help(cga_ik.solve)` describes its main function.
"""

from .io.flags import Flag
from .motion import arms
from .motion.arms import Arm
from .motion.path import JointPath
from .motion.pose import Pose, forward, hanging, soft_reach, solve, swivel, swivel_toward
from .motion.swivels import Swivels, continuous_core_angles, feasible_swivel
from .reference.joints import Branch
from .reference.kinematics import continuous

__all__ = ["Arm", "Branch", "Flag", "JointPath", "Pose", "Swivels", "arms"]
__all__ += ["continuous", "continuous_core_angles", "feasible_swivel", "forward", "hanging", "soft_reach", "solve"]
__all__ += ["swivel", "swivel_toward"]

__version__ = "2.0.0"
