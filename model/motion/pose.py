# SPDX-License-Identifier: Apache-2.0
"""Poses of an arm from Python: the public functions of `cga_ik`.

Frame: the shoulder at the origin, x forward, y to the left, z up.  Lengths are in any one unit, angles in radians.
Quaternions are Hamilton's and give the right-handed rotation; at rest the upper arm points along z and the forearm is
folded back on it:

    elbow = Qs (d1 e3) Qs~          wrist = Qs (d1 e3 + Qe (-d2 e3) Qe~) Qs~

The reference axis is the direction that replaces the paper's z axis, from which the swivel angle is measured.  The
equations are singular where the wrist lies on it, so it should point where no hand goes.  The core uses z only; the
host rotates coordinates by R, which takes the axis to z, and multiplies Qs by R~ afterwards.  Any such R will do: a
further turn about z changes azimuth and Qs by the same angle, and leaves phi unchanged.
"""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from itertools import product
from typing import TYPE_CHECKING, Any, Literal, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..dataflow import fixed
from ..dataflow.datapaths import CONFIGURATIONS
from ..dataflow.formats import WIDTHS
from ..io.words import (
    DEFAULT_D1,
    DEFAULT_D2,
    FIELDS,
    RESULT_FIELDS,
    Targets,
    angle_doubt,
    from_words,
    result_values,
    scale_exponent,
    to_words,
)
from ..reference import kinematics
from ..reference.equations import solve_clamped
from ..reference.joints import angles, flexion, outside, settled, wrist_quaternion
from ..reference.kinematics import conjugate, matrix, multiply
from ..reference.lean_equations import solve_direct
from .hands import Hands, checked_limits, refuse

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

Floats = NDArray[np.float64]

Order = Literal["wxyz", "xyzw"]
"""Position of a quaternion's scalar part: first, or last as in scipy and most engines."""

CHUNK, LONG_CHUNK = 2048, 16384
"""Targets solved at a time: in double precision, where arrays then stay in the cache; with hands or in words."""

Axis = str | Sequence[float] | NDArray[Any]
"""A name of :data:`NAMED_AXES`, or a vector of three, of any length."""

_HALF_TURN = (0.0, 1.0, 0.0, 0.0)  # about x: -z becomes z
_TO_Z = {"x": (0.5, -0.5, -0.5, -0.5), "y": (0.5, 0.5, 0.5, 0.5), "z": (1.0, 0.0, 0.0, 0.0)}
"""Cyclic exchanges of the axes: they only permute coordinates, so no bit is lost."""

NAMED_AXES = ("z", "-z", "x", "-x", "y", "-y")


_NO_AXIS = f"must be {', '.join(NAMED_AXES)} or a nonzero vector of three finite numbers"


@dataclass(frozen=True, eq=False)
class Pose:
    """N poses.

    * qs, qe (N, 4): shoulder and elbow quaternion, in ``order``; in words of ``width`` bits their values are exact
    * flags (N,): int64, bits of :class:`Flag`; 0 where the hand is at the target
    * elbow, wrist (N, 3): positions from forward kinematics, in the unit of the targets
    * phi (N,): the requested swivel angle, rad
    """

    qs: Floats
    qe: Floats
    flags: NDArray[np.int64]
    elbow: Floats
    wrist: Floats
    phi: Floats
    order: Order = "wxyz"

    def to_scipy(self) -> "tuple[Rotation, Rotation]":
        """Return shoulder and elbow as :class:`scipy.spatial.transform.Rotation` (matrices, Euler angles, slerp)."""
        from scipy.spatial.transform import Rotation

        first = self.order == "wxyz"
        return Rotation.from_quat(self.qs, scalar_first=first), Rotation.from_quat(self.qe, scalar_first=first)


@dataclass(frozen=True, eq=False, kw_only=True)
class ArmPose(Pose):
    """N poses of the whole arm.

    * qw (N, 4): wrist quaternion, (Qs Rx(th4))~ Qh
    * hand (N, 3): the hand's point from forward kinematics
    * joints (N, 7): th1 .. th7, rad in -pi to pi
    * over_limit (N, 7): True for a joint outside its limits
    """

    qw: Floats
    hand: Floats
    joints: Floats
    over_limit: NDArray[np.bool_]


@overload
def solve(
    points: ArrayLike,
    phi: ArrayLike | None = None,
    d1: ArrayLike = DEFAULT_D1,
    d2: ArrayLike = DEFAULT_D2,
    *,
    axis: Axis = "z",
    width: int | None = None,
    datapath: str = "lean",
    order: Order = "wxyz",
    nan: Literal["raise", "pass"] = "raise",
) -> Pose: ...


