# SPDX-License-Identifier: Apache-2.0
"""Size and clock on FPGAs by open tools."""
