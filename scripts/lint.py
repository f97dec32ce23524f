# SPDX-License-Identifier: Apache-2.0
"""Lint every Verilog module as its own top with Verilator, Icarus and slang; check the Python with ruff and others.

Each module is linted with each of its parameter sets, without macros and with each macro. Any message is a finding and
makes the exit status 1. Waivers are in rtl/lint.vlt for Verilator and in WAIVED for slang. The first parameter set is
also linted with the distribution's Verilator (5.006 in Debian 12), if installed.
"""

import importlib.util
import itertools
import os
import re
import shlex
import subprocess
import sys
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path

import click

from scripts.console import InputError, Options, command
from tb.sim.env import ROOT, environment
from tb.sim.sources import RULES, includes, sources

MODULE_SETS = {
    "ik_axi": [
        {"W": 32},
        {"W": 18, "DATA_W": 32, "ADDR_W": 64, "LOG2_BURST": 5},
        {"W": 18, "DATAPATH": 0, "DIGIT": 1, "DATA_W": 128, "ADDR_W": 12, "LOG2_BURST": 1},
        {"W": 32, "ARM": 1},
        *({"W": 24, "DATAPATH": 2, "ARM": arm} for arm in (0, 1)),
        {"W": 18, "ARM": 1, "DATA_W": 32, "ADDR_W": 13, "LOG2_BURST": 4},
    ],
    "ik_axi_target": [{"W": width} for width in (32, 31, 18, 16)] + [{"W": 18, "LOG2_RECORD": 6}],
    "ik_axis": [{"W": 24}, {"W": 16}, {"W": 18, "TILE": 25}, {"W": 24, "DATAPATH": 2}],
    "ik_axis_bytes": [{"W": 18}],
    "ik_arm_bytes": [{"W": 18, "CHOOSE": choose} for choose in (0, 1)],
    "ik_paper": [{"W": width, "DIGIT": digit} for width in (32, 18) for digit in (0, 1)],
    **{name: [{"W": width} for width in (32, 20)] for name in ("ik_fold", "ik_fold_arm")},
    **{name: [{}] for name in ("ik_fold_datapath", "ik_fold_norm", "ik_fold_arm_hand")},
    "icebreaker": [{}, {"BAUD": 115200}, {"ARM": 1}],
    "ik_arm": [
        *({"W": 24}, {"W": 16}, {"W": 18, "TILE": 25}, {"W": 24, "TILE": 16}, {"W": 24, "DATAPATH": 2}),
        *({"W": 24, "CHOOSE": 1}, {"W": 18, "CHOOSE": 1, "EPS": 1}, {"W": 24, "DATAPATH": 2, "CHOOSE": 1}),
    ],
    **{
        f"ik_lean_{part}": [{"W": 32, "N": 35}, {"W": 18, "N": 25}]
        for part in ("direction", "triangle", "turn", "hand", "frame")
    },
}
"""Module -> its parameter sets. Other modules are linted at W = 32 and 18, or with their defaults if they have no W.
Submodules are linted with the parameters that their top gives them: ik_axi covers the cores of 32 and 18 bits."""

FOLDERS = ("examples/icebreaker", "tb/axi/rules")
"""Folders whose modules are linted in addition to rtl/. Models of vendor primitives are in tb/icebreaker."""

OLDEST = "5.006"  # oldest supported Verilator
SLANG = """import sys
from pyslang.driver import Driver
for line in sys.argv[1:]:
    driver = Driver()
    driver.addStandardArgs()
    ready = driver.parseCommandLine(line) and driver.processOptions() and driver.parseAllSources()
    if not (ready and driver.runFullCompilation(quiet=True)):
        sys.exit(1)
"""
"""Python program that runs slang; each of its arguments is a command line of slang."""
WAIVED = {
    ("rtl/lib/ik_mul3.v", "shift-count-overflow"): "the low part of a product may have no bits",
    ("rtl/lib/ik_vector.v", "shift-count-overflow"): "the last turns shift a length out as a whole",
}
"""File and warning of slang -> reason why it is no finding."""
DIAGNOSTIC = re.compile(r"^(\S+?):\d+:\d+: (?:warning|error): .*?(?: \[-W(\S+)\])?$", re.MULTILINE)

LICENCE = "SPDX-License-Identifier: Apache-2.0"
LICENSED = re.compile(r"(.*\.(py|v|vh|vlt|f|c|h|cpp|js|css|html|j2|toml)|(.*/)?(Makefile|run))")
LONGEST = 500  # lines of a hand-written source file
GENERATED = re.compile(r"rtl/.*(_nodes|_table|latency|program)\.vh|.*/ik_regs\.h|docs/generated/.*")

TOOLS = {
    "ruff": ["ruff", "check", "--quiet", "."],
    "ruff format": ["ruff", "format", "--check", "--quiet", "."],
    "imports (import-linter)": ["lint-imports", "--no-logo", "--cache-dir", "build/import_linter"],
    "types of the model (mypy)": ["mypy"],
}
"""Check -> its command; the settings are in pyproject.toml."""


