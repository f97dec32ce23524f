# SPDX-License-Identifier: Apache-2.0
"""Simulation of examples/icebreaker at its pins: a UART model from a cocotb extension, and the host script itself."""
