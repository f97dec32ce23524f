# SPDX-License-Identifier: Apache-2.0
"""Swivel angles that keep all seven joints within limits, in closed form; joint angles without jumps along a path.

While the hand stays in place, the arm turns about the line from shoulder to wrist, so every element of the rotation
matrix M of shoulder or wrist is A sin(phi) + B cos(phi) + C. The angles of the ball joint M = Rz(a) Rx(b) Rz(c) are

    tan a = M02 / -M12,  cos b = M22,  tan c = M20 / M21

so an angle is at a limit where an expression of the same form is 0, which holds for at most two phi (Shimizu et al.,
IEEE T-RO 24(5), 2008).  Each arc between two neighbours of these phi is feasible or infeasible as a whole.
"""

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..io.words import DEFAULT_D1, DEFAULT_D2, Targets
from ..reference import joints
from ..reference.kinematics import Axis, direction, product, to_z
from .pose import Floats, Hands, Order, checked_limits, hanging, refuse, solve

CHUNK = 1024
TURN = 2 * np.pi

FLIPS = np.array([(0, 1, 4, 5), (2, 3, 6, 7)])  # branches of each elbow solution

BESIDE = np.tan(np.radians((-75, -60, -40, -20, 0, 20, 40, 60, 75)))
"""Scaled offsets from the swivel angle at which a ball joint is nearest to singular; th1 and th3 turn equally."""


@dataclass(frozen=True, eq=False)
class Swivels:
    """Swivel angles of N hand poses for which all joints are within their limits.

    * intervals (N, K, 2): first and last angle of each closed interval, rad.  The first is in -pi to pi, the last at
      most a turn above it.  Poses with fewer than K intervals are filled up with nan
    * over_limit (N, 7): mask of joints outside their limits at the angle with fewest such joints; all True out of reach
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
            return beyond(distance, near, far)
        over = [str(1 + joint) for joint in np.flatnonzero(self.over_limit[n])]
        return f"joint{'s'[: len(over) > 1]} {', '.join(over)} outside the limits" if over else ""

    def nearest(self, near: ArrayLike | None = None, margin: float = 0.0) -> Floats:
        """Return the feasible swivel angle (N,) nearest to ``near``, rad in -pi to pi; nan where there is none.

        near: rad, a number or (N,).  None treats the poses as a path: near is ``start`` for the first pose, then the
        previous angle.  margin: least distance (rad) from both ends of an interval; if the interval is too short, its
        middle is returned.  Raises ValueError for a negative margin and for numbers that are not finite.
        """
        if not 0 <= margin < np.inf:
            raise ValueError(f"margin {margin!r} must be a finite angle in rad, 0 or more")
        refuse("near", ~np.isfinite(np.atleast_1d(0.0 if near is None else near)), "not finite")
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


def beyond(distance: float, near: float, far: float) -> str:
    """Return a message for a wrist whose distance from the shoulder is outside the reach, ``near`` to ``far``."""
    return f"wrist {distance:.6g} from the shoulder, where the arm reaches {near:.6g} to {far:.6g}"


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

    The arguments are as in :func:`solve`; ``bent`` is (upper, fore) of an :class:`Arm` with bent links.  Without
    limits all angles of a pose in reach are feasible.  A pose out of reach has no feasible angle.  Isolated angles are
    intervals of length 0.  Raises ValueError like :func:`solve`.
    """
    hands = Hands.checked(hand, tool, branch, order)
    circles = Circles.of(np.asarray(points, dtype=np.float64) - hands.offset.T, hands, d1, d2, axis, bent)
    bounds = checked_limits(limits if limits is not None else [(-np.inf, np.inf)] * 7)
    branches = np.broadcast_to(hands.branch, len(circles))
    elbow = (branches & joints.Branch.ELBOW > 0).astype(int)
    parts = [circles.arcs(rows, elbow[rows], bounds, [branches[rows]]) for rows in circles.chunks()]
    intervals, over_limit = _padded([some for (some,), _ in parts]), np.concatenate([over for _, over in parts])
    return Swivels(intervals, over_limit, circles.distance, circles.reach, hanging(axis))


