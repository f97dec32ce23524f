# SPDX-License-Identifier: Apache-2.0
"""arm.svg: what the core solves, drawn from the answers of the bit-true model.

One target, every swivel angle: the elbow runs around a circle about the line from shoulder to wrist.
"""

from __future__ import annotations

import numpy as np

from model.dataflow import fixed
from model.reference.kinematics import forward
from model.targets.words import DEFAULT_D1, DEFAULT_D2, Targets, result_values, to_words

TARGET = (0.38, -0.14, 0.05)
PHI = 2.5
"""Of the arm that is drawn in full, rad."""

SCALE, MIDDLE = 560, (150, 205)
"""Pixels a metre, and where the shoulder is."""

AZIMUTH, ELEVATION = np.radians(-68), np.radians(16)
"""Of the camera."""

STYLE = """text{font:14px sans-serif} .axis{stroke:#666;stroke-width:1.2} .ghost{stroke:#cbd5e1;stroke-width:9}
.upper{stroke:#1d4ed8;stroke-width:12} .fore{stroke:#c2410c;stroke-width:10} line{stroke-linecap:round}
.swivel{fill:none;stroke:#64748b;stroke-dasharray:4 4} .reach{stroke:#64748b;stroke-dasharray:2 5}"""


def project(points: np.ndarray) -> np.ndarray:
    """Pixels (N, 2) of points (N, 3) in metres: a parallel projection, z up."""
    x, y, z = np.asarray(points, dtype=float).T
    across = -x * np.sin(AZIMUTH) + y * np.cos(AZIMUTH)
    away = x * np.cos(AZIMUTH) + y * np.sin(AZIMUTH)
    up = z * np.cos(ELEVATION) - away * np.sin(ELEVATION)
    return np.column_stack([MIDDLE[0] + SCALE * across, MIDDLE[1] - SCALE * up])


def line(kind: str, start: np.ndarray, end: np.ndarray) -> str:
    """A line between two pixels."""
    return f'<line class="{kind}" x1="{start[0]:.1f}" y1="{start[1]:.1f}" x2="{end[0]:.1f}" y2="{end[1]:.1f}"/>'


def label(text: str, at: np.ndarray, dx: float, dy: float) -> str:
    """A text beside a pixel."""
    return f'<text x="{at[0] + dx:.1f}" y="{at[1] + dy:.1f}">{text}</text>'


def picture() -> str:
    """The SVG."""
    phi = np.concatenate([[PHI], np.linspace(-np.pi, np.pi, 73)])
    targets = Targets("arm", *(np.full(len(phi), v) for v in TARGET), phi, DEFAULT_D1, DEFAULT_D2)
    words, _ = to_words(targets, 32)
    q = result_values(fixed.run(words, 32, "lean").results, 32)
    elbows, wrists = (project(p) for p in forward(q[:, :4], q[:, 4:], targets.d1, targets.d2))
    shoulder, x, y, z = project([(0, 0, 0), (0.16, 0, 0), (0, 0.16, 0), (0, 0, 0.24)])
    elbow, wrist = elbows[0], wrists[0]
    circle = " ".join(f"{a:.1f},{b:.1f}" for a, b in elbows[1:])
    top = elbows[1:][np.argmin(elbows[1:, 1])]
    parts = [
        *(line("ghost", a, b) for n in (28, 48) for a, b in ((shoulder, elbows[n]), (elbows[n], wrist))),
        *(line("axis", shoulder, end) for end in (x, y, z)),
        *(label(name, end, 4, 4) for name, end in (("x", x), ("y", y), ("z", z))),
        line("reach", shoulder, wrist),
        f'<polyline class="swivel" points="{circle}"/>',
        line("upper", shoulder, elbow),
        line("fore", elbow, wrist),
        *(f'<circle cx="{a:.1f}" cy="{b:.1f}" r="7" fill="#fff" stroke="#111"/>' for a, b in (shoulder, elbow, wrist)),
        label("shoulder: Qs", shoulder, -100, -8),
        label("elbow: Qe", elbow, -30, 28),
        label("target p of the wrist", wrist, 14, 5),
        label("d1", (shoulder + elbow) / 2, -32, 8),
        label("d2", (elbow + wrist) / 2, 4, 22),
        label("swivel angle phi", top, -48, -10),
    ]
    return (
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="40 60 460 310"><title>The arm that the core solves</title>\n'
        f'<style>{STYLE}</style>\n<rect x="40" y="60" width="460" height="310" fill="#fff"/>\n'
        + "\n".join(parts) + "\n</svg>\n"
    )
