# SPDX-License-Identifier: Apache-2.0
"""Chain of seven joints in a URDF file: reader, forward kinematics, and the nearest arm that can be solved exactly.

An arm can be solved exactly if its first three axes meet at right angles, its last three do too, and shoulder, elbow
and wrist are in a plane perpendicular to axis 4. `nearest` is for files whose numbers are rounded, and for a few real
arms.
"""

import warnings
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from ..reference.joints import UNIT
from ..reference.kinematics import about, fixed_axes, matrix, quaternion
from .pose import Floats

TOLERANCE = 1e-6
"""Largest distance between axes that meet, relative to the chain's size; largest cosine between perpendicular axes."""

MISFIT, TURN_MISFIT = 2e-3, 1e-3
"""Largest tip differences of an accepted chain from the nearest exact arm: distance / size of the chain; rad."""

DOUBTFUL = 1e-4  # misfit / size above which a warning is given
SAMPLES = 4000  # joint positions at which the two chains are compared
SOLVED, ROUNDS = 1e-12, 20  # error and number of steps at which the correction stops


@dataclass(frozen=True, eq=False)
class Chain:
    """Chain of seven joints; axes, points and end describe it with all joints at 0.

    * axes (7, 3): unit vectors; points (7, 3): one point on each axis; end (4, 4): frame of the tip
    * names (7,); limits (7, 2), rad; velocities (7,): greatest speeds, rad/s, inf where the file has none
    """

    axes: Floats
    points: Floats
    end: Floats
    names: tuple[str, ...]
    limits: Floats
    velocities: Floats

    @property
    def size(self) -> float:
        """Length of the diagonal of the box around all points."""
        return float(np.linalg.norm(np.ptp(np.vstack((self.points, self.end[:3, 3])), axis=0)))

    def turns(self, positions: Floats) -> Floats:
        """Return the rotations (8, N, 3, 3) before each joint and after the last, for joint positions (N, 7)."""
        total = [np.broadcast_to(np.eye(3), (len(positions), 3, 3))]
        for axis, angle in zip(self.axes, positions.T, strict=True):
            x, y, z = axis
            across = np.array(((0, -z, y), (z, 0, -x), (-y, x, 0)))
            sine, versed = np.sin(angle)[:, None, None], 2 * np.square(np.sin(angle / 2))[:, None, None]
            total.append(total[-1] @ (np.eye(3) + sine * across + versed * (across @ across)))
        return np.array(total)

    def forward(self, positions: Floats) -> tuple[Floats, Floats, Floats]:
        """Return points (N, 3) and rotations (N, 3, 3) of the tip, and its Jacobian (N, 6, 7): linear, then angular."""
        turns = self.turns(positions)
        bones = np.diff(np.vstack((self.points, self.end[:3, 3])), axis=0)
        places = [self.points[0] + np.zeros((len(positions), 3))]
        for turn, bone in zip(turns[1:], bones, strict=True):
            places.append(places[-1] + turn @ bone)
        axes = np.einsum("knij,kj->nki", turns[:-1], self.axes)
        arms = np.moveaxis(places[-1] - np.array(places[:-1]), 0, 1)
        jacobian = np.concatenate((np.cross(axes, arms), axes), axis=2).swapaxes(1, 2)
        return places[-1], turns[-1] @ self.end[:3, :3], jacobian

    def corrected(self, positions: Floats, points: Floats, turns: Floats) -> tuple[Floats, Floats]:
        """Correct joint positions (N, 7) within the limits so that the tip reaches points (N, 3) and orientations
        (N, 3, 3). Return them and their remaining errors (N,): the larger of distance / size and angle (rad).

        Newton's steps, damped near singular poses: dq = J' (J J' + mu)^-1 e, J the Jacobian, mu = 1e-3 |e|^2 + 1e-14.
        """
        low, high = self.limits.T
        at = np.clip(positions, low, high)
        free, errors = np.ones(at.shape, dtype=bool), np.zeros(len(at))
        rows = np.arange(len(at))
        for _ in range(ROUNDS + 1):
            place, turn, jacobian = self.forward(at[rows])
            off = turns[rows] @ turn.swapaxes(1, 2)
            twist = np.stack([off[:, k - 1, k - 2] - off[:, k - 2, k - 1] for k in range(3)], axis=1) / 2
            error = np.concatenate(((points[rows] - place) / self.size, twist), axis=1)
            errors[rows] = np.abs(error).max(axis=1)
            moving = errors[rows] > SOLVED
            rows, error, jacobian = rows[moving], error[moving], jacobian[moving]
            if not len(rows):
                break
            jacobian[:, :3] /= self.size
            jacobian *= free[rows][:, None]
            damped = jacobian @ jacobian.swapaxes(1, 2)
            damped += (1e-3 * np.square(error).sum(axis=1) + 1e-14)[:, None, None] * np.eye(6)
            step = (jacobian.swapaxes(1, 2) @ np.linalg.solve(damped, error[..., None]))[..., 0]
            step *= np.minimum(1, 0.5 / np.maximum(np.abs(step).max(axis=1), 1e-300))[:, None]
            moved = at[rows] + step
            free[rows] = (moved >= low) & (moved <= high)  # the next step leaves out joints that have met a limit
            at[rows] = np.clip(moved, low, high)
        return at, errors


