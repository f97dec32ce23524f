# SPDX-License-Identifier: Apache-2.0
"""Testbenches of the modules of rtl/lib, one test file per module or pair."""
