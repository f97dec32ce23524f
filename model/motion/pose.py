# SPDX-License-Identifier: Apache-2.0
"""Poses of an arm from Python: the public functions of `cga_ik`.

The shoulder is at the origin, x points forward, y to the left, z up.  Lengths are in any one unit, angles in radians.
Quaternions are Hamilton's and describe right-handed rotations.  With Qs = Qe = 1 the upper arm points along z and the
forearm lies back on it:

    elbow = Qs (d1 e3) Qs~          wrist = Qs (d1 e3 + Qe (-d2 e3) Qe~) Qs~

The swivel angle is measured from the reference axis, by default z.  The equations are singular where the wrist lies on
that axis, so it should point where no hand goes.  The core uses z only: the host rotates coordinates by R, which takes
the axis to z, and multiplies Qs by R~ afterwards.
"""

import warnings
from dataclasses import dataclass, field
from functools import lru_cache
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..dataflow import fixed
from ..dataflow.datapaths import CONFIGURATIONS, MODELS
from ..dataflow.formats import WIDTHS
from ..io import words as core
from ..io.flags import BAD_HAND, OVER_BIT
from ..io.words import DEFAULT_D1, DEFAULT_D2, FIELDS, LENGTH_TOLERANCE, RESULT_FIELDS, Targets, angle_doubt
from ..reference import joints, kinematics
from ..reference.equations import solve_clamped
from ..reference.kinematics import Axis, conjugate, direction, matrix, multiply, quaternion, to_z
from ..reference.lean_equations import solve_direct

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

Floats = NDArray[np.float64]

Order = Literal["wxyz", "xyzw"]
"""Position of a quaternion's scalar part: first, or last as in scipy and most engines."""

CHUNK, LONG_CHUNK = 2048, 16384
"""Targets solved at a time, so that arrays stay in the cache; LONG_CHUNK for hand poses or with a width."""


@dataclass(frozen=True, eq=False)
class Hands:
    """Hands of N poses; a field may also hold a single value for all poses.

    * q (4, N): orientations, unit quaternions w, i, j, k
    * tool (N,): distance from the wrist to the hand's point, along the hand's z axis
    * branch (N,): bits of :class:`Branch`
    * missing (N,): True for poses whose input has a nan in orientation or tool; q and tool then hold placeholders
    """

    q: Floats
    tool: Floats
    branch: NDArray[np.int64]
    missing: NDArray[np.bool_]

    @classmethod
    def checked(
        cls, hand: ArrayLike, tool: ArrayLike, branch: ArrayLike, order: str = "wxyz", nan: str = "raise"
    ) -> "Hands":
        """Return hands for orientations as in :func:`quaternions`; normalize the quaternions to length 1.

        Raises ValueError for a length that is not about 1, for other wrong arguments, and for a nan with nan="raise".
        """
        check_order(order)
        rows = quaternions(hand, order)
        if rows.ndim != 2 or rows.shape[1] != 4:
            raise ValueError(f"hand has the shape {np.shape(hand)}, not (N, 4)")
        length = np.sqrt(np.einsum("ij,ij->i", rows, rows))
        wrong = (np.abs(length - 1) > LENGTH_TOLERANCE) | (length == np.inf)
        refuse("hand", wrong, f"length {length[wrong.argmax()]:.6g}, not 1," if wrong.any() else "")
        tools, branches = np.asarray(tool, dtype=np.float64), np.asarray(branch)
        if branches.dtype.kind not in "iu" or ((branches < 0) | (branches >= 2 ** len(joints.Branch))).any():
            raise ValueError(f"branch {branch!r} is not a combination of {', '.join(joints.Branch.__members__)}")
        if np.isinf(tools).any():
            raise ValueError("tool: not finite")
        missing = np.isnan(length) | np.isnan(tools)
        if missing.any():
            refuse("hand and tool", missing & (nan == "raise"), "not finite")
            rows, length = np.where(missing[:, None], 0.5, rows), np.where(missing, 1.0, length)
            tools = np.where(missing, 0.0, tools)
        q = rows.T[[0, 1, 2, 3] if order == "wxyz" else [3, 0, 1, 2]] / length
        return cls(q, tools, branches, missing)

    @property
    def offset(self) -> Floats:
        """Vectors (3, N) from the wrist to the hand's point."""
        return joints.tool_offset(self.q, self.tool)

    def part(self, rows: slice) -> "Hands":
        """Return the hands of the poses in ``rows``."""
        return Hands(*(v if v.shape[-1:] in ((), (1,)) else v[..., rows] for v in vars(self).values()))


