# SPDX-License-Identifier: Apache-2.0
"""``python -m scripts.fpga``."""

import sys

from scripts.fpga.measure import main

sys.exit(main())
