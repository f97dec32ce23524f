# SPDX-License-Identifier: Apache-2.0
"""The lean datapath across every boundary of its equations, one lsb of one input word a step.

A walk is a target of which one word counts up. At each of its steps

* a flag changes where exact integers say, by a threshold that is worked out without the words of the walk;
* elbow, wrist and joints move no further than those of the exact pose (double precision, clamped as needed), but for
  the error of a result;
* the exact pose itself is continuous: halving the step where it moves most, again and again, makes the move vanish.

Where it is not, the walk says so. The points, elbow and wrist, jump

* at the z axis, where the reference of the swivel angle does, for an arm that is neither straight nor folded: azimuth 0
  is taken there, so only a target that comes along +x meets no jump;
* at the shoulder, which has no direction: +z is taken.

The joints jump there too, even with a straight arm on the z axis, whose shoulder then turns about the arm; and where a
length becomes positive, since an arm without a length is taken as straight. No other step of any walk jumps.
"""

from dataclasses import dataclass, field
from functools import cache
from math import isqrt

import numpy as np
import pytest

from model.dataflow import fixed
from model.io.flags import AT_SHOULDER, BAD_LENGTH, ON_AXIS, TOO_FAR, TOO_NEAR, expected_flags
from model.io.words import FIELDS, RESULT_FIELDS, result_values
from model.reference.kinematics import angle_between, forward
from model.reference.lean_equations import solve_lean

TESTED = (16, 18, 24, 27, 32)
STEPS = 24
"""To either side of a boundary."""

BASES = 4
"""Random targets that a kind of walk starts from; half of them with arms of some 30 lsb where it can be."""

POINT_BAR = {16: 2e-4, 18: 5e-5, 24: 1e-6, 27: 1.25e-7, 32: 2e-8}
"""Error of elbow and wrist in parts of the reach, as in test_lean.py."""

ANGLE_ULPS = {16: 3, 18: 3, 24: 3, 27: 3, 32: 21}

HALVINGS = 45
STILL = 1e-5
"""A move (parts of the reach, rad) that is left after so many halvings of a step and counts as none. A root moves by
the square root of what is left of the step."""


@dataclass
class Walk:
    """``words`` (M, 6), of which ``axis`` counts up. ``flag`` is set where ``where`` (M,) says. ``jumps`` and
    ``turns``: steps, by the walked word before and after, at which points and joints of the exact pose jump."""

    words: np.ndarray
    axis: str
    flag: int = 0
    where: list[bool] = field(default_factory=list)
    jumps: tuple = ()
    turns: tuple = ()

    @property
    def values(self) -> np.ndarray:
        return self.words[:, FIELDS.index(self.axis)]


def walk(base: dict[str, int], axis: str, values, flag: int = 0, holds=None, jumps=(), turns=()) -> Walk:
    """The walk of ``base`` along ``values`` of one word; ``holds(value)`` says where the flag is set."""
    words = np.array([[{**base, axis: int(v)}[name] for name in FIELDS] for v in values], dtype=np.int64)
    return Walk(words, axis, flag, [holds(int(v)) for v in values] if holds else [], jumps, (*jumps, *turns))


def around(value: int, low: int = -(1 << 40)) -> range:
    return range(max(value - STEPS, low), value + STEPS + 1)


