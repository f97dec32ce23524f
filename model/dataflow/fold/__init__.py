# SPDX-License-Identifier: Apache-2.0
"""Lean dataflow and whole arm as programs for one multiplier, for ``rtl/fold``: steps, clocks, program words."""
