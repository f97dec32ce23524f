# SPDX-License-Identifier: Apache-2.0
"""The report: a page that shows a run."""
