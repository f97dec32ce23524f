# SPDX-License-Identifier: Apache-2.0
"""Software that solves the targets of table 6: C, numpy, numba, JAX.

Each solves its targets repeatedly. Libraries that solve a different problem from the core's are in
:mod:`scripts.paper.table6.others`.
"""

from __future__ import annotations

import importlib
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numpy as np

from model.io.words import FIELDS, RESULT_FIELDS, Targets
from model.reference import equations
from model.reference.kinematics import forward
from model.reference.lean_equations import solve_lean
from scripts.paper.table6.arrays import lean, lean_of
from scripts.paper.table6.compiled import EQUATIONS, REALS, WAYS, Software

CHUNK = 100_000
"""Targets per chunk in the error computation."""


@dataclass(frozen=True)
class Bound:
    """Contender bound to targets: ``again(times)`` solves them all ``times`` times, ``errors()`` returns hand error /
    reach (N,), nan where there is no answer."""

    again: Callable[[int], Any]
    errors: Callable[[], np.ndarray]


@dataclass(frozen=True)
class Contender:
    """Software in the comparison. ``bind`` binds it to targets; ``lacks`` names what is missing here, in which case it
    is skipped; ``most`` limits the number of random targets."""

    key: str
    group: str
    name: str
    bind: Callable[[Targets], Bound] | None
    lacks: str = ""
    most: int | None = None


def found(module: str) -> ModuleType | None:
    """Import an optional package; return None if it is missing or does not load."""
    try:
        return importlib.import_module(module)
    except (ImportError, OSError, RuntimeError):
        return None


def version(module: str) -> str:
    """Return the version of a package for the table."""
    package = found(module)
    return getattr(package, "__version__", "") if package else ""


def columns(targets: Targets) -> list[np.ndarray]:
    """Return the columns x, y, z, phi, d1, d2."""
    return [getattr(targets, name) for name in FIELDS]


def hand_errors(answers: np.ndarray, targets: Targets) -> np.ndarray:
    """Return the hand errors / reach (N,) of answers (N, 6)."""
    out = np.empty(len(targets))
    for start in range(0, len(targets), CHUNK):
        rows = slice(start, start + CHUNK)
        part = np.asarray(answers[rows], dtype=np.float64)
        wrist = forward(part[:, :4], part[:, 4:], targets.d1[rows], targets.d2[rows])[1]
        out[rows] = np.linalg.norm(wrist - targets.position[rows], axis=1) / targets.reach[rows]
    return out


def repeated(solve: Callable[[], Any]) -> Callable[[int], Any]:
    """Return a function that calls ``solve`` repeatedly and returns the last result."""

    def again(times: int) -> Any:
        result = None
        for _ in range(times):
            result = solve()
        return result

    return again


def of_arrays(solve: Callable[..., Any], targets: Targets, real: type) -> Bound:
    """Bind a function from six arrays to six arrays to targets."""
    given = [np.ascontiguousarray(c, dtype=real) for c in columns(targets)]

    def once() -> Any:
        with np.errstate(all="ignore"):
            return solve(*given)

    return Bound(repeated(once), lambda: hand_errors(np.stack(once(), axis=1), targets))


def in_c(software: Software) -> Iterator[Contender]:
    """Yield the single-threaded C variants."""
    for equations_ in EQUATIONS:
        for real in REALS:
            for way in WAYS:

                def bind(targets: Targets, equations_=equations_, way=way, real=real) -> Bound:
                    solve = software.way(equations_, way, real, columns(targets))
                    return Bound(solve, lambda: hand_errors(solve(1), targets))

                key = f"c-{equations_}-{real}-{way}"
                yield Contender(key, "C, one thread", f"{equations_}, {real}, {way}", bind)


def _of_model(solve: Callable[..., dict]) -> Callable[..., tuple]:
    def six(*given: np.ndarray) -> tuple:
        nodes = solve(*given)
        return tuple(nodes[name] for name in RESULT_FIELDS)

    return six


def in_numpy() -> Iterator[Contender]:
    """Yield the model's functions, which return flags and intermediate values, and the plain equations."""
    for key, name, solve in (
        ("numpy-model-lean", "lean, the model's `solve_lean`: exact sums, flags, every node", solve_lean),
        ("numpy-model-paper", "paper, the model's `equations.solve`: every node", equations.solve),
    ):
        yield Contender(key, "numpy", name, lambda t, s=solve: of_arrays(_of_model(s), t, np.float64))
    for real, kind in REALS.items():
        plain = lean_of(np, kind)
        yield Contender(
            f"numpy-{real}", "numpy", f"lean, {real}", lambda t, plain=plain, kind=kind: of_arrays(plain, t, kind)
        )


def _choose(condition: Any, yes: Any, no: Any) -> Any:
    return yes if condition else no


def _numba_solve(kind: type) -> Callable[..., Any]:
    """Return a function from six arrays to six, a loop compiled by numba."""
    numba = found("numba")
    inline = numba.njit(inline="always")
    one = inline(lean(kind, math.sqrt, math.sin, math.cos, inline(_choose)))

    @numba.njit(error_model="numpy")
    def loop(x, y, z, phi, d1, d2, out):
        for k in range(len(x)):
            q = one(x[k], y[k], z[k], phi[k], d1[k], d2[k])
            out[0, k], out[1, k], out[2, k], out[3, k], out[4, k], out[5, k] = q

    room: dict[int, np.ndarray] = {}

    def solve(*given: np.ndarray) -> Any:
        count = len(given[0])
        loop(*given, room.setdefault(count, np.empty((6, count), dtype=kind)))
        return room[count]

    return solve


def in_numba() -> Iterator[Contender]:
    """Yield the plain equations, one target at a time."""
    lacks = "" if found("numba") else "not installed"
    for real, kind in REALS.items():
        yield Contender(
            f"numba-{real}",
            f"numba {version('numba')}".strip(),
            f"lean, {real}, a loop, one thread",
            lambda t, kind=kind: of_arrays(_numba_solve(kind), t, kind),
            lacks,
        )


def _jax_bound(targets: Targets, device: Any, kind: type) -> Bound:
    jax = found("jax")
    given = [jax.device_put(c.astype(kind), device) for c in columns(targets)]
    compiled = jax.jit(lean_of(found("jax.numpy"), kind))

    def once() -> Any:
        return jax.block_until_ready(compiled(*given))

    once()  # compiles
    return Bound(repeated(once), lambda: hand_errors(np.stack([np.asarray(c) for c in once()], axis=1), targets))


def in_jax() -> Iterator[Contender]:
    """Yield the plain equations compiled by XLA; targets and answers stay on the device."""
    jax, devices = found("jax"), {}
    if jax:
        jax.config.update("jax_enable_x64", True)
        for platform in ("cpu", "gpu"):
            try:
                devices[platform] = jax.devices(platform)[0]
            except RuntimeError:  # no such device
                continue
    group = f"JAX {version('jax')}".strip()
    for platform, absent in (("cpu", "no CPU backend here"), ("gpu", "no GPU here")):
        device = devices.get(platform)
        lacks = "not installed" if not jax else absent if device is None else ""
        where = "CPU, all cores" if platform == "cpu" else f"GPU{f', {device.device_kind}' if device else ''}"
        for real, kind in REALS.items():
            yield Contender(
                f"jax-{platform}-{real}",
                group,
                f"lean, {real}, {where}",
                lambda t, device=device, kind=kind: _jax_bound(t, device, kind),
                lacks,
            )
