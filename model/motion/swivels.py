# SPDX-License-Identifier: Apache-2.0
"""Closed form of the swivel angles that keep all seven joints within their limits; joints along a path without jumps.

While the hand stays in place, the arm turns about the line from shoulder to wrist, so every element of the rotation
matrix M of shoulder or wrist is A sin(phi) + B cos(phi) + C. The angles of the ball joint M = Rz(a) Rx(b) Rz(c) are

    tan a = M02 / -M12,  cos b = M22,  tan c = M20 / M21

so an angle is at a limit where an expression of the same form is 0, which holds for at most two phi (Shimizu et al.,
IEEE T-RO 24(5), 2008).  Each arc between two neighbours of these phi is feasible or infeasible as a whole.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..io.words import DEFAULT_D1, DEFAULT_D2
from ..reference import joints
from ..reference.kinematics import product
from .hands import Hands, checked_limits
from .pose import Axis, Floats, Order, hanging, solve, to_z

CHUNK = 1024
TURN = 2 * np.pi
ROOTS = 28  # two for each limit of six joints, and for a straight arm two for each ball joint


@dataclass(frozen=True, eq=False)
class Swivels:
    """Swivel angles of N hand poses for which all joints are within their limits.

    * intervals (N, K, 2): first and last angle of each closed interval, rad.  The first is in -pi to pi, the last at
      most a turn above it.  Poses with fewer than K intervals are filled up with nan
    * over_limit (N, 7): joints outside their limits at the angle with the fewest such joints; all True out of reach
    * distance (N,): from shoulder to wrist; reach (N, 2): the least and the largest possible distance
    * start: swivel angle (rad) at which the elbow hangs
    """

    intervals: Floats
    over_limit: NDArray[np.bool_]
    distance: Floats
    reach: Floats
    start: float

    @property
    def feasible(self) -> NDArray[np.bool_]:
        """True for a pose with at least one interval, (N,)."""
        return np.asarray(np.isfinite(self.intervals[..., 0]).any(axis=1))

    def reason(self, n: int) -> str:
        """Return text that explains why pose n is infeasible, or an empty string if it is feasible."""
        (near, far), distance = self.reach[n], self.distance[n]
        if _beyond(distance, near, far):
            return f"wrist {distance:.6g} from the shoulder, where the arm reaches {near:.6g} to {far:.6g}"
        over = [str(1 + joint) for joint in np.flatnonzero(self.over_limit[n])]
        return f"joint{'s'[: len(over) > 1]} {', '.join(over)} outside the limits" if over else ""

    def nearest(self, near: ArrayLike | None = None, margin: float = 0.0) -> Floats:
        """Return the feasible swivel angle (N,) nearest to ``near``, rad in -pi to pi; nan where there is none.

        near: rad, a number or (N,).  None treats the poses as a path: near is ``start`` for the first pose, then the
        previous angle.  margin: least distance (rad) from both ends; a shorter interval gives its middle.
        """
        first, last = np.moveaxis(self.intervals, 2, 0)
        inset = np.minimum(margin, (last - first) / 2)
        whole = last - first >= TURN
        first, last = np.where(whole, first, first + inset), np.where(whole, last, last - inset)
        if near is not None:
            return _nearest(first, last, np.broadcast_to(np.asarray(near, dtype=np.float64), len(first)))
        chosen, before = np.empty(len(first)), np.array([self.start])
        for n in range(len(first)):
            chosen[n] = _nearest(first[n : n + 1], last[n : n + 1], before)[0]
            before = chosen[n : n + 1] if np.isfinite(chosen[n]) else before
        return chosen


def _beyond(distance, near, far):
    """Return whether distances are outside an arm's reach by more than rounding."""
    return np.abs(distance - np.clip(distance, near, far)) > joints.ROUNDING * far


def _nearest(first: Floats, last: Floats, near: Floats) -> Floats:
    """Return the angles (N,) in the intervals from ``first`` to ``last`` (N, K) that are nearest to ``near`` (N,)."""
    ahead = np.mod(near[:, None] - first, TURN)
    inside = ahead <= last - first
    to_first, to_last = joints.wrap(first - near[:, None]), joints.wrap(last - near[:, None])
    step = np.where(inside, 0.0, np.where(np.abs(to_first) <= np.abs(to_last), to_first, to_last))
    best = np.nanargmin(np.where(np.isnan(step), np.inf, np.abs(step)), axis=1)
    return joints.wrap(near + np.take_along_axis(step, best[:, None], 1)[:, 0])


