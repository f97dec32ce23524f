# SPDX-License-Identifier: Apache-2.0
"""Proofs: properties, solver engines, and the proof that no node overflows."""
