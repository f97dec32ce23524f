# SPDX-License-Identifier: Apache-2.0
"""Browser fixture, shared with the tests of the report."""

from scripts.report.tests.conftest import browser

__all__ = ["browser"]
