# SPDX-License-Identifier: Apache-2.0
"""The models: geometry and equations in double precision, the bit-true dataflows, their bounds, targets and scores."""
