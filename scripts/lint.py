# SPDX-License-Identifier: Apache-2.0
"""Lint every Verilog module as its own top with Verilator and Icarus -Wall; check the Python with ruff and others.

A module is linted at each parameter set below. Any message is a finding; the exit status is then 1. Verilator's
waivers are in rtl/lint.vlt.
"""

import itertools
import os
import re
import subprocess
import sys
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace

import click

from scripts.console import InputError, command
from tb.sim.env import ROOT, environment
from tb.sim.sources import includes, sources

# parameter -> its values; a module is linted at every combination of the parameters that it has
PARAMETER_SETS = {"W": (32, 18)}
# engines of memory: narrow and wide buses, addresses and bursts
BUSES = [{"ADDR_W": a, "DATA_W": d, "LOG2_BURST": b} for a, d, b in ((32, 64, 3), (64, 32, 5), (12, 128, 1))]
# module -> its own sets, if the sets above are illegal or insufficient
MODULE_SETS = {
    "ik_axi": [
        {"W": 32},
        {"W": 18, "DATA_W": 32, "ADDR_W": 64, "LOG2_BURST": 5},
        {"W": 18, "DATAPATH": 0, "DIGIT": 1, "DATA_W": 128, "ADDR_W": 12, "LOG2_BURST": 1},
    ],
    "ik_axi_job": [{"ADDR_W": a, "DATA_W": d} for a, d in ((32, 64), (64, 32), (12, 128))],
    "ik_axi_read": BUSES,
    "ik_axi_write": BUSES,
    "ik_axi_result": [{"W": w, "DATA_W": d} for w, d in ((32, 64), (18, 32), (16, 128))],
    "ik_axi_target": [{"W": w} for w in (32, 31, 18, 16)],
    "ik_axis": [
        {"W": 32},
        {"W": 18},
        {"W": 18, "DATAPATH": 0, "DIGIT": 1},
        {"W": 18, "TILE": 25},
        {"W": 24, "DATAPATH": 2},
    ],
    "ik_div": [{"DIGIT": 0}, {"DIGIT": 1}],
    "ik_div_digit": [
        {"NW": 40, "DW": 32, "SH": 22, "QW": 32, "LAT": 34},
        {"NW": 40, "DW": 32, "SH": 22, "QW": 32, "LAT": 18},
        {"NW": 18, "DW": 18, "SH": 16, "QW": 18, "LAT": 20},
    ],
    "ik_sincos": [{"W": 32}, {"W": 18}],
    "ik_root": [{"DIGIT": 0}, {"DIGIT": 1}],
    "ik_root_digit": [
        {"NW": 32, "SH": 30, "QW": 32, "LAT": 32},
        {"NW": 33, "SH": 29, "QW": 32, "LAT": 17},
        {"NW": 18, "SH": 17, "QW": 18, "LAT": 18},
    ],
    "ik_root_row": [{"K": 0}, {"K": 15}, {"K": 30}],
    "ik_even": [{"VW": 64, "MW": 34}, {"VW": 36, "MW": 24}, {"VW": 18, "MW": 24}],
    "ik_fold": [{"W": 24}, {"W": 32}, {"W": 20}],
    "ik_fold_norm": [{}],
    "icebreaker": [{}, {"BAUD": 115200}],
    "ik_fold_word": [{}],
    **{f"ik_lean_{part}": [{"W": 32, "N": 35}, {"W": 18, "N": 25}] for part in ("direction", "triangle", "turn")},
    "ik_paper": [{"W": w, "DIGIT": digit} for w in (32, 18) for digit in (0, 1)],
    "ik_mul3": [{"AW": 35, "BW": 35, "SH": 33, "OW": 35}, {"AW": 23, "BW": 24, "SH": 20, "OW": 30}],
    "ik_rsqrt": [{"F": 31}, {"F": 22}, {"F": 21}, {"F": 19}],
    "ik_quadratic": [{}],
    "ik_trig": [{"W": 32, "F": 31}, {"W": 24, "F": 27}, {"W": 18, "F": 23}, {"W": 16, "F": 19}],  # F goes with W
}

PREFIX = "ik_"
FOLDERS = ("examples/icebreaker", "tb/rules")
"""Folders of modules that are linted with rtl/."""
MODELS = "tb/icebreaker"
"""Models of vendor primitives; not linted themselves."""

LICENCE = "SPDX-License-Identifier: Apache-2.0"
LICENSED = re.compile(r"(.*\.(py|v|vh|vlt|f|c|h|cpp|js|css|html|j2|toml)|(.*/)?(Makefile|run))")
LONGEST = 500
"""Lines of a hand-written source file."""
GENERATED = re.compile(r"rtl/.*(_nodes|_table|latency|program)\.vh|.*/ik_regs\..*|docs/generated/.*")

TOOLS = {
    "ruff": ["ruff", "check", "--quiet", "."],
    "ruff format": ["ruff", "format", "--check", "--quiet", "."],
    "imports (import-linter)": ["lint-imports", "--no-logo", "--cache-dir", "build/import_linter"],
    "types of the model (mypy)": ["mypy"],
}
"""Check -> its command; the settings are in pyproject.toml."""


