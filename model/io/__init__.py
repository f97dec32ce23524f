# SPDX-License-Identifier: Apache-2.0
"""Targets: core words, files, trajectories, stimuli, flags, scores."""
