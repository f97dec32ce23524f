# SPDX-License-Identifier: Apache-2.0
"""What `make lint` holds the tree to besides ruff: rooms, private names, sizes, licences, types of the model.

    python -m scripts.contracts

Which room may import which is in pyproject.toml.
"""

from __future__ import annotations

import ast
import fnmatch
import subprocess
import sys
from pathlib import Path

from tb.sim.env import ROOT, environment

LONGEST = 500
"""Lines of a file that is written by hand."""

GENERATED = (
    "docs/generated/*", "tb/mutation/results.jsonl", "rtl/*_nodes.vh", "rtl/*_table.vh", "rtl/ik_latency.vh",
    "*/ik_regs.*", "*.lock",
)  # fmt: skip
"""Files that a command writes."""

LICENCE = "SPDX-License-Identifier: Apache-2.0"
SOURCES = (".py", ".v", ".vh", ".vlt", ".f", ".c", ".h", ".cpp", ".sby", ".js", ".css", ".html", ".j2", ".toml")
SOURCES += ("Makefile", "run")
"""How the names of files end that say their licence."""

ROOMS = ("model", "tb", "scripts")

TOOLS = {
    "ruff": ["ruff", "check", "--quiet", "."],
    "rooms (import-linter)": ["lint-imports", "--no-logo", "--cache-dir", "build/import_linter"],
    "types of the model (mypy)": ["mypy"],
}
"""What is held -> the command that says so; their settings are in pyproject.toml."""


def private_names(path: Path) -> list[str]:
    """The private names that a Python file takes from another one, a line each.

    A name below a module is found by ruff (SLF001); this finds the rest, whatever package they come from.
    """
    found = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").partition(".")[0] in ROOMS:
            found += [
                f"{path}:{node.lineno}: takes the private name {name.name} of {node.module}"
                for name in node.names
                if name.name.startswith("_")
            ]
    return found


def too_long(path: Path, name: str) -> list[str]:
    """The file if it is written by hand and has more than `LONGEST` lines; `name`: relative to the checkout."""
    if any(fnmatch.fnmatch(name, pattern) for pattern in GENERATED):
        return []
    lines = len(path.read_bytes().splitlines())
    return [f"{name}: {lines} lines; split what is written by hand at {LONGEST}"] if lines > LONGEST else []


def tracked(root: Path) -> list[tuple[str, Path]]:
    """The files of a checkout, by name."""
    listed = subprocess.run(["git", "ls-files"], cwd=root, capture_output=True, text=True, check=True).stdout
    return [(name, root / name) for name in listed.splitlines() if (root / name).is_file()]


def unlicensed(root: Path = ROOT) -> list[str]:
    """The source files of a checkout whose first lines do not say their licence."""
    return [
        f"{name}: no line {LICENCE}"
        for name, path in tracked(root)
        if name.endswith(SOURCES) and LICENCE not in "".join(path.open(encoding="utf-8").readlines()[:5])
    ]


def findings(root: Path = ROOT) -> list[str]:
    """Private names and long files of a checkout, a line each."""
    files = tracked(root)
    found = [line for name, path in files if name.endswith(".py") for line in private_names(path)]
    return found + [line for name, path in files for line in too_long(path, name)]


def main() -> int:
    """Prints a line for each contract, and what breaks it; 1 if something does."""
    said = {"private names, sizes of files": findings(), "licences": unlicensed()}
    for what, command in TOOLS.items():
        done = subprocess.run(command, cwd=ROOT, env=environment(), capture_output=True, text=True, check=False)
        said[what] = (done.stdout + done.stderr).splitlines() if done.returncode else []
    for what, lines in said.items():
        print("\n".join([f"{'FAIL' if lines else 'ok  '} {what}", *lines]), flush=True)
    return int(any(said.values()))


if __name__ == "__main__":
    sys.exit(main())
