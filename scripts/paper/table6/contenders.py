# SPDX-License-Identifier: Apache-2.0
"""Software in table 6: C, numpy, JAX and EAIK. Each solves its targets repeatedly.

The lean equations for arrays are made from the table of :mod:`model.reference.lean_equations`. Like equations.c, they
are for targets in reach: each sum is rounded and there are no flags.

EAIK solves another problem than ours, which is to find one pose from the hand's position and the swivel angle. It
solves this arm in closed form, but from the full pose of the hand. It gets the forearm's frame of the model's answer,
which contains the swivel angle, and returns all sets of joint angles; the smallest hand error counts.
"""

import importlib
import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from types import ModuleType
from typing import Any

import numpy as np
import sympy
from sympy.printing.pycode import PythonCodePrinter

from model.io.scoring import hand_errors
from model.io.words import FIELDS, LENGTHS, RESULT_FIELDS, Targets
from model.reference.cga import symbol
from model.reference.kinematics import forward, matrix, multiply
from model.reference.lean_equations import LEAN, solve_lean
from scripts.paper.derivation.proofs import parse, rsqrt
from scripts.paper.table6.compiled import EQUATIONS, REALS, WAYS, Solver

Bound = tuple[Callable[[int], Any], Callable[[], np.ndarray]]
"""Software bound to targets: a function that solves them all a number of times, and one that returns hand error / reach
(N,), nan where there is no answer."""


@dataclass(frozen=True)
class Contender:
    """Software in the comparison. ``bind`` binds it to targets; ``lacks`` names what is missing here, in which case it
    is skipped; ``most`` limits the number of random targets."""

    key: str
    group: str
    name: str
    bind: Callable[[Targets], Bound]
    lacks: str = ""
    most: int | None = None


def found(module: str) -> ModuleType | None:
    """Import an optional package; return None if it is missing or does not load."""
    try:
        return importlib.import_module(module)
    except (ImportError, OSError, RuntimeError):
        return None


def columns(targets: Targets) -> list[np.ndarray]:
    """Return the columns x, y, z, phi, d1, d2."""
    return [getattr(targets, name) for name in FIELDS]


def _repeated(solve: Callable[[], Any], errors: Callable[[Any], np.ndarray]) -> Bound:
    """Bind a function that solves all targets once; ``errors`` takes its result."""

    def again(times: int = 1) -> Any:
        with np.errstate(all="ignore"):
            for _ in range(times):
                answers = solve()
        return answers

    return again, lambda: errors(again())


CHEAPER = {
    "root_far": "sqrt(where(a_far > zero, a_far, zero))",
    "root_near": "sqrt(where(b_near > zero, b_near, zero))",
    "inv_12": "half/sqrt(d1*d2)",
    "inv_law": "half*inv_s/d1",
    "az_c": "where(u_y <= zero, az_sq, half*u_x)",
    "az_s": "where(u_y <= zero, half*u_x, az_sq)",
    "inv_q": "where(k_1 < zero, -one, one)/sqrt(length_sq)",
}
"""Lines with other arithmetic: a library has roots, and computes a reciprocal root as 1/sqrt. `az_sq` is a part of the
half angle quaternion, and the sign of Qs belongs to `inv_q`."""


def lines() -> list[tuple[sympy.Symbol, sympy.Expr]]:
    """Return the lines that the results need. Numbers are symbols, so that they can have the arrays' type."""
    zero, half, one, where = *map(symbol, ("zero", "half", "one")), sympy.Function("where")
    found, needed = [], {*map(symbol, RESULT_FIELDS)}
    for name, text in reversed([line for group in LEAN.values() for line in group.items()]):
        if symbol(name) not in needed:
            continue
        length_sq = symbol(name[:-1] + "sq")  # of half an angle's quaternion: half_c, half_s
        halves = {part: partial(sympy.Function(part), length_sq) for part in ("half_c", "half_s")}
        value = parse(CHEAPER.get(name, text), halves | {"where": where})
        if name not in CHEAPER:
            value = value.xreplace({sympy.S.Half: half}).replace(rsqrt, lambda v: one / sympy.sqrt(v))
        value = value.replace(sympy.Function("half_c"), lambda large, c, s: where(c >= zero, large, half * s))
        value = value.replace(sympy.Function("half_s"), lambda large, c, s: where(c >= zero, half * s, large))
        found.append((symbol(name), value))
        needed |= value.free_symbols
    return found[::-1]


def lean_of(library: Any, real: Any) -> Callable[..., tuple]:
    """Return a solver (x, y, z, phi, d1, d2) -> (qs_w, qs_i, qs_j, qs_k, qe_w, qe_i) for a library with numpy's
    function names, all of type `real`; an integer among floats would promote them to double."""
    functions = {name: getattr(library, name) for name in ("sqrt", "sin", "cos", "where")}
    names = functions | {"zero": real(0), "half": real(0.5), "one": real(1)}
    results = tuple(map(symbol, RESULT_FIELDS))
    printer = PythonCodePrinter({"fully_qualified_modules": False, "allow_unknown_functions": True, "order": "none"})
    return sympy.lambdify([*map(symbol, FIELDS)], results, [names], printer, cse=lambda _: (lines(), results))


