# SPDX-License-Identifier: Apache-2.0
"""Test the theorem of the lean datapath's accuracy: its tables, and every part of its bound against the real words."""

import numpy as np
import pytest

from model.bounds.accuracy import Accuracy, accuracy
from model.dataflow import fixed
from model.io.flags import UNREACHABLE, expected_flags
from model.io.stimuli import mixed

REAL = np.longdouble


def poses(count: int, width: int, seed: int) -> np.ndarray:
    """Return targets in reach (N, 6): half are those of all kinds, half have words of any size and nearly right angles,
    the poses with the largest errors."""
    random = np.random.default_rng((seed, width))
    words = random.integers(-(1 << width - 1), 1 << width - 1, (count, 6)) >> random.integers(0, width - 1, (count, 6))
    words[:, 4:] = np.minimum(np.abs(words[:, 4:]) + 1, (1 << width - 1) - 1)
    p = words[:, :3].astype(float)
    far, d1 = np.linalg.norm(p, axis=1), words[:, 4].astype(float)
    near = np.rint(np.hypot(far, d1)).astype(np.int64)  # cos a = 0
    words[:, 5] = np.where(random.random(count) < 0.7, np.minimum(near, (1 << width - 1) - 1), words[:, 5])
    words = np.concatenate([words, mixed(count, width, seed)])
    return words[(expected_flags(words, width) & UNREACHABLE == 0) & words[:, :3].any(axis=1)]


def multiply(p, q):
    """Return the product of quaternions with components first."""
    (a, b, c, d), (e, f, g, h) = p, q
    return np.array((a*e - b*f - c*g - d*h, a*f + b*e + c*h - d*g, a*g - b*h + c*e + d*f, a*h + b*g - c*f + d*e))  # fmt: skip


def measured(words: np.ndarray, width: int, datapath: str) -> dict[str, np.ndarray]:
    """Return the errors (N,) of every part of the bound, each from the words before it, in units of 2^-(W-2).

    ``a |p| + b d2`` is the error of the wrist, divided by that bound.
    """
    nodes = fixed.run(words, width, datapath).bits.nodes

    def v(name):
        node = nodes[name]
        return np.asarray(node.value).astype(REAL) / REAL(2) ** node.frac

    def vector(names):
        return np.array([v(name) for name in names.split()])

    def size(vectors):
        return np.sqrt((vectors * vectors).sum(axis=0))

    x, y, z, d1, d2 = (v(name) for name in ("x", "y", "z", "d1", "d2"))
    rho, p, zero = np.sqrt(v("rho_sq")), np.sqrt(v("s")), np.zeros(len(words), REAL)
    off = rho == 0
    r = np.where(off, 1, rho)
    angles = {
        "azimuth": ("az", np.where(off, 0, -y / r), np.where(off, 1, x / r)),
        "tilt": ("tilt", z / p, rho / p),
        "bend": ("bend", v("k_law") / (2 * d1 * p), np.sqrt(v("a_far")) * np.sqrt(v("b_near")) / (2 * d1 * p)),
    }
    parts, h = {}, {}
    for name, (pair, cosine, sine) in angles.items():
        h[pair] = c, s = v(f"{pair}_c"), v(f"{pair}_s")
        parts[f"{name} k"] = np.abs((c * c + s * s) / v(f"{pair}_sq") - 1)
        c, s = c * c - s * s, 2 * c * s
        parts[f"{name} w"] = np.abs(np.arctan2(s * cosine - c * sine, c * cosine + s * sine))
    h["phi"] = v("cos_h"), v("sin_h")
    square = {name: c * c + s * s for name, (c, s) in h.items()}
    parts["phi k"] = np.abs(square["phi"] - 1)
    scale = 4 * v("inv_q") ** 2 * v("az_sq") * v("tilt_sq") * v("bend_sq")
    parts["length k"] = np.abs(scale - 1)

    def about(pair, axis):
        c, s = h[pair]
        return np.array([c, s, zero, zero] if axis == "x" else [c, zero, zero, s])

    tilt, back, length = about("tilt", "x"), about("bend", "x"), np.sqrt(scale * np.prod([*square.values()], axis=0))
    back[1] *= -1
    c_plus, s_plus, c_minus, s_minus = vector("c_plus s_plus c_minus s_minus")
    turned, q_0, q_1 = (
        multiply(about("az", "z"), about("phi", "z")),
        vector("w_0 i_0 j_0 k_0"),
        vector("w_1 i_1 j_1 k_1"),
    )
    by_tilt = np.array([h["tilt"][0] * c_plus, h["tilt"][1] * c_minus, h["tilt"][1] * s_minus, h["tilt"][0] * s_plus])
    exact = multiply(multiply(about("az", "z"), tilt), about("phi", "z"))
    sides = [square[name] for name in ("az", "phi", "tilt", "bend")]
    for name, error, over in (
        ("first products", by_tilt - exact, 3),
        ("tilt products", q_0 - by_tilt, 3),
        ("bend products", q_1 - multiply(q_0, back), 4),
    ):
        parts[name] = 2 * length * size(error) / np.sqrt(np.prod(sides[:over], axis=0))
    q, qs = vector("w_q i_q j_q k_q"), vector("qs_w qs_i qs_j qs_k")
    parts["inv_q products"] = 2 * size(q - 2 * v("inv_q") * q_1)
    parts["Qs rounding"] = 2 * np.minimum(size(qs - q), size(qs + q))
    exact = np.sqrt(np.array([v("a_far"), v("b_near")]) / (4 * d1 * d2)) * np.array([[1], [-1]])
    parts["Qe"] = 2 * size(vector("qe_w qe_i") - exact)
    c, s = vector("qe_w qe_i")
    arm = np.array([zero, zero, 2 * c * s * d2, d1 - (c * c - s * s) * d2])
    wrist = multiply(multiply(qs, arm), qs * np.array([[1], [-1], [-1], [-1]]))[1:]
    bound = accuracy(width, datapath)
    parts["wrist"] = size(wrist - np.array([x, y, z])) / (float(bound.a) * p + float(bound.b) * d2)
    return {name: (part * REAL(2) ** (width - 2)).astype(float) for name, part in parts.items()}


def limits(bound: Accuracy) -> dict[str, float]:
    """Return the constants of the parts that :func:`measured` returns."""
    constants = {name: float(part) for name, part in bound.parts.items()}
    return constants | {"Qe": constants["Qe factors"] + constants["Qe rests"], "wrist": 1.0}


def ratios(words, width, datapath):
    most = limits(accuracy(width, datapath))
    return {name: part / most[name] for name, part in measured(words, width, datapath).items()}
