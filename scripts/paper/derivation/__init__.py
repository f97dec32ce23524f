# SPDX-License-Identifier: Apache-2.0
"""The symbolic derivations: docs/generated/derivation.md and docs/generated/lean.md."""
