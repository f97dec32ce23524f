# SPDX-License-Identifier: Apache-2.0
"""make lint: every Verilog module as its own top in Verilator -Wall and Icarus -Wall, then the Python's contracts.

A module that has a parameter of PARAMETER_SETS is looked at once for each value. Any message is a finding,
and the exit status is then 1. Verilator's waivers, if there are any, are in rtl/lint.vlt; each one matches a text
and gives its reason.
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

from scripts import contracts
from scripts.console import InputError, Parser, command
from tb.sim.env import ROOT, environment
from tb.sim.sources import LIST, includes, sources

# parameter: values it is linted at. A module is linted at every combination of those it has.
PARAMETER_SETS = {"W": (32, 18)}
# of engines of memory: narrow and wide buses, addresses and bursts
BUSES = [{"ADDR_W": a, "DATA_W": d, "LOG2_BURST": b} for a, d, b in ((32, 64, 3), (64, 32, 5), (12, 128, 1))]
# module: sets of its own, where the table above is not enough or not legal for it
MODULE_SETS = {
    "ik_axi": [
        {"W": 32},
        {"W": 18, "DATA_W": 32, "ADDR_W": 64, "LOG2_BURST": 5},
        {"W": 18, "LEAN": 0, "DIGIT": 1, "DATA_W": 128, "ADDR_W": 12, "LOG2_BURST": 1},
    ],
    "ik_axi_job": [{"ADDR_W": a, "DATA_W": d} for a, d in ((32, 64), (64, 32), (12, 128))],
    "ik_axi_read": BUSES,
    "ik_axi_write": BUSES,
    "ik_axi_result": [{"W": w, "DATA_W": d} for w, d in ((32, 64), (18, 32), (16, 128))],
    "ik_axi_target": [{"W": w} for w in (32, 31, 18, 16)],
    "ik_axis": [{"W": 32}, {"W": 18}, {"W": 18, "LEAN": 0, "DIGIT": 1}, {"W": 32, "LEAN": 0, "SHORT": 1},
                {"W": 18, "TILE": 25}, {"W": 24, "LEAN": 2}],
    "ik_div": [{"DIGIT": 0}, {"DIGIT": 1}, {"DIGIT": 1, "CUT": 8, "CUT_D": 12}],
    "ik_div_digit": [
        {"NW": 40, "DW": 32, "SH": 22, "QW": 32, "LAT": 34},
        {"NW": 40, "DW": 32, "SH": 22, "QW": 32, "LAT": 18},
        {"NW": 18, "DW": 18, "SH": 16, "QW": 18, "LAT": 20},
    ],
    "ik_sincos": [{"W": 32}, {"W": 18}, {"W": 32, "CUT": 7}],
    "ik_pick": [{"W": 32}, {"W": 18}, {"W": 32, "CUT": 5}],
    "ik_root": [{"DIGIT": 0}, {"DIGIT": 1}, {"DIGIT": 1, "CUT": 12}],
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
    "ik_paper": [
        *({"W": w, "DIGIT": digit} for w in (32, 18) for digit in (0, 1)),
        *({"W": 32, "DIGIT": digit, "SHORT": 1} for digit in (0, 1)),
    ],
    "ik_mul3": [{"AW": 35, "BW": 35, "SH": 33, "OW": 35}, {"AW": 23, "BW": 24, "SH": 20, "OW": 30}],
    "ik_rsqrt": [{"F": 31}, {"F": 22}, {"F": 21}, {"F": 19}],
    "ik_quadratic": [{}],
    "ik_trig": [{"W": 32, "F": 31}, {"W": 24, "F": 27}, {"W": 18, "F": 23}, {"W": 16, "F": 19}],  # F goes with W
}

PREFIX = "ik_"
BESIDE = ("examples/icebreaker", "tb/rules")
MODELS = ("tb/icebreaker",)
"""Folders of modules that are linted with those of rtl/, and of what stands for a vendor's in them."""
COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.S)
MODULE = re.compile(r"^\s*module\s+(\w+)", re.M)
PARAMETER = re.compile(r"\bparameter\b[^;)]*?\b{}\s*=")


