# SPDX-License-Identifier: Apache-2.0
"""What make says of a variable on its command line that its target does not take. Standard library only.

    python3 scripts/setup/variables.py TARGET 'UNKNOWN ...' 'TAKEN ...'

prints one line; the Makefile stops with it.
"""

import difflib
import sys


def complaint(target, unknown, taken):
    """The line about the first of the unknown names, with the name that was meant if one looks like it."""
    name = unknown[0]
    alike = difflib.get_close_matches(name.upper(), taken, 1)
    if alike:
        return f"make {target} takes no variable {name}: perhaps {alike[0]} is meant"
    return f"make {target} takes no variable {name}: it takes {', '.join(taken) or 'none'}"


if __name__ == "__main__":
    print(complaint(sys.argv[1], sys.argv[2].split(), sys.argv[3].split()))
