# SPDX-License-Identifier: Apache-2.0
"""Simulator support: build, run, tool paths."""
