# SPDX-License-Identifier: Apache-2.0
"""Pose nearest to a robot's present joints, computed without arrays for a control loop that needs one pose at a time.

The elbow keeps its side of the line from shoulder to wrist. Of the branches, the one whose largest joint step is least
is taken. n is the unit vector toward the wrist p; v, perpendicular to n, points toward the elbow. The upper arm is

    u = n cos a + v sin a        cos a = (s + d1^2 - d2^2) / (2 d1 |p|)        s = |p|^2
"""

from collections.abc import Sequence
from math import atan2, copysign, cos, hypot, inf, pi, remainder, sin, sqrt
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..reference.joints import ROUNDING
from ..reference.kinematics import conjugate, multiply
from .path import SINGULAR
from .swivels import TURN

if TYPE_CHECKING:
    from .arms import Arm


class Step(NamedTuple):
    """Result of :meth:`Arm.track`.

    * joints: seven positions, rad; None at a dead end
    * branch: bits of :class:`Branch`
    * largest: largest step of a joint, rad
    * reason: cause of the dead end; empty if the step has joints
    """

    joints: tuple[float, ...] | None
    branch: int
    largest: float
    reason: str = ""


def axes(q: Sequence[float]) -> tuple[tuple[float, ...], ...]:
    """Return the axes x, y, z as rotated by a unit quaternion: the columns of its rotation matrix."""
    w, i, j, k = q
    ii, jj, kk, ij, ik, jk, wi, wj, wk = i * i, j * j, k * k, i * j, i * k, j * k, w * i, w * j, w * k
    return (
        (1 - 2 * (jj + kk), 2 * (ij + wk), 2 * (ik - wj)),
        (2 * (ij - wk), 1 - 2 * (ii + kk), 2 * (jk + wi)),
        (2 * (ik + wj), 2 * (jk - wi), 1 - 2 * (ii + jj)),
    )