def arguments(path: str | Path, base: str | None, tip: str | None) -> dict[str, Any]:
    """Return the arguments of :class:`Arm` for the chain between two links of a URDF file.

    Warns if the chain differs by more than DOUBTFUL from one that `Arm` solves exactly. Raises OSError, ValueError.
    """
    try:
        chain = read(ElementTree.parse(path).getroot(), base, tip)
    except (ElementTree.ParseError, KeyError) as error:
        raise ValueError(f"not a URDF file: {error}") from None
    try:
        return exact(chain)
    except ValueError as error:
        fitted, misfit, turn = nearest(chain)
        if misfit > MISFIT * chain.size or turn > TURN_MISFIT:
            text = f"even the nearest solvable arm has its tip off by {misfit:.3g} and {turn:.3g} rad"
            raise ValueError(f"{error}; {text}; docs/related.md names solvers for such arms") from None
        if misfit > DOUBTFUL * chain.size:
            text = f"{error}; joints are corrected, but swivel angles and reach are those of the nearest solvable arm"
            warnings.warn(f"{path}: {text}, off by {misfit:.3g} at the tip", stacklevel=4)
        return exact(fitted) | {"chain": chain, "misfit": (misfit, turn)}


def nearest(chain: Chain) -> tuple[Chain, float, float]:
    """Return the nearest chain that can be solved exactly, and the largest distance and angle (rad) between the tips.

    The axes are made perpendicular in sequence. A least-squares fit over SAMPLES positions within the limits then gives
    the shoulder, the bones u and f (perpendicular to axis 4) and the tool. Rk is the rotation about the first k axes:

        tip = shoulder + R3 u + R4 f + R7 tool
    """
    axes = chain.axes.copy()
    for one, other in ((0, 1), (1, 2), (4, 5), (5, 6)):
        axes[other] -= axes[one] * (axes[one] @ axes[other])
        axes[other] /= np.linalg.norm(axes[other])
    low, high = np.clip(chain.limits.T, -np.pi, np.pi)
    positions = np.random.default_rng(0).uniform(low, high, (SAMPLES, 7))
    tips, orientations, _ = chain.forward(positions)
    turns = replace(chain, axes=axes).turns(positions)
    across = np.linalg.svd(axes[3:4])[2][1:].T  # (3, 2)
    columns = (np.broadcast_to(np.eye(3), turns[0].shape), turns[3] @ across, turns[4] @ across, turns[7])
    unknown = np.concatenate(columns, axis=2).reshape(3 * SAMPLES, 10)
    solution = np.linalg.lstsq(unknown, tips.ravel(), rcond=None)[0]
    shoulder, u, f, tool = solution[:3], across @ solution[3:5], across @ solution[5:7], solution[7:]
    left, _, right = np.linalg.svd((turns[7].swapaxes(1, 2) @ orientations).mean(axis=0))
    wrist, end = shoulder + u + f, left @ np.diag((1, 1, np.linalg.det(left @ right))) @ right
    points = np.array([shoulder] * 3 + [shoulder + u] + [wrist] * 3)
    fitted = replace(chain, axes=axes, points=points, end=placed(end, wrist + tool))
    off = np.trace((turns[7] @ end).swapaxes(1, 2) @ orientations, axis1=1, axis2=2)
    misfit = np.linalg.norm((unknown @ solution).reshape(-1, 3) - tips, axis=1).max()
    return fitted, float(misfit), float(np.arccos(np.clip((off - 1) / 2, -1, 1)).max())


