# SPDX-License-Identifier: Apache-2.0
"""Proofs of streams, dividers, roots, AXI engines, and of the ranges and errors of the lean dataflow."""
