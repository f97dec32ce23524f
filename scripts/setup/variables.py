# SPDX-License-Identifier: Apache-2.0
"""Print make's error message for a variable that its target does not take. Standard library only.

python3 scripts/setup/variables.py TARGET 'UNKNOWN ...' 'TAKEN ...'
"""

import difflib
import sys


def complaint(target, unknown, taken):
    """Return the message for the first unknown name, with a similar valid name if there is one."""
    name = unknown[0]
    alike = difflib.get_close_matches(name.upper(), taken, 1)
    if alike:
        return f"make {target} takes no variable {name}: perhaps {alike[0]} is meant"
    return f"make {target} takes no variable {name}: it takes {', '.join(taken) or 'none'}"


if __name__ == "__main__":
    print(complaint(sys.argv[1], sys.argv[2].split(), sys.argv[3].split()))
