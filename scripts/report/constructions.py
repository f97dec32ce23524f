# SPDX-License-Identifier: Apache-2.0
"""Entities of figures 1 to 5 of the paper for every target of a trajectory, from `model.reference.geometry`.

They are computed from the core's input words in double precision; no result of the core enters.
"""

from __future__ import annotations

import base64
from typing import Any

import numpy as np

from model.io.words import from_words
from model.reference import cga, geometry
from model.reference.cga import e3
from scripts.trajectory import Prepared

STEPS = 32000
"""Units per length 1 and per half turn. Numbers fit in 16 bits, which keeps long clips small."""

NOTHING = -32768
"""Marks an undefined entity, such as the elbow where the spheres do not meet."""

NEAR = 1e-4
"""Largest geometric error, as a fraction of the reach, at which an entity near a singular pose is still drawn."""


def entities(item: Prepared, width: int) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Return vectors (N, 3) in the user's frame, angles (N,) in rad and lengths (N,) by name.

    Points and lengths are relative to the reach, directions have length 1. Undefined entities are nan.
    """
    asked = from_words(item.core_words(width), 0, width, item.targets.name)
    lengths = [values / asked.reach for values in (asked.x, asked.y, asked.z, asked.d1, asked.d2)]
    d1, d2 = lengths[3:]
    with np.errstate(divide="ignore", invalid="ignore"):
        found = geometry.solve(*lengths[:3], asked.phi, d1, d2)
        P_w, Q_s, Q_e, Q_12 = (found[name] for name in ("P_w", "Q_s", "Q_e", "Q_12"))
        # The rest pose after the rotation about the elbow, before the rotation about the shoulder.
        rest = cga.rotate(Q_e, e3 * cga.scalar(-d2)) + e3 * cga.scalar(d1)
        coordinates = {
            "axis": (0 * d1, 0 * d1, 0 * d1 + 1),  # L_z
            "along": cga.direction(found["L_sw"]),
            "vertical": cga.direction(geometry.swivel_plane(P_w, 0 * d1)[2]),  # normal of the swivel plane at phi = 0
            "swivel": cga.direction(found["pi_swivel"]),
            "centre": cga.euclidean_coordinates(cga.centre(found["Z_e"])),
            "elbow": cga.euclidean_coordinates(found["P_e"]),
            "other": cga.euclidean_coordinates(geometry.elbow_point(-found["PP"])),
            # The wrist before the rotation by Q_e, by Q_12 and by Q_3.
            "folded": cga.euclidean_coordinates(cga.rotate(Q_s, cga.point(0 * d1, 0 * d1, d1 - d2))),
            "rest": _vector(rest),
            "half": _vector(cga.rotate(Q_12, rest)),
            "middle": cga.direction(found["L_m"]),
            "yz2": cga.direction(found["pi_yz2"]),
        }
        vectors = {name: np.column_stack(np.broadcast_arrays(*each)) for name, each in coordinates.items()}
        q3_w, _, _, q3_k = cga.quaternion_coefficients(found["Q_3"])
        angles = {"theta4": np.arccos(np.clip(found["c4"], -1, 1)), "theta3": 2 * np.arctan2(q3_k, q3_w)}
        radius = cga.radius(found["Z_e"])
        wrist = np.column_stack(_vector(cga.rotate(Q_s, rest)))
        met = np.abs(np.linalg.norm(vectors["elbow"], axis=1) - d1) < NEAR
        home = met & (np.linalg.norm(wrist - np.column_stack(lengths[:3]), axis=1) < NEAR)
    radius[met & np.isnan(radius)] = 0.0  # arm straight within roundoff
    for name in ("elbow", "other"):
        vectors[name][~met] = np.nan
    turns = (vectors[name] for name in ("folded", "rest", "half", "middle", "yz2"))
    for values in (*turns, *angles.values()):
        values[~home] = np.nan
    shown = {name: item.targets.points_from_core(values) for name, values in vectors.items()}
    return shown, angles, {"radius": radius}


def _vector(mv: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return mv.e1, mv.e2, mv.e3


def packed(item: Prepared, width: int) -> dict[str, Any]:
    """Encode the entities for the page: a row of vectors, angles and lengths per target, 16-bit words in base64."""
    vectors, angles, lengths = entities(item, width)
    turns = [values / np.pi for values in angles.values()]
    rows = np.column_stack([*vectors.values(), *turns, *lengths.values()])
    words = np.where(np.isfinite(rows), np.rint(STEPS * np.nan_to_num(rows)), NOTHING)
    return {
        "vectors": list(vectors),
        "angles": list(angles),
        "lengths": list(lengths),
        "steps": STEPS,
        "nothing": NOTHING,
        "rows": base64.b64encode(words.astype("<i2").tobytes()).decode(),
    }