@dataclass(frozen=True, eq=False)
class Pose:
    """Poses of N targets.

    * qs, qe (N, 4): shoulder and elbow quaternion, in ``order``; with a width, exact values of the core's words
    * flags (N,): bits of :class:`Flag`; 0 where the hand is at the target
    * elbow, wrist (N, 3): from forward kinematics, in the unit of the targets
    * phi (N,): the requested swivel angle, rad; with a width, rounded to a word

    Only for hand poses, otherwise empty:

    * qw (N, 4): wrist quaternion, (Qs Rx(th4))~ Qh
    * hand (N, 3): the hand's point from forward kinematics
    * joints (N, 7): th1 .. th7, rad in -pi to pi
    * over_limit (N, 7): True for a joint outside its limits
    * branch (N,): bits of :class:`Branch`
    """

    qs: Floats
    qe: Floats
    flags: NDArray[np.int64]
    elbow: Floats
    wrist: Floats
    phi: Floats
    order: Order = "wxyz"
    qw: Floats = field(default_factory=lambda: np.empty((0, 4)))
    hand: Floats = field(default_factory=lambda: np.empty((0, 3)))
    joints: Floats = field(default_factory=lambda: np.empty((0, 7)))
    over_limit: NDArray[np.bool_] = field(default_factory=lambda: np.empty((0, 7), dtype=bool))
    branch: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, dtype=np.int64))

    def to_scipy(self) -> "tuple[Rotation, Rotation]":
        """Return shoulder and elbow as :class:`scipy.spatial.transform.Rotation` (matrices, Euler angles, slerp)."""
        from scipy.spatial.transform import Rotation

        first = self.order == "wxyz"
        return Rotation.from_quat(self.qs, scalar_first=first), Rotation.from_quat(self.qe, scalar_first=first)


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
    """Return poses of arms: shoulder and elbow for wrist targets ((10)-(18) of the paper), all joints for hand poses.

    * points (N, 3) or (3,): wrist targets relative to the shoulder; with ``hand``, the hand's points
    * phi: swivel angle, rad, a number or (N,).  At 0 the elbow is in the plane of axis and wrist, on the side of the
      axis.  None: :func:`hanging`
    * d1, d2: lengths of upper arm and forearm; numbers or (N,)
    * axis: the reference axis, a name ("z", "-z", "x", ...) or a vector of three; th1 turns about it
    * width: None is double precision; 16 to 32 is the core's word length, for bit-true results
    * datapath: "lean", "paper", or lean with products split for other multipliers: "lean25" (25x18 bits), "lean16";
      "fold" and "fold16" give the same words as "lean" and "lean16"
    * nan: "pass" returns nan and flags 0 for rows that contain a nan; "raise" raises ValueError
    * hand (N, 4) or (4,): orientations of the hand, unit quaternions; with a width, only for datapath "lean"
    * tool: distance from the wrist to the hand's point, along the hand's z axis; a number or (N,)
    * branch: bits of :class:`Branch`, one of eight solutions for the joints; a number or (N,)
    * limits (7, 2): lower and upper limit of each joint, rad, for ``over_limit``; with a width, rounded inward.  In
      double precision they also choose among equivalent pairs th1, th3 (th5, th7) where th2 (th6) is 0 or pi

    An unreachable target gets the nearest pose, and a flag.  Warns if phi exceeds a turn.  Raises ValueError for wrong
    arguments, and its subclass TargetError for a target that does not fit the core's format at the common scale.
    """
    if datapath not in CONFIGURATIONS:
        raise ValueError(f"datapath {datapath!r} is none of {', '.join(CONFIGURATIONS)}")
    widths = [w for w in CONFIGURATIONS[datapath].widths if w in WIDTHS]
    if width is not None and (not isinstance(width, (int, np.integer)) or width not in widths):
        raise ValueError(f"width {width!r} must be None or one of {', '.join(map(str, widths))}")
    if nan not in ("raise", "pass"):
        raise ValueError(f"nan {nan!r} is neither 'raise' nor 'pass'")
    if hand is not None and width is not None and datapath != "lean":
        raise ValueError(f"datapath {datapath!r}: with hand and width it must be 'lean'")
    if limits is not None and hand is None:
        raise ValueError("limits: wrist targets have no joints; give hand")
    hands = None if hand is None else Hands.checked(hand, tool, branch, order, nan)
    joint_limits = None if limits is None else checked_limits(limits)
    table, missing = _table(points, hanging(axis) if phi is None else phi, d1, d2, hands, nan)
    frame = None if isinstance(axis, str) and axis == "z" else to_z(axis)
    exponent = core.scale_exponent(_targets(table, hands, frame), width) if width and table.size else 0

    count, step = table.shape[1], LONG_CHUNK if width or hands else CHUNK
    arrays: dict[str, Any] = {}
    for rows in (slice(start, start + step) for start in range(0, max(count, 1), step)):
        some = table[:, rows], hands and hands.part(rows), joint_limits, frame, datapath
        for name, values in (_in_words(*some, width, exponent) if width else _in_double(*some)).items():
            arrays.setdefault(name, np.empty((count, *values.shape[1:]), values.dtype))[rows] = values
    for name, values in arrays.items():
        if missing is not None:
            values[missing] = np.nan if values.dtype.kind == "f" else 0
        if name in ("qs", "qe", "qw"):
            arrays[name] = _rolled(order, values, -1)
    if hands is not None:
        arrays["branch"] = np.broadcast_to(hands.branch, count).copy()
    return Pose(**arrays, order=order)


