# SPDX-License-Identifier: Apache-2.0
"""The paper's datapath with shorter words where dividers, roots and the CORDIC are: ``DATAPATH=short``, W = 32.

``python -m scripts.fpga.search`` found how much shorter: so much that the predicted error of elbow and hand stays
within 1e-6 of the reach on the regular trajectories.  A shortened node ends in zeros: formats and clocks stay, and
nothing downstream changes.
"""

from __future__ import annotations

from collections.abc import Mapping

WIDTH = 32
"""The word length that is shortened."""

CUTS: Mapping[str, int] = {
    "l_sw": 12,
    **{"sin_h": 7, "cos_h": 7},
    **{"pi_swivel_x": 7, "pi_swivel_y": 8, "pi_swivel_z": 7},
    "tmp_sqr": 5,
    **{"e_x_quo": 4, "e_y_quo": 4, "e_z_quo": 5},
    **{"c4_quo": 7, "qe_w": 6, "qe_abs": 7},
    **{"l_m": 7, "q12_i": 7, "q12_j": 6, "q12_k": 5},
    **{"pi_abs": 9, "pi_inv": 7, "q3_scalar": 6, "q3_abs": 6},
}
"""Node -> lowest bits of its word that are 0."""
