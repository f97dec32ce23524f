# SPDX-License-Identifier: Apache-2.0
"""Software in table 6: C, numpy, numba, JAX, EAIK and ikpy. Each solves its targets repeatedly.

EAIK and ikpy solve different problems from ours, which is to find one pose from the hand's position and the swivel
angle. EAIK solves this arm in closed form, but from the full pose of the hand. It gets the forearm's frame of the
model's answer, which contains the swivel angle, and returns all sets of joint angles; the smallest hand error counts.
ikpy searches from a fixed start, given only the hand's position, and finds some elbow.
"""

from __future__ import annotations

import importlib
import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from types import ModuleType
from typing import Any

import numpy as np

from model.io.words import FIELDS, LENGTHS, RESULT_FIELDS, Targets
from model.reference import equations
from model.reference.kinematics import forward, matrix, multiply
from model.reference.lean_equations import solve_lean
from scripts.paper.table6.arrays import lean, lean_of
from scripts.paper.table6.compiled import EQUATIONS, REALS, WAYS, Solver


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
    bind: Callable[[Targets], Bound]
    lacks: str = ""
    most: int | None = None


def found(module: str) -> ModuleType | None:
    """Import an optional package; return None if it is missing or does not load."""
    try:
        return importlib.import_module(module)
    except (ImportError, OSError, RuntimeError):
        return None


def _titled(module: str, title: str = "") -> str:
    """Return the name of a package with its version, if installed."""
    return f"{title or module} {getattr(found(module), '__version__', '')}".strip()


def columns(targets: Targets) -> list[np.ndarray]:
    """Return the columns x, y, z, phi, d1, d2."""
    return [getattr(targets, name) for name in FIELDS]


def first(targets: Targets, count: int | None) -> Targets:
    """Return the first ``count`` targets."""
    return replace(targets, **{name: getattr(targets, name)[:count] for name in FIELDS})


def hand_errors(answers: np.ndarray, targets: Targets) -> np.ndarray:
    """Return the hand errors / reach (N,) of answers (N, 6)."""
    answers = np.asarray(answers, dtype=np.float64)
    wrist = forward(answers[:, :4], answers[:, 4:], targets.d1, targets.d2)[1]
    return np.linalg.norm(wrist - targets.position, axis=1) / targets.reach


def _repeated(solve: Callable[[], Any], errors: Callable[[Any], np.ndarray]) -> Bound:
    """Bind a function that solves all targets once; ``errors`` takes its result."""

    def again(times: int) -> None:
        for _ in range(times):
            solve()

    return Bound(again, lambda: errors(solve()))


# -- functions from six arrays to six arrays -------------------------------------------------------


def _bind_c(equations_: str, real: str, way: str, targets: Targets) -> Bound:
    solve = Solver(columns(targets), equations_, real, way)
    return Bound(solve, lambda: hand_errors(solve(1), targets))


def _bind_arrays(make: Callable[[], Callable[..., Any]], kind: type, targets: Targets) -> Bound:
    solve, given = make(), [np.ascontiguousarray(c, dtype=kind) for c in columns(targets)]

    def once() -> Any:
        with np.errstate(all="ignore"):
            return solve(*given)

    return _repeated(once, lambda answers: hand_errors(np.stack(answers, axis=1), targets))


def _of_model(solve: Callable[..., dict], *given: np.ndarray) -> tuple:
    nodes = solve(*given)
    return tuple(nodes[name] for name in RESULT_FIELDS)


def _choose(condition: Any, yes: Any, no: Any) -> Any:
    return yes if condition else no


def _numba_solve(kind: type) -> Callable[..., Any]:
    """Return a function from six arrays to six, a loop compiled by numba."""
    numba = found("numba")
    inline = numba.njit(inline="always")
    one = inline(lean(kind, sqrt=math.sqrt, sin=math.sin, cos=math.cos, where=inline(_choose)))

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


def _bind_jax(device: Any, kind: type, targets: Targets) -> Bound:
    jax = found("jax")
    given = [jax.device_put(c.astype(kind), device) for c in columns(targets)]
    compiled = jax.jit(lean_of(found("jax.numpy"), kind))
    jax.block_until_ready(compiled(*given))
    return _repeated(
        lambda: jax.block_until_ready(compiled(*given)),
        lambda answers: hand_errors(np.stack([np.asarray(c) for c in answers], axis=1), targets),
    )


def in_c() -> Iterator[Contender]:
    """Yield the single-threaded C variants."""
    for names in itertools.product(EQUATIONS, REALS, WAYS):
        yield Contender(f"c-{'-'.join(names)}", "C, one thread", ", ".join(names), partial(_bind_c, *names))


