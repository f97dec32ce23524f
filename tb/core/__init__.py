# SPDX-License-Identifier: Apache-2.0
"""Testbenches of the whole core: streams, sections, every node of every target."""
