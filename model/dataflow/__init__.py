# SPDX-License-Identifier: Apache-2.0
"""Dataflows, node by node, and their evaluation: in integers, as a table of formats and clocks."""