def _targets(table: Floats, hands: Hands | None, frame: Any) -> Targets:
    """Return the targets of a table (6, N) with rows as ``FIELDS``; frame (4,): R, which takes the axis to z."""
    hand: dict[str, Any] = {"hand": hands.q.T, "tool": hands.tool, "branch": hands.branch} if hands else {}
    x, y, z, phi, d1, d2 = table
    return Targets("targets", x, y, z, phi, d1, d2, frame=frame, **hand)


def _in_words(
    table: Floats, hands: Hands | None, limits: Any, frame: Any, datapath: str, width: int, exponent: int
) -> dict[str, Any]:
    """Return fields of :class:`Pose`, computed in the core's words, with lengths scaled by 2^exponent.

    table: as in :func:`_targets`; with ``hands``, its x, y, z are the hands' points.
    """
    words, _ = core.to_words(_targets(table, hands, frame), width, exponent)
    path, ends = MODELS["arm" if hands else datapath], core.limit_words(limits, width)
    run = fixed.run(words[:, :-1], width, path.name, words[:, -1], ends) if hands else fixed.run(words, width, datapath)
    value = dict(zip(path.results, core.result_values(run.results, width).T, strict=True))
    results, qw, th = (
        np.array([value[k] for k in names if k in value]) for names in (RESULT_FIELDS, core.WRIST_FIELDS, core.JOINTS)
    )
    phi = core.from_words(words[:, : len(FIELDS)], exponent, width, "targets").phi
    pose = _pose(table, results, run.flags & 2 * BAD_HAND - 1, phi, frame)
    if not hands:
        return pose
    over = run.flags >> OVER_BIT + np.arange(7)[:, None] & 1 > 0
    over |= np.array([[high < low] for low, high in ends])  # limits with no word between them
    w, i = results[4:]
    q = kinematics.product(kinematics.product(pose["qs"].T, np.array((-i, w, 0 * w, 0 * w))), qw)
    hand = pose["wrist"] + joints.tool_offset(q / np.linalg.norm(q, axis=0), hands.tool).T
    th *= np.pi / 2  # result_values returns 1 for a quarter turn
    return pose | {"qw": qw.T, "hand": hand, "joints": th.T, "over_limit": over.T}


