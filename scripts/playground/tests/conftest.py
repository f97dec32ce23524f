# SPDX-License-Identifier: Apache-2.0
"""Browser fixtures, shared with the tests of the report."""

from scripts.report.tests.conftest import browser, chromium

__all__ = ["browser", "chromium"]