@overload
def solve(
    points: ArrayLike,
    phi: ArrayLike | None = None,
    d1: ArrayLike = DEFAULT_D1,
    d2: ArrayLike = DEFAULT_D2,
    *,
    axis: Axis = "z",
    width: int | None = None,
    datapath: str = "lean",
    order: Order = "wxyz",
    nan: Literal["raise", "pass"] = "raise",
    hand: ArrayLike,
    tool: ArrayLike = 0.0,
    branch: ArrayLike = 0,
    limits: ArrayLike | None = None,
) -> ArmPose: ...


def solve(
    points: ArrayLike,
    phi: ArrayLike | None = None,
    d1: ArrayLike = DEFAULT_D1,
    d2: ArrayLike = DEFAULT_D2,
    *,
    axis: Axis = "z",
    width: int | None = None,
    datapath: str = "lean",
    order: Order = "wxyz",
    nan: Literal["raise", "pass"] = "raise",
    hand: ArrayLike | None = None,
    tool: ArrayLike = 0.0,
    branch: ArrayLike = 0,
    limits: ArrayLike | None = None,
) -> Pose:
    """Return shoulder and elbow of arms for wrist targets, (10)-(18) of the paper, or all seven joints for hand poses.

    * points (N, 3) or (3,): wrist targets, the shoulder at the origin; with ``hand``, the hand's points
    * phi: swivel angle, rad: 0 is the elbow in the plane of axis and wrist, on the side to which the axis points.
      None is :func:`hanging`
    * d1, d2: upper arm and forearm; they and phi are numbers or (N,)
    * axis: the reference axis, a name ("z", "-z", "x", ...) or a vector of three; th1 turns about it
    * width: None is double precision; 16 to 32 gives the words of the core, bit for bit
    * datapath: "lean", "paper", or lean with products cut for other multipliers: "lean25" (25x18 bits), "lean16"
    * nan: "pass" returns nan and flags 0 for rows with a nan; "raise" raises ValueError
    * hand (N, 4) or (4,): orientation of the hand, unit quaternions; in words, with datapath "lean" only
    * tool: distance from the wrist to the hand's point, along the hand's z axis; a number or (N,)
    * branch: bits of :class:`Branch`, one of eight solutions for the joints; a number or (N,)
    * limits (7, 2): lower and upper limit of each joint, rad, for ``over_limit``; the pose is the same, but where
      th2 or th6 is 0 or pi, limits choose between equivalent pairs of the angles around it. Words keep their pair, and
      limits are rounded inward to words

    An unreachable target gets the nearest pose, and a flag.  Warns if phi exceeds a turn, as degrees would.  Raises
    ValueError for shapes that do not broadcast, numbers that are not finite, lengths that are not positive, a hand
    that is no unit quaternion, limits in the wrong order, an unknown width, datapath, order or branch, and (as its
    subclass TargetError) for a target that does not fit the core's format together with the others.
    """
    if datapath not in CONFIGURATIONS:
        raise ValueError(f"datapath {datapath!r} is none of {', '.join(CONFIGURATIONS)}")
    widths = [w for w in CONFIGURATIONS[datapath].widths if w in WIDTHS] if width is not None else []
    if width is not None and (not isinstance(width, (int, np.integer)) or width not in widths):
        raise ValueError(f"width {width!r} must be None or one of {', '.join(map(str, widths))}")
    if order not in ("wxyz", "xyzw"):
        raise ValueError(f"order {order!r} is neither 'wxyz' nor 'xyzw'")
    if nan not in ("raise", "pass"):
        raise ValueError(f"nan {nan!r} is neither 'raise' nor 'pass'")
    if hand is not None and width is not None and datapath != "lean":
        raise ValueError(f"datapath {datapath!r}: with hand and width it must be 'lean'")
    hands = None if hand is None else Hands(hand, tool, branch, order)
    bounds = None if limits is None else checked_limits(limits)
    position = np.asarray(points, dtype=np.float64)
    position = position.reshape(-1, 3) if position.ndim < 2 and position.size in (0, 3) else position
    if position.ndim != 2 or position.shape[1] != 3:
        raise ValueError(f"points have the shape {position.shape}, not (N, 3)")
    given = [np.asarray(v, dtype=np.float64) for v in (hanging(axis) if phi is None else phi, d1, d2)]
    count = ({len(position), *(v.size for v in given), hands.count if hands else 1} - {1} or {1}).pop()
    table = np.empty((len(FIELDS), count))
    table[:3], table[3], table[4], table[5] = position.T, *given
    lost: Any = None  # rows of nan, which repeat another row until the end
    if hands and hands.lost.any():
        refuse("hand and tool", hands.lost & (nan == "raise"), "not finite")
        table[0, hands.lost if len(hands.lost) > 1 else slice(None)] = np.nan
    if np.count_nonzero(np.isfinite(table)) < table.size:
        _refuse(table, np.isinf(table) if nan == "pass" else ~np.isfinite(table), "not finite")
        lost = np.isnan(table).any(axis=0)
        table[:, lost] = 1.0 if lost.all() else table[:, [np.argmin(lost)]]
    if np.count_nonzero(table[4:] > 0.0) < 2 * count:
        _refuse(table, (table <= 0) & (np.arange(len(FIELDS)) > 3)[:, None], "not positive")
    if np.count_nonzero(np.abs(table[3]) > 2 * np.pi):
        warnings.warn(angle_doubt(table[3]), stacklevel=2)

    frame = None if isinstance(axis, str) and axis == "z" else to_z(axis)
    targets = partial(Targets, "targets", frame=frame)
    of_hand = {"hand": hands.part(slice(None))[0].T, "tool": hands.tool} if hands else {}
    exponent = scale_exponent(targets(*table, **of_hand), width) if width and count else 0
    qs, qe, flags, asked = np.empty((count, 4)), np.zeros((count, 4)), np.empty(count, dtype=np.int64), table[3].copy()
    elbow, wrist = np.empty((2, count, 3))
    w, i = (0, 1) if order == "wxyz" else (3, 0)
    qw, found, reached = (np.empty((count if hands else 0, size)) for size in (4, 7, 3))
    over = np.zeros(found.shape, dtype=bool)
    step = LONG_CHUNK if width or hands else CHUNK
    for rows in (slice(start, start + step) for start in range(0, count, step)):
        part = table[:, rows]
        if hands and width is None:
            q, offset, own_branch = hands.part(rows)
            part = np.concatenate((part[:3] - offset, part[3:]))
        if width is None:
            part = part if frame is None else np.concatenate((targets(*part).core_position.T, part[3:]))
            results, flags[rows] = solve_direct(part) if datapath != "paper" else _by_the_paper(part)
        elif hands:
            solved = hands.in_words(rows, targets(*part), exponent, width, bounds)
            results, flags[rows], asked[rows], turn, th, own_over = solved
        else:
            results, flags[rows], asked[rows] = _in_words(targets(*part), width, exponent, datapath)
        turned = results[:4].T if frame is None else multiply(conjugate(frame), results[:4].T)
        elbow[rows], wrist[rows] = kinematics.forward(turned, results[4:].T, part[4], part[5])
        qs[rows], qe[rows, w], qe[rows, i] = _rolled(order, turned, -1), results[4], results[5]
        if hands and width is None:
            turn = wrist_quaternion(turned.T, results[4:], q)
            th = angles(results[:4], flexion(results[4:]), turn, own_branch)
            if bounds is not None:
                th = settled(th, bounds)
                over[rows] = outside(th, bounds).T
        elif hands:
            offset, over[rows] = hands.reached(rows, turned.T, results[4:], turn), own_over.T
        if hands:
            qw[rows], reached[rows], found[rows] = _rolled(order, turn.T, -1), wrist[rows] + offset.T, th.T
    if lost is not None:
        for values in (qs, qe, elbow, wrist, asked, flags, *((qw, found, reached, over) if hands else ())):
            values[lost] = np.nan if values.dtype.kind == "f" else 0
    if hands is None:
        return Pose(qs, qe, flags, elbow, wrist, asked, order)
    return ArmPose(qs, qe, flags, elbow, wrist, asked, order, qw=qw, hand=reached, joints=found, over_limit=over)


