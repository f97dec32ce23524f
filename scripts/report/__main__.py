# SPDX-License-Identifier: Apache-2.0
"""``python -m scripts.report``."""

import sys

from scripts.report.page import main

sys.exit(main())
