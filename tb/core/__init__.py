# SPDX-License-Identifier: Apache-2.0
"""Testbenches of the whole core: streams, elaboration, power-up, every node of every target, the hardest targets."""
