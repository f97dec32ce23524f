# SPDX-License-Identifier: Apache-2.0
"""Seven joint angles of the whole arm: three of the shoulder, one of the elbow, three of the wrist.

    Qs = Rz(th1) Rx(th2) Rz(th3)                         th4 = 2 atan2(qe_w, -qe_i)
    Qw = (Qs Rx(th4))~ Qh = Rz(th5) Rx(th6) Rz(th7)      hand point = wrist + Qh (tool e3) Qh~

z points along each bone, and all angles are 0 if the arm is straight along z. The angles of Rz(a) Rx(b) Rz(c) are

    s = atan2(k, w),  d = atan2(j, i),  a = s + d,  c = s - d,  b = 2 atan2(|(i, j)|, |(w, k)|)

Unless stated otherwise, arrays have components first: quaternions (4, N), angles (7, N) in radians, -pi to pi.
"""

from enum import IntFlag

import numpy as np

from .kinematics import conjugate, product, rotate


class Branch(IntFlag):
    """Bits that select one of the eight joint solutions of a pose; the arm is in the same place in all eight."""

    SHOULDER = 1  # th1 + pi, -th2, th3 + pi
    ELBOW = 2  # th3 + pi, -th4, th5 + pi
    WRIST = 4  # th5 + pi, -th6, th7 + pi


UNIT = (1.0, 0.0, 0.0, 0.0)  # quaternion
JOINTS = tuple(f"th{k}" for k in range(1, 8))

BRANCHES = tuple(f"branch_{name.lower()}" for name in Branch.__members__)  # names of the bits of a branch, lowest first

TURNED = {"th1": BRANCHES[:1], "th3": BRANCHES[:2], "th5": BRANCHES[1:], "th7": BRANCHES[2:]}
NEGATED = dict(zip(("th2", "th4", "th6"), BRANCHES, strict=True))
"""Joint -> branch bits that add half a turn to its angle (TURNED); joint -> branch bit that negates it (NEGATED)."""

TURNED_BY = np.array([[bit in TURNED.get(joint, ()) for bit in BRANCHES] for joint in JOINTS], dtype=int)
NEGATED_BY = np.array([[bit == NEGATED.get(joint) for bit in BRANCHES] for joint in JOINTS], dtype=int)
"""TURNED and NEGATED as tables of 0 and 1, joint by branch bit, (7, 3)."""

_BITS = np.arange(8) >> np.arange(3)[:, None] & 1
SIGNS, TURNS = 1.0 - 2 * (NEGATED_BY @ _BITS & 1), np.pi * (TURNED_BY @ _BITS & 1)
"""Sign and turn (rad) of each joint in each branch, (7, 8): sign * angle in branch 0 + turn."""


def wrap(angle):
    """Return angles (rad) wrapped to -pi .. pi."""
    return angle - 2 * np.pi * np.rint(angle * (0.5 / np.pi))


def branched(joints, branch):
    """Return joints (7, ...) of branch 0 converted to ``branch``, an integer or an array (...); angles are wrapped."""
    shape = np.shape(branch) or (1,) * (joints.ndim - 1)
    sign, turn = (table[:, branch].reshape(7, *shape) for table in (SIGNS, TURNS))
    return wrap(joints * sign + turn)


def zxz(q):
    """Return the angles (3, ...) a, b and c of unit quaternions (4, ...) Rz(a) Rx(b) Rz(c)."""
    w, i, j, k = q
    s, d = np.arctan2(k, w), np.arctan2(j, i)
    angles = np.empty((3, *s.shape))
    angles[0], angles[2] = wrap(s + d), wrap(s - d)
    with np.errstate(divide="ignore"):
        angles[1] = 2 * np.arctan(np.sqrt((i * i + j * j) / (w * w + k * k)))
    return angles


def wrist_quaternion(qs, qe, hand):
    """Return Qw (4, N) from Qs (4, N), the components qe_w and qe_i (2, N) of Qe, and Qh (4, N)."""
    (w, i, j, k), s, c = qs, qe[0], -qe[1]
    return product((w * c - i * s, -w * s - i * c, -j * c - k * s, j * s - k * c), hand)  # (Qs Rx(th4))~ Qh


def tool_offset(hand, tool):
    """Return the vectors (3, N) Qh (tool e3) Qh~ from wrist to hand point.  hand: Qh (4, N); tool: lengths (N,)."""
    w, i, j, k = hand
    return np.array((2 * (i * k + w * j), 2 * (j * k - w * i), (w * w + k * k) - (i * i + j * j))) * tool


def flexion(qe):
    """Return th4 (N,) from the components qe_w and qe_i (2, N) of Qe."""
    with np.errstate(divide="ignore"):
        return 2 * np.arctan(qe[0] / np.abs(qe[1]))


