# SPDX-License-Identifier: Apache-2.0
"""The pose nearest to a robot's present joints, without arrays: for a control loop that asks for one pose at a time.

The elbow keeps its side of the line from shoulder to wrist; of the eight branches, the one whose largest step is the
smallest is taken. With n toward the wrist and v across it toward the elbow, the upper arm is

    u = n cos a + v sin a        cos a = (s + d1^2 - d2^2) / (2 d1 |p|)        s = |p|^2
"""

from collections.abc import Sequence
from math import atan2, copysign, cos, hypot, inf, pi, remainder, sin, sqrt
from typing import NamedTuple

from ..reference.joints import ROUNDING
from .hands import Floats
from .path import SINGULAR

TURN = 2 * pi

Vector = tuple[float, float, float]


class Step(NamedTuple):
    """Answer of :meth:`Arm.track`.

    * joints: seven positions, rad; None at a dead end
    * branch: bits of :class:`Branch`
    * largest: largest step of a joint, rad
    * reason: why it is a dead end, or an empty string
    """

    joints: tuple[float, ...] | None
    branch: int
    largest: float
    reason: str = ""


def times(a: Sequence[float], b: Sequence[float]) -> tuple[float, float, float, float]:
    """Return the Hamilton product of two quaternions w, i, j, k."""
    aw, ai, aj, ak = a
    bw, bi, bj, bk = b
    return (
        aw * bw - ai * bi - aj * bj - ak * bk,
        aw * bi + ai * bw + aj * bk - ak * bj,
        aw * bj - ai * bk + aj * bw + ak * bi,
        aw * bk + ai * bj - aj * bi + ak * bw,
    )


def axes(q: Sequence[float]) -> tuple[Vector, Vector, Vector]:
    """Return the axes x, y, z that a unit quaternion turns to, the columns of its rotation matrix."""
    w, i, j, k = q
    ii, jj, kk, ij, ik, jk, wi, wj, wk = i * i, j * j, k * k, i * j, i * k, j * k, w * i, w * j, w * k
    return (
        (1 - 2 * (jj + kk), 2 * (ij + wk), 2 * (ik - wj)),
        (2 * (ij - wk), 1 - 2 * (ii + kk), 2 * (jk + wi)),
        (2 * (ik + wj), 2 * (jk - wi), 1 - 2 * (ii + jj)),
    )


