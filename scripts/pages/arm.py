# SPDX-License-Identifier: Apache-2.0
"""arm.svg: what the core solves, drawn from the answers of the bit-true model.

One target, every swivel angle: the elbow runs around a circle about the line from shoulder to wrist.
"""

from __future__ import annotations

import numpy as np

from model.dataflow import fixed
from model.reference.kinematics import forward
from model.targets.words import DEFAULT_D1, DEFAULT_D2, Targets, result_values, to_words
from scripts.pages.render import render

TARGET = (0.38, -0.14, 0.05)
PHI = 2.5
"""Of the arm that is drawn in full, rad."""

SCALE, MIDDLE = 560, (150, 205)
"""Pixels a metre, and where the shoulder is."""

AZIMUTH, ELEVATION = np.radians(-68), np.radians(16)
"""Of the camera."""


def project(points: np.ndarray) -> np.ndarray:
    """Pixels (N, 2) of points (N, 3) in metres: a parallel projection, z up."""
    x, y, z = np.asarray(points, dtype=float).T
    across = -x * np.sin(AZIMUTH) + y * np.cos(AZIMUTH)
    away = x * np.cos(AZIMUTH) + y * np.sin(AZIMUTH)
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
