# SPDX-License-Identifier: Apache-2.0
"""Robots with seven joints: base frame, zero positions, joint directions and limits; reader of URDF files.

Joint n of the robot is at signs[n] * th_n + offsets[n], where th_n is an angle of :mod:`cga_ik.reference.joints`. The
built-in arms are in `ROBOTS`, among them `IIWA14`, a KUKA LBR iiwa 14 R820, and `HUMAN`, with anatomical limits.
"""

from collections import UserDict
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..io.flags import UNREACHABLE
from ..io.words import DEFAULT_D1, DEFAULT_D2
from ..reference import joints
from ..reference.kinematics import angle_between, conjugate, matrix, multiply, quaternion, rotate
from .path import JointPath, Planner, Progress
from .pose import Floats, Hands, Pose, checked_limits, common_count, refuse, solve, swivel
from .swivels import Circles, Swivels, feasible_swivel
from .track import Step, Tracker
from .urdf import SAMPLES, TURN_MISFIT, Chain, arguments, exact, nearest, placed

Given = ArrayLike | None  # argument; None: chosen

UNIT = joints.UNIT
SPARE = 0.02  # angle (rad) by which the start of a correction may exceed a limit
CORRECTED = 1e-9  # largest error after correction (distance / size, or rad); otherwise all candidates are corrected
GOAL = 0.2  # largest step of a joint along a path, rad
BATCH = 128  # poses per batch if branch and swivel angle are chosen, so that arrays stay in the cache
CHUNK = 1024  # poses per batch if only the branch is chosen


def _vector(name: str, values: ArrayLike, size: int) -> Floats:
    vector = np.asarray(values, dtype=np.float64)
    if vector.shape != (size,):
        raise ValueError(f"{name} of the arm: shape {vector.shape}, not ({size},)")
    return vector


def _rows(name: str, values: ArrayLike, size: int) -> Floats:
    """Return values as an array (N, size); shape (size,) is one row.  Raises ValueError for other shapes and nan."""
    rows = np.asarray(values, dtype=np.float64)
    rows = rows[None] if rows.ndim == 1 and rows.size else rows.reshape(-1, size) if not rows.size else rows
    if rows.ndim != 2 or rows.shape[1] != size:
        raise ValueError(f"{name}: shape {np.shape(values)}, not (N, {size})")
    refuse(name, np.asarray(~np.isfinite(rows).all(axis=1)), "not finite")
    return rows