def _padded(intervals: list[Floats]) -> Floats:
    """Return intervals (n, K, 2) of several parts as one array, filled up with nan to the largest K."""
    most = max(some.shape[1] for some in intervals)
    return np.concatenate(
        [np.pad(p, ((0, 0), (0, most - p.shape[1]), (0, 0)), constant_values=np.nan) for p in intervals]
    )


@dataclass(frozen=True, eq=False)
class Circles:
    """Rotations of shoulder and wrist of N hand poses as functions of the swivel angle, for both elbow solutions.

    * ends (2, N, 2, 2, 4): quaternions by elbow solution, pose, phi (0 or pi), and ball joint (shoulder or wrist);
      Q(phi) = cos(phi/2) Q(0) + sin(phi/2) Q(pi)
    * flexion (2, N): th4
    * distance (N,): from shoulder to wrist; reach (N, 2): the least and the largest possible distance; slack: distance
      by which a wrist may be out of reach
    """

    ends: Floats
    flexion: Floats
    distance: Floats
    reach: Floats
    slack: float = 0.0

    def __len__(self) -> int:
        return len(self.distance)

    @classmethod
    def of(
        cls, wrists: ArrayLike, hands: Hands, d1: ArrayLike, d2: ArrayLike, axis: Axis = "z", bent: Any = None
    ) -> "Circles":
        """Return the circles for wrist targets (N, 3) and hands.  Arguments and errors as in :func:`solve`."""
        pose = solve(wrists, 0.0, d1, d2, axis=axis)
        count, frame = len(pose.qs), to_z(axis)
        lengths = [np.broadcast_to(np.asarray(d, dtype=np.float64), count) for d in (d1, d2)]
        reach = np.column_stack((np.abs(lengths[0] - lengths[1]), lengths[0] + lengths[1]))
        line = np.broadcast_to(np.atleast_2d(wrists), (count, 3))
        distance = np.linalg.norm(line, axis=1)
        # The arm turns about the line to the wrist; a wrist at the shoulder counts as above it.
        about = np.where(distance > 0, line.T / np.where(distance > 0, distance, 1), direction(axis)[:, None])
        qe, q = pose.qe[:, :2].T, np.broadcast_to(hands.q, (4, count))
        ends, flexion = np.empty((2, count, 2, 2, 4)), np.empty((2, count))
        for end, qs in enumerate((pose.qs.T, product((0, *about), pose.qs.T))):
            bones = product(frame, qs), joints.flexion(qe), joints.wrist_quaternion(qs, qe, q)
            for elbow in (0, 1):
                turns = joints.bent(*bones, elbow * joints.Branch.ELBOW, *(bent or (joints.UNIT, joints.UNIT)))
                ends[elbow, :, end, 0], flexion[elbow], ends[elbow, :, end, 1] = turns[0].T, turns[1], turns[2].T
        return cls(ends, flexion, distance, reach)

    @property
    def unreachable(self) -> NDArray[np.bool_]:
        """True for a wrist out of reach, (N,)."""
        return np.asarray(_beyond(self.distance, *(self.reach + (-self.slack, self.slack)).T))

    def chunks(self) -> Iterator[slice]:
        """Yield slices of poses, so short that their arrays stay in the cache."""
        yield from (slice(start, start + CHUNK) for start in range(0, max(len(self), 1), CHUNK))

    def joints(self, row: NDArray, elbow: NDArray, phi: Floats) -> Floats:
        """Return th1 .. th7 (7, M) of poses ``row`` at swivel angles ``phi``, in branch 0 of shoulder and wrist."""
        ends = self.ends[elbow.astype(int), row]
        half = (phi / 2)[:, None, None]
        qs, qw = np.moveaxis(ends[:, 0] * np.cos(half) + ends[:, 1] * np.sin(half), 0, 2)
        return joints.angles(qs, self.flexion[elbow.astype(int), row], qw)

    def extremes(self) -> Floats:
        """Return swivel angles (N, K, 2 elbow solutions) where th2 or th6 is nearest to singular, and angles nearby."""
        stations = self.ends[:, :, 0], (self.ends[:, :, 0] + self.ends[:, :, 1]) * 0.5**0.5, self.ends[:, :, 1]
        at_0, at_quarter, at_half = ((np.square(q) * (1, -1, -1, 1)).sum(axis=-1)[..., None] for q in stations)
        middle = (at_0 + at_half) / 2
        size = np.hypot(at_quarter - middle, at_0 - middle)
        phi = np.arctan2(at_quarter - middle, at_0 - middle) + (0, np.pi)  # of the largest and smallest cosine
        cosine = middle + size * (1, -1)
        sine = np.sqrt(np.clip(1 - np.square(cosine), 0, 1))
        beside = (sine / np.sqrt(np.maximum(size, 1e-12)))[..., None] * BESIDE
        toward = cosine * (1, -1) > 0  # the side on which the joint comes near 0 or pi
        used = (BESIDE == 0) | (((sine < 0.4) & toward)[..., None] & (np.abs(beside) < 0.5))
        swivels = np.where(used, phi[..., None] + beside, np.nan)
        return np.moveaxis(swivels.reshape(2, len(self), 4 * len(BESIDE)), 0, 2)

    def middles(self, bounds: Floats) -> Floats:
        """Return swivel angles (N, K, 8 branches): the middle of each feasible interval, and points near its ends."""
        arcs = [[self.arcs(rows, elbow, bounds, list(FLIPS[elbow]))[0] for rows in self.chunks()] for elbow in (0, 1)]
        intervals = _padded([part[n] for parts in arcs for n in range(4) for part in parts])
        of_branch = intervals.reshape(8, len(self), *intervals.shape[1:])[FLIPS.ravel().argsort()]
        first, last = of_branch.transpose(3, 1, 2, 0)
        inset = np.minimum(0.05, (last - first) / 2)
        return np.concatenate((first + inset, (first + last) / 2, last - inset), axis=1)

    def arcs(self, rows: slice, elbow: NDArray | int, bounds: Floats, branches: list) -> tuple[list[Floats], NDArray]:
        """Return the feasible intervals (n, K, 2) of poses ``rows`` for each of ``branches`` (numbers or (n,)) and, for
        the last branch, a mask (n, 7) of the joints outside their limits at the angle with the fewest such joints.

        elbow (n,): elbow solution, used instead of the branch's ELBOW bit.
        """
        numbers = np.arange(len(self))[rows]
        ends, flexion = np.moveaxis(self.ends[elbow, numbers], 0, 3), self.flexion[elbow, numbers]
        roots = np.sort(_roots(ends, bounds), axis=1)  # nan last
        roots = roots[:, : max(1, np.isfinite(roots).sum(axis=1).max(initial=0))]
        last = np.nanmax(np.where(np.isnan(roots), -np.pi, roots), axis=1, keepdims=True)
        roots = np.where(np.isnan(roots), last, roots)
        following = np.concatenate((roots[:, 1:], roots[:, :1] + TURN), axis=1)
        tried = np.concatenate((roots, (roots + following) / 2), axis=1)
        qs, qw = ends[0, ..., None] * np.cos(tried / 2) + ends[1, ..., None] * np.sin(tried / 2)
        th = joints.angles(qs, np.broadcast_to(flexion[:, None], tried.shape), qw)
        outsides = []  # (7, n, 2 K) with both ball joints in branch 0, and in the other
        for some in (th, joints.branched(th, joints.Branch.SHOULDER | joints.Branch.WRIST)):
            beyond = joints.outside(some, bounds)
            settled = joints.settled(some, bounds, beyond)
            outsides.append(beyond if settled is some else joints.outside(settled, bounds))
        outside, intervals = np.array(outsides) | self.unreachable[rows][:, None], []
        for branch in branches:
            balls = np.asarray(branch) & joints.Branch.SHOULDER > 0, np.asarray(branch) & joints.Branch.WRIST > 0
            other = np.broadcast_to(np.array(balls)[[0, 0, 0, 0, 1, 1, 1]].reshape(7, -1), (7, len(numbers)))
            beyond = outside[other.astype(int), np.arange(7)[:, None], np.arange(len(numbers))]
            at_root, arc = np.split(~beyond.any(axis=0), 2, axis=1)
            arc = np.where(following == roots, at_root, arc)  # an arc of length 0
            intervals.append(_joined(roots, at_root | arc | np.roll(arc, 1, axis=1), arc))
        fewest = np.take_along_axis(beyond, beyond.sum(axis=0).argmin(axis=1)[None, :, None], 2)[..., 0].T
        return intervals, fewest


