# SPDX-License-Identifier: Apache-2.0
"""All that starts a simulator: build, run, tool paths."""
