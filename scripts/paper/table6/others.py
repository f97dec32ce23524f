# SPDX-License-Identifier: Apache-2.0
"""EAIK and ikpy on our arm, set up as close to our problem as they allow.

Our problem: find one pose from the hand's position and the swivel angle. EAIK solves this arm in closed form, but from
the full pose of the hand. It gets the forearm's frame of the model's answer, which contains the swivel angle, and
returns all sets of joint angles; the smallest hand error counts. ikpy searches from a fixed start, given only the
hand's position, and finds some elbow. Both have tolerances in units of length, so each arm is scaled to a reach of 1.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from model.io.words import FIELDS, LENGTHS, Targets
from model.reference.kinematics import forward, matrix, multiply
from model.reference.lean_equations import solve_lean
from scripts.paper.table6.contenders import Bound, Contender, columns, found, repeated

FEW = {"eaik": 1000, "ikpy": 20}
"""Number of random targets. Each has its own arm, built before the timing starts, and both libraries are slow."""

X, Y, Z = np.eye(3)
NONE = np.zeros(3)


def first(targets: Targets, count: int) -> Targets:
    """Return the first ``count`` targets."""
    return replace(targets, **{name: getattr(targets, name)[:count] for name in FIELDS})


def of_reach_1(targets: Targets) -> Targets:
    """Scale targets and arms to a reach of 1."""
    return replace(targets, **{name: getattr(targets, name) / targets.reach for name in LENGTHS})


def arms(targets: Targets) -> list[tuple[float, float]]:
    """Return the lengths of upper arm and forearm for each target."""
    return list(zip(targets.d1.tolist(), targets.d2.tolist(), strict=True))


def hand_poses(targets: Targets) -> np.ndarray:
    """Return the forearm's frame at the wrist in the model's pose, (N, 4, 4)."""
    pose = solve_lean(*columns(targets))
    qs = np.stack([pose[f"qs_{unit}"] for unit in "wijk"], axis=1)
    qe = np.stack([pose["qe_w"], pose["qe_i"], *np.zeros((2, len(targets)))], axis=1)
    frames = np.zeros((len(targets), 4, 4))
    frames[:, :3, :3] = matrix(multiply(qs, qe))
    frames[:, :3, 3] = forward(qs, qe[:, :2], targets.d1, targets.d2)[1]
    frames[:, 3, 3] = 1
    return frames


def _eaik_bound(targets: Targets) -> Bound:
    targets = of_reach_1(targets)
    robot_of = found("eaik.IK_HP").HPRobot
    # Shoulder, elbow. With z as the third axis, which also meets the elbow's, EAIK 1.2.2 misclassifies the arm and
    # misses the pose by half the reach.
    axes = np.array([Z, X, Y, X])
    made = {arm: robot_of(axes, np.array([NONE, NONE, NONE, arm[0] * Z, -arm[1] * Z])) for arm in set(arms(targets))}
    asked = list(zip([made[arm] for arm in arms(targets)], hand_poses(targets), strict=True))

    def once() -> list:
        return [robot.IK(pose) for robot, pose in asked]

    def errors() -> np.ndarray:
        out = np.full(len(targets), np.nan)
        for n, ((robot, _), solution) in enumerate(zip(asked, once(), strict=True)):
            hands = [robot.fwdKin(angles)[:3, 3] for angles in solution.Q]
            if hands:
                out[n] = np.linalg.norm(np.array(hands) - targets.position[n], axis=1).min() / targets.reach[n]
        return out

    return Bound(repeated(once), errors)


def _chain(d1: float, d2: float):
    link, chain = found("ikpy.link"), found("ikpy.chain")
    joints = [("azimuth", 0, Z), ("elevation", 0, X), ("upper arm", 0, Z), ("elbow", d1, X)]
    links = [link.URDFLink(name, [0, 0, along], [0, 0, 0], rotation=axis) for name, along, axis in joints]
    hand = link.URDFLink("hand", [0, 0, -d2], [0, 0, 0], joint_type="fixed")
    moves = [False, *(True for _ in joints), False]
    return chain.Chain([link.OriginLink(), *links, hand], active_links_mask=moves)


def _ikpy_bound(targets: Targets) -> Bound:
    targets = of_reach_1(targets)
    made = {arm: _chain(*arm) for arm in set(arms(targets))}
    asked = list(zip([made[arm] for arm in arms(targets)], targets.position, strict=True))
    start = [0, 0.1, 0.5, 0.1, 2, 0]  # a bent arm

    def once() -> list:
        return [chain.inverse_kinematics(position, initial_position=start) for chain, position in asked]

    def errors() -> np.ndarray:
        hands = [chain.forward_kinematics(q)[:3, 3] for (chain, _), q in zip(asked, once(), strict=True)]
        return np.linalg.norm(np.array(hands) - targets.position, axis=1) / targets.reach

    return Bound(repeated(once), errors)


def others() -> Iterator[Contender]:
    """Yield both, installed or not."""
    for key, module, name, bind in (
        ("eaik", "eaik.IK_HP", "4 joints, the hand's whole pose given, all solutions", _eaik_bound),
        ("ikpy", "ikpy.chain", "4 joints, the hand's place given, any elbow, by search", _ikpy_bound),
    ):
        lacks = "" if found(module) else "not installed"
        yield Contender(key, {"eaik": "EAIK"}.get(key, key), name, bind, lacks, most=FEW[key])
