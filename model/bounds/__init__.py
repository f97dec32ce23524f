# SPDX-License-Identifier: Apache-2.0
"""What is proved or predicted of the dataflows: ranges, affine forms, errors, tolerances."""
