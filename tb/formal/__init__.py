# SPDX-License-Identifier: Apache-2.0
"""Proofs: properties of the streams, dividers and roots, ranges of the lean dataflow, and their solvers."""