class Tracker:
    """Constants of an exact arm with straight links, as plain numbers; for the arguments see :class:`Arm`."""

    def __init__(
        self,
        d1: float,
        d2: float,
        tool: Floats,
        offsets: Floats,
        signs: Floats,
        limits: Floats,
        base: Floats,
        mount: Floats,
        tip: Floats,
    ) -> None:
        self.d1, self.d2, self.tool, self.base = d1, d2, tuple(tool.tolist()), tuple(base.tolist())
        w, i, j, k = mount.tolist()
        self.from_base, self.frame = (w, -i, -j, -k), axes((w, -i, -j, -k))
        w, i, j, k = tip.tolist()
        self.from_tip = (w, -i, -j, -k)
        self.joints = list(zip(offsets.tolist(), signs.tolist(), *limits.T.tolist(), strict=True))

    def _options(self, joint: int, th: float, other: float, present: float) -> tuple[tuple[float, float], ...]:
        """Return for two angles of a joint the step and its nearest position; step inf outside the limits."""
        offset, sign, low, high = self.joints[joint]
        options = []
        for angle in (th, other):
            at = present + remainder(sign * angle + offset - present, TURN)
            inside = low - ROUNDING <= at <= high + ROUNDING
            options.append((abs(at - present), min(max(at, low), high)) if inside else (inf, at))
        return tuple(options)

    def step(self, point: Sequence[float], hand: Sequence[float], joints: Sequence[float]) -> Step:
        """Return the nearest pose with the elbow on its present side; none for a hand whose length is not 1."""
        size = hand[0] * hand[0] + hand[1] * hand[1] + hand[2] * hand[2] + hand[3] * hand[3]
        if not abs(size - 1) < ROUNDING:
            return Step(None, 0, inf)
        present = [(at - offset) * sign for at, (offset, sign, _, _) in zip(joints, self.joints, strict=True)]
        (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = self.frame
        bx, by, bz = self.base
        bx, by, bz = point[0] - bx, point[1] - by, point[2] - bz
        hx, hy, hz = axes(times(times(self.from_base, hand), self.from_tip))
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
        s1, c1, s2, c2, s3, c3 = (f(angle) for angle in present[:3] for f in (sin, cos))
        gx, gy, gz = c1 * c3 - s1 * c2 * s3, s1 * c3 + c1 * c2 * s3, s2 * s3
        along = gx * nx + gy * ny + gz * nz
        gx, gy, gz = gx - along * nx, gy - along * ny, gz - along * nz
        size = copysign(sqrt(gx * gx + gy * gy + gz * gz), present[3])
        if abs(size) < SINGULAR:
            return Step(None, 0, inf)
        gx, gy, gz = gx / size, gy / size, gz / size
        vx, vy, vz = ny * gz - nz * gy, nz * gx - nx * gz, nx * gy - ny * gx
        cos_a, sin_a = (s + d1 * d1 - d2 * d2) / (2 * d1 * far), stretch * fold / (2 * d1 * far)
        ux, uy, uz = cos_a * nx + sin_a * vx, cos_a * ny + sin_a * vy, cos_a * nz + sin_a * vz
        yz_u = cos_a * vz - sin_a * nz  # z component of the upper arm's y
        fx, fy, fz = (px - d1 * ux) / d2, (py - d1 * uy) / d2, (pz - d1 * uz) / d2
        wx, wy, wz = fy * gz - fz * gy, fz * gx - fx * gz, fx * gy - fy * gx  # the forearm's y

        th4 = 2 * atan2(stretch, fold)
        th2, th6 = atan2(hypot(ux, uy), uz), 0.0
        if abs(sin(th2)) < SINGULAR:
            th1, turn = present[0], atan2(gy, gx)
            th3 = turn - th1 if uz > 0 else th1 - turn
        else:
            th1, th3 = atan2(ux, -uy), atan2(gz, yz_u)
        m02, m12, m22 = (a * hz[0] + b * hz[1] + c * hz[2] for a, b, c in ((gx, gy, gz), (wx, wy, wz), (fx, fy, fz)))
        th6 = atan2(hypot(m02, m12), m22)
        if abs(sin(th6)) < SINGULAR:
            turn = atan2(wx * hx[0] + wy * hx[1] + wz * hx[2], gx * hx[0] + gy * hx[1] + gz * hx[2])
            th5 = present[4]
            th7 = turn - th5 if m22 > 0 else th5 - turn
        else:
            th5 = atan2(m02, -m12)
            th7 = atan2(fx * hx[0] + fy * hx[1] + fz * hx[2], fx * hy[0] + fy * hy[1] + fz * hy[2])

        options = self._options
        one, two, three = (
            options(0, th1, th1 + pi, joints[0]),
            options(1, th2, -th2, joints[1]),
            options(2, th3, th3 + pi, joints[2]),
        )
        four, five = options(3, th4, -th4, joints[3]), options(4, th5, th5 + pi, joints[4])
        six, seven = options(5, th6, -th6, joints[5]), options(6, th7, th7 + pi, joints[6])
        best, chosen = inf, 0
        for branch in range(8):
            a, b, c = branch & 1, branch >> 1 & 1, branch >> 2
            most = max(one[a][0], two[a][0], three[a ^ b][0], four[b][0], five[b ^ c][0], six[c][0], seven[c][0])
            if most < best:
                best, chosen = most, branch
        if best == inf:
            return Step(None, 0, inf)
        a, b, c = chosen & 1, chosen >> 1 & 1, chosen >> 2
        picked = one[a], two[a], three[a ^ b], four[b], five[b ^ c], six[c], seven[c]
        return Step(tuple(at for _, at in picked), chosen, best)
