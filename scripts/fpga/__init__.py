# SPDX-License-Identifier: Apache-2.0
"""Size and clock of the datapaths on FPGAs, measured with open tools."""