def _in_double(table: Floats, hands: Hands | None, limits: Any, frame: Any, datapath: str) -> dict[str, Any]:
    """Return the same fields as :func:`_in_words`, computed in double precision."""
    asked = wrists = np.concatenate((table[:3] - hands.offset, table[3:])) if hands else table
    if frame is not None:
        asked = np.concatenate((_targets(wrists, None, frame).core_position.T, wrists[3:]))
    if datapath == "paper":
        clamped = solve_clamped(*asked)
        results, flags = np.array([clamped[field] for field in RESULT_FIELDS]), clamped["flags"]
    else:
        results, flags = solve_direct(asked)
    pose = _pose(wrists, results, flags, table[3], frame)
    if not hands:
        return pose
    qw = joints.wrist_quaternion(pose["qs"].T, results[4:], hands.q)
    th = joints.angles(results[:4], joints.flexion(results[4:]), qw, hands.branch)
    over = np.zeros(th.shape, dtype=bool)
    if limits is not None:
        th = joints.settled(th, limits)
        over = joints.outside(th, limits)
    return pose | {"qw": qw.T, "hand": pose["wrist"] + hands.offset.T, "joints": th.T, "over_limit": over.T}


def _pose(table: Floats, results: Floats, flags: NDArray[np.int64], phi: Floats, frame: Any) -> dict[str, Any]:
    """Return fields of :class:`Pose`, in the user's frame, from results (6, N) of the core."""
    qs, qe = results[:4].T, results[4:].T
    qs = qs if frame is None else multiply(conjugate(frame), qs)
    elbow, wrist = kinematics.forward(qs, qe, table[4], table[5])
    whole_qe = np.zeros((len(qe), 4))
    whole_qe[:, :2] = qe
    return {"qs": qs, "qe": whole_qe, "flags": flags, "elbow": elbow, "wrist": wrist, "phi": phi}


def _table(
    points: ArrayLike, phi: ArrayLike, d1: ArrayLike, d2: ArrayLike, hands: Hands | None, nan: str
) -> tuple[Floats, NDArray[np.bool_] | None]:
    """Return checked targets as a table (6, N), rows as ``FIELDS``; and a mask (N,) of columns with nan, or None.

    A column with a nan is replaced by another column, so that all columns can be solved.
    """
    position = np.asarray(points, dtype=np.float64)
    position = position.reshape(-1, 3) if position.ndim < 2 and position.size in (0, 3) else position
    if position.ndim != 2 or position.shape[1] != 3:
        raise ValueError(f"points have the shape {position.shape}, not (N, 3)")
    columns = [np.asarray(v, dtype=np.float64) for v in (phi, d1, d2)]
    arrays: dict[str, NDArray[Any]] = dict(zip(("points", *FIELDS[3:]), (position[:, 0], *columns), strict=True))
    arrays |= {"hand": hands.q[0], "tool": hands.tool, "branch": hands.branch} if hands else {}
    count = common_count({name: v.size for name, v in arrays.items()})
    table = np.empty((len(FIELDS), count))
    table[:3], table[3], table[4], table[5] = position.T, *columns
    missing: Any = None
    if hands and hands.missing.any():
        table[0, np.broadcast_to(hands.missing, table.shape[1])] = np.nan
    if np.count_nonzero(np.isfinite(table)) < table.size:
        _refuse(np.isinf(table) if nan == "pass" else ~np.isfinite(table), "not finite")
        missing = np.isnan(table).any(axis=0)
        table[:, missing] = 1.0 if missing.all() else table[:, [np.argmin(missing)]]
    if np.count_nonzero(table[4:] > 0.0) < table[4:].size:
        _refuse((table <= 0) & (np.arange(len(FIELDS)) > 3)[:, None], "not positive")
    if np.count_nonzero(np.abs(table[3]) > 2 * np.pi):
        warnings.warn(angle_doubt(table[3]), stacklevel=3)
    return table, missing


