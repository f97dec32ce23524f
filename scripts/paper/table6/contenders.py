# SPDX-License-Identifier: Apache-2.0
"""Software in table 6: C, numpy, JAX and EAIK. Each solves its targets repeatedly.

For numpy and JAX, the lean equations of equations.c are written for arrays, without flags; targets must be in reach.
Unlike the model's functions, these equations round every sum.

C, numpy and JAX find one pose from the hand's position and the swivel angle. EAIK solves another problem: in closed
form, it finds all sets of joint angles of this arm from the full pose of the last link. Here this is the forearm's
frame in the model's answer; this frame depends on the swivel angle. Among EAIK's solutions, the smallest hand error
counts.
"""

import contextlib
import ctypes
import importlib
import itertools
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np

from model.io.scoring import hand_errors
from model.io.words import FIELDS, LENGTHS, Targets
from model.reference.joints import reached
from model.reference.kinematics import forward, matrix, multiply
from model.reference.lean_equations import solve_lean
from scripts.console import InputError

SOURCE = Path(__file__).parent / "equations.c"

FLAGS = ("-std=gnu11", "-O3", "-march=native", "-fno-math-errno", "-fno-trapping-math")
"""The last two flags let loops with roots and selections be vectorized. They do not change the results."""

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
    """Compile and load equations (lean or paper) with C type ``real``. Raises InputError if compilation fails."""
    with tempfile.TemporaryDirectory(prefix="ik_") as folder:
        command = [compiler(), "-shared", "-fPIC", "-o", f"{folder}/equations.so", *FLAGS, *extra]
        command += [f"-DSOLVE={equations}", f"-DREAL={real}", str(SOURCE), "-lm"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            wrong = [line for line in done.stderr.splitlines() if "error" in line] or done.stderr.splitlines() or ["?"]
            raise InputError(f"cc cannot compile {SOURCE.name}: {wrong[0]}")
        return ctypes.CDLL(f"{folder}/equations.so")


def solver(
    columns: list[np.ndarray], equations: str = "lean", real: str = "double", way: str = "batch"
) -> Callable[..., np.ndarray]:
    """Return a function solve(times=1) that solves all targets ``times`` times in C and returns answers (N, 6), or
    joints (N, 7) of hand poses. ``columns``: x, y, z, phi, d1, d2, (N,) each; for hand poses also tool and qh."""
    name, extra = (WAYS | {"arm": ARM})[way]
    function = getattr(shared_object(equations, real, extra), name)
    inputs = [np.ascontiguousarray(column, dtype=REALS.get(real, np.longdouble)) for column in columns]
    answers = np.full((7 if way == "arm" else 6, len(columns[0])), np.nan, dtype=inputs[0].dtype)

    def solve(times: int = 1) -> np.ndarray:
        pointers = (ctypes.c_void_p(array.ctypes.data) for array in (*inputs, *answers))
        function(ctypes.c_long(times), ctypes.c_long(len(inputs[0])), *pointers)
        return answers.T

    return solve


Bound = tuple[Callable[[int], Any], Callable[[], np.ndarray]]
"""Software bound to N targets: a function that solves all targets a given number of times, and a function that returns
the hand errors / reach (N,), nan for a target without an answer."""


class Contender(NamedTuple):
    """Software in the comparison. ``bind`` binds the software to targets. If ``lacks`` is not empty, it names what is
    missing on this computer, and the software is not measured. ``most`` limits the number of random targets."""

    key: str
    group: str
    name: str
    bind: Callable[[Targets], Bound]
    lacks: str = ""
    most: int | None = None


def found(module: str) -> ModuleType | None:
    """Import and return an optional module; return None if it is missing or does not load."""
    try:
        return importlib.import_module(module)
    except (ImportError, OSError, RuntimeError):
        return None


def columns(targets: Targets) -> list[np.ndarray]:
    """Return the columns x, y, z, phi, d1, d2 of targets, (N,) each."""
    return [getattr(targets, name) for name in FIELDS]


def _repeated(solve: Callable[[], Any], errors: Callable[[Any], np.ndarray]) -> Bound:
    """Return a :class:`Bound` from ``solve``, which solves all targets once, and ``errors``, which maps the result of
    ``solve`` to hand errors (N,)."""

    def again(times: int = 1) -> Any:
        with np.errstate(all="ignore"):
            for _ in range(times):
                answers = solve()
        return answers

    return again, lambda: errors(again())


def lean(library: Any, x: Any, y: Any, z: Any, phi: Any, d1: Any, d2: Any) -> tuple:
    """Solve the lean equations for arrays of ``library``, numpy or jax.numpy; return the six results."""
    sqrt, where = library.sqrt, library.where
    d_sum, d_dif = d1 + d2, d1 - d2
    rho_sq = x * x + y * y
    s = rho_sq + z * z
    inv_rho, inv_s = 1 / sqrt(rho_sq), 1 / sqrt(s)
    root_far, root_near = (sqrt(library.maximum(v, 0)) for v in (d_sum * d_sum - s, s - d_dif * d_dif))
    inv_12, inv_law = 0.5 / sqrt(d1 * d2), 0.5 * inv_s / d1
    u_x, u_y, sin_el, cos_el = x * inv_rho, y * inv_rho, z * inv_s, rho_sq * inv_rho * inv_s
    cos_bend, sin_bend = (s + d_sum * d_dif) * inv_law, root_far * root_near * inv_law

    def half(c: Any, s: Any) -> tuple[Any, Any, Any]:
        """Return the parts and the squared length of quaternion h(c, s) in model/dataflow/lean_operations.py."""
        square = 0.5 + 0.5 * abs(c)
        return where(c >= 0, square, 0.5 * s), where(c >= 0, 0.5 * s, square), square

    (az_c, az_s, az_sq), (tilt_c, tilt_s, tilt_sq) = half(-u_y, u_x), half(sin_el, cos_el)
    bend_c, bend_s, bend_sq = half(cos_bend, sin_bend)
    sin_h, cos_h = library.sin(0.5 * phi), library.cos(0.5 * phi)
    cc, ss, sc, cs = az_c * cos_h, az_s * sin_h, az_s * cos_h, az_c * sin_h
    w_0, i_0, j_0, k_0 = tilt_c * (cc - ss), tilt_s * (cc + ss), tilt_s * (sc - cs), tilt_c * (sc + cs)
    w_1, i_1 = w_0 * bend_c + i_0 * bend_s, i_0 * bend_c - w_0 * bend_s
    j_1, k_1 = j_0 * bend_c - k_0 * bend_s, k_0 * bend_c + j_0 * bend_s
    length = sqrt(az_sq * tilt_sq * bend_sq)
    inv_q = 1 / where(k_1 < 0, -length, length)
    return w_1 * inv_q, i_1 * inv_q, j_1 * inv_q, k_1 * inv_q, root_far * inv_12, -root_near * inv_12


def joints(library: Any, x: Any, y: Any, z: Any, phi: Any, d1: Any, d2: Any, tool: Any, *hand: Any) -> tuple:
    """Return the seven joint angles of hand poses, as function ``arm`` in equations.c does."""
    w, i, j, k = hand
    x, y = x - 2 * (i * k + w * j) * tool, y - 2 * (j * k - w * i) * tool
    *qs, s, c = lean(library, x, y, z - ((w * w + k * k) - (i * i + j * j)) * tool, phi, d1, d2)
    v, f, g, h = (qs[0] * -c - qs[1] * s, qs[0] * s - qs[1] * c, qs[2] * -c + qs[3] * s, -qs[3] * c - qs[2] * s)

    def zxz(w: Any, i: Any, j: Any, k: Any) -> tuple[Any, Any, Any]:
        a, b = library.arctan2(k, w), library.arctan2(j, i)
        return a + b, 2 * library.arctan2(library.sqrt(i * i + j * j), library.sqrt(w * w + k * k)), a - b

    wrist = v * w + f * i + g * j + h * k, v * i - f * w - g * k + h * j, v * j - g * w - h * i + f * k
    return *zxz(*qs), 2 * library.arctan2(s, -c), *zxz(*wrist, v * k - h * w - f * j + g * i)


def poses(targets: Targets) -> list[np.ndarray]:
    """Return the columns of hand poses, (N,) each. Each pose has the wrist of a target, a random orientation,
    and a tool as long as the forearm."""
    hand = np.random.default_rng(1).standard_normal((4, len(targets)))
    w, i, j, k = hand = hand / np.linalg.norm(hand, axis=0)
    tool = targets.d2
    axis = np.array((2 * (i * k + w * j), 2 * (j * k - w * i), (w * w + k * k) - (i * i + j * j)))
    return [*(targets.position.T + axis * tool), targets.phi, targets.d1, targets.d2, tool, *hand]


def arm_errors(answers: Any, targets: Targets) -> np.ndarray:
    """Return the errors of the hand's point / (d1 + d2 + tool), (N,), for joints (7, N) that solve :func:`poses`."""
    pose, zero = np.array(poses(targets)), np.zeros(len(targets))
    tool = np.stack((zero, zero, targets.d2), axis=1)
    point, _ = reached(np.asarray(answers, dtype=float), targets.d1, targets.d2, tool)
    return np.linalg.norm(point - pose[:3].T, axis=1) / (targets.reach + targets.d2)


KINDS = {
    "": (lean, columns, lambda answers, targets: hand_errors(np.stack(answers, axis=1), targets)),
    "-arm": (joints, poses, arm_errors),
}
"""Part of a contender's key -> functions: equations for arrays, inputs of targets, hand errors of answers."""
NAMES = {"": "lean", "-arm": "whole arm, seven joints"}


def _bind_c(key: str, equations: str, real: str, way: str, targets: Targets) -> Bound:
    _, inputs, errors = KINDS[key]
    solve = solver(inputs(targets), equations, real, way)
    return solve, lambda: errors(solve().T, targets)


def _bind_numpy(kind: type, key: str, targets: Targets) -> Bound:
    solve, inputs, errors = KINDS[key]
    arrays = [np.ascontiguousarray(c, dtype=kind) for c in inputs(targets)]
    return _repeated(lambda: solve(np, *arrays), lambda answers: errors(answers, targets))


def _bind_jax(device: Any, kind: type, key: str, targets: Targets) -> Bound:
    jax, (solve, inputs, errors) = found("jax"), KINDS[key]
    arrays = [jax.device_put(c.astype(kind), device) for c in inputs(targets)]
    compiled = jax.jit(partial(solve, found("jax.numpy")))
    return _repeated(
        lambda: jax.block_until_ready(compiled(*arrays)),
        lambda answers: errors([np.asarray(c) for c in answers], targets),
    )


def _jax() -> Iterator[Contender]:
    """Yield the contenders that use JAX: XLA compiles the equations; targets and answers stay on the device."""
    jax = found("jax")
    for platform, where, lacks in (("cpu", "CPU, all cores", "no CPU backend here"), ("gpu", "GPU", "no GPU here")):
        device = None
        if jax:
            jax.config.update("jax_enable_x64", True)
            with contextlib.suppress(RuntimeError):  # no such device
                device, lacks = jax.devices(platform)[0], ""
        if device and platform == "gpu":
            where += f", {device.device_kind}"
        for (key, name), (real, kind) in itertools.product(NAMES.items(), REALS.items()):
            group, bind = f"JAX {jax.__version__}" if jax else "JAX", partial(_bind_jax, device, kind, key)
            lacks = lacks if jax else "not installed"
            yield Contender(f"jax-{platform}{key}-{real}", group, f"{name}, {real}, {where}", bind, lacks)


def _hand_poses(targets: Targets) -> np.ndarray:
    """Return the frames (N, 4, 4) of the forearm at the wrist in the model's solutions of the targets."""
    pose = solve_lean(*columns(targets))
    qs = np.stack([pose[f"qs_{unit}"] for unit in "wijk"], axis=1)
    qe = np.stack([pose["qe_w"], pose["qe_i"], *np.zeros((2, len(targets)))], axis=1)
    frames = np.zeros((len(targets), 4, 4))
    frames[:, :3, :3] = matrix(multiply(qs, qe))
    frames[:, :3, 3] = forward(qs, qe[:, :2], targets.d1, targets.d2)[1]
    frames[:, 3, 3] = 1
    return frames


def _bind_eaik(targets: Targets) -> Bound:
    """Bind EAIK to targets, scaled to a reach of 1 because EAIK's tolerances are lengths. The robots, one per pair of
    bone lengths, are made here, before the timing starts."""
    targets = replace(targets, **{name: getattr(targets, name) / targets.reach for name in LENGTHS})
    x, y, z = np.eye(3)
    none, robot_of = np.zeros(3), found("eaik.IK_HP").HPRobot
    # Three axes of the shoulder, then the elbow's. If the third were z, which also meets the elbow's axis, EAIK 1.2.2
    # would misclassify the arm and miss the pose by half the reach.
    axes, arms = np.array([z, x, y, x]), list(zip(targets.d1.tolist(), targets.d2.tolist(), strict=True))
    robots = {(d1, d2): robot_of(axes, np.array([none, none, none, d1 * z, -d2 * z])) for d1, d2 in set(arms)}
    asked = [(robots[arm], pose) for arm, pose in zip(arms, _hand_poses(targets), strict=True)]

    def errors(solutions: list) -> np.ndarray:
        distances = []
        for (robot, _), solution, position in zip(asked, solutions, targets.position, strict=True):
            hands = (robot.fwdKin(angles)[:3, 3] for angles in solution.Q)
            distances.append(min((float(np.linalg.norm(hand - position)) for hand in hands), default=np.nan))
        return np.array(distances)

    return _repeated(lambda: [robot.IK(pose) for robot, pose in asked], errors)


def contenders() -> list[Contender]:
    every = [
        Contender(f"c-{'-'.join(names)}", "C, one thread", ", ".join(names), partial(_bind_c, "", *names))
        for names in itertools.product(EQUATIONS, REALS, WAYS)
    ]
    for real in REALS:
        name = f"{NAMES['-arm']}, {real}, vector"
        bind = partial(_bind_c, "-arm", "lean", real, "arm")
        every.append(Contender(f"c-arm-{real}", "C, one thread", name, bind))
    for (key, name), (real, kind) in itertools.product(NAMES.items(), REALS.items()):
        every.append(Contender(f"numpy{key}-{real}", "numpy", f"{name}, {real}", partial(_bind_numpy, kind, key)))
    lacks = "" if found("eaik.IK_HP") else "not installed"
    pose = "4 joints, the hand's whole pose given, all solutions"
    return [*every, *_jax(), Contender("eaik", "EAIK", pose, _bind_eaik, lacks, 1000)]
