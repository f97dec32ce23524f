# SPDX-License-Identifier: Apache-2.0
"""Targets: words of the core, files, trajectories, stimuli, flags, scores."""
