# SPDX-License-Identifier: Apache-2.0
"""Set-up of the checkout's environment."""

import subprocess
import sys
from pathlib import Path


def installed(need: str) -> bool:
    """Install what a command needs, such as ``verilator``, unless it is there; return whether it is there then."""
    words = [sys.executable, "-ES", Path(__file__).with_name("bootstrap.py"), need]
    return subprocess.run(words, check=False).returncode == 0
