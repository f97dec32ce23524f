# SPDX-License-Identifier: Apache-2.0
"""Symbolic derivations of the paper's equations and of the lean dataflow, and the proof engine of both."""