def _by_the_paper(part: Floats) -> tuple[Floats, NDArray[np.int64]]:
    found = solve_clamped(*part)
    return np.array([found[field] for field in RESULT_FIELDS]), found["flags"]


def _in_words(targets: Targets, width: int, exponent: int, datapath: str) -> tuple[Floats, Floats, Floats]:
    """Return the results (6, N), flags and swivel angles (N,) of the core; its nodes are released."""
    words, _ = to_words(targets, width, exponent)
    run = fixed.run(words, width, datapath)
    return result_values(run.results, width).T, run.flags, from_words(words, exponent, width, targets.name).phi


def _refuse(table: Floats, wrong: NDArray[np.bool_], reason: str) -> None:
    """Raise ValueError, which names the first rows with a number (6, N) that is wrong, if there are any."""
    for name, rows in (("points", wrong[:3].any(axis=0)), *zip(FIELDS[3:], wrong[3:], strict=True)):
        refuse(name, rows, reason)


def forward(
    qs: ArrayLike, qe: ArrayLike, d1: ArrayLike = DEFAULT_D1, d2: ArrayLike = DEFAULT_D2, *, order: Order = "wxyz"
) -> tuple[Floats, Floats]:
    """Return elbow and wrist (N, 3) of arms whose joints are at Qs and Qe, (N, 4) each, in the unit of the lengths.

    d1, d2: numbers or (N,).  Any reference axis: it is part of Qs.  Raises ValueError for shapes that do not match.
    """
    shoulder, elbow = (np.atleast_2d(np.asarray(q, dtype=np.float64)) for q in (qs, qe))
    for q in (shoulder, elbow):
        if q.shape[-1] != 4:
            raise ValueError(f"quaternions have the shape {q.shape}, not (N, 4)")
    return kinematics.forward(_rolled(order, shoulder, 1), _rolled(order, elbow, 1), d1, d2)


