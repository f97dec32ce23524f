# SPDX-License-Identifier: Apache-2.0
"""Testbenches and proofs."""