class Arm:
    """Arm with three joint axes that meet in the shoulder, one in the elbow, and three that meet in the wrist.

    * d1, d2: distances from shoulder to elbow and from elbow to wrist
    * tool: offset of the tip from the wrist: distance along axis 7, or vector (3,) in the hand's frame (z along axis 7)
    * offsets (7,) rad, signs (7,) of 1 or -1: position of a joint = sign * th + offset
    * limits (7, 2): lower and upper limit of each joint, rad
    * base (3,), mount (4,): position of the shoulder and orientation of its frame (z along axis 1) in the base frame
    * tip (4,): orientation of the tip's frame in the hand's frame
    * upper (4,): orientation of the upper arm in the frame of axis 3, whose z is axis 3
    * fore (4,): orientation of the frame of axis 5 in the forearm's frame; links are bent unless upper = fore = 1
    * names (7,): names of the joints; velocities (7,): greatest speeds, rad/s
    * chain: true chain if the axes only almost meet, else None; misfit: tip errors (distance, rad) of the exact arm

    Quaternions are w, i, j, k.  Methods take and return points and orientations of the tip in the base frame.
    """

    def __init__(
        self,
        d1: float,
        d2: float,
        tool: ArrayLike = 0.0,
        offsets: ArrayLike = (0.0,) * 7,
        signs: ArrayLike = (1.0,) * 7,
        limits: ArrayLike = ((-np.inf, np.inf),) * 7,
        *,
        base: ArrayLike = (0.0, 0.0, 0.0),
        mount: ArrayLike = UNIT,
        tip: ArrayLike = UNIT,
        upper: ArrayLike = UNIT,
        fore: ArrayLike = UNIT,
        names: Sequence[str] = ("joint1", "joint2", "joint3", "joint4", "joint5", "joint6", "joint7"),
        velocities: ArrayLike = (np.inf,) * 7,
        chain: Chain | None = None,
        misfit: tuple[float, float] = (0.0, 0.0),
    ) -> None:
        """Set the attributes.  Raises ValueError for wrong shapes and for a lower limit above the upper limit."""
        self.d1, self.d2, self.names, self.limits = float(d1), float(d2), tuple(names), checked_limits(limits)
        if (half := np.isfinite(self.limits).sum(axis=1) == 1).any():
            raise ValueError(f"limits of joint {half.argmax() + 1}: only one of them is finite")
        along: Any = np.asarray(tool, dtype=np.float64)
        self.tool = _vector("tool", along if along.ndim else along * (0.0, 0.0, 1.0), 3)
        self.offsets, self.signs = _vector("offsets", offsets, 7), _vector("signs", signs, 7)
        self.base, self.mount, self.tip = _vector("base", base, 3), _vector("mount", mount, 4), _vector("tip", tip, 4)
        self.upper, self.fore = _vector("upper", upper, 4), _vector("fore", fore, 4)
        self.velocities, self.chain, self.misfit = _vector("velocities", velocities, 7), chain, misfit
        self._tracker = Tracker(self) if self.bent is None and chain is None else None

    @property
    def bounds(self) -> Floats:
        """Limits (7, 2) of the angles th1 .. th7, rad."""
        return np.sort((self.limits - self.offsets[:, None]) * self.signs[:, None], axis=1)

    @property
    def bent(self) -> tuple[Floats, Floats] | None:
        """(upper, fore) if links are bent, otherwise None."""
        return None if np.array_equal((self.upper, self.fore), (UNIT, UNIT)) else (self.upper, self.fore)

    def _asked(
        self, points: ArrayLike, hand: ArrayLike, phi: Any = None, branch: Any = None, near: Any = None
    ) -> tuple[Floats, Floats, Any, Any, Any]:
        """Return wrist targets (N, 3), hands (N, 4), phi, branch and near for poses of the tip.

        Wrists and hands are in the shoulder's frame; the others have N rows or are None.  Raises ValueError.
        """
        asked = {"points": _rows("points", points, 3), "hand": Hands.checked(hand, 0.0, 0).q.T}
        asked |= {} if phi is None else {"phi": _rows("phi", np.ravel(phi)[:, None], 1)[:, 0]}
        asked |= {} if branch is None else {"branch": np.atleast_1d(Hands.checked(hand, 0.0, branch).branch)}
        asked |= {} if near is None else {"near": _rows("near", near, 7)}
        count = common_count({name: len(rows) for name, rows in asked.items()})
        asked = {name: np.broadcast_to(rows, (count, *rows.shape[1:])) for name, rows in asked.items()}
        q = multiply(multiply(conjugate(self.mount), asked["hand"]), conjugate(self.tip))
        wrists = rotate(conjugate(self.mount), asked["points"] - self.base) - rotate(q, self.tool)
        return wrists, q, *(asked.get(name) for name in ("phi", "branch", "near"))

    def _planner(self, wrists: Floats, q: Floats) -> Planner:
        """Return a planner of wrist targets (N, 3) with hands (N, 4) in the shoulder's frame."""
        circles = Circles.of(wrists, Hands.checked(q, 0.0, 0), self.d1, self.d2, bent=self.bent)
        circles = replace(circles, slack=4 * self.misfit[0])
        planner = Planner(circles, self.limits, self.offsets, self.signs, SPARE * bool(self.chain))
        if self.chain:
            planner.corrected = lambda at, rows: self._corrected(at, wrists[rows], q[rows])
        return planner

    def _branched(self, pose: Pose, branch: ArrayLike) -> Floats:
        """Return th1 .. th7 (7, N) of poses in branch 0, converted to ``branch``, a number or (N,)."""
        if not self.bent:
            return joints.branched(pose.joints.T, branch)
        return joints.angles(*joints.bent(pose.qs.T, joints.flexion(pose.qe.T), pose.qw.T, branch, *self.bent))

    def _nearest_branches(self, pose: Pose, near: Floats | None) -> tuple[NDArray[np.int64], Floats]:
        """Return the best branches (N,) and joint positions (N, 7) for poses in branch 0. Rows that need a planner are
        nan: singular poses, poses out of reach, and poses without a branch within the limits."""
        branches, at = np.empty(len(pose.joints), dtype=np.int64), np.empty(pose.joints.shape)
        planner, th = self._planner(pose.wrist[:0], pose.qw[:0]), [self._branched(pose, elbow) for elbow in (0, 2)]
        for first in range(0, len(at), CHUNK):
            rows = slice(first, first + CHUNK)
            to = None if near is None else near[rows].T
            branches[rows], positions, found = planner.nearest_branch([some[:, rows] for some in th], to)
            at[rows] = np.where(found & (pose.flags[rows] & UNREACHABLE == 0), positions, np.nan).T
        return branches, at

    def _corrected(self, positions: Floats, wrists: Floats, q: Floats) -> tuple[Floats, Floats]:
        """Correct joint positions (N, 7) so that the true chain reaches wrist targets (N, 3) with hands (N, 4), both in
        the shoulder's frame. Return the corrected positions and their errors (N,)."""
        assert self.chain
        points = self.base + rotate(self.mount, wrists + rotate(q, self.tool))
        return self.chain.corrected(positions, points, matrix(multiply(multiply(self.mount, q), self.tip)))

    def _fill(
        self, at: Floats, left: NDArray, wrists: Floats, q: Floats, asked: list, corrected: bool = False
    ) -> tuple:
        """Set rows ``left`` of ``at`` (N, 7) to the joints of :meth:`Planner.best`; return their phi and branch.

        asked: [phi, branch, near], each for all rows or None; corrected: correct the candidates on the true chain.
        """
        swivels, branches = np.empty(len(left)), np.empty(len(left), dtype=np.int64)
        for batch in (slice(first, first + BATCH) for first in range(0, len(left), BATCH)):
            rows = left[batch]
            planner = self._planner(wrists[rows], q[rows])
            planner.true[:] = corrected
            phi, branch, near = (None if v is None else v[rows] for v in asked)
            hint = None if near is None else self._swivel(near, wrists[rows])
            best, swivels[batch], branches[batch] = planner.best(phi, branch, near, hint)
            at[rows[best.row]] = best.at.T
        return swivels, branches

    def _swivel(self, positions: Floats, wrists: Floats) -> Floats:
        """Return swivel angles (N,) for wrists (N, 3) with the elbow on the same side as at joint positions (N, 7)."""
        th = self.angles(positions).T
        elbow = rotate(multiply(joints.turned(*th[:3]).T, self.upper), (0, 0, self.d1))
        return swivel((0.0, 0.0, 0.0), elbow, wrists)

    def angles(self, positions: ArrayLike) -> Floats:
        """Return th1 .. th7 (N, 7) for the robot's joint positions (N, 7), rad."""
        return (np.asarray(positions) - self.offsets) * self.signs

    def positions(self, th: ArrayLike, near: Floats | None = None) -> Floats:
        """Return the robot's joint positions (N, 7) for angles th1 .. th7 (N, 7), rad.

        Adds whole turns to come nearest to ``near`` (N, 7) or, where it is nan or None, within the limits if possible.
        """
        low, high = self.limits.T + [[-joints.ROUNDING], [joints.ROUNDING]]
        at = joints.wrap(np.asarray(th) * self.signs + self.offsets)
        for turn in (-2 * np.pi, 2 * np.pi):
            at = np.where(((at < low) | (at > high)) & (at + turn >= low) & (at + turn <= high), at + turn, at)
        return at if near is None else np.where(np.isnan(near), at, near + joints.wrap(at - near))

    def nearest(self) -> tuple["Arm", float, float]:
        """Return the nearest exact arm, and the largest distance and angle (rad) between the tips of the two
        arms. Links of the exact arm that would bend by less than the accepted misfit (rad) are made straight."""
        assert self.chain
        arm = Arm(**exact(nearest(self.chain)[0], TURN_MISFIT))
        low, high = np.clip(self.limits.T, -np.pi, np.pi)
        positions = np.random.default_rng(0).uniform(low, high, (SAMPLES, 7))
        (points, turns), (at, to) = (of.forward(positions) for of in (self, arm))
        return arm, float(np.linalg.norm(points - at, axis=1).max()), float(angle_between(turns, to).max())

    def solve(
        self, points: ArrayLike, hand: ArrayLike, phi: Given = None, branch: Given = None, near: Given = None
    ) -> Pose:
        """Return the poses in which the tip is at points (N, 3) or (3,) with orientations ``hand``.

        * hand: quaternions (N, 4) or (4,), matrices (N, 3, 3), (3, 3) or (N, 4, 4), or a scipy Rotation
        * phi: swivel angle, rad, a number or (N,), measured from axis 1
        * branch: bits of :class:`Branch`, a number or (N,)
        * near (N, 7) or (7,): joint positions, rad

        If phi or branch is None, it is chosen so that the joints are within their limits and nearest to ``near`` or, if
        near is None, farthest from the limits. Where this is impossible, the sum of the angles beyond the limits is
        smallest. ``Pose.joints`` are the robot's positions.  Raises ValueError as :func:`cga_ik.solve` does.
        """
        wrists, q, *given = self._asked(points, hand, phi, branch, near)
        count, (turns, of, to) = len(wrists), given
        swivels = np.empty(count) if turns is None else joints.wrap(turns) if of is None else turns
        branches = np.empty(count, dtype=np.int64) if of is None else of.copy()
        at, pose = np.full((count, 7), np.nan), None
        if turns is not None:
            pose = solve(wrists, swivels, self.d1, self.d2, hand=q)
            if of is None:
                branches, at = self._nearest_branches(pose, to)
        if turns is None or of is None:
            left = np.flatnonzero(np.isnan(at[:, 0]))
            swivels[left], branches[left] = self._fill(at, left, wrists, q, given)
        pose = pose or solve(wrists, swivels, self.d1, self.d2, hand=q)
        th, missing = joints.settled(self._branched(pose, branches), self.bounds), np.isnan(at[:, 0])
        over = joints.outside(th, self.bounds).T & missing[:, None]
        at[missing] = self.positions(th.T[missing])
        if self.chain:
            within = np.flatnonzero(~over.any(axis=1))
            at[within], errors = self._corrected(at[within], wrists[within], q[within])
            left = within[errors > CORRECTED]
            self._fill(at, left, wrists, q, given, corrected=True)
            at[left], errors = self._corrected(at[left], wrists[left], q[left])
            over[left[errors > CORRECTED]] = True
        elbow, wrist = (self.base + rotate(self.mount, point) for point in (pose.elbow, pose.wrist))
        hand = wrist + rotate(self.mount, rotate(q, self.tool))
        places: dict[str, Any] = {"elbow": elbow, "wrist": wrist, "hand": hand}
        return replace(pose, qs=multiply(self.mount, pose.qs), joints=at, over_limit=over, branch=branches, **places)

    def forward(self, positions: ArrayLike) -> tuple[Floats, Floats]:
        """Return points (N, 3) and orientations (N, 4) of the tip for joint positions (N, 7), rad."""
        if self.chain:
            place, turn, _ = self.chain.forward(_rows("positions", positions, 7))
            return place, quaternion(turn)
        th = self.angles(_rows("positions", positions, 7)).T
        point, q = joints.reached(th, self.d1, self.d2, self.tool, self.upper, self.fore)
        return self.base + rotate(self.mount, point), multiply(self.mount, multiply(q, self.tip))

    def feasible_swivel(self, points: ArrayLike, hand: ArrayLike, branch: ArrayLike = 0) -> Swivels:
        """Return the swivel angles for which all joints are within their limits.  Raises ValueError."""
        wrists, q, *_ = self._asked(points, hand)
        return feasible_swivel(wrists, q, self.d1, self.d2, limits=self.bounds, branch=branch, bent=self.bent)

    def reasons(self, points: ArrayLike, hand: ArrayLike) -> dict[int, str]:
        """Return row -> reason for poses of the tip that no branch and swivel angle solves: which joints exceed their
        limits in the best branch and by how much, or that the wrist is out of reach.  Raises ValueError."""
        wrists, q, *_ = self._asked(points, hand)
        planner, over = self._planner(wrists, q), self.solve(points, hand).over_limit.any(axis=1)
        return planner.impossible(np.flatnonzero(over | planner.circles.unreachable))

    def path(
        self,
        points: ArrayLike,
        hand: ArrayLike,
        start: Given = None,
        goal: float = GOAL,
        *,
        phi: Given = None,
        branch: Given = None,
        progress: Progress | None = None,
    ) -> JointPath:
        """Return joints along a path of poses of the tip: points (N, 3), orientations ``hand`` as in :meth:`solve`.

        Joints are within their limits, or nan.  If branches and swivel angles allow it, no step of a joint
        exceeds ``goal`` (rad). start (7,): joint positions before the first pose. phi (rad), branch: numbers or (N,),
        or None to choose them. progress: callback with the fraction done, 0 to 1, and the number of swivel angles
        tried; the fraction restarts for each further attempt.  Raises ValueError.
        """
        wrists, q, given_phi, given_branch, _ = self._asked(points, hand, phi, branch)
        if not 0 < goal < np.inf:
            raise ValueError(f"goal {goal!r} is not an angle")
        before = None if start is None else _vector("start", start, 7)
        if before is not None:
            if not np.isfinite(before).all():
                raise ValueError("start: not finite")
            over = np.maximum(before - self.limits[:, 1], self.limits[:, 0] - before)
            if over.max() > 1e-6:
                raise ValueError(f"start: {self.names[over.argmax()]} is {over.max():.3g} rad outside its limits")
        planner = self._planner(wrists, q)
        planner.progress = progress or planner.progress
        return planner.plan(given_phi, given_branch, before, goal)

    def track(self, point: Sequence[float], hand: Sequence[float], positions: Sequence[float]) -> Step:
        """Return the step from the robot's present joint positions (7,) to a pose of the tip, for a control loop.

        point (3,), hand (4,): sequences of numbers.  If no branch is within the limits with the elbow on its present
        side, or a joint would move by more than 0.2 rad, all swivel angles are tried, which takes a hundred times as
        long. At a dead end the step has a reason but no joints.
        """
        step = self._tracker.step(point, hand, positions) if self._tracker else Step(None, 0, np.inf)
        if step.largest <= 0.2:
            return step
        pose = self.solve(point, hand, near=positions)
        if pose.over_limit.any() or (pose.flags & UNREACHABLE).any() and not self.chain:
            return Step(None, 0, np.inf, self.reasons(point, hand).get(0, "out of reach"))
        at = pose.joints[0]
        slow = Step(tuple(at.tolist()), int(pose.branch[0]), float(np.abs(at - positions).max()))
        return step if step.largest <= slow.largest else slow

    def continuous_joints(self, positions: ArrayLike) -> Floats:
        """Return joint positions (N, 7), rad, with the same hands and elbows but without jumps between branches.

        positions (N, 7): rad; each row may be in any branch.  The results are within the limits; a
        row is nan if none of its branches is within them.  Raises ValueError.
        """
        rows = _rows("positions", positions, 7)
        points, hand = self.forward(rows)
        wrists, *_ = self._asked(points, hand)
        return self.path(points, hand, phi=self._swivel(rows, wrists)).joints

    @classmethod
    def from_urdf(cls, path: str | Path, base: str | None = None, tip: str | None = None) -> "Arm":
        """Return the arm between two links of a URDF file; by default, from its only root link to its only leaf link.

        An arm whose axes almost meet is accepted (``misfit``); results of :meth:`solve` and :meth:`path` are corrected
        on its true chain.  Raises OSError, and ValueError for a file that is no URDF, for a chain without exactly seven
        turning joints, and for axes that do not meet.
        """
        try:
            return cls(**arguments(path, base, tip))
        except ValueError as error:
            raise ValueError(f"{path}: {error}") from None