def _bind_c(equations_: str, real: str, way: str, targets: Targets) -> Bound:
    solve = Solver(columns(targets), equations_, real, way)
    return solve, lambda: hand_errors(solve(), targets)


def _bind_numpy(kind: type, targets: Targets) -> Bound:
    solve, given = lean_of(np, kind), [np.ascontiguousarray(c, dtype=kind) for c in columns(targets)]
    return _repeated(lambda: solve(*given), lambda answers: hand_errors(np.stack(answers, axis=1), targets))


def _bind_jax(device: Any, kind: type, targets: Targets) -> Bound:
    jax = found("jax")
    given = [jax.device_put(c.astype(kind), device) for c in columns(targets)]
    compiled = jax.jit(lean_of(found("jax.numpy"), kind))
    return _repeated(
        lambda: jax.block_until_ready(compiled(*given)),
        lambda answers: hand_errors(np.stack([np.asarray(c) for c in answers], axis=1), targets),
    )


def _jax() -> Iterator[Contender]:
    """Yield the lean equations compiled by XLA; targets and answers stay on the device."""
    jax = found("jax")
    for platform, where, lacks in (("cpu", "CPU, all cores", "no CPU backend here"), ("gpu", "GPU", "no GPU here")):
        device = None
        if jax:
            jax.config.update("jax_enable_x64", True)
            try:
                device, lacks = jax.devices(platform)[0], ""
            except RuntimeError:  # no such device
                pass
        if device and platform == "gpu":
            where += f", {device.device_kind}"
        for real, kind in REALS.items():
            group, bind = f"JAX {jax.__version__}" if jax else "JAX", partial(_bind_jax, device, kind)
            lacks = lacks if jax else "not installed"
            yield Contender(f"jax-{platform}-{real}", group, f"lean, {real}, {where}", bind, lacks)


def _hand_poses(targets: Targets) -> np.ndarray:
    """Return the forearm's frame at the wrist in the model's pose, (N, 4, 4)."""
    pose = solve_lean(*columns(targets))
    qs = np.stack([pose[f"qs_{unit}"] for unit in "wijk"], axis=1)
    qe = np.stack([pose["qe_w"], pose["qe_i"], *np.zeros((2, len(targets)))], axis=1)
    frames = np.zeros((len(targets), 4, 4))
    frames[:, :3, :3] = matrix(multiply(qs, qe))
    frames[:, :3, 3] = forward(qs, qe[:, :2], targets.d1, targets.d2)[1]
    frames[:, 3, 3] = 1
    return frames


def _bind_eaik(targets: Targets) -> Bound:
    """Scale targets and arms to a reach of 1, since EAIK has tolerances in units of length, and make the robots, one an
    arm, before the timing starts."""
    targets = replace(targets, **{name: getattr(targets, name) / targets.reach for name in LENGTHS})
    x, y, z = np.eye(3)
    none, robot_of = np.zeros(3), found("eaik.IK_HP").HPRobot
    # Shoulder, elbow. With z as the third axis, which also meets the elbow's, EAIK 1.2.2 misclassifies the arm and
    # misses the pose by half the reach.
    axes, arms = np.array([z, x, y, x]), list(zip(targets.d1.tolist(), targets.d2.tolist(), strict=True))
    robots = {(d1, d2): robot_of(axes, np.array([none, none, none, d1 * z, -d2 * z])) for d1, d2 in set(arms)}
    asked = [(robots[arm], pose) for arm, pose in zip(arms, _hand_poses(targets), strict=True)]

    def errors(solutions: list) -> np.ndarray:
        found = []
        for (robot, _), solution, position in zip(asked, solutions, targets.position, strict=True):
            hands = (robot.fwdKin(angles)[:3, 3] for angles in solution.Q)
            found.append(min((float(np.linalg.norm(hand - position)) for hand in hands), default=np.nan))
        return np.array(found)

    return _repeated(lambda: [robot.IK(pose) for robot, pose in asked], errors)


def contenders() -> list[Contender]:
    """Return all software in table order."""
    every = [
        Contender(f"c-{'-'.join(names)}", "C, one thread", ", ".join(names), partial(_bind_c, *names))
        for names in itertools.product(EQUATIONS, REALS, WAYS)
    ]
    for real, kind in REALS.items():
        every.append(Contender(f"numpy-{real}", "numpy", f"lean, {real}", partial(_bind_numpy, kind)))
    lacks = "" if found("eaik.IK_HP") else "not installed"
    pose = "4 joints, the hand's whole pose given, all solutions"
    return [*every, *_jax(), Contender("eaik", "EAIK", pose, _bind_eaik, lacks, 1000)]
