# SPDX-License-Identifier: Apache-2.0
"""The playground: an HTML page that runs the Verilog."""
