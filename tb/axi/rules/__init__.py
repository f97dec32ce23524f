# SPDX-License-Identifier: Apache-2.0
"""AXI rules from the specification, checked on every port in every cocotb simulation."""
