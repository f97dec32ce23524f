# SPDX-License-Identifier: Apache-2.0
"""``python -m scripts.playground``."""

import sys

from scripts.playground.page import main

sys.exit(main())