def read(robot: ElementTree.Element, base: str | None, tip: str | None) -> Chain:
    """Return the chain between two links, by default the only root and the only leaf. Raises KeyError or ValueError.

    Floating and planar joints are ignored; the default chain begins below them.
    """
    joints = [joint for joint in robot.findall("joint") if joint.attrib["type"] not in ("floating", "planar")]
    above = {_attributes(joint, "child")["link"]: joint for joint in joints}
    parents = {_attributes(joint, "parent")["link"] for joint in joints}
    base, tip = base or _only("base", parents - set(above)), tip or _only("tip", set(above) - parents)
    chain: list[ElementTree.Element] = []
    link = tip
    while link != base:
        if link not in above or len(chain) > len(above):
            raise ValueError(f"no chain of joints leads from {base} to {tip}")
        chain.append(above[link])
        link = _attributes(above[link], "parent")["link"]
    frame = np.eye(4)
    rows: list[tuple[Any, ...]] = []
    for joint in reversed(chain):
        name, kind = joint.attrib["name"], joint.attrib["type"]
        turn = matrix(fixed_axes(*_numbers(joint, "origin", "rpy", "0 0 0")))
        frame = frame @ placed(turn, _numbers(joint, "origin", "xyz", "0 0 0"))
        if kind == "fixed":
            continue
        if kind not in ("revolute", "continuous"):
            raise ValueError(f"joint {name} is {kind}; all joints have to turn")
        if (mimic := joint.find("mimic")) is not None:
            raise ValueError(f"joint {name} mimics {mimic.get('joint')}; all joints have to be free")
        axis = frame[:3, :3] @ _numbers(joint, "axis", "xyz", "1 0 0")
        if not axis.any():
            raise ValueError(f"joint {name} has the axis 0 0 0")
        limited = kind == "revolute" and joint.find("limit") is not None
        sides = (("lower", "0"), ("upper", "0")) if limited else (("", "-inf"), ("", "inf"))
        limits = [_numbers(joint, "limit", *side)[0] for side in sides]
        velocity = _numbers(joint, "limit", "velocity", "inf")[0]
        rows.append((axis / np.linalg.norm(axis), frame[:3, 3], name, limits, velocity))
    if len(rows) != 7:
        raise ValueError(f"expected 7 moving joints between {base} and {tip}, got {len(rows)}")
    axes, points, names, *ranges = zip(*rows, strict=True)
    return Chain(np.array(axes), np.array(points), frame, names, *map(np.array, ranges))


def _only(what: str, links: set[str]) -> str:
    if len(links) != 1:
        listed = ", ".join(sorted(links)) or "there are no joints"
        raise ValueError(f"no unique link for {what}: {listed}" + f"; choose with {what.upper()}=" * bool(links))
    return links.pop()


def _attributes(joint: ElementTree.Element, part: str) -> dict[str, str]:
    element = joint.find(part)
    return {} if element is None else element.attrib


def _numbers(joint: ElementTree.Element, part: str, name: str, default: str) -> Floats:
    """Return the numbers in the attribute ``name`` of a joint's element ``part``, or in ``default``."""
    text = _attributes(joint, part).get(name, default)
    try:
        values = np.array(text.split(), dtype=np.float64)
    except ValueError:
        values = np.empty(0)
    if len(values) != len(default.split()) or np.isnan(values).any():
        raise ValueError(f"joint {joint.attrib['name']}: {part} {name} {text!r} is not {len(default.split())} numbers")
    return values


