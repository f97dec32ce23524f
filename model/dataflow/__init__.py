# SPDX-License-Identifier: Apache-2.0
"""The dataflows, node by node, and how they run: in integers, in reals, as a table of formats and clocks."""