IIWA14 = Arm(
    d1=0.42,
    d2=0.4,
    tool=0.126,
    offsets=np.radians((-90, 0, 180, 0, -180, 0, 90)),
    limits=np.radians([(-d, d) for d in (170, 120, 170, 120, 170, 120, 175)]),
    base=(0.0, 0.0, 0.36),
    names=tuple(f"A{n}" for n in range(1, 8)),
)
"""KUKA LBR iiwa 14 R820; lengths in m. The tip is the flange; the base frame is on the ground, z up."""

_DOWN, _FORWARD, _RIGHT = np.array((0.0, 0.0, -1.0)), np.array((1.0, 0.0, 0.0)), np.array((0.0, -1.0, 0.0))

_HUMAN = Chain(
    axes=np.array((_DOWN, _FORWARD, _DOWN, _RIGHT, _DOWN, -_FORWARD, _RIGHT)),
    points=np.array((0.0, 0.0, 0.0, DEFAULT_D1, *[DEFAULT_D1 + DEFAULT_D2] * 3))[:, None] * _DOWN,
    end=placed(np.column_stack((_FORWARD, _RIGHT, _DOWN)), (DEFAULT_D1 + DEFAULT_D2 + 0.08) * _DOWN),
    names=("plane", "elevation", "rotation", "elbow", "pronation", "flexion", "deviation"),
    limits=np.radians(((-45, 135), (0, 180), (-120, 70), (0, 150), (-80, 80), (-70, 80), (-30, 20))),
    velocities=np.full(7, np.inf),
)
HUMAN = Arm(**exact(_HUMAN))
"""Left arm of a person; lengths in m, x forward, y to the left, z up. With all joints at 0 it hangs, thumb forward.

The shoulder joints are the plane of elevation (0 sideways, 90 degrees forward), the elevation, and inward rotation. The
wrist flexes toward the palm and deviates toward the thumb. The tip is in the palm; its frame has x along the thumb, y
out of the palm, and z along the fingers. Limits are the norms of the AAOS, with a larger range of outward rotation,
because the AAOS measures it with the arm held sideways.
"""


class Robots(UserDict[str, Any]):
    """Arms by name. An arm from a URDF file is read at its first use."""

    folder = Path(__file__).with_name("robots")

    def __getitem__(self, name: str) -> Arm:
        if isinstance(self.data[name], Path):
            self.data[name] = Arm.from_urdf(self.data[name])
        return self.data[name]


ROBOTS = Robots(iiwa14=IIWA14, human=HUMAN, **{path.stem: path for path in sorted(Robots.folder.glob("*.urdf"))})
"""Built-in arms: two of this module, others from files in the folder robots."""
