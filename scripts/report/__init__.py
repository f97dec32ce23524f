# SPDX-License-Identifier: Apache-2.0
"""The report: an HTML page that shows a run."""
