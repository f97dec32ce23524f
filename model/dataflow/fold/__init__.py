# SPDX-License-Identifier: Apache-2.0
"""Lean dataflow as the program of one multiplier, for ``rtl/fold``: steps, their clocks, the program's words."""
