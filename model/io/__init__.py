# SPDX-License-Identifier: Apache-2.0
"""Targets and results: core words, files, trajectories, stimuli, flags, scores."""
