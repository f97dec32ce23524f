# SPDX-License-Identifier: Apache-2.0
"""Simulation of examples/icebreaker at its pins, with the UART model of cocotbext-uart and with host programs."""
