# SPDX-License-Identifier: Apache-2.0
"""Commands that the Makefile runs."""

import _signal  # the built-in part of signal, which takes no time to import
import sys

if sys.argv[0] == "-m" and _signal.getsignal(_signal.SIGINT) is not _signal.SIG_IGN:
    _signal.signal(_signal.SIGINT, _signal.SIG_DFL)  # Ctrl-C prints no traceback while a command imports its modules