def _elements(q):
    """Return the elements M02, -M12, M22, M20, M21 (5, N) of the rotation matrices of quaternions (4, N)."""
    w, i, j, k = q
    tilt = (w * w + k * k) - (i * i + j * j)
    return np.array((2 * (i * k + w * j), 2 * (w * i - j * k), tilt, 2 * (i * k - w * j), 2 * (j * k + w * i)))


def _roots(ends, bounds):
    """Return the swivel angles (N, 28) at which a joint may be at a limit; nan fills missing ones.

    Each limit of six joints gives two angles. If the straight arm is along an axis, each ball joint gives two more.
    """
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
        goal = centre[first] + sign * centre[first + 2] - begin
        rate[np.minimum(w * w + k * k, i * i + j * j) > 1e-10] = np.nan
        straight += [rate * (goal + side * (width[first] + width[first + 2])) for side in (-1, 1)]
    return joints.wrap(np.concatenate((middle - half, middle + half, straight))).T


def _joined(roots, at_root, arc):
    """Join feasible arcs to intervals (N, K, 2). at_root, arc: whether a root and the arc after it are feasible."""
    ring = np.stack((at_root, arc), axis=2).reshape(len(roots), 2 * roots.shape[1])
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
    wrapped = np.flatnonzero(intervals[:, 0, 1] < intervals[:, 0, 0])  # its end belongs to the last interval
    lasts = intervals[wrapped, :, 1]
    intervals[wrapped, :, 1] = np.roll(lasts, -1, axis=1)
    intervals[wrapped, counts[wrapped] - 1, 1] = lasts[:, 0] + TURN
    return intervals


