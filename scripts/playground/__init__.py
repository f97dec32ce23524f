# SPDX-License-Identifier: Apache-2.0
"""The playground: a page in which the Verilog runs."""
