# SPDX-License-Identifier: Apache-2.0
"""The browser that the tests of the report have."""

from scripts.report.tests.conftest import browser

__all__ = ["browser"]
