# SPDX-License-Identifier: Apache-2.0
"""What people run: the command line, set-up, lint, reports."""