def continuous_core_angles(angles: ArrayLike) -> Floats:
    """Return joints (N, 7) without jumps: each row takes the branch and whole turns nearest to the previous row.

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


def elbow_jumps(targets: Targets) -> tuple[NDArray[np.intp], list[float]]:
    """Return the rows at which the elbow jumps because the wrist passes the reference axis, and a better axis.

    Let the wrist move by s from one row to the next, and let r be the smaller of its two distances from the axis.
    The elbow jumps if it moves by more than a tenth of the reach, more than 4 s, and more than 4 (r - s).
    """
    reach = targets.reach.max(initial=1e-300)
    position, jumps = targets.core_wrist / reach, [np.empty(0, dtype=np.intp)]
    elbow = solve(position, targets.phi % (2 * np.pi), targets.d1 / reach, targets.d2 / reach).elbow
    arms = np.zeros(len(targets)) if targets.arm is None else targets.arm
    for rows in (np.flatnonzero(arms == arm) for arm in np.unique(arms)):
        moved, swung = (np.linalg.norm(np.diff(points[rows], axis=0), axis=1) for points in (position, elbow))
        off_axis = np.hypot(*position[rows, :2].T)
        passed = np.minimum(off_axis[1:], off_axis[:-1]) - moved
        most = np.maximum(4 * np.maximum(moved, passed), 0.1 * targets.reach[rows[1:]] / reach)
        jumps.append(rows[1:][swung > most])
    lines = np.array([line for line in itertools.product((0.0, 1.0, -1.0), repeat=3) if line > (0.0, 0.0, 0.0)])
    wrist = targets.points_from_core(targets.core_wrist)
    near = np.abs(wrist @ lines.T) / np.linalg.norm(lines, axis=1)
    toward = (near / np.maximum(np.linalg.norm(wrist, axis=1), 1e-300)[:, None]).max(axis=0)
    return np.sort(np.concatenate(jumps)), lines[np.argmin(toward)].tolist()
