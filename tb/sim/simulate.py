# SPDX-License-Identifier: Apache-2.0
"""Library that runs targets through the RTL in a simulator, for ``scripts/trajectory.py`` and the tests."""

import contextlib
import pickle
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

from model.dataflow.datapaths import MODELS
from model.dataflow.nodes import Limits
from tb.sim import native_run, runner
from tb.sim.env import ROOT
from tb.sim.job import Run, SimulationError
from tb.sim.subprocesses import full, started

LONG = 2000
"""Least number of targets that Verilator runs natively by default. For fewer, cocotb takes less time than the native
build; Icarus takes about as long as that build."""


def simulate(
    jobs: list[np.ndarray],
    *,
    simulator: str,
    datapath: str,
    width: int,
    waves: Path | None = None,
    progress: Callable[[int, int], None] = lambda done, total: None,
    root: Path = ROOT,
    name: str = "",
    cores: str | None = None,
    native: bool | None = None,
    limits: Limits | None = None,
) -> list[Run]:
    """Run all jobs (:mod:`tb.sim.job`) in one simulation and compare every node with the bit-true model.

    ``waves`` is a VCD file to write. ``progress(done, total)`` is called about twice a second, or after each frame of
    a native run. ``root`` and ``name`` select another copy of the RTL; ``cores`` selects the kind of dividers and roots
    (see :func:`tb.sim.runner.simulate`). With ``native``, which is the default from :data:`LONG` targets on, Verilator
    runs without Python in the loop (:mod:`tb.sim.native_run`), unless it writes waves; the results are the same.
    ``limits`` are the joints' limits of the whole arm, in words. Raises :class:`SimulationError`.
    """
    done, total = 0, sum(map(len, jobs))
    if native is None:
        native = total >= LONG
    if native and simulator == "verilator" and not waves:
        program = native_run.program(datapath, width, root, name, cores, limits)

        def frames(job):
            nonlocal done
            for words, answer in native_run.answered(job, width, datapath, limits):
                yield words, answer
                progress(done := done + len(words), total)

        return [native_run.compare(program, frames(job), width, datapath, root) for job in jobs]
    with tempfile.TemporaryDirectory(prefix="ik_") as folder:
        place = Path(folder)
        (place / "jobs").write_bytes(pickle.dumps((jobs, limits)))
        log = place / "log"
        core = {"parameters": {"W": width, **MODELS[datapath].parameters}, "core": cores, "root": root, "name": name}
        core |= {"sim": simulator, "waves": waves, "env": {"IK_FOLDER": folder}}
        command = runner.command(MODELS[datapath].top, "tb.core.pipeline", **core)
        with open(log, "w") as out, started(command, folder, stdout=out, stderr=subprocess.STDOUT) as process:
            while process.poll() is None:
                with contextlib.suppress(subprocess.TimeoutExpired):
                    process.wait(timeout=0.5)
                if (place / "progress").exists():
                    progress(int((place / "progress").read_text() or 0), total)
        if process.returncode == 0:
            progress(total, total)
        lacking = full(*([waves.parent] if waves else []))  # a simulator may truncate a waveform silently
        if process.returncode or lacking or not (place / "runs").exists():
            lacking = lacking or full(place, ROOT / "build")
            raise SimulationError(lacking or reason(log.read_text(errors="replace"), simulator))
        return pickle.loads((place / "runs").read_bytes())


def reason(log: str, simulator: str) -> str:
    """Return the log lines that explain a failure."""
    telling = [line for line in log.splitlines() if any(w in line for w in ("rror", "FAIL", "assert", "syntax"))]
    return "\n".join([f"the {simulator} simulation failed:", *(telling or log.splitlines())[-12:]])
