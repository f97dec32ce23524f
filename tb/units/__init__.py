# SPDX-License-Identifier: Apache-2.0
"""Testbenches of the modules of rtl/lib, one pair a module."""