def parameter_sets(name: str, text: str) -> list[dict]:
    """Return the parameter sets at which a module is linted."""
    if name in MODULE_SETS:
        return MODULE_SETS[name]
    has = [p for p in PARAMETER_SETS if re.search(rf"\bparameter\b[^;)]*?\b{p}\s*=", text)]
    combinations = itertools.product(*(PARAMETER_SETS[p] for p in has))
    return [dict(zip(has, values, strict=True)) for values in combinations]


def commands(source: Path, parameters: dict) -> list[list[str]]:
    """Return the commands of both simulators for a module."""
    name = source.stem
    folders = [*dict.fromkeys(path.parent for path in sources()), *(ROOT / name for name in (*FOLDERS, MODELS))]
    where = [f"-I{folder}" for folder in (*includes(), *folders)]
    where += [word for folder in folders for word in ("-y", str(folder))]
    verilator = ["verilator_bin", "--lint-only", "-Wall", "--default-language", "1364-2001", "--top-module", name]
    verilator += [*where, *(f"-G{k}={v}" for k, v in parameters.items()), str(ROOT / "rtl" / "lint.vlt"), str(source)]
    icarus = ["iverilog", "-g2001", "-Wall", "-t", "null", "-s", name]
    icarus += [*where, *(f"-P{name}.{k}={v}" for k, v in parameters.items()), str(source)]
    return [verilator, icarus]


def run(words: Sequence[str]) -> str:
    """Return the messages of a command; empty if there is no finding."""
    done = subprocess.run(words, cwd=ROOT, env=environment(), capture_output=True, text=True, check=False)
    # Verilator ends with lines such as "- Verilator: Walltime ..."
    lines = [line for line in (done.stdout + done.stderr).splitlines() if line and not line.startswith("- ")]
    return "\n".join(lines or [f"{words[0]} ended with status {done.returncode}"] * bool(done.returncode))


def lint_module(source: Path) -> tuple[str, str]:
    """Return a line about a module, and its findings."""
    start = time.monotonic()
    name = source.stem
    text = re.sub(r"//[^\n]*|/\*.*?\*/", " ", source.read_text(encoding="utf-8"), flags=re.DOTALL)
    sets = parameter_sets(name, text)
    modules = re.findall(r"^\s*module\s+(\w+)", text, re.MULTILINE)
    if modules != [name]:
        findings = [f"{source}: defines {modules or 'no module'}, expected the one module {name}"]
    elif ROOT / "rtl" in source.parents and not name.startswith(PREFIX):
        findings = [f"{source}: a module name must start with {PREFIX}"]
    else:
        # Several parameter sets may give the same message.
        findings = dict.fromkeys(run(words) for parameters in sets for words in commands(source, parameters))
    at = ", ".join(" ".join(f"{k}={v}" for k, v in p.items()) or "defaults" for p in sets)
    findings = "\n".join(filter(None, findings))
    return f"{'FAIL' if findings else 'ok  '} {name:<28} {at:<16} {time.monotonic() - start:5.1f} s", findings


def unkept(names: Sequence[str]) -> list[str]:
    """Return the findings on licences and lengths of source files."""
    findings = []
    for name in filter(LICENSED.fullmatch, names):
        lines = (ROOT / name).read_text(encoding="utf-8").splitlines() if (ROOT / name).is_file() else [LICENCE]
        if not any(LICENCE in line for line in lines[:5]):
            findings.append(f"{name}: no line {LICENCE}")
        if len(lines) > LONGEST and not GENERATED.fullmatch(name):
            findings.append(f"{name}: {len(lines)} lines, at most {LONGEST} allowed")
    return findings


@command(
    "lint",
    f"{__doc__.splitlines()[0]} With MODULE only these modules, and no Python.",
    [click.Argument(["modules"], nargs=-1, metavar="[MODULE]...")],
    passes="no finding",
    fails="a finding",
)
def main(options: SimpleNamespace) -> int:
    found = [*sources(), *(path for name in FOLDERS for path in sorted((ROOT / name).glob("*.v")))]
    if unknown := set(options.modules) - {source.stem for source in found}:
        raise InputError(f"no module {', '.join(sorted(unknown))}")
    found = [source for source in found if source.stem in (options.modules or [source.stem])]
    failed = 0
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for line, findings in pool.map(lint_module, found):
            print(line, *filter(None, [findings]), sep="\n", flush=True)
            failed += bool(findings)
    print(f"{len(found) - failed} of {len(found)} Verilog modules without a finding", flush=True)

    if not options.modules:
        results = {"licences, lengths of files": "\n".join(unkept(run(["git", "ls-files"]).splitlines()))}
        for name, words in TOOLS.items():
            done = subprocess.run(words, cwd=ROOT, env=environment(), capture_output=True, text=True, check=False)
            results[name] = done.stdout + done.stderr if done.returncode else ""
        for name, findings in results.items():
            print(f"{'FAIL' if findings else 'ok  '} {name}", *filter(None, [findings]), sep="\n", flush=True)
            failed += bool(findings)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
