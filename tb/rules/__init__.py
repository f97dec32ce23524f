# SPDX-License-Identifier: Apache-2.0
"""The rules of AXI, from its specification, on every port of every simulation by cocotb."""