class Tracker:
    """Constants of an exact arm with straight links, as plain numbers."""

    def __init__(self, arm: "Arm") -> None:
        self.d1, self.d2, self.tool, self.base = arm.d1, arm.d2, tuple(arm.tool.tolist()), tuple(arm.base.tolist())
        self.frame = axes(conjugate(arm.mount).tolist())
        turned = multiply(multiply(conjugate(arm.mount), np.eye(4)), conjugate(arm.tip))
        self.turn = tuple(map(tuple, turned.T.tolist()))  # matrix (4, 4) of the product mount~ hand tip~
        self.joints = list(zip(arm.offsets.tolist(), arm.signs.tolist(), *arm.limits.T.tolist(), strict=True))

    def _placed(self, th: Sequence[float], branch: int, present: Sequence[float]) -> tuple[float, list[float]]:
        """Return the largest step (inf outside the limits) and the positions in ``branch``. ``th`` is in branch 0."""
        th1, th2, th3, th4, th5, th6, th7 = th
        if branch & 1:
            th1, th2, th3 = th1 + pi, -th2, th3 + pi
        if branch & 2:
            th3, th4, th5 = th3 + pi, -th4, th5 + pi
        if branch & 4:
            th5, th6, th7 = th5 + pi, -th6, th7 + pi
        most, positions, angles = 0.0, list[float](), (th1, th2, th3, th4, th5, th6, th7)
        for (offset, sign, low, high), now, angle in zip(self.joints, present, angles, strict=True):
            at = now + remainder(sign * angle + offset - now, TURN)
            most = max(most, abs(at - now))
            if not low <= at <= high:
                if not low - ROUNDING <= at <= high + ROUNDING:
                    return inf, positions
                at = low if at < low else high
            positions.append(at)
        return most, positions

    def step(self, point: Sequence[float], hand: Sequence[float], joints: Sequence[float]) -> Step:
        """Return the step to the pose with the elbow on its present side; without joints if it fails or |hand| != 1."""
        size = hand[0] * hand[0] + hand[1] * hand[1] + hand[2] * hand[2] + hand[3] * hand[3]
        if not abs(size - 1) < ROUNDING:
            return Step(None, 0, inf)
        (o1, g1, _, _), (o2, g2, _, _), (o3, g3, _, _), (o4, g4, _, _), (o5, g5, _, _), (o6, g6, _, _), _ = self.joints
        q1, q2, q3, q4, q5, q6, _ = joints
        now1, now2, now3 = (q1 - o1) * g1, (q2 - o2) * g2, (q3 - o3) * g3
        now4, now5, now6 = (q4 - o4) * g4, (q5 - o5) * g5, (q6 - o6) * g6
        (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = self.frame
        bx, by, bz = self.base
        bx, by, bz = point[0] - bx, point[1] - by, point[2] - bz
        w, i, j, k = hand
        hx, hy, hz = axes([tw * w + ti * i + tj * j + tk * k for tw, ti, tj, tk in self.turn])
        tx, ty, tz = self.tool
        px = xx * bx + yx * by + zx * bz - (hx[0] * tx + hy[0] * ty + hz[0] * tz)
        py = xy * bx + yy * by + zy * bz - (hx[1] * tx + hy[1] * ty + hz[1] * tz)
        pz = xz * bx + yz * by + zz * bz - (hx[2] * tx + hy[2] * ty + hz[2] * tz)
        d1, d2 = self.d1, self.d2
        s = px * px + py * py + pz * pz
        stretch, fold, far = (d1 + d2) ** 2 - s, s - (d1 - d2) ** 2, sqrt(s)
        if far == 0 or min(stretch, fold) < -ROUNDING * (d1 + d2) ** 2:
            return Step(None, 0, inf)
        stretch, fold = sqrt(max(stretch, 0.0)), sqrt(max(fold, 0.0))
        nx, ny, nz = px / far, py / far, pz / far

        # The hinge x of the present elbow, made perpendicular to n; v = n x hinge.
        s1, c1, s2, c2, s3, c3 = sin(now1), cos(now1), sin(now2), cos(now2), sin(now3), cos(now3)
        gx, gy, gz = c1 * c3 - s1 * c2 * s3, s1 * c3 + c1 * c2 * s3, s2 * s3
        along = gx * nx + gy * ny + gz * nz
        gx, gy, gz = gx - along * nx, gy - along * ny, gz - along * nz
        size = copysign(sqrt(gx * gx + gy * gy + gz * gz), now4)
        if abs(size) < SINGULAR:
            return Step(None, 0, inf)
        gx, gy, gz = gx / size, gy / size, gz / size
        vx, vy, vz = ny * gz - nz * gy, nz * gx - nx * gz, nx * gy - ny * gx
        cosine, sine = (s + d1 * d1 - d2 * d2) / (2 * d1 * far), stretch * fold / (2 * d1 * far)  # of the angle n to u
        ux, uy, uz = cosine * nx + sine * vx, cosine * ny + sine * vy, cosine * nz + sine * vz
        yz_u = cosine * vz - sine * nz  # z component of the upper arm's y
        fx, fy, fz = (px - d1 * ux) / d2, (py - d1 * uy) / d2, (pz - d1 * uz) / d2
        wx, wy, wz = fy * gz - fz * gy, fz * gx - fx * gz, fx * gy - fy * gx  # the forearm's y

        th4 = 2 * atan2(stretch, fold)
        th2 = atan2(hypot(ux, uy), uz)
        if abs(sin(th2)) < SINGULAR:
            th1, turn = now1, atan2(gy, gx)
            th3 = turn - th1 if uz > 0 else th1 - turn
        else:
            th1, th3 = atan2(ux, -uy), atan2(gz, yz_u)
        ax, ay, az = hz
        m02, m12, m22 = gx * ax + gy * ay + gz * az, wx * ax + wy * ay + wz * az, fx * ax + fy * ay + fz * az
        th6 = atan2(hypot(m02, m12), m22)
        if abs(sin(th6)) < SINGULAR:
            turn = atan2(wx * hx[0] + wy * hx[1] + wz * hx[2], gx * hx[0] + gy * hx[1] + gz * hx[2])
            th5 = now5
            th7 = turn - th5 if m22 > 0 else th5 - turn
        else:
            th5 = atan2(m02, -m12)
            th7 = atan2(fx * hx[0] + fy * hx[1] + fz * hx[2], fx * hy[0] + fy * hy[1] + fz * hy[2])

        # Any other branch turns joint 1, 3 or 5 by half a turn more, so a largest step below pi/2 is the least.
        th = (th1, th2, th3, th4, th5, th6, th7)
        branch = (now2 < 0) + 2 * (now4 < 0) + 4 * (now6 < 0)
        most, at = self._placed(th, branch, joints)
        if most >= pi / 2:
            most, branch = min((self._placed(th, other, joints)[0], other) for other in range(8))
            at = self._placed(th, branch, joints)[1]
        return Step(None, 0, inf) if most == inf else Step(tuple(at), branch, most)