def _refuse(wrong: NDArray[np.bool_], reason: str) -> None:
    """Raise ValueError if any of ``wrong`` (6, N) is True; the message names the field and its first wrong columns."""
    for name, rows in (("points", wrong[:3].any(axis=0)), *zip(FIELDS[3:], wrong[3:], strict=True)):
        refuse(name, rows, reason)


def forward(
    qs: ArrayLike, qe: ArrayLike, d1: ArrayLike = DEFAULT_D1, d2: ArrayLike = DEFAULT_D2, *, order: Order = "wxyz"
) -> tuple[Floats, Floats]:
    """Return elbow and wrist (N, 3) of arms with joints Qs and Qe (N, 4); d1, d2: numbers or (N,).

    The result does not depend on the reference axis.  Raises ValueError for shapes that do not match.
    """
    shoulder, elbow = (np.atleast_2d(np.asarray(q, dtype=np.float64)) for q in (qs, qe))
    for q in (shoulder, elbow):
        if q.shape[-1] != 4:
            raise ValueError(f"quaternions have the shape {q.shape}, not (N, 4)")
    return kinematics.forward(_rolled(order, shoulder, 1), _rolled(order, elbow, 1), d1, d2)


def swivel(shoulder: ArrayLike, elbow: ArrayLike, wrist: ArrayLike, axis: Axis = "z") -> Floats:
    """Return the swivel angle (N,), rad in [-pi, pi], of arms with their joints at these points, (N, 3) or (3,).

    With this angle as phi, :func:`solve` reproduces the elbow.  The angle is arbitrary where the arm is straight or
    closed, and less accurate near those poses.
    """
    shoulder = np.asarray(shoulder, dtype=np.float64)
    turn = matrix(to_z(axis)).T
    e, p = (np.atleast_2d(np.asarray(point, dtype=np.float64) - shoulder) @ turn for point in (elbow, wrist))
    rho = np.hypot(p[:, 0], p[:, 1])
    on_axis = rho == 0  # azimuth 0, as in the core
    c, s = np.where(on_axis, 1.0, p[:, 0]), np.where(on_axis, 0.0, p[:, 1])
    p[~p.any(axis=1), 2] = 1.0  # a wrist at the shoulder counts as above it
    length = np.hypot(c, s)
    c, s = c / length, s / length
    inward = e[:, 0] * c + e[:, 1] * s
    aside = e[:, 0] * s - e[:, 1] * c
    return np.arctan2(aside, (rho * e[:, 2] - p[:, 2] * inward) / np.linalg.norm(p, axis=1))


def swivel_toward(points: ArrayLike, pole: ArrayLike, axis: Axis = "z") -> Floats:
    """Return the swivel angle (N,), rad, for which the elbow points at a pole (N, 3) or (3,).

    The elbow is then in the half plane that starts at the line from shoulder to wrist target and contains the pole.
    The angle is arbitrary for a pole on that line.
    """
    return swivel((0.0, 0.0, 0.0), pole, points, axis)


def soft_reach(points: ArrayLike, d1: ArrayLike = DEFAULT_D1, d2: ArrayLike = DEFAULT_D2, soft: float = 0.05) -> Floats:
    """Return wrist targets (N, 3) or (3,) that approach the full stretch smoothly, so the elbow does not snap straight.

    Beyond L - b, where L = d1 + d2 and b = soft L, the distance r from the shoulder becomes L - b exp((L - b - r) / b).
    Raises ValueError for ``soft`` outside 0 to 1.
    """
    if not 0 <= soft <= 1:
        raise ValueError(f"soft {soft!r} is not in 0 to 1")
    points, reach = np.asarray(points, dtype=np.float64), np.add(d1, d2, dtype=np.float64)[..., None]
    distance = np.linalg.norm(points, axis=-1, keepdims=True)
    band = soft * reach
    with np.errstate(divide="ignore", invalid="ignore"):
        softened = (reach - band * np.exp((reach - band - distance) / band)) / distance
    return points * np.where((distance > reach - band) & (band > 0), softened, 1.0)


