# SPDX-License-Identifier: Apache-2.0
"""The symbolic derivations: docs/derivation.md and docs/lean.md."""
