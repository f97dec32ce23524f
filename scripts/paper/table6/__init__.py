# SPDX-License-Identifier: Apache-2.0
"""Table 6: the core compared with software that solves the same targets."""
