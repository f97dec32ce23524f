# SPDX-License-Identifier: Apache-2.0
"""``python -m scripts.table6``."""

import sys

from scripts.table6.measure import main

sys.exit(main())
