# SPDX-License-Identifier: Apache-2.0
"""Figures of tables 5 and 6 of the paper, and the resources of its chip."""

LUTS = 30_000
MHZ = 100
LATENCY = 550
"""Latency of the paper's pipeline (clocks)."""

TARGETS = 100
FIRST_US = 5.0
ALL_US = 6.0
"""Microseconds of the pipeline until the first and the last result."""
SOFTWARE_US = 860.0

CHIP = "2VP70"
CHIP_LUTS = 66_176
CHIP_MULTIPLIERS = 328
"""Virtex-II Pro 2VP70: 33088 slices of two LUT4 each, 18x18 multipliers (Xilinx DS083)."""


def of_chip(luts: int) -> str:
    """Format LUTs as a percentage of the chip's LUTs."""
    return f"{luts / CHIP_LUTS:.0%}"
