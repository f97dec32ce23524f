# SPDX-License-Identifier: Apache-2.0
"""cocotb runs on modules of ``rtl/`` with Icarus or Verilator, through cocotb-test.

Every set of toplevel, parameters and options has its own folder under ``build/sim``, kept between runs.
"""

import asyncio
import fcntl
import hashlib
import json
import os
import shutil
import signal
import sys
from contextlib import contextmanager
from importlib.metadata import version
from pathlib import Path

import cocotb_test.simulator

from tb.sim import coverage
from tb.sim.env import ROOT, cores, environment, simulator
from tb.sim.sources import headers, includes, sources, with_rules

BUILD = coverage.build("sim")

COMPACT = ["--output-split", "0", str(ROOT / "tb" / "sim" / "tables.vlt")]
"""Verilator arguments for a single, shorter C++ file. It parses the system's headers once: half the compile time."""

VERILATOR_ARGS = [
    *COMPACT,
    "-O1",  # Verilator's own passes: C++ compile time matters more here than simulation speed
    "-Wno-fatal",  # `make lint` covers warnings
    *("--x-initial", "unique"),  # random initial registers, as in a chip
    *("--x-assign", "unique"),  # likewise for assigned X
    *("--timescale", "1ns/1ps"),
]
MAKE_ARGS = ["CFG_CXXFLAGS_PCH_I=-include"]  # compiler flag missing from the PyPI package's configuration
UNOPTIMIZED = ["OPT_FAST=-O0", "OPT_SLOW=-O0"]
"""Make arguments that save a third of the compile time. Python takes nine tenths of the simulation time anyway."""
WITH_DIGIT = ("ik_axis", "ik_axis_bytes", "ik_axi")  # toplevels that have the parameter DIGIT
DEPTH = {"ik_axis": 4, "ik_arm": 5, "ik_axi": 8}
"""Toplevel -> depth of recorded scopes; delay lines and operators are deeper. Other toplevels are recorded whole."""
TRACED = ROOT / "tb" / "sim" / "waves.vlt"
"""File that lists the scopes that Verilator omits from the waves of the toplevels in `DEPTH`."""


@contextmanager
def alone(folder: Path):
    """Lock a build folder for one process at a time."""
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / ".lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


@contextmanager
def runtime(folder: Path, kind: str, header: bool = True):
    """Share Verilator's runtime and parsed headers between all builds of a kind, to save 10 s of compilation. Yield
    make's arguments; without them, make would rebuild the copied runtime, because it is older than the makefile.

    header: False if Verilator precompiles its own header, as for a model in several files; gcc accepts only one."""
    store = BUILD / "verilator" / f"runtime-{version('verilator')}-{kind}"
    with alone(store):
        if not (store / "common.h").exists():
            shutil.copy(ROOT / "tb" / "sim" / "common.h", store)
    ready = list(store.glob("*.o"))
    for path in ready:
        if not (folder / path.name).exists():
            shutil.copy(path, folder / path.name)
    files = ROOT / "tb" / "sim" / "common.mk", store / "common.h"
    rule, common = (os.path.relpath(path, folder) for path in files)
    settings = [f"COMMON={common}", *[f"USER_CPPFLAGS=-include {common}"] * header]
    settings += [f"--old-file={path.name}" for path in ready]
    yield [f"-j{os.cpu_count()}", *MAKE_ARGS, "-f", rule, *settings]
    for path in folder.glob("verilated*.o"):
        if not (store / path.name).exists():
            copy = store / f"{path.name}.{os.getpid()}"
            shutil.copy(path, copy)
            os.replace(copy, store / path.name)


