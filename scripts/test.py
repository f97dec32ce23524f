# SPDX-License-Identifier: Apache-2.0
"""Run tests with pytest, for `make test`, `make test-all`, `make test-browser` and `make release-check`.

Each of these commands is a gate, and each test is in exactly one gate. With SIM=verilator, tests that start no
simulator are left out, as they have the same result.
"""

import difflib
import os
import sys

import click

from scripts.console import InputError, Options, command, option, sim_option, switch
from tb.sim.env import CORES, ROOT
from tb.sim.sources import sources

GATES = {
    "quick": "not slow and not release",
    "slow": "slow and not release",
    "browser": "not slow and not release",
    "release": "release",
}
"""Gate -> expression for pytest -m that selects its tests by the markers in pyproject.toml."""

BROWSER = ["scripts/report/tests/browser_test_report.py", "scripts/playground/tests/browser_test_playground.py"]
PYTEST = [sys.executable, "-m", "pytest", "-n", "auto", "--dist", "loadfile", "--no-loadscope-reorder"]


@command(
    "test",
    [
        click.Argument(["gate"], type=click.Choice(GATES)),
        sim_option(),
        option("--cores", "dividers and roots", click.Choice(CORES), default=CORES[0]),
        option(
            "--only",
            "quick and slow tests in FILE, or whose names match PATTERN; or all benches that contain a Verilog "
            "MODULE, up to the first failure",
            metavar="FILE|MODULE|PATTERN",
        ),
        switch("--waves", "record simulations; keep a VCD and a GTKWave save file of each that fails, in build/waves"),
    ],
    passes="all tests pass",
    fails="a test fails",
)
def main(options: Options) -> int:
    marks = "not release" if options.only else GATES[options.gate]
    if options.sim == "verilator" and options.gate != "browser":
        marks += " and sim"
    words = [*BROWSER] if options.gate == "browser" else []
    if options.only:
        words += selection(options.only)
    os.chdir(ROOT)
    os.environ.update(SIM=options.sim, IK_CORES=options.cores, IK_WAVES="1" * options.waves)
    os.execv(PYTEST[0], [*PYTEST, *words, "-m", marks])


def selection(only: str) -> list[str]:
    """Return pytest's arguments for a file, module of rtl/ or pattern. Raises InputError for an unknown module."""
    modules = [path.stem for path in sources()]
    if (ROOT / only.partition("::")[0]).exists():
        return [only]
    if only in modules:
        return ["tb", f"--module={only}", "--exitfirst", "-n0"]  # in order, the module's own bench first
    if only.startswith("ik_") and only.isidentifier() and not any(only in module for module in modules):
        near = ", ".join(difflib.get_close_matches(only, modules)) or "none"
        raise InputError(f"argument --only: no module {only}; similar names: {near}")
    return ["-k", only]


if __name__ == "__main__":
    sys.exit(main())
