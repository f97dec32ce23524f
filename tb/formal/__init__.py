# SPDX-License-Identifier: Apache-2.0
"""Proofs: properties, solver engines, what proves that no node overflows."""