def placed(turn: Floats, point: Floats) -> Floats:
    """Return the homogeneous matrix (4, 4) of an orientation (3, 3) and a position (3,)."""
    return np.vstack((np.column_stack((turn, point)), (0, 0, 0, 1)))


def exact(chain: Chain, straight: float = TOLERANCE) -> dict[str, Any]:
    """Return the arguments of :class:`Arm` for a chain.  Raises ValueError for a chain that cannot be solved exactly.

    Links that bend by less than ``straight`` (rad) count as straight.
    """
    axes, points, end, size = chain.axes, chain.points, chain.end, chain.size
    centres = []
    for first, name in ((0, "shoulder"), (4, "wrist")):
        three = slice(first, first + 3)
        for one, other in ((first, first + 1), (first + 1, first + 2)):
            if abs(axes[one] @ axes[other]) > TOLERANCE:
                angle = np.degrees(np.arccos(abs(axes[one] @ axes[other])))
                raise ValueError(f"axes {one + 1} and {other + 1} are {angle:.6g} degrees apart, not 90")
        across = np.eye(3) - axes[three, :, None] * axes[three, None, :]  # removes the part along each axis
        centre = np.linalg.solve(across.sum(axis=0), (across @ points[three, :, None]).sum(axis=0)[:, 0])
        away = np.linalg.norm(np.cross(centre - points[three], axes[three]), axis=1)
        if away.max() > TOLERANCE * size:
            group = f"axes {first + 1} to {first + 3}, of the {name},"
            raise ValueError(f"{group} do not meet in one point: they miss it by up to {away.max():.6g}")
        centres.append(centre)
    shoulder, wrist = centres
    elbow = points[3] + axes[3] * ((shoulder - points[3]) @ axes[3])
    aside = (wrist - elbow) @ axes[3]
    if abs(aside) > TOLERANCE * size:
        raise ValueError(f"shoulder and wrist are {abs(aside):.6g} apart along axis 4, not 0")
    d1, d2 = np.linalg.norm(elbow - shoulder), np.linalg.norm(wrist - elbow)
    if min(d1, d2) <= TOLERANCE * size:
        raise ValueError(f"axis 4 passes through the {'shoulder' if d1 < d2 else 'wrist'}")
    u, f, reach = (elbow - shoulder) / d1, (wrist - elbow) / d2, end[:3, 3] - wrist
    signs = np.ones(7)
    signs[2::2] = [1.0 if along >= 0 else -1.0 for along in (axes[2] @ u, axes[4] @ f, axes[6] @ reach)]
    a = axes * signs[:, None]

    def frame(x, z):
        return np.column_stack((x, np.cross(z, x), z))

    def tilt(first, second, third):  # angle about the second axis from the first to the third
        return np.arctan2(third @ np.cross(second, first), third @ first)

    def spin(m):  # angle of a turn about z, None for other turns
        return np.arctan2(m[1, 0], m[0, 0]) if m[2, 2] > 1 - straight**2 else None

    flexion = np.arctan2(axes[3] @ np.cross(u, f), u @ f)
    mount, upper_arm = frame(a[1], a[0]), frame(axes[3], u)
    upper = matrix(about(0, -tilt(a[0], a[1], a[2]))) @ mount.T @ upper_arm
    wrist_frame = frame(a[5], a[4])
    fore = (upper_arm @ matrix(about(0, flexion))).T @ wrist_frame
    to_hand = matrix(about(0, -tilt(a[4], a[5], a[6]))) @ wrist_frame.T
    th = np.array((0, tilt(a[0], a[1], a[2]), spin(upper) or 0, flexion, spin(fore) or 0, tilt(a[4], a[5], a[6]), 0))
    turns = quaternion(np.stack((mount, to_hand @ end[:3, :3], upper, fore)))
    links = [UNIT if spin(link) is not None else turn for link, turn in ((upper, turns[2]), (fore, turns[3]))]
    arm = {"d1": d1, "d2": d2, "tool": to_hand @ reach, "offsets": -signs * th, "signs": signs, "base": shoulder}
    arm |= {"mount": turns[0], "tip": turns[1], "upper": links[0], "fore": links[1]}
    return arm | {"limits": chain.limits, "names": chain.names, "velocities": chain.velocities}
