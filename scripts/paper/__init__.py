# SPDX-License-Identifier: Apache-2.0
"""Answers to the paper: derivation, operations, word lengths, figures and table 6 (`make paper`)."""