def angles(qs, th4, qw, branch=0):
    """Return th1 .. th7 (7, N) in a branch, from unit quaternions Qs and Qw (4, N) and th4 (N,)."""
    th = np.empty((7, *th4.shape))
    th[:3], th[3], th[4:] = zxz(qs), th4, zxz(qw)
    return branched(th, branch) if np.any(branch) else th


def bent(qs, th4, qw, branch, upper, fore):
    """Convert rotations of bent bones to rotations of the joint axes; return arguments for :func:`angles`.

    upper (4,): orientation of the upper arm in the frame of axis 3; fore (4,): orientation of the frame of axis 5 in
    the forearm's frame. The branch ELBOW turns each bone by pi about itself, which with bent links changes all joints.
    """
    other = branch & Branch.ELBOW != 0
    half, back = np.array((0.0, 0.0, 0.0, 1.0)), np.array((0.0, 0.0, 0.0, -1.0))
    qs, qw = np.where(other, product(qs, half), qs), np.where(other, product(back, qw), qw)
    qs, qw = product(qs, conjugate(upper)), product(conjugate(fore), qw)
    return qs, np.where(other, -th4, th4), qw, branch & ~Branch.ELBOW


def turned(a, b, c):
    """Return the quaternions Rz(a) Rx(b) Rz(c), (4, N)."""
    s, d, cosine, sine = (a + c) / 2, (a - c) / 2, np.cos(b / 2), np.sin(b / 2)
    return np.array((cosine * np.cos(s), sine * np.cos(d), sine * np.sin(d), cosine * np.sin(s)))


def reached(joints, d1, d2, tool, upper=UNIT, fore=UNIT):
    """Return the hand's point (N, 3) and orientation (N, 4) at joints (7, N).  tool (N, 3): from wrist to hand
    point, in the hand's frame. upper, fore: as in :func:`bent`."""
    upper = product(turned(*joints[:3]), upper)
    straight = product(upper, turned(0 * joints[3], joints[3], 0 * joints[3]))
    hand = product(product(straight, fore), turned(*joints[4:])).T
    bones = (upper.T, d1), (straight.T, d2)
    return sum(rotate(q, (0.0, 0.0, 1.0)) * np.reshape(d, (-1, 1)) for q, d in bones) + rotate(hand, tool), hand


def centred(limits):
    """Return centres (J,) and half widths (J,) of limits (J, 2), rad; a range of a turn or more counts as -pi to pi."""
    low, high = np.where((limits[:, 1] - limits[:, 0] >= 2 * np.pi)[:, None], (-np.pi, np.pi), limits).T
    return (low + high) / 2, (high - low) / 2


def excess(joints, limits):
    """Return by how much joints (7, ...) exceed their limits (7, 2), rad; negative inside. Whole turns are ignored."""
    middle, half = (column.reshape(7, *[1] * (joints.ndim - 1)) for column in centred(limits))
    return np.abs(wrap(joints - middle)) - half


def outside(joints, limits):
    """Return the mask (7, ...) of joints more than ROUNDING outside their limits (7, 2); whole turns are ignored."""
    return excess(joints, limits) > ROUNDING


def settled(joints, limits, beyond=None):
    """Return joints (7, ...) with th1, th3 and th5, th7 moved into their limits (7, 2) where the pose allows it.

    If th2 (th6) is within STRAIGHT of 0 or pi, the pose depends only on the sum or difference of th1, th3 (th5, th7).
    beyond (7, ...): result of :func:`outside`, if known. If no joint moves, ``joints`` itself is returned.
    """
    middle, half = centred(limits)
    result, beyond = joints, outside(joints, limits) if beyond is None else beyond
    for a, tilt, c in ((0, 1, 2), (4, 5, 6)):
        moved = (beyond[a] | beyond[c]) & (np.abs(np.sin(joints[tilt])) < STRAIGHT)
        if moved.any():
            result = result.copy() if result is joints else result
            sign = np.where(np.cos(joints[tilt]) < 0, -1, 1)
            both = joints[a] + sign * joints[c]
            gap = wrap(both - (middle[a] + sign * middle[c]))
            first = middle[a] + gap * (half[a] / ((half[a] + half[c]) or 1.0))
            result[a] = np.where(moved, wrap(first), joints[a])
            result[c] = np.where(moved, wrap(sign * (both - first)), joints[c])
    return result


STRAIGHT = 1e-7
"""Angle (rad): :func:`settled` treats th2 and th6 as 0 or pi if they are nearer than this. The limit is large because
th4 of a straight arm has only half of a double's digits."""

SINGULAR = 1e-9  # like STRAIGHT, for paths (model.motion.swivels)
ROUNDING = 1e-9  # allowance at a joint limit (rad)