class Bases:
    """Random targets of one width, the same ones each time."""

    def __init__(self, width: int) -> None:
        self.random = np.random.default_rng((width, 31))
        self.width = width
        self.top = (1 << (width - 1)) - 1

    def phi(self) -> int:
        """No multiple of a quarter turn and none near: on the z axis those may hide a jump."""
        quarter = 1 << (self.width - 2)
        return int(self.random.integers(-2, 2)) * quarter + int(quarter * self.random.uniform(0.2, 0.8))

    def __call__(self, size: float = 1.0, **words) -> dict[str, int]:
        """A target in reach with arms from 1:2 to 2:1."""
        reach = size * self.top * self.random.uniform(0.6, 0.9)
        share = self.random.uniform(1 / 3, 2 / 3)
        d1, d2 = max(1, round(reach * share)), max(1, round(reach * (1 - share)))
        v = self.random.normal(size=3)
        v *= self.random.uniform(abs(d1 - d2) + 0.2 * reach, 0.9 * reach) / np.linalg.norm(v)
        position = dict(zip("xyz", (int(p) or 1 for p in np.rint(v)), strict=True))
        return position | {"phi": self.phi(), "d1": d1, "d2": d2} | words

    def sizes(self) -> list[float]:
        return [1.0] * (BASES // 2) + [30 / self.top] * (BASES - BASES // 2)


def root_up(n: int) -> int:
    """The least integer whose square is at least n."""
    return isqrt(n - 1) + 1 if n > 0 else 0


def without(base, axis) -> int:
    """x^2 + y^2 + z^2 without one of them, exact."""
    return sum(base[a] ** 2 for a in "xyz" if a != axis)


# -- the walks, by kind


def across_full_stretch(b: Bases, size: float):
    for axis in "xyz":
        base = b(size)
        base[axis] = 0
        rest = (base["d1"] + base["d2"]) ** 2 - without(base, axis)
        last = isqrt(rest)
        for side in (1, -1):
            yield walk(base, axis, around(side * last), TOO_FAR, lambda v, m=last: abs(v) > m)
    for axis, other in (("d1", "d2"), ("d2", "d1")):
        base = b(size)
        base[other] = max(1, isqrt(without(base, None)) // 2)
        least = root_up(without(base, None)) - base[other]
        yield walk(base, axis, around(least, 1), TOO_FAR, lambda v, m=least: v < m)


def across_full_fold(b: Bases, size: float):
    for axis in "xyz":
        for longer, shorter in (("d1", "d2"), ("d2", "d1")):
            base = b(size)
            base[longer] = 2 * base[shorter]
            scale = base[shorter] / (4 * max(abs(base[a]) for a in "xyz"))
            base |= {a: round(base[a] * scale) or 1 for a in "xyz"}
            first = root_up((base["d1"] - base["d2"]) ** 2 - without(base, axis))
            for side in (1, -1):
                yield walk(base, axis, around(side * first), TOO_NEAR, lambda v, m=first: abs(v) < m)
    for axis, other in (("d1", "d2"), ("d2", "d1")):
        base = b(size)
        base |= {a: base[a] // 4 for a in "xyz"}
        most = isqrt(without(base, None))
        for edge in (base[other] + most, base[other] - most):  # the longer arm, then the shorter one
            yield walk(
                base, axis, around(edge, 1), TOO_NEAR, lambda v, o=base[other], m=most: v > 0 and abs(v - o) > m
            )


def across_the_z_axis(b: Bases, size: float):
    for z in (1, -1):
        for axis, jumps in (("x", ((-1, 0),)), ("y", ((-1, 0), (0, 1)))):
            base = b(size)
            height = z * round(0.8 * (base["d1"] + base["d2"]))
            yield walk({**base, "x": 0, "y": 0, "z": height}, axis, around(0), ON_AXIS, lambda v: v == 0, jumps)


def across_the_z_axis_with_a_straight_arm(b: Bases, size: float):
    for z in (1, -1):
        for axis, jumps in (("x", ((-1, 0),)), ("y", ((-1, 0), (0, 1)))):
            base = b(size)
            reach, fold = base["d1"] + base["d2"], max(1, abs(base["d1"] - base["d2"]) // 2)
            for height in (reach, reach + 5, fold if base["d1"] != base["d2"] else reach + 1):
                # At the reach it is straight on the axis only.
                on_axis = {**base, "x": 0, "y": 0, "z": z * height}
                yield walk(on_axis, axis, around(0), ON_AXIS, lambda v: v == 0, (), jumps)


def past_the_z_axis(b: Bases, size: float):
    for z in (1, -1):
        for axis, aside in (("x", "y"), ("y", "x")):
            for off in (1, -1, 2, 7):
                base = b(size)
                height = z * round(0.8 * (base["d1"] + base["d2"]))
                yield walk({**base, aside: off, "z": height}, axis, around(0), ON_AXIS, lambda v: False)


def toward_the_z_axis_along_x(b: Bases, size: float):
    base = b(size)
    height = round(0.8 * (base["d1"] + base["d2"]))
    for z in (1, -1):
        yield walk({**base, "y": 0, "z": z * height}, "x", range(0, STEPS), ON_AXIS, lambda v: v == 0)


def along_the_z_axis(b: Bases, size: float):
    base = b(size, x=0, y=0)
    reach = base["d1"] + base["d2"]
    for side in (1, -1):
        heights = [v for v in around(side * reach) if v * side > 0]  # not past the shoulder
        yield walk(base, "z", heights, TOO_FAR, lambda v, m=reach: abs(v) > m)
    for longer, shorter in (("d1", "d2"), ("d2", "d1")):
        arms = {**base, longer: 3 * base[shorter]}
        edge = 2 * base[shorter]
        if edge > STEPS:
            for side in (1, -1):
                yield walk(arms, "z", around(side * edge), TOO_NEAR, lambda v, m=edge: abs(v) < m)


def through_the_shoulder(b: Bases, size: float):
    none = {"x": 0, "y": 0, "z": 0}
    base = b(size, **none)
    equal = {**base, "d2": base["d1"]}
    for axis in "xyz":
        # Bent arms: the elbow is beside the line to the target, and at the shoulder above it.
        yield walk(equal, axis, around(0), AT_SHOULDER, lambda v: v == 0, ((-1, 0), (0, 1)))
        for other in (base["d1"] * 2 + 60, max(1, base["d1"] // 2)):
            # Folded: along the line to the target, and at the shoulder upward.
            jumps = ((-1, 0),) if axis == "z" else ((-1, 0), (0, 1))
            arms = {**base, "d1": base["d1"] + 60, "d2": other}
            yield walk(arms, axis, around(0), AT_SHOULDER, lambda v: v == 0, jumps)
    d = base["d2"]
    # The upper arm goes from below, the forearm being the longer, to above.
    yield walk(base, "d1", around(d, 1), TOO_NEAR, lambda v: v != d, ((d - 1, d),))
    d = base["d1"]
    yield walk(base, "d2", around(d, 1), TOO_NEAR, lambda v: v != d, ((d, d + 1),))


def lengths_through_0(b: Bases, size: float):
    for axis, other in (("d1", "d2"), ("d2", "d1")):
        base = b(size)
        s = without(base, None)
        for length, turns in ((isqrt(s) // 2, ()), (2 * isqrt(s) + 40, ((0, 1),))):  # out of reach, too near
            arms = {**base, other: max(1, length)}
            yield walk(arms, axis, around(0), BAD_LENGTH, lambda v: v <= 0, (), turns)
        for length in (0, -5):
            yield walk({**base, other: length}, axis, around(0), BAD_LENGTH, lambda v: True)
        # exactly as far as the other arm is long: 3-4-5
        k = max(8, round(size * b.top / 8))
        arms = {**base, "x": 3 * k, "y": -4 * k, "z": 0, other: 5 * k}
        yield walk(arms, axis, around(0), BAD_LENGTH, lambda v: v <= 0, (), ((0, 1),))


def swivel_angle(b: Bases, size: float):
    half = 1 << (b.width - 1)
    for start in (half, 0, half // 2, -half // 2):
        values = [(v + half) % (2 * half) - half for v in around(start)]
        yield walk(b(size), "phi", values)
        base = b(size, x=0, y=0)
        yield walk({**base, "z": round(0.8 * (base["d1"] + base["d2"]))}, "phi", values)


def half_angles(b: Bases, size: float):
    """Where the cosine that chooses a branch is 0: u_y, z, cos a, then k of Qs and the squared length 1/4."""
    for axis in "yz":
        yield walk(b(size), axis, around(0))
        yield walk(b(size, **{"z" if axis == "y" else "y": 0}), axis, around(0))
    for axis in "xyz":  # s = d2^2 - d1^2
        base = b(size)
        base["d2"] = root_up(base["d1"] ** 2 + without(base, None))
        yield walk(base, axis, around(base[axis]))
    base = b(size)
    base["d2"] = root_up(base["d1"] ** 2 + without(base, None))
    yield walk(base, "d2", around(base["d2"], 1))
    yield walk(base, "d1", around(base["d1"], 1))
    for node in ("k", "low"):
        base = b(size)
        edge = flip(base, "phi" if node == "k" else "x", node, b.width)
        if edge is not None:
            axis = "phi" if node == "k" else "x"
            yield walk(base, axis, around(edge))
    base = b(1.0, y=0)
    for axis, edge in (("x", 1 << (b.width - 3)), ("d1", 1 << (b.width - 3)), ("d2", 1 << (b.width - 3))):
        yield walk(base, axis, around(edge))  # the roots' shifts change


def flip(base, axis: str, node: str, width: int) -> int | None:
    """A value of the word at which a decision of the dataflow changes, or None."""

    def decision(values):
        bits = fixed.run(walk(base, axis, values).words, width, "lean").bits
        return np.asarray(bits.nodes["k_1"].value < 0 if node == "k" else bits.nodes["low"].value != 0)

    span = (1 << (width - 1)) - 1 if axis == "phi" else abs(base["x"])
    low, high = -span, span
    values = np.linspace(low, high, 200).astype(np.int64)
    changes = np.flatnonzero(np.diff(decision(values).astype(int)))
    if not len(changes):
        return None
    low, high = int(values[changes[0]]), int(values[changes[0] + 1])
    while high - low > 1:
        middle = (low + high) // 2
        first, other = decision([low, middle])
        low, high = (middle, high) if first == other else (low, middle)
    return low


KINDS = {
    kind.__name__: kind
    for kind in (
        across_full_stretch, across_full_fold, across_the_z_axis, across_the_z_axis_with_a_straight_arm,
        past_the_z_axis, toward_the_z_axis_along_x, along_the_z_axis, through_the_shoulder, lengths_through_0,
        swivel_angle, half_angles,
    )
}  # fmt: skip


# -- running them


@dataclass
class Pose:
    """Points (N, 2, 3): elbow and wrist, in lsb; joints: Qs (N, 4) and Qe as a quaternion (N, 4)."""

    points: np.ndarray
    joints: tuple[np.ndarray, np.ndarray]

    @classmethod
    def of(cls, q: np.ndarray, words: np.ndarray) -> "Pose":
        joints = q[:, :4], np.column_stack([q[:, 4:], np.zeros((len(q), 2))])
        return cls(np.stack(forward(q[:, :4], q[:, 4:], words[:, 4], words[:, 5]), axis=1), joints)

    def at(self, rows) -> "Pose":
        return Pose(self.points[rows], tuple(j[rows] for j in self.joints))

    def moved(self, other: "Pose", reach) -> tuple[np.ndarray, np.ndarray]:
        """Largest move of a point / reach, largest turn of a joint (rad)."""
        apart = np.linalg.norm(self.points - other.points, axis=2).max(axis=1) / reach
        return apart, np.maximum(*(angle_between(a, b) for a, b in zip(self.joints, other.joints, strict=True)))


def exact_pose(words: np.ndarray, width: int) -> Pose:
    """Of words that need not be integers."""
    x, y, z, phi, d1, d2 = words.T
    answer = solve_lean(x, y, z, phi * (2 * np.pi / 2.0**width), d1, d2)
    return Pose.of(np.column_stack([answer[name] for name in RESULT_FIELDS]), words)


@dataclass
class Walked:
    """All steps of some walks, from row ``first`` (S,) to the next one, with what moves at it."""

    walks: list[Walk]
    words: np.ndarray
    flags: np.ndarray
    first: np.ndarray
    reach: np.ndarray
    core: Pose
    exact: Pose
    jumps: tuple[np.ndarray, np.ndarray]

    def step(self, n: int) -> str:
        return f"from {self.words[self.first[n]].tolist()} to {self.words[self.first[n] + 1].tolist()}"


@cache
def walked(kind: str, width: int) -> Walked:
    bases = Bases(width)
    walks = [w for size in bases.sizes() for w in KINDS[kind](bases, size)]
    low, top = -(1 << (width - 1)), (1 << (width - 1)) - 1
    walks = [w for w in walks if (w.words >= low).all() and (w.words <= top).all()]
    words = np.concatenate([w.words for w in walks])
    starts = np.cumsum([0] + [len(w.words) for w in walks])
    first = np.concatenate([np.arange(a, b - 1) for a, b in zip(starts, starts[1:], strict=False)])
    answer = fixed.run(words, width, "lean")
    lengths = np.abs(words[:, 4]) + np.abs(words[:, 5])
    reach = np.maximum(np.maximum(lengths[first], lengths[first + 1]), 1).astype(float)
    core = Pose.of(result_values(answer.results, width), words.astype(float))
    exact = exact_pose(words.astype(float), width)
    jumps = left_after_halving(words, first, width, reach)
    return Walked(walks, words, answer.flags, first, reach, core, exact, jumps)


def left_after_halving(words, first, width: int, reach) -> tuple[np.ndarray, np.ndarray]:
    """What is left of each step's move of the exact pose, points and joints, when the half that moves more is kept."""
    left = []
    for what in (0, 1):
        a, b = words[first].astype(float), words[first + 1].astype(float)
        turn = 2.0**width
        b[:, 3] += turn * np.round((a[:, 3] - b[:, 3]) / turn)
        pose_a, pose_b = exact_pose(a, width), exact_pose(b, width)
        for _ in range(HALVINGS):
            middle = (a + b) / 2
            pose = exact_pose(middle, width)
            right = pose.moved(pose_b, reach)[what] > pose.moved(pose_a, reach)[what]
            a, b = np.where(right[:, None], middle, a), np.where(right[:, None], b, middle)
            pose_a, pose_b = chosen(right, pose, pose_a), chosen(right, pose_b, pose)
        left.append(pose_a.moved(pose_b, reach)[what])
    return tuple(left)


def chosen(mask, a: Pose, b: Pose) -> Pose:
    joints = tuple(np.where(mask[:, None], u, v) for u, v in zip(a.joints, b.joints, strict=True))
    return Pose(np.where(mask[:, None, None], a.points, b.points), joints)


every_kind = pytest.mark.parametrize("kind", KINDS)
every_width = pytest.mark.parametrize(
    "width", [w if w in (18, 32) else pytest.param(w, marks=[pytest.mark.slow, pytest.mark.cost(1)]) for w in TESTED]
)


@every_width
@every_kind
def test_flags_change_exactly_where_integers_say(kind, width):
    run = walked(kind, width)
    start = 0
    crossed = 0
    for w in run.walks:
        flags = run.flags[start : start + len(w.words)]
        start += len(w.words)
        assert (flags == expected_flags(w.words, width)).all(), f"{w.axis} of {w.words[0].tolist()}"
        if w.flag:
            assert (flags & w.flag != 0).tolist() == w.where, f"{w.axis} of {w.words[0].tolist()}"
            crossed += len(set(w.where)) == 2
    if kind not in ("past_the_z_axis", "swivel_angle", "half_angles"):
        assert crossed >= BASES, "walks that cross"
    else:
        assert len(run.walks) >= BASES and len(set((run.flags & (ON_AXIS | BAD_LENGTH)).tolist())) <= 2


@every_width
@every_kind
def test_pose_moves_no_further_than_the_exact_one(kind, width):
    run = walked(kind, width)
    a, b = run.first, run.first + 1
    moved, turned = run.core.at(a).moved(run.core.at(b), run.reach)
    move, turn = run.exact.at(a).moved(run.exact.at(b), run.reach)
    bar = 2 * POINT_BAR[width]
    n = int(np.argmax(moved - move))
    assert moved[n] <= move[n] + bar, f"points move {moved[n]:.3g}, not {move[n]:.3g}, {run.step(n)}"
    bar = 2 * ANGLE_ULPS[width] * 2.0 ** (2 - width)
    n = int(np.argmax(turned - turn))
    assert turned[n] <= turn[n] + bar, f"joints turn {turned[n]:.3g}, not {turn[n]:.3g} rad, {run.step(n)}"


@every_width
@every_kind
def test_points_and_joints_are_those_of_the_exact_pose(kind, width):
    run = walked(kind, width)
    reach = np.maximum(np.abs(run.words[:, 4]) + np.abs(run.words[:, 5]), 1)
    off, turned = run.core.moved(run.exact, reach)
    n = int(np.argmax(off))
    assert off[n] <= POINT_BAR[width], f"points are {off[n]:.3g} of the reach off at {run.words[n].tolist()}"
    n = int(np.argmax(turned))
    assert turned[n] <= ANGLE_ULPS[width] * 2.0 ** (2 - width), (
        f"joints are {turned[n]:.3g} rad off at {run.words[n].tolist()}"
    )


@every_width
@every_kind
def test_the_exact_pose_jumps_where_it_is_said_to_and_nowhere_else(kind, width):
    run = walked(kind, width)
    declared = {"points": [], "joints": []}
    for w in run.walks:
        steps = list(zip(w.values.tolist(), w.values[1:].tolist(), strict=False))
        declared["points"] += [s in w.jumps for s in steps]
        declared["joints"] += [s in w.turns for s in steps]
    for what, left in zip(declared, run.jumps, strict=True):
        wrong = np.flatnonzero((left > STILL) != np.array(declared[what]))
        assert not len(wrong), f"{what}: {left[wrong[0]]:.3g} is left of the step {run.step(wrong[0])}"


def test_halving_finds_a_jump_between_any_two_words():
    """The tool itself: the azimuth's jump at the z axis is left as it is, the root at full stretch is not."""
    width = 32
    d = 1 << 29
    crossing = [[x, 0, d, 1 << 28, d, d] for x in (-1, 0)]
    words = np.array(crossing + [[0, 2 * d + more, 0, 5, d, d] for more in (0, 1)])
    points, joints = left_after_halving(words, np.array([0, 2]), width, np.full(2, 2.0 * d))
    assert points[0] > 0.1 and joints[0] > 1
    assert points[1] < STILL and joints[1] < STILL
