# SPDX-License-Identifier: Apache-2.0
"""Poses of arms: wrist targets and hand poses from Python, robots, motion-capture clips."""
