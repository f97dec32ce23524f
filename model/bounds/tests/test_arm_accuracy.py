# SPDX-License-Identifier: Apache-2.0
"""Test the accuracy of the whole arm: every constant against the words, and against errors of its nodes alone."""

import numpy as np
import pytest

from model.bounds.arm_accuracy import arm_accuracy
from model.bounds.predict import Real
from model.bounds.tests.test_accuracy import REAL, Words, poses, size
from model.dataflow import fixed
from model.io.flags import BAD_HAND, SATURATED, UNREACHABLE
from model.io.stimuli import REGIONS, hand_poses, region
from model.reference.joints import Branch, turned
from model.reference.kinematics import product

WIDTHS = [18, 32, *(pytest.param(width, marks=pytest.mark.slow) for width in (16, 17, 24, 27, 31))]
BACK = np.array([[1], [-1], [-1], [-1]])


def in_reach(width: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return hand poses (N, 11) of all kinds, many with th2 or th6 near 0 or half a turn, and random branches (N,)."""
    targets = [poses(6000, width, seed), *(region(name, 1500, width, seed) for name in REGIONS)]
    words = hand_poses(np.concatenate(targets), width, seed)
    branch = np.random.default_rng(seed).integers(8, size=len(words))
    good = fixed.run(words, width, "arm", branch).flags & (UNREACHABLE | SATURATED | BAD_HAND) == 0
    return words[good], branch[good]


def angle(p, q):
    """Return the angle (rad) between the rotations by quaternions (4, N) of any length."""
    between = product(p * BACK, q)
    return 2 * np.arctan2(size(between[1:]), np.abs(between[0]))


def rotated(q, vectors):
    """Return vectors (3, N) rotated by quaternions (4, N) of any length."""
    return product(product(q, np.array([0 * q[0], *vectors])), q * BACK)[1:] / size(q) ** 2


def measured(words: np.ndarray, branch: np.ndarray, width: int) -> dict[str, np.ndarray]:
    """Return what each constant limits, (N,), computed from the words before it, in units of 2^-(W-2); the wrist's
    errors and the point's are divided by their limits."""
    v, of, ulp = Words(words, width, "arm", branch), arm_accuracy(width), REAL(2) ** (2 - width)
    qs, qw, h, hand = (v(" ".join(f"{name}_{part}" for part in parts)) for name, parts in
                       (("qs", "wijk"), ("qw", "wijk"), ("h", "wijk"), ("hand", "xyz")))  # fmt: skip
    d1, d2, tool, p = v("d1"), v("d2"), v("tool_h"), v("x y z")
    bend = np.array([-v("qe_i"), v("qe_w"), v.zero, v.zero])
    half = np.arctan2(REAL(0), REAL(-1))
    th = [v(f"th{k}") * half for k in range(1, 8)]
    other = branch & Branch.ELBOW != 0  # turns both bones about themselves
    th[2], th[3], th[4] = th[2] + half * other, np.where(other, -th[3], th[3]), th[4] + half * other
    shoulder, elbow, wrist = turned(*th[:3]), turned(v.zero, th[3], v.zero), turned(*th[4:])
    parts = {"ball, Qs": angle(shoulder, qs), "elbow": angle(elbow, bend), "ball, Qw": angle(wrist, qw)}
    parts["Qw"] = angle(qw, product(bend * BACK, product(qs * BACK, h)))
    parts["orientation"] = angle(product(product(shoulder, elbow), wrist), h)
    constant = {name: float(part) for name, part in {**of._asdict(), **of.parts}.items() if name != "parts"}

    def reached(q, e, end):
        return rotated(q, rotated(e, end + np.array([v.zero, v.zero, d2])) + np.array([v.zero, v.zero, d1]))

    off = size(reached(qs, bend, np.array([v.zero] * 3)) - p)
    parts["a, b"] = off / (constant["a, arm"] * size(p) + constant["b, arm"] * d2)
    w, i, j, k = h
    column = np.array([2 * (i * k + w * j), 2 * (j * k - w * i), 1 - 2 * i * i - 2 * j * j])
    parts["offset"] = size(p - hand + tool * column) / (constant["tool"] * np.abs(tool) + constant["wrist"])
    off = size(reached(shoulder, elbow, rotated(wrist, np.array([v.zero, v.zero, tool]))) - hand)
    off -= 2 * np.abs((h * h).sum(axis=0) - 1) * np.abs(tool)
    whole = (constant["point"] - constant["wrist"]) * (d1 + d2 + np.abs(tool)) + constant["wrist"]
    parts["hand"] = np.maximum(off, 0) / whole
    return {name: (part / ulp / constant.get(name, 1)).astype(float) for name, part in parts.items()}


@pytest.mark.parametrize("width", WIDTHS)
def test_no_word_exceeds_its_constant(width):
    for name, part in measured(*in_reach(width, 1), width).items():
        print(f"{name}: {part.max():.3f} of the limit")
        assert 0.2 < part.max() <= 1, name


@pytest.mark.parametrize("width", WIDTHS)
def test_no_group_of_errors_exceeds_its_constant(width):
    """Evaluate the dataflow in double precision with errors of one group's nodes alone, at the ends of their range."""
    words, branch = in_reach(width, 2)
    bits, of, random = fixed.run(words, width, "arm", branch).bits, arm_accuracy(width), np.random.default_rng(3)
    tool = np.abs(words[:, 6]) / 2.0 ** (width - 2)
    frame = [node.name for node in bits.nodes.values() if node.section == "frame" and any(node.error)]
    groups = {
        "Qw": (frame, [f"qw_{c}" for c in "wijk"], 1.0),
        "tool": ("h_ik h_wj h_jk h_wi h_ii h_jj".split(), "xyz", tool),
        "wrist": ("x y z off_x off_y off_z".split(), "xyz", 1.0),
    }
    still = Real(bits, {}).values
    for name, (members, results, scale) in groups.items():
        constant = float(of.parts[name] if name in of.parts else of.wrist) / (2 if name == "Qw" else 1)
        worst = 0.0
        for _ in range(8):
            nodes = (bits.nodes[member] for member in members)
            values = Real(bits, {node.name: random.choice(node.error, len(tool)) for node in nodes}).values
            off = np.linalg.norm([values[result] - still[result] for result in results], axis=0)
            worst = max(worst, ((off * 2.0 ** (width - 2) - 1e-3) / (constant * scale + 1e-3)).max())
        print(f"{name}: {worst:.3f} of the limit")
        assert 0.2 < worst <= 1, name
