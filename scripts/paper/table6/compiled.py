# SPDX-License-Identifier: Apache-2.0
"""The C sources of this folder, compiled with the local compiler and called through ctypes."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np

from scripts.console import InputError
from tb.sim.env import ROOT

SOURCE = Path(__file__).parent / "software.c"
BUILD = ROOT / "build" / "table6"

FLAGS = ("-std=gnu11", "-O3", "-march=native", "-fno-math-errno", "-fno-trapping-math")
"""Without the last two flags, roots and selections prevent vectorization; results do not depend on either flag."""

SCALAR = ("-fno-tree-vectorize", "-fno-tree-slp-vectorize")
"""Flags that disable vectorization in gcc and clang."""

WAYS = {"chain": ("chain", SCALAR), "batch": ("batch", SCALAR), "vector": ("batch", ())}
"""Way -> function of ways.h and its flags. chain: each target waits for the previous one; batch: independent targets;
vector: several targets per instruction."""

EQUATIONS = ("lean", "paper")
REALS = {"double": np.float64, "float": np.float32}


def compiler() -> str:
    """Return the path of cc. Raises InputError if it is not in PATH."""
    found = shutil.which("cc")
    if not found:
        raise InputError("no C compiler: cc is not in PATH (on Debian: apt-get install gcc)")
    return found


def compiler_version() -> str:
    """Return the first line of the compiler's version."""
    said = subprocess.run([compiler(), "--version"], capture_output=True, text=True, check=False).stdout
    return said.splitlines()[0] if said else "cc"


def library(source: Path, path: Path, extra: tuple[str, ...] = ()) -> Path:
    """Compile a C file to a library at ``path``. Raises InputError if compilation fails."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.unlink(missing_ok=True)  # never overwrite a loaded library
    command = [compiler(), *FLAGS, *extra, "-shared", "-fPIC", "-o", str(path), str(source), "-lm"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        wrong = [line for line in done.stderr.splitlines() if "error" in line] or done.stderr.splitlines() or ["?"]
        raise InputError(f"cc cannot compile {source.name}: {wrong[0]}")
    return path


def build(folder: Path, extra: tuple[str, ...]) -> ctypes.CDLL:
    """Compile and load software.c. Raises InputError if compilation fails."""
    return ctypes.CDLL(str(library(SOURCE, folder / ("scalar.so" if extra else "vector.so"), extra)))


class Bound:
    """C function bound to its targets and output arrays."""

    def __init__(self, function: Callable, columns: list[np.ndarray], real: type):
        self.function = function
        self._columns = [np.ascontiguousarray(column, dtype=real) for column in columns]
        self._answers = np.full((len(columns), len(columns[0])), np.nan, dtype=real)
        self._pointers = [ctypes.c_void_p(a.ctypes.data) for a in (*self._columns, *self._answers)]

    def __call__(self, times: int = 1, *more: np.ndarray) -> np.ndarray:
        """Solve all targets ``times`` times; return the answers (N, 6). more: arrays for further outputs."""
        count = len(self._columns[0])
        self.function(
            ctypes.c_long(times),
            ctypes.c_long(count),
            *self._pointers,
            *(ctypes.c_void_p(array.ctypes.data) for array in more),
        )
        return self._answers.T

    def watched(self) -> np.ndarray:
        """Return the time of each solve of a chain (N,) in ns, including the clock reads."""
        ns = np.zeros_like(self._columns[0])
        self(1, ns)
        return ns


class Software:
    """The compiled libraries."""

    def __init__(self, folder: Path = BUILD):
        self._libraries = {extra: build(folder, extra) for extra in ((), SCALAR)}

    def way(self, equations: str, way: str, real: str, columns: list[np.ndarray]) -> Bound:
        """Bind a way of solving to targets given as columns x, y, z, phi, d1, d2."""
        name, extra = WAYS[way]
        return Bound(getattr(self._libraries[extra], f"{equations}_{name}_{real}"), columns, REALS[real])

    def watched(self, columns: list[np.ndarray]) -> Bound:
        """Bind the lean equations in double precision as a chain that times each solve."""
        return Bound(self._libraries[SCALAR].lean_watched_double, columns, np.float64)
