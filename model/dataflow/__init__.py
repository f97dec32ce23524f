# SPDX-License-Identifier: Apache-2.0
"""Dataflows defined node by node, their evaluation in integers, and the formats and clocks of the nodes."""
