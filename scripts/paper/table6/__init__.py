# SPDX-License-Identifier: Apache-2.0
"""Table 6: the cores compared with software that solves the same targets."""