@contextmanager
def _signals():
    """Restore the SIGINT and SIGTERM handlers, which cocotb-test 0.3.0 replaces for good."""
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def simulate(
    toplevel: str,
    module: str,
    *,
    parameters: dict[str, int] | None = None,
    sim: str | None = None,
    env: dict[str, str] | None = None,
    seed: int = 1,
    waves: Path | None = None,
    root: Path = ROOT,
    name: str = "",
    core: str | None = None,
    top: str = "",
    start: int = 1,
    built: bool = False,
    build: Path | None = None,
    seconds: float | None = None,
) -> None:
    """Run the cocotb tests of ``module`` on ``toplevel``.

    ``sim`` is icarus or verilator (default: variable ``SIM``, else icarus). ``env`` has environment variables for the
    tests. ``waves`` is a VCD file to write. ``root`` holds another copy of ``rtl/``; ``name`` distinguishes its build.
    ``core``, the kind of dividers and roots, is behavioural or digit (default: variable ``IK_CORES``, else
    behavioural). ``top`` is the text of a toplevel outside ``rtl/``. ``start`` is the seed of initial register values
    under Verilator. ``built`` reuses the build of an earlier call that differs only in env and seeds. ``build`` is
    another folder for builds. ``seconds`` limits each command. Raises ``SystemExit`` when a test or the build fails, as
    cocotb-test does, or at the limit.
    """
    ready = environment()  # cocotb-test's commands inherit the environment of this process
    os.environ.clear()
    os.environ.update(ready)
    sim = simulator(sim)
    digit = cores(core) == "digit" and toplevel in WITH_DIGIT
    parameters = ({"DIGIT": 1} if digit else {}) | (parameters or {})
    parts = [toplevel, *(f"{k}{v}" for k, v in parameters.items()), name]
    parts.append("waves" if waves and sim == "verilator" else "")
    parts.append(hashlib.sha1(top.encode()).hexdigest()[:10] if top else "")
    folder = (build or BUILD) / sim / "-".join(filter(None, parts))
    with alone(folder):
        files = with_rules(sources(root), folder)
        if top:
            files.append(folder / f"{toplevel}.v")
            if not files[-1].exists():
                files[-1].write_text(top)
    options: dict = {
        "toplevel": toplevel,
        "module": module,
        "verilog_sources": [str(path) for path in files],
        "includes": [str(folder) for folder in includes(root)],
        "parameters": parameters,
        "sim_build": str(folder),
        "extra_env": {"SIM": sim, "COCOTB_ANSI_OUTPUT": "0", **(env or {})},
        "seed": seed,
    }
    if sim == "icarus":
        options["toplevel"] = [toplevel, "ik_waves"]
        options["timescale"] = "1ns/1ps"
        options["defines"] = [f"IK_TOP={toplevel}", f"IK_DEPTH={DEPTH.get(toplevel, 0)}"]
        options["verilog_sources"].append(str(ROOT / "tb" / "sim" / "ik_waves.v"))
        options["plus_args"] = [f"+waves={waves}"] if waves else []
    else:
        options["compile_args"] = [
            *VERILATOR_ARGS,
            *(["--trace-vcd", *[str(TRACED)] * (toplevel in DEPTH)] if waves else []),
            *(coverage.FLAGS if coverage.folder() else []),
        ]
        options["plus_args"] = ["+verilator+rand+reset+2", f"+verilator+seed+{start}"]
        options["plus_args"] += ["--trace", "--trace-file", str(waves)] if waves else []
    # cocotb-test 0.3.0 compares the ages of sources only, not of included files
    built_as = folder / f"{toplevel}.vvp"
    if sim == "icarus" and built_as.exists():
        options["force_compile"] = max(path.stat().st_mtime for path in headers(root)) > built_as.stat().st_mtime

    def run(kind, **others) -> None:
        simulator = kind(**options, **others)
        simulator.seconds = seconds
        simulator.run()

    with _signals():
        if not built and sim == "icarus":
            with alone(folder):
                try:
                    run(Icarus, compile_only=True)
                except BaseException:
                    built_as.unlink(missing_ok=True)  # a partial file would look up to date
                    raise
        elif not built:
            with alone(folder), runtime(folder, "waves" if waves else "plain") as shared:
                run(Verilator, compile_only=True, make_args=[*shared, *UNOPTIMIZED])
        with coverage.counting(root) as counts:  # Icarus ignores them
            options["plus_args"] += counts
            run(Icarus if sim == "icarus" else Built)


class Limited(cocotb_test.simulator.Simulator):
    """Simulator with a time limit for each command: cocotb-test 0.3.0 has none."""

    seconds: float | None = None

    async def _exec(self, command: list[str]) -> None:
        limit = asyncio.get_running_loop().call_later(self.seconds or 1e9, lambda: self.process.kill())
        await super()._exec(command)
        if self.process.returncode and limit.when() <= asyncio.get_running_loop().time():
            raise SystemExit(f"{Path(command[0]).name} was ended after {self.seconds:g} s")
        limit.cancel()


class Icarus(Limited, cocotb_test.simulator.Icarus):
    pass


class Verilator(Limited, cocotb_test.simulator.Verilator):
    pass


class Built(Verilator):
    """Run of an existing Verilator build, which cocotb-test 0.3.0 would build again."""

    def build_command(self) -> list[list[str]]:
        """Return the command that starts the program; the base class's commands would build it again."""
        return [[os.path.join(self.sim_dir, self.toplevel_module), *self.plus_args]]


def command(*names: str, **options) -> list[str]:
    """Return a command that calls :func:`simulate` in a process of its own, since cocotb-test changes signal handlers
    and logging."""
    return [sys.executable, "-m", "tb.sim.runner", json.dumps([names, options], default=str)]


if __name__ == "__main__":
    names, named = json.loads(sys.argv[1])
    simulate(*names, **named | {key: Path(named[key]) for key in ("waves", "root", "build") if named.get(key)})
