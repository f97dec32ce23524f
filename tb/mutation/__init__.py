# SPDX-License-Identifier: Apache-2.0
"""The mutation campaign: mutants of elaborated netlists, benches that must kill them, proofs for the survivors."""