def swivel(shoulder: ArrayLike, elbow: ArrayLike, wrist: ArrayLike, axis: Axis = "z") -> Floats:
    """Return the swivel angle (N,), rad in [-pi, pi], of arms whose joints are at these points, (N, 3) each or (3,).

    Passed to :func:`solve` as phi, it reproduces the elbow.  It is arbitrary where the arm is straight or folded;
    near those poses, rounding of the elbow's offset from the line limits its accuracy.
    """
    shoulder = np.asarray(shoulder, dtype=np.float64)
    turn = matrix(to_z(axis)).T
    e, p = (np.atleast_2d(np.asarray(point, dtype=np.float64) - shoulder) @ turn for point in (elbow, wrist))
    rho = np.hypot(p[:, 0], p[:, 1])
    on_axis = rho == 0  # azimuth 0, as in the core
    c, s = np.where(on_axis, 1.0, p[:, 0]), np.where(on_axis, 0.0, p[:, 1])
    p[~p.any(axis=1), 2] = 1.0  # the shoulder counts as above itself
    length = np.hypot(c, s)
    c, s = c / length, s / length
    inward = e[:, 0] * c + e[:, 1] * s
    aside = e[:, 0] * s - e[:, 1] * c
    return np.arctan2(aside, (rho * e[:, 2] - p[:, 2] * inward) / np.linalg.norm(p, axis=1))


def swivel_toward(points: ArrayLike, pole: ArrayLike, axis: Axis = "z") -> Floats:
    """Return the swivel angle (N,), rad, for which the elbow points at a pole, as pole vectors do elsewhere.

    The elbow then lies in the half plane of shoulder, wrist and pole.  points (N, 3) or (3,) are wrist targets, the
    pole (3,) or (N, 3); the shoulder is at the origin.  The angle is arbitrary where the pole is on the line to the
    wrist.
    """
    return swivel((0.0, 0.0, 0.0), pole, points, axis)


def soft_reach(points: ArrayLike, d1: ArrayLike = DEFAULT_D1, d2: ArrayLike = DEFAULT_D2, soft: float = 0.05) -> Floats:
    """Return wrist targets that approach the full stretch smoothly, so that the elbow does not snap straight.

    Beyond L - b, where L = d1 + d2 and b = soft L, the distance r from the shoulder becomes L - b exp((L - b - r) / b);
    nearer points (N, 3) or (3,) stay.  Raises ValueError for ``soft`` outside 0 to 1.
    """
    if not 0 <= soft <= 1:
        raise ValueError(f"soft {soft!r} is not in 0 to 1")
    points, reach = np.asarray(points, dtype=np.float64), np.add(d1, d2, dtype=np.float64)[..., None]
    distance = np.linalg.norm(points, axis=-1, keepdims=True)
    band = soft * reach
    with np.errstate(divide="ignore", invalid="ignore"):
        softened = (reach - band * np.exp((reach - band - distance) / band)) / distance
    return points * np.where((distance > reach - band) & (band > 0), softened, 1.0)


