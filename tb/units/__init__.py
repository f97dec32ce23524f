# SPDX-License-Identifier: Apache-2.0
"""Testbenches of the modules of rtl/lib and of some modules of rtl/fold, one test file per group of modules."""