def feasible_swivel(
    points: ArrayLike,
    hand: ArrayLike,
    d1: ArrayLike = DEFAULT_D1,
    d2: ArrayLike = DEFAULT_D2,
    tool: ArrayLike = 0.0,
    limits: ArrayLike | None = None,
    branch: ArrayLike = 0,
    *,
    axis: Axis = "z",
    order: Order = "wxyz",
    bent: tuple[ArrayLike, ArrayLike] | None = None,
) -> Swivels:
    """Return all swivel angles for which the seven joints of hand poses are within their limits.

    The arguments are those of :func:`solve`; ``bent`` is (upper, fore) of an :class:`Arm` with bent links.  Without
    limits all angles of a pose in reach are feasible.  A pose out of reach has no feasible angle.  Isolated angles are
    intervals of length 0.  Raises ValueError like :func:`solve`.
    """
    hands = Hands.checked(hand, tool, branch, order)
    wrists = np.asarray(points, dtype=np.float64) - hands.offset.T
    poses = [solve(wrists, phi, d1, d2, axis=axis) for phi in (0.0, np.pi / 2, np.pi)]
    count, frame = len(poses[0].qs), to_z(axis)
    bounds = checked_limits(limits if limits is not None else [(-np.inf, np.inf)] * 7)
    lengths = [np.broadcast_to(np.asarray(d, dtype=np.float64), count) for d in (d1, d2)]
    reach = np.column_stack((np.abs(lengths[0] - lengths[1]), lengths[0] + lengths[1]))
    distance = np.broadcast_to(np.linalg.norm(np.atleast_2d(wrists), axis=1), count)
    unreachable = _beyond(distance, *reach.T)
    hand_q, branches = np.broadcast_to(hands.q, (4, count)), np.broadcast_to(hands.branch, count)
    parts = []
    for rows in (slice(start, start + CHUNK) for start in range(0, max(count, 1), CHUNK)):
        at_0, at_quarter, at_half = (pose.qs[rows].T for pose in poses)
        # Q(phi) = cos(phi/2) Q(0) + sin(phi/2) Q(pi); a solved quaternion may have the other sign.
        at_half = at_half * np.sign((at_quarter * at_0).sum(axis=0) * (at_quarter * at_half).sum(axis=0))
        qe, ends = poses[0].qe[rows, :2].T, []
        for qs in (at_0, at_half):
            qw = joints.wrist_quaternion(qs, qe, hand_q[:, rows])
            bones = product(frame, qs), joints.flexion(qe), qw, branches[rows]
            qs, flexion, qw, axis_branch = bones if bent is None else joints.bent(*bones, *bent)
            ends.append((qs, qw))
        parts.append(_intervals(np.array(ends), flexion, bounds, axis_branch, unreachable[rows]))
    most = max(1, *(part.shape[1] for part, _ in parts))
    padded = [np.pad(p, ((0, 0), (0, most - p.shape[1]), (0, 0)), constant_values=np.nan) for p, _ in parts]
    over_limit = np.concatenate([over for _, over in parts])
    return Swivels(np.concatenate(padded), over_limit, distance, reach, hanging(axis))


def _elements(q):
    """Return the elements M02, -M12, M22, M20, M21 (5, N) of the rotation matrices of quaternions (4, N)."""
    w, i, j, k = q
    tilt = (w * w + k * k) - (i * i + j * j)
    return np.array((2 * (i * k + w * j), 2 * (w * i - j * k), tilt, 2 * (i * k - w * j), 2 * (j * k + w * i)))


def _roots(ends, branch, bounds):
    """Return the swivel angles (N, ROOTS) at which a joint may be at a limit; nan for missing ones."""
    stations = ends[0], (ends[0] + ends[1]) * 0.5**0.5, ends[1]
    at_0, at_quarter, at_half = (np.array([_elements(q) for q in balls]) for balls in stations)  # (ball, element, N)
    constant, cosine = (at_0 + at_half) / 2, (at_0 - at_half) / 2
    form = np.array((at_quarter - constant, cosine, constant))
    bounded = np.where((bounds[:, 1] - bounds[:, 0] < TURN)[:, None], bounds, np.nan)
    forms = []  # expressions that are 0 where a joint is at a limit
    for ball, first in ((0, 0), (1, 4)):
        u1, v1, cos_b, u3, v3 = np.moveaxis(form[:, ball], 1, 0)  # (3, N)
        forms += [u1 * np.cos(limit) - v1 * np.sin(limit) for limit in bounded[first]]
        forms += [cos_b - np.array((0, 0, np.cos(limit)))[:, None] for limit in bounded[first + 1]]
        forms += [u3 * np.cos(limit) - v3 * np.sin(limit) for limit in bounded[first + 2]]
    a, b, c = np.moveaxis(np.array(forms), 1, 0)  # (12, N): a sin(phi) + b cos(phi) + c = 0
    size = np.hypot(a, b)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = -c / size
    ratio = np.where(np.abs(ratio) > 1, np.where(np.abs(ratio) < 1 + 1e-12, np.sign(ratio), np.nan), ratio)
    middle, half = np.arctan2(a, b), np.arccos(ratio)
    # Where the arm is straight along an axis, a + c or a - c is the swivel angle, up to a constant.
    straight, (centre, width) = [], joints.centred(bounds)
    for ball, first in ((0, 0), (1, 4)):
        w, i, j, k = ends[0][ball]
        sum_counts = w * w + k * k >= i * i + j * j  # the angle b is 0, not pi
        begin, quarter = (2 * np.where(sum_counts, *np.arctan2(q[ball][[3, 2]], q[ball][:2])) for q in stations[:2])
        rate, sign = np.sign(joints.wrap(quarter - begin)), np.where(sum_counts, 1, -1)
        goal = centre[first] + sign * centre[first + 2] + np.pi * (branch & joints.Branch.ELBOW != 0) - begin
        straight += [rate * (goal + side * (width[first] + width[first + 2])) for side in (-1, 1)]
    return joints.wrap(np.concatenate((middle - half, middle + half, straight))).T