def elbow_jumps(targets: Targets) -> tuple[NDArray[np.intp], list[float]]:
    """Return the rows of a path at which the elbow jumps, because the wrist has passed close to the reference axis, and
    an axis that is farther from the path.

    It jumps where it moves by more than a tenth of the reach and by more than four times both the wrist's own move and
    the wrist's distance from the axis, less that move.  Each arm has a path of its own.
    """
    reach = targets.reach.max(initial=1e-300)
    position, found = targets.core_wrist / reach, [np.empty(0, dtype=np.intp)]
    elbow = solve(position, targets.phi % (2 * np.pi), targets.d1 / reach, targets.d2 / reach).elbow
    arms = np.zeros(len(targets)) if targets.arm is None else targets.arm
    for own in (np.flatnonzero(arms == arm) for arm in np.unique(arms)):
        moves = np.diff(position[own], axis=0)
        moved, swung = (np.linalg.norm(steps, axis=1) for steps in (moves, np.diff(elbow[own], axis=0)))
        passed = np.hypot(*position[own, :2].T)  # at the nearer end, less the way
        passed = np.minimum(passed[1:], passed[:-1]) - moved
        found.append(own[1:][(swung > np.maximum(4 * np.maximum(moved, passed), 0.1 * targets.reach[own[1:]] / reach))])
    lines = np.array([line for line in product((0.0, 1.0, -1.0), repeat=3) if line > (0.0, 0.0, 0.0)])
    wrist = targets.points_from_core(targets.core_wrist)
    near = np.abs(wrist @ lines.T) / np.linalg.norm(lines, axis=1)
    toward = (near / np.maximum(np.linalg.norm(wrist, axis=1), 1e-300)[:, None]).max(axis=0)
    return np.sort(np.concatenate(found)), lines[np.argmin(toward)].tolist()


def hanging(axis: Axis = "z") -> float:
    """Return the swivel angle (rad) for which the elbow of an arm that reaches forward (x) hangs straight down (-z).

    It is pi for z, 0 for -z.  Where the axis is x itself, the arm reaches to the left (y) instead.
    """
    return _hanging(axis if isinstance(axis, str) else tuple(direction(axis)))


@lru_cache
def _hanging(axis: str | tuple[float, ...]) -> float:
    reach = (0.0, 1.0, 0.0) if abs(direction(axis)[0]) == 1 else (1.0, 0.0, 0.0)
    return float(swivel((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), reach, axis)[0])


def _rolled(order: Order, q: Floats, places: int) -> Floats:
    """Return quaternions in another order: `places` is -1 from wxyz to `order`, 1 from `order` to wxyz."""
    if order not in ("wxyz", "xyzw"):
        raise ValueError(f"order {order!r} is neither 'wxyz' nor 'xyzw'")
    return q if order == "wxyz" else np.roll(q, places, axis=-1)


# -- the reference axis ----------------------------------------------------------------------------


def direction(axis: Axis) -> Floats:
    """Return the unit vector (3,) of an axis.  Raises ValueError."""
    if isinstance(axis, str) and axis in NAMED_AXES:
        return np.where(np.array(list("xyz")) == axis[-1], -1.0 if axis[0] == "-" else 1.0, 0.0)
    try:
        vector = np.asarray(axis, dtype=np.float64)
    except (TypeError, ValueError):
        vector = np.empty(0)
    size = np.abs(vector).max(initial=0.0)
    if vector.shape != (3,) or not np.isfinite(vector).all() or size == 0:
        raise ValueError(f"axis {axis!r} {_NO_AXIS}")
    vector = vector / size  # squares of very long or short vectors would overflow or underflow
    return vector / np.linalg.norm(vector)


def parse_axis(text: str) -> Axis:
    """Parse an axis: a name, or three numbers separated by commas.  Raises ValueError."""
    try:
        axis = tuple(float(part) for part in text.split(",")) if "," in text else text
        direction(axis)
    except ValueError:
        raise ValueError(f"axis {text!r} {_NO_AXIS}") from None
    return axis


def to_z(axis: Axis) -> Floats:
    """Return the quaternion (4,) w, i, j, k of R, which takes the axis to z."""
    a = direction(axis)
    if np.count_nonzero(a) == 1:
        turn = np.array(_TO_Z["xyz"[np.argmax(np.abs(a))]])
        return multiply(_HALF_TURN, turn) if a.sum() < 0 else turn
    # The shorter way to z or -z: half of it is below 45 degrees, where the sum does not cancel.
    below = a[2] < 0
    x, y, z = a * (1, -1, -1) if below else a
    turn = np.array((1 + z, y, -x, 0.0))
    turn /= np.linalg.norm(turn)
    return multiply(turn, _HALF_TURN) if below else turn
