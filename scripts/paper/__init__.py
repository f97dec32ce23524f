# SPDX-License-Identifier: Apache-2.0
"""Reproduction of the paper: derivation, operations, figures and table 6 (`make paper`)."""