def _intervals(ends, flexion, bounds, branch, unreachable):
    """Return intervals (N, K, 2), and joints outside their limits (N, 7) at the angle with the fewest such joints.

    ends (2, 2, 4, N): Qs and Qw at phi = 0 and pi.
    """
    roots = np.sort(_roots(ends, branch, bounds), axis=1)  # nan last
    last = np.nanmax(np.where(np.isnan(roots), -np.pi, roots), axis=1, keepdims=True)
    roots = np.where(np.isnan(roots), last, roots)
    following = np.concatenate((roots[:, 1:], roots[:, :1] + TURN), axis=1)
    tried = np.concatenate((roots, (roots + following) / 2), axis=1)
    qs, qw = ends[0, ..., None] * np.cos(tried / 2) + ends[1, ..., None] * np.sin(tried / 2)
    th4, branches = (np.broadcast_to(column[:, None], tried.shape) for column in (flexion, branch))
    th = joints.settled(joints.angles(qs, th4, qw, branches), bounds)
    outside = joints.outside(th, bounds) | unreachable[:, None]
    fewest = np.take_along_axis(outside, outside.sum(axis=0).argmin(axis=1)[None, :, None], 2)[..., 0].T
    at_root, arc = np.split(~outside.any(axis=0), 2, axis=1)
    arc = np.where(following == roots, at_root, arc)  # an arc of length 0
    at_root |= arc | np.roll(arc, 1, axis=1)
    ring = np.stack((at_root, arc), axis=2).reshape(len(roots), 2 * ROOTS)
    whole = ring.all(axis=1)
    begins, ends = ring & ~np.roll(ring, 1, axis=1), ring & ~np.roll(ring, -1, axis=1)
    counts = np.maximum(begins.sum(axis=1), whole)
    intervals = np.full((len(roots), counts.max(initial=1), 2), np.nan)
    present = np.arange(intervals.shape[1]) < counts[:, None]
    intervals[whole, 0] = -np.pi, np.pi
    present[whole] = False
    for side, marks in enumerate((begins, ends)):
        row, place = np.nonzero(marks)
        intervals[..., side][present] = roots[row, place // 2]
    wrapped = intervals[:, :1, 1] < intervals[:, :1, 0]  # the first end in the row belongs to the last interval
    for n in np.flatnonzero(wrapped[:, 0]) if wrapped.size else ():
        lasts = intervals[n, : counts[n], 1]
        lasts[:] = np.append(lasts[1:], lasts[0] + TURN)
    return intervals, fewest


def continuous_joints(angles: ArrayLike) -> Floats:
    """Return joints (N, 7) of a path without jumps: each pose takes the branch and turns nearest to the previous pose.

    angles (N, 7): rad; rows of nan are skipped.  Where th2 is within `joints.SINGULAR` of 0 or pi, only the sum or
    difference of th1 and th3 counts, so th1 keeps its value.  The same holds for th6 with th5 and th7.
    """
    path = np.array(angles, dtype=np.float64)
    present = np.flatnonzero(np.isfinite(path).all(axis=1))
    th = path[present].T
    for first, tilt, third in ((0, 1, 2), (4, 5, 6)):
        away = np.cos(th[tilt]) < 0
        regular = np.abs(np.sin(th[tilt])) > joints.SINGULAR
        before = np.maximum.accumulate(np.where(regular, np.arange(len(present)), 0))
        kept = np.where(regular, th[first], th[first, before])
        th[third] += np.where(away, kept - th[first], th[first] - kept)
        th[first] = kept
    branches = np.array([joints.branched(th, branch) for branch in range(8)])  # (branch, 7, N)
    chosen, branch = np.zeros(len(present), dtype=int), 0
    for start in range(1, len(present), CHUNK):
        rows = slice(start, start + CHUNK)
        move = joints.wrap(branches[None, ..., rows] - branches[:, None, :, start - 1 : start - 1 + len(th[0, rows])])
        nearest = np.square(move).sum(axis=2).argmin(axis=1)  # (branch before, row)
        for n, row in enumerate(nearest.T.tolist(), start):
            chosen[n] = branch = row[branch]
    path[present] = np.unwrap(branches[chosen, :, np.arange(len(present))], axis=0)
    return path