def parameter_sets(name: str, text: str) -> list[dict]:
    """The parameter sets a module is linted at; at least the one with its defaults."""
    if name in MODULE_SETS:
        return MODULE_SETS[name]
    has = [p for p in PARAMETER_SETS if re.search(PARAMETER.pattern.format(p), text)]
    combinations = itertools.product(*(PARAMETER_SETS[p] for p in has))
    return [dict(zip(has, values, strict=True)) for values in combinations]


def commands(source: Path, root: Path, parameters: dict) -> list[list[str]]:
    name = source.stem
    beside = [root / name for name in (*BESIDE, *MODELS)]
    where = [f"-I{folder}" for folder in (*includes(root), *beside)]
    folders = [*dict.fromkeys(path.parent for path in sources(root)), *beside]
    where += [word for folder in folders for word in ("-y", str(folder))]
    lint_vlt = root / "rtl" / "lint.vlt"
    waivers = [str(lint_vlt)] if lint_vlt.exists() else []
    verilator = ["verilator_bin", "--lint-only", "-Wall", "--default-language", "1364-2001", *waivers]
    verilator += [*where, *(f"-G{k}={v}" for k, v in parameters.items()), "--top-module", name, str(source)]
    icarus = ["iverilog", "-g2001", "-Wall", "-t", "null", "-s", name]
    icarus += [*where, *(f"-P{name}.{k}={v}" for k, v in parameters.items()), str(source)]
    return [verilator, icarus]


def run(command: list[str], env: dict) -> str:
    """What a tool has to say; empty if it is content."""
    done = subprocess.run(command, env=env, capture_output=True, text=True, check=False)
    # Verilator sums up in lines such as "- Verilator: Walltime ..." on success
    said = [line for line in (done.stdout + done.stderr).splitlines() if line and not line.startswith("- ")]
    if done.returncode and not said:
        said = [f"{command[0]} ended with status {done.returncode}"]
    return "\n".join(said)


def lint_module(source: Path, root: Path, env: dict) -> tuple[str, str]:
    """One line about the module, and its findings."""
    start = time.monotonic()
    name = source.stem
    text = COMMENT.sub(" ", source.read_text(encoding="utf-8"))
    findings = []
    modules = MODULE.findall(text)
    if modules != [name]:
        findings.append(f"{source}: holds {modules or 'no module'}, must hold the one module {name}")
    if root / "rtl" in source.parents and not name.startswith(PREFIX):
        findings.append(f"{source}: a module's name starts with {PREFIX}")
    sets = parameter_sets(name, text)
    for parameters in sets if not findings else []:
        for words in commands(source, root, parameters):
            findings += [said for said in [run(words, env)] if said]
    at = ", ".join(" ".join(f"{k}={v}" for k, v in p.items()) or "defaults" for p in sets)
    line = f"{'FAIL' if findings else 'ok  '} {name:<28} {at:<16} {time.monotonic() - start:5.1f} s"
    # a file that several runs complain about in the same words is quoted once
    return line, "\n".join(dict.fromkeys(findings))


@command("lint")
def main(arguments: Sequence[str] | None) -> int:
    parser = Parser("lint", __doc__.split("\n")[0], "no finding", "a finding")
    parser.add_argument("modules", nargs="*", metavar="MODULE", help="only these modules, and no Python")
    parser.add_argument("--root", type=Path, default=ROOT, metavar="DIR", help="the folder that holds rtl/")
    parser.add_argument("--no-python", action="store_true", help="only the Verilog")
    options = parser.parse_args(arguments)

    root = options.root.resolve()
    found = sources(root) if (root / LIST).exists() else []
    found += [path for name in BESIDE for path in sorted((root / name).glob("*.v"))]
    unknown = set(options.modules) - {s.stem for s in found}
    if unknown or not found:
        what = f"no module {', '.join(sorted(unknown))}" if unknown else "no Verilog"
        raise InputError(f"{what} in {options.root / LIST}")
    if options.modules:
        found = [s for s in found if s.stem in options.modules]

    env = environment()
    failed = 0
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for line, findings in pool.map(lambda source: lint_module(source, root, env), found):
            print(line, flush=True)
            if findings:
                print(findings, flush=True)
                failed += 1
    print(f"{len(found) - failed} of {len(found)} Verilog modules without a finding", flush=True)

    if not (options.no_python or options.modules):
        failed += contracts.main()
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
