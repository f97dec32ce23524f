# SPDX-License-Identifier: Apache-2.0
"""The report: an HTML page of a run."""
