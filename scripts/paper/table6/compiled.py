# SPDX-License-Identifier: Apache-2.0
"""equations.c, compiled with the local compiler and called through ctypes."""

import ctypes
import shutil
import subprocess
import tempfile
from functools import cache
from pathlib import Path

import numpy as np

from scripts.console import InputError

SOURCE = Path(__file__).parent / "equations.c"

FLAGS = ("-std=gnu11", "-O3", "-march=native", "-fno-math-errno", "-fno-trapping-math")
"""Without the last two flags, roots and selections prevent vectorization. These two flags do not change the results."""

SCALAR = ("-fno-tree-vectorize", "-fno-tree-slp-vectorize")  # flags that disable vectorization in gcc and clang

WAYS = {"chain": ("chain", SCALAR), "batch": ("batch", SCALAR), "vector": ("batch", ())}
"""Way to solve many targets -> function of equations.c and additional flags. chain: each target waits for the previous
answer; batch: targets are independent; vector: several targets per instruction."""
ARM = ("arm", ("-DARM",))  # the same for independent hand poses

EQUATIONS = ("lean", "paper")
REALS = {"double": np.float64, "float": np.float32}


def compiler() -> str:
    """Return the path of the C compiler. Raises InputError if cc is not in PATH."""
    path = shutil.which("cc")
    if not path:
        raise InputError("no C compiler: cc is not in PATH (on Debian: apt-get install gcc)")
    return path


def compiler_version() -> str:
    text = subprocess.run([compiler(), "--version"], capture_output=True, text=True, check=False).stdout
    return text.splitlines()[0] if text else "cc"


@cache
def shared_object(equations: str, real: str, extra: tuple[str, ...]) -> ctypes.CDLL:
    """Compile and load a set of equations (lean or paper) for a C type. Raises InputError if compilation fails."""
    with tempfile.TemporaryDirectory(prefix="ik_") as folder:
        command = [compiler(), "-shared", "-fPIC", "-o", f"{folder}/equations.so", *FLAGS, *extra]
        command += [f"-DSOLVE={equations}", f"-DREAL={real}", str(SOURCE), "-lm"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            wrong = [line for line in done.stderr.splitlines() if "error" in line] or done.stderr.splitlines() or ["?"]
            raise InputError(f"cc cannot compile {SOURCE.name}: {wrong[0]}")
        return ctypes.CDLL(f"{folder}/equations.so")


class Solver:
    """C function that solves targets, bound to the targets' columns x, y, z, phi, d1, d2 (of hand poses, tool and qh as
    well) and to arrays for answers: six, or seven joints."""

    def __init__(self, columns: list[np.ndarray], equations: str = "lean", real: str = "double", way: str = "batch"):
        name, extra = (WAYS | {"arm": ARM})[way]
        self._function = getattr(shared_object(equations, real, extra), name)
        self._columns = [np.ascontiguousarray(column, dtype=REALS.get(real, np.longdouble)) for column in columns]
        self._answers = np.full((7 if way == "arm" else 6, len(columns[0])), np.nan, dtype=self._columns[0].dtype)

    def __call__(self, times: int = 1) -> np.ndarray:
        """Solve all targets ``times`` times; return the answers, (N, 6) or (N, 7)."""
        pointers = (ctypes.c_void_p(array.ctypes.data) for array in (*self._columns, *self._answers))
        self._function(ctypes.c_long(times), ctypes.c_long(len(self._columns[0])), *pointers)
        return self._answers.T
