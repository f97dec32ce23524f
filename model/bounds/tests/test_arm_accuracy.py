# SPDX-License-Identifier: Apache-2.0
"""Test the accuracy of the whole arm: every constant against the words, and against errors of its nodes alone."""

import numpy as np
import pytest

from model.bounds.arm_accuracy import arm_accuracy
from model.bounds.predict import Real
from model.bounds.tests.test_accuracy import poses
from model.dataflow import fixed
from model.io.flags import BAD_HAND, SATURATED, UNREACHABLE
from model.io.stimuli import REGIONS, hand_poses, region
from model.reference.joints import Branch, reached, turned
from model.reference.kinematics import angle_between, conjugate, forward, multiply

WIDTHS = [18, 32, *(pytest.param(width, marks=pytest.mark.slow) for width in (16, 17, 24, 27, 31))]


def in_reach(width: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return hand poses (N, 11) of all kinds, many with th2 or th6 near 0 or half a turn, and random branches (N,)."""
    targets = [poses(6000, width, seed), *(region(name, 1500, width, seed) for name in REGIONS)]
    words = hand_poses(np.concatenate(targets), width, seed)
    branch = np.random.default_rng(seed).integers(8, size=len(words))
    good = fixed.run(words, width, "arm", branch).flags & (UNREACHABLE | SATURATED | BAD_HAND) == 0
    return words[good], branch[good]


def length(vectors):
    return np.linalg.norm(vectors, axis=1)


@pytest.mark.parametrize("width", WIDTHS)
def test_no_word_exceeds_its_constant(width):
    """Check each error, computed from the words before it, in units of 2^-(W-2)."""
    words, branch = in_reach(width, 1)
    answer, one, of = fixed.run(words, width, "arm", branch), 2.0 ** (width - 2), arm_accuracy(width)
    most = {name: float(part) for name, part in {**of.parts, **of._asdict()}.items() if name != "parts"}

    def v(*names):
        return np.stack([answer.bits.nodes[name].value for name in names], axis=1) / one

    qs, qw, h = (v(*(f"{q}_{part}" for part in "wijk")) for q in ("qs", "qw", "h"))
    d1, d2, tool = (v(name)[:, 0] for name in ("d1", "d2", "tool_h"))
    qe, p, at = v("qe_w", "qe_i"), v("x", "y", "z"), v("hand_x", "hand_y", "hand_z")
    bend = np.column_stack([-qe[:, 1], qe[:, 0], 0 * qe])
    th = answer.results[:, :7].T * (2 * np.pi / (1 << width))
    plain = branch & Branch.ELBOW == 0  # otherwise both bones are turned about themselves
    still = 0 * th[3]
    pairs = {
        "ball, Qs": (turned(*th[:3]), qs),
        "elbow": (turned(still, th[3], still), bend),
        "ball, Qw": (turned(*th[4:]), qw),
    }
    errors = {name: angle_between(q.T, exact) * plain for name, (q, exact) in pairs.items()}
    errors["Qw"] = angle_between(qw, multiply(conjugate(bend), multiply(conjugate(qs), h)))
    point, hand = reached(th, d1, d2, tool[:, None] * (0.0, 0.0, 1.0))
    errors["orientation"] = angle_between(hand, h)
    errors = {name: part / most[name] for name, part in errors.items()}

    off = length(forward(qs / length(qs)[:, None], qe / length(qe)[:, None], d1, d2)[1] - p)
    errors["a, b"] = off / (most["a, arm"] * length(p) + most["b, arm"] * d2)
    w, i, j, k = h.T
    column = np.stack([2 * (i * k + w * j), 2 * (j * k - w * i), 1 - 2 * i * i - 2 * j * j], axis=1)
    errors["offset"] = length(p - at + tool[:, None] * column) / (most["tool"] * np.abs(tool) + most["wrist"])
    off = length(point - at) - 2 * np.abs((h * h).sum(axis=1) - 1) * np.abs(tool)
    limit = (most["point"] - most["wrist"]) * (d1 + d2 + np.abs(tool)) + most["wrist"]
    errors["point"] = off / limit
    for name, part in errors.items():
        print(f"{name}: {part.max() * one:.3f} of the limit")
        assert 0.2 < part.max() * one <= 1, name


@pytest.mark.parametrize("width", WIDTHS)
def test_no_group_of_errors_exceeds_its_constant(width):
    """Evaluate the dataflow in double precision with errors of one group's nodes alone, at the ends of their range."""
    words, branch = in_reach(width, 2)
    bits, of, random = fixed.run(words, width, "arm", branch).bits, arm_accuracy(width), np.random.default_rng(3)
    tool = np.abs(words[:, 6]) / 2.0 ** (width - 2)
    frame = [node.name for node in bits.nodes.values() if node.section == "frame" and any(node.error)]
    groups = {
        "Qw": (frame, [f"qw_{c}" for c in "wijk"], float(of.parts["Qw"]) / 2),
        "tool": ("h_ik h_wj h_jk h_wi h_ii h_jj".split(), "xyz", float(of.parts["tool"]) * tool),
        "wrist": ("x y z off_x off_y off_z".split(), "xyz", float(of.wrist)),
    }
    still = Real(bits, {}).values
    for name, (members, results, limit) in groups.items():
        worst = 0.0
        for _ in range(8):
            moves = {member: random.choice(bits.nodes[member].error, len(tool)) for member in members}
            values = Real(bits, moves).values
            off = np.linalg.norm([values[result] - still[result] for result in results], axis=0) * 2.0 ** (width - 2)
            worst = max(worst, (off / (limit + 1e-3)).max())
        print(f"{name}: {worst:.3f} of the limit")
        assert 0.2 < worst <= 1, name
