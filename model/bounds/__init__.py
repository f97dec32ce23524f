# SPDX-License-Identifier: Apache-2.0
"""Proved and predicted properties of the dataflows: ranges, errors, tolerances."""