def hanging(axis: Axis = "z") -> float:
    """Return the swivel angle (rad) for which the elbow of an arm that reaches forward (x) hangs straight down (-z).

    If the axis is x, the arm reaches to the left (y).
    """
    return _hanging(axis if isinstance(axis, str) else tuple(direction(axis)))


@lru_cache
def _hanging(axis: str | tuple[float, ...]) -> float:
    reach = (0.0, 1.0, 0.0) if abs(direction(axis)[0]) == 1 else (1.0, 0.0, 0.0)
    return float(swivel((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), reach, axis)[0])


def _rolled(order: Order, q: Floats, places: int) -> Floats:
    """Convert quaternions between wxyz and `order`; places: -1 to convert to `order`, 1 to convert to wxyz."""
    check_order(order)
    return q if order == "wxyz" else np.roll(q, places, axis=-1)


def refuse(name: str, rows: NDArray[np.bool_], reason: str) -> None:
    """Raise ValueError if any of ``rows`` (N,) is True; the message names the first three rows."""
    if rows.any():
        first = np.flatnonzero(rows)
        more = f" and {len(first) - 3} more" if len(first) > 3 else ""
        raise ValueError(f"{name}: {reason} in row{'s'[: len(first) > 1]} {', '.join(map(str, first[:3]))}{more}")


def check_order(order: str) -> None:
    if order not in ("wxyz", "xyzw"):
        raise ValueError(f"order {order!r} is neither 'wxyz' nor 'xyzw'")


def quaternions(hand: Any, order: str) -> Floats:
    """Return orientations as quaternions (N, 4) in ``order``, from quaternions (N, 4) or (4,), matrices (N, 3, 3),
    (3, 3) or (N, 4, 4), or a scipy Rotation.  Raises ValueError for matrices that are no rotations."""
    if hasattr(hand, "as_quat"):
        return np.atleast_2d(np.roll(hand.as_quat(), int(order == "wxyz"), axis=-1))
    values = np.asarray(hand, dtype=np.float64)
    if values.shape[-2:] != (3, 3) and not (values.ndim == 3 and values.shape[1:] == (4, 4)):
        return np.atleast_2d(values)
    turns = values[..., :3, :3].reshape(-1, 3, 3)
    off = np.abs(turns @ turns.swapaxes(1, 2) - np.eye(3)).max(axis=(1, 2))
    refuse("hand", ~(off < LENGTH_TOLERANCE) | ~(np.linalg.det(np.nan_to_num(turns)) > 0), "not a rotation matrix")
    return np.roll(quaternion(turns), -int(order == "xyzw"), axis=1)


def common_count(counts: dict[str, int]) -> int:
    """Return the number of rows to which ``counts`` (argument -> rows) broadcast.  Raises ValueError if they do not."""
    if len(different := set(counts.values()) - {1} or {1}) > 1:
        listed = ", ".join(f"{name} has {count}" for name, count in counts.items())
        raise ValueError(f"numbers of rows do not broadcast: {listed}")
    return different.pop()


def checked_limits(limits: ArrayLike) -> Floats:
    """Return joint limits as an array (7, 2), rad.  Warns if they seem to be in degrees.  Raises ValueError for a wrong
    shape or an empty interval."""
    ends = np.asarray(limits, dtype=np.float64)
    if ends.shape != (7, 2):
        raise ValueError(f"limits have the shape {ends.shape}, not (7, 2)")
    for joint, (low, high) in enumerate(ends.tolist(), 1):
        if not low <= high:
            raise ValueError(f"limits of joint {joint}: {low:.6g} to {high:.6g} is not an interval")
    sizes = np.abs(ends)
    largest = sizes[sizes <= 1080].max(initial=0.0)
    if largest > 8 * np.pi:
        warnings.warn(f"limits reach {largest:g}; their unit is the radian: convert degrees", stacklevel=3)
    return ends
