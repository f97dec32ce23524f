# SPDX-License-Identifier: Apache-2.0
"""Pictures of the arm, drawn from the answers of the bit-true model.

arm.svg: one target, every swivel angle; the elbow runs around a circle about the line from shoulder to wrist.
frame.svg: the same on a body, with the reference axis from which the swivel angle counts.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from model import solve
from model.dataflow import fixed
from model.io.words import DEFAULT_D1, DEFAULT_D2, Targets, result_values, to_words
from model.reference.kinematics import forward
from scripts.generate.render import render

TARGET = (0.38, -0.14, 0.05)
PHI = 2.5
"""Of the arm that is drawn in full, rad."""

SCALE, MIDDLE = 560, (150, 205)
"""Pixels a metre, and where the shoulder is."""

ASIDE, BEHIND, ELEVATION = np.radians(-68), np.radians(-125), np.radians(16)
"""Where the camera is: at the side of a right arm, or behind that."""


def project(points: np.ndarray, azimuth: float = ASIDE) -> np.ndarray:
    """Pixels (N, 2) of points (N, 3) in metres: a parallel projection, z up."""
    x, y, z = np.asarray(points, dtype=float).T
    across = -x * np.sin(azimuth) + y * np.cos(azimuth)
    away = x * np.cos(azimuth) + y * np.sin(azimuth)
    up = z * np.cos(ELEVATION) - away * np.sin(ELEVATION)
    return np.column_stack([MIDDLE[0] + SCALE * across, MIDDLE[1] - SCALE * up])


def picture() -> str:
    """The SVG."""
    phi = np.concatenate([[PHI], np.linspace(-np.pi, np.pi, 73)])
    targets = Targets("arm", *(np.full(len(phi), v) for v in TARGET), phi, DEFAULT_D1, DEFAULT_D2)
    words, _ = to_words(targets, 32)
    q = result_values(fixed.run(words, 32, "lean").results, 32)
    elbows, wrists = (project(p) for p in forward(q[:, :4], q[:, 4:], targets.d1, targets.d2))
    shoulder, x, y, z = project([(0, 0, 0), (0.16, 0, 0), (0, 0.16, 0), (0, 0, 0.24)])
    return render(
        "arm.svg", shoulder=shoulder, elbow=elbows[0], wrist=wrists[0], axes={"x": x, "y": y, "z": z},
        circle=elbows[1:], ghosts=elbows[[28, 48]], top=elbows[1:][np.argmin(elbows[1:, 1])],
    )  # fmt: skip


OUTWARD_AND_UP = (0.0, -1.0, 1.0)
BODY = {"neck": (0, 0.19, 0.1), "left": (0, 0.38, 0.02), "hip": (0, 0.3, -0.5), "side": (0, 0.08, -0.5)}
"""Points of a body whose right shoulder is the origin, m."""


def frame_picture() -> str:
    """The SVG: a right arm on its body, the axis outward and up."""
    point, phi = (0.42, -0.06, 0.02), 2.2
    pose = solve([point], [phi], axis=OUTWARD_AND_UP)
    zero, hanging = solve([point], 0.0, axis=OUTWARD_AND_UP), solve([(0.05, -0.05, -0.55)], axis=OUTWARD_AND_UP)
    circle = solve([point] * 73, np.linspace(-np.pi, np.pi, 73), axis=OUTWARD_AND_UP).elbow
    arc = solve([point] * 40, np.linspace(0, phi, 40), axis=OUTWARD_AND_UP).elbow
    foot = np.dot(pose.elbow[0], point) / np.dot(point, point) * np.array(point)  # the middle of the circle
    near = foot + 0.45 * (arc - foot)
    at = partial(project, azimuth=BEHIND)
    names = ("shoulder", "x", "y", "z", "axis", "foot")
    ends = [(0, 0, 0), (0.2, 0, 0), (0, 0.14, 0), (0, 0, 0.2), (0, -0.19, 0.19), foot]
    places = dict(zip(names, at(ends), strict=True))
    return render(
        "frame.svg", **places, body={name: at for name, at in zip(BODY, at(list(BODY.values())), strict=True)},
        elbow=at(pose.elbow)[0], wrist=at(pose.wrist)[0], zero=at(zero.elbow)[0],
        down=[at(hanging.elbow)[0], at(hanging.wrist)[0]], circle=at(circle), arc=at(near),
    )  # fmt: skip
