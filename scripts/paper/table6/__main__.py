# SPDX-License-Identifier: Apache-2.0
"""``python -m scripts.paper.table6``."""

import sys

from scripts.paper.table6.measure import main

sys.exit(main())