def findings(words: Sequence[str], only_failures: bool = False) -> str:
    """Run a command and return its output. With `only_failures`, return "" if the exit status is 0."""
    done = subprocess.run(words, cwd=ROOT, env=environment(), capture_output=True, text=True, check=False)
    if only_failures and not done.returncode:
        return ""
    # Verilator ends with lines such as "- Verilator: Walltime ..."
    lines = [line for line in (done.stdout + done.stderr).splitlines() if line and not line.startswith("- ")]
    return "\n".join(lines or [f"{words[0]} ended with status {done.returncode}"] * bool(done.returncode))


@cache
def verilators() -> list[list[str]]:
    """Return the commands of the checkout's Verilator and, if it is OLDEST or newer, the distribution's Verilator."""
    other = ["env", "-u", "VERILATOR_ROOT", "/usr/bin/verilator_bin"]
    version = findings([*other, "--version"]).split() if Path(other[-1]).exists() else []
    return [["verilator_bin"], *([other] if version[1:] and version[1] >= OLDEST else [])]


def lint_module(source: Path) -> tuple[str, str]:
    """Lint a module with all front ends; return a line with its name and parameter sets, and the findings."""
    text, name = source.read_text(encoding="utf-8"), source.stem
    modules = re.findall(r"^module +(\w+)", text, re.MULTILINE) if source.parent == RULES else [name]
    has_width = re.search(r"\bparameter +(integer +)?W *=", text)
    sets = MODULE_SETS.get(name) or ([{"W": 32}, {"W": 18}] if has_width else [{}])
    folders = [*dict.fromkeys(path.parent for path in sources()), *(ROOT / f for f in (*FOLDERS, "tb/icebreaker"))]
    where = [f"-I{folder}" for folder in (*includes(), *folders)]
    where += [word for folder in folders for word in ("-y", str(folder))]
    macros = [[], *([f"-D{name}"] for name in sorted(set(re.findall(r"`ifdef (\w+)", text))))]
    messages, lines = {}, []  # several parameter sets may give the same message
    for top, values, macro in itertools.product(modules, sets, macros):
        parameters = [f"-G{k}={v}" for k, v in values.items()]
        verilator = ["--lint-only", "-Wall", "--default-language", "1364-2001", "--top-module", top, *macro]
        verilator += [*where, *parameters, str(ROOT / "rtl" / "lint.vlt"), str(source)]
        for program in verilators() if values == sets[0] else verilators()[:1]:
            messages[findings([*program, *verilator])] = None
        icarus = ["iverilog", "-g2001", "-Wall", "-t", "null", "-s", top, *macro]
        icarus += [*where, *(f"-P{top}.{k}={v}" for k, v in values.items()), str(source)]
        messages[findings(icarus)] = None
        lines.append(shlex.join(["slang", "-Wextra", "--top", top, *macro, *where, *parameters, str(source)]))
    if importlib.util.find_spec("pyslang"):
        said = findings([sys.executable, "-c", SLANG, *lines])
        diagnostics = set(DIAGNOSTIC.findall(said))
        messages["" if diagnostics and diagnostics <= WAIVED.keys() else said] = None
    at = ", ".join(" ".join(f"{k}={v}" for k, v in values.items()) or "defaults" for values in sets)
    return f"{name} {at}", "\n".join(filter(None, messages))


def unkept(names: Sequence[str]) -> str:
    """Return the findings about licence lines and lengths of source files."""
    messages = []
    for name in filter(LICENSED.fullmatch, names):
        lines = (ROOT / name).read_text(encoding="utf-8").splitlines() if (ROOT / name).is_file() else [LICENCE]
        if not any(LICENCE in line for line in lines[:5]):
            messages.append(f"{name}: no line {LICENCE}")
        if len(lines) > LONGEST and not GENERATED.fullmatch(name):
            messages.append(f"{name}: {len(lines)} lines, at most {LONGEST} allowed")
    return "\n".join(messages)


@command(
    "lint",
    [click.Argument(["modules"], nargs=-1, metavar="[MODULE]...")],
    about=f"{__doc__.splitlines()[0]} With MODULE only these modules, and no Python.",
    passes="no finding",
    fails="a finding",
)
def main(options: Options) -> int:
    every = [*sources(), *(path for name in FOLDERS for path in sorted((ROOT / name).glob("*.v")))]
    if unknown := set(options.modules) - {source.stem for source in every}:
        raise InputError(f"no module {', '.join(sorted(unknown))}")
    if not verilators()[1:]:
        print(f"skip the distribution's Verilator: there is none, or it is older than {OLDEST}")
    if not importlib.util.find_spec("pyslang"):
        print("skip slang: pyslang needs Python 3.11")
    failed, checks = 0, {}
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        if not options.modules:
            checks = {name: pool.submit(findings, words, only_failures=True) for name, words in TOOLS.items()}
            checks["licences, lengths of files"] = pool.submit(unkept, findings(["git", "ls-files"]).splitlines())
        linted = pool.map(lint_module, [s for s in every if s.stem in (options.modules or [s.stem])])
        for name, messages in itertools.chain(linted, ((name, check.result()) for name, check in checks.items())):
            failed += bool(messages)
            print(f"{'FAIL' if messages else 'ok  '} {name}", *filter(None, [messages]), sep="\n", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