def in_numpy() -> Iterator[Contender]:
    """Yield the model's functions, which return flags and intermediate values, and the plain equations."""
    for key, name, solve in (
        ("numpy-model-lean", "lean, the model's `solve_lean`: exact sums, flags, every node", solve_lean),
        ("numpy-model-paper", "paper, the model's `equations.solve`: every node", equations.solve),
    ):
        make = partial(partial, _of_model, solve)
        yield Contender(key, "numpy", name, partial(_bind_arrays, make, np.float64))
    for real, kind in REALS.items():
        bind = partial(_bind_arrays, partial(lean_of, np, kind), kind)
        yield Contender(f"numpy-{real}", "numpy", f"lean, {real}", bind)


def in_numba() -> Iterator[Contender]:
    """Yield the plain equations, one target at a time."""
    lacks, group = "" if found("numba") else "not installed", _titled("numba")
    for real, kind in REALS.items():
        bind = partial(_bind_arrays, partial(_numba_solve, kind), kind)
        yield Contender(f"numba-{real}", group, f"lean, {real}, a loop, one thread", bind, lacks)


def in_jax() -> Iterator[Contender]:
    """Yield the plain equations compiled by XLA; targets and answers stay on the device."""
    jax, group = found("jax"), _titled("jax", "JAX")
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
            bind = partial(_bind_jax, device, kind)
            name = f"lean, {real}, {where}"
            yield Contender(f"jax-{platform}-{real}", group, name, bind, lacks if jax else "not installed")


# -- libraries that solve another problem ----------------------------------------------------------

X, Y, Z = np.eye(3)
NONE = np.zeros(3)


def _of_reach_1(targets: Targets) -> Targets:
    """Scale targets and arms to a reach of 1: both libraries have tolerances in units of length."""
    return replace(targets, **{name: getattr(targets, name) / targets.reach for name in LENGTHS})


def _asked(make: Callable[[float, float], Any], targets: Targets, goals: np.ndarray) -> list[tuple[Any, np.ndarray]]:
    """Return the robot and the goal of each target; robots are made once per arm, before the timing starts."""
    arms = list(zip(targets.d1.tolist(), targets.d2.tolist(), strict=True))
    made = {arm: make(*arm) for arm in set(arms)}
    return [(made[arm], goal) for arm, goal in zip(arms, goals, strict=True)]


def _error(hands: list[np.ndarray], position: np.ndarray) -> float:
    """Return the smallest distance of some hands from a position, nan without a hand."""
    return min((float(np.linalg.norm(hand - position)) for hand in hands), default=np.nan)


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
    targets = _of_reach_1(targets)
    # Shoulder, elbow. With z as the third axis, which also meets the elbow's, EAIK 1.2.2 misclassifies the arm and
    # misses the pose by half the reach.
    axes, robot_of = np.array([Z, X, Y, X]), found("eaik.IK_HP").HPRobot
    asked = _asked(
        lambda d1, d2: robot_of(axes, np.array([NONE, NONE, NONE, d1 * Z, -d2 * Z])), targets, _hand_poses(targets)
    )

    def errors(solutions: list) -> np.ndarray:
        hands = ([r.fwdKin(q)[:3, 3] for q in s.Q] for (r, _), s in zip(asked, solutions, strict=True))
        return np.array([*map(_error, hands, targets.position)])

    return _repeated(lambda: [robot.IK(pose) for robot, pose in asked], errors)


def _ikpy_chain(d1: float, d2: float) -> Any:
    link, chain = found("ikpy.link"), found("ikpy.chain")
    joints = [("azimuth", 0, Z), ("elevation", 0, X), ("upper arm", 0, Z), ("elbow", d1, X)]
    links = [link.URDFLink(name, [0, 0, along], [0, 0, 0], rotation=axis) for name, along, axis in joints]
    hand = link.URDFLink("hand", [0, 0, -d2], [0, 0, 0], joint_type="fixed")
    moves = [False, *(True for _ in joints), False]
    return chain.Chain([link.OriginLink(), *links, hand], active_links_mask=moves)


def _bind_ikpy(targets: Targets) -> Bound:
    targets = _of_reach_1(targets)
    asked = _asked(_ikpy_chain, targets, targets.position)
    start = [0, 0.1, 0.5, 0.1, 2, 0]  # a bent arm

    def errors(angles: list) -> np.ndarray:
        hands = ([c.forward_kinematics(q)[:3, 3]] for (c, _), q in zip(asked, angles, strict=True))
        return np.array([*map(_error, hands, targets.position)])

    return _repeated(lambda: [chain.inverse_kinematics(p, initial_position=start) for chain, p in asked], errors)


def others() -> Iterator[Contender]:
    """Yield EAIK and ikpy; both are slow."""
    for key, group, module, name, bind, most in (
        ("eaik", "EAIK", "eaik.IK_HP", "4 joints, the hand's whole pose given, all solutions", _bind_eaik, 1000),
        ("ikpy", "ikpy", "ikpy.chain", "4 joints, the hand's place given, any elbow, by search", _bind_ikpy, 20),
    ):
        yield Contender(key, group, name, bind, "" if found(module) else "not installed", most)


def contenders() -> list[Contender]:
    """Return all software in table order."""
    return [*in_c(), *in_numpy(), *in_numba(), *in_jax(), *others()]
