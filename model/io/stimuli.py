# SPDX-License-Identifier: Apache-2.0
"""Targets for testbenches: signed input words (N, 6) of ``width`` bits, reproducible from the seed.

Columns are ``FIELDS`` of :mod:`model.io.words`: x, y, z, phi, d1, d2.
"""

from math import isqrt

import numpy as np

from ..dataflow.expressions import wrap
from ..reference.joints import turned
from ..reference.kinematics import multiply, rotate
from ..reference.lean_equations import solve_lean
from .flags import UNREACHABLE, expected_flags
from .words import ARM_FIELDS, FIELDS, binary_angles


def random_reachable(count: int, width: int, seed: int) -> np.ndarray:
    """Return targets that set no flags; directions and swivel angles are uniform.

    Every other target has lengths that fill their words; for the rest, the logarithm of the size is uniform.
    """
    random, rows = np.random.default_rng((seed, width, 1)), np.zeros((0, len(FIELDS)), dtype=np.int64)
    while len(rows) < count:
        n = count + 16
        size = np.where(np.arange(n) % 2, 0.0, random.uniform(3 - width, 0, n))  # log2 of d1 + d2, approximately
        total = np.exp2(size) * random.uniform(0.5, 1.9, n)
        share = random.uniform(0.03, 0.97, n)
        d1, d2 = total * share, total * (1 - share)
        distance = random.uniform(np.abs(d1 - d2), total)
        direction = random.normal(size=(n, 3))
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
        lengths = np.column_stack([direction * distance[:, None], d1, d2]) * 2.0 ** (width - 2)
        words = np.rint(lengths).astype(np.int64)
        words = np.insert(words, 3, random.integers(-(1 << (width - 1)), 1 << (width - 1), n), axis=1)
        rows = np.concatenate([rows, words[expected_flags(words, width) == 0]])
    return rows[:count]


def unreachable(count: int, width: int, seed: int) -> np.ndarray:
    """Return clamped targets of seven kinds in rotation: too far, too near (longer upper arm), too near (longer
    forearm), at the shoulder, on the z axis out of reach, a bone length of 0, a negative bone length."""
    random = np.random.default_rng((seed, width, 2))
    top = (1 << (width - 1)) - 1
    number = np.arange(count)
    kind = number % 7
    size = 1 << random.integers(2, width - 1, (count, 1))
    position = random.integers(-size, size, (count, 3))
    phi = random.integers(-top - 1, top + 1, count)
    arms = random.integers(1, 1 << random.integers(1, width - 1, (count, 1)), (count, 2))
    either = random.integers(2, size=count)  # which bone

    too_far = kind == 0
    position[too_far] |= 1 << (width - 3)
    arms[too_far] = random.integers(1, 1 << (width - 5), (too_far.sum(), 2))
    for arm in range(2):
        too_near = kind == 1 + arm
        position[too_near] >>= 4
        arms[too_near, arm] = top - random.integers(0, 1 << (width - 3), too_near.sum())
        arms[too_near, 1 - arm] = 1 << (width - 5)
    on_axis = kind == 4  # out of reach, on either side
    position[on_axis | (kind == 3)] = 0
    position[on_axis, 2] = np.where(number[on_axis] % 2, 1, -1) << (width - 2)
    arms[on_axis] >>= 3
    arms[number, either] *= np.select([kind == 5, kind == 6], [0, -1], 1)

    rows = np.clip(np.column_stack([position, phi, arms]), -top - 1, top)
    stray = (expected_flags(rows, width) & UNREACHABLE == 0) & rows[:, :3].any(axis=1)
    rows[stray, 4] = 0
    return rows


def corners(width: int) -> dict[str, tuple[int, ...]]:
    """Return targets at the limits of formats, reach and equations: name -> words."""
    low, top = -(1 << (width - 1)), (1 << (width - 1)) - 1
    k = 1 << (width - 6)  # unit of exact lengths: 3-4-5, 1-2-2-3
    half_turn, quarter = low, 1 << (width - 2)
    place = (3 * k, 2 * k, k)  # a point in reach of (3k, 2k)
    arm = (3 * k, 2 * k)
    angles = {"0": 0, "half a turn": half_turn, "half a turn - 1 lsb": top, "1 lsb": 1, "-1 lsb": -1}
    angles |= {"a quarter turn": quarter, "minus a quarter turn": -quarter}
    return {
        # extreme words
        "zero": (0, 0, 0, 0, 0, 0),
        "all lowest": (low, low, low, low, low, low),
        "all highest": (top, top, top, top, top, top),
        "x = -2, longest arm": (low, 0, 0, 0, top, top),
        "y = -2, longest arm": (0, low, 0, quarter, top, top),
        "z = -2, longest arm": (0, 0, low, 0, top, top),
        "cube corner, longest arm": (low, low, low, 12345, top, top),
        "opposite corner, longest arm": (top, top, top, half_turn, top, top),
        "1 lsb, longest arm": (1, 0, 0, 0, top, top),
        "-1 lsb each, longest arm": (-1, -1, -1, quarter, top, top),
        "arms of 1 lsb": (1, 0, 0, 0, 1, 1),
        "arms of 1 lsb, -1 lsb each": (-1, -1, -1, 1, 1, 1),
        "arms of 1 lsb, stretched": (0, 2, 0, 0, 1, 1),
        "arms of 1 lsb, far": (top, 1, low, 0, 1, 1),
        "forearm of 1 lsb": (0, top, 0, quarter, top, 1),
        "forearm of 1 lsb, down": (0, 1, 2 - top, quarter, top - 2, 1),  # d1 + |p_ez| is rounded to 2
        "forearm of 1 lsb, up": (0, 0, top - 1, quarter, top - 1, 1),  # p_ez is rounded to 1
        "odd long arms, 2 lsb apart": (1, 0, 2, top, quarter + 3 * k + 1, quarter + 3 * k - 1),
        "odd long arms, 1 lsb apart": (-1, 0, -1, low, quarter + 3 * k, quarter + 3 * k - 1),
        "upper arm of 1 lsb": (top, 0, 0, quarter, 1, top),
        "arms of 2^n exactly": (k, k, k, 0, 2 * k, 2 * k),
        # reach
        "exactly full stretch": (3 * k, 4 * k, 0, quarter, 2 * k, 3 * k),
        "exactly full stretch, off the planes": (-k, 2 * k, -2 * k, 777, 2 * k, k),
        "full stretch, 1 lsb less": (3 * k, 4 * k, 0, quarter, 2 * k, 3 * k + 1),
        "full stretch, 1 lsb more": (3 * k, 4 * k, 0, quarter, 2 * k, 3 * k - 1),
        "exactly closed, upper arm longer": (3 * k, 0, -4 * k, 999, 7 * k, 2 * k),
        "exactly closed, forearm longer": (3 * k, 0, -4 * k, 999, 2 * k, 7 * k),
        "closed, 1 lsb less": (3 * k, 0, -4 * k, 999, 7 * k - 1, 2 * k),
        "closed, 1 lsb more": (3 * k, 0, -4 * k, 999, 7 * k + 1, 2 * k),
        "at the shoulder, equal arms": (0, 0, 0, 5, 3 * k, 3 * k),
        "at the shoulder, unequal lengths": (0, 0, 0, 5, 3 * k, 2 * k),
        # the z axis
        "target on +z": (0, 0, 4 * k, 0, *arm),
        "target on -z": (0, 0, -4 * k, 0, *arm),
        "target on +z, swivel": (0, 0, 4 * k, quarter + 3, *arm),
        "target 1 lsb off +z": (0, -1, 4 * k, quarter, *arm),
        "target 1 lsb off -z": (1, 0, -4 * k, -quarter, *arm),
        "exactly full stretch on +z": (0, 0, 5 * k, 0, *arm),
        "exactly full stretch on -z": (0, 0, -5 * k, 0, *arm),
        "too far on +z": (0, 0, 6 * k, 0, *arm),
        "too far on -z": (0, 0, -6 * k, 0, *arm),
        "exactly closed on +z": (0, 0, k, 0, *arm),
        "exactly closed on -z": (0, 0, -k, half_turn, *arm),
        "too near on +z": (0, 0, k >> 1, 0, *arm),
        "too near on -z, forearm longer": (0, 0, -(k >> 1), 0, *arm[::-1]),
        # an upper arm of 5k along the axis, a forearm (3k, 0, +-4k) or (4k, 0, -+3k)
        "elbow on +z, forearm up": (3 * k, 0, 9 * k, 0, 5 * k, 5 * k),
        "elbow on +z, forearm down": (0, 3 * k, k, 0, 5 * k, 5 * k),
        "elbow on -z, forearm up": (-3 * k, 0, -k, half_turn, 5 * k, 5 * k),
        "elbow on -z, forearm down": (3 * k, 0, -9 * k, half_turn, 5 * k, 5 * k),
        # the swivel angle
        **{f"phi = {name}": (*place, phi, *arm) for name, phi in angles.items()},
        # lengths
        "d1 = 0": (*place, 77, 0, 2 * k),
        "d2 = 0": (*place, 77, 3 * k, 0),
        "d1 = -1 lsb": (*place, 77, -1, 2 * k),
        "d2 = -2": (*place, 77, 3 * k, low),
        "d1 = d2 = -2": (*place, 77, low, low),
        "d1 = -d2": (*place, 77, -2 * k, 2 * k),
    }


def edges(count: int, width: int, seed: int) -> np.ndarray:
    """Return up to ``count`` reachable targets that are likely to overflow: a target near the shoulder with long bones,
    or a short forearm on a long upper arm along the z axis."""
    random = np.random.default_rng((seed, width, 5))
    top = (1 << (width - 1)) - 1
    near = np.arange(count) % 2 == 0
    small = np.exp2(random.uniform(0, width / 2, count)).astype(np.int64)
    # target near the shoulder
    position = np.rint(random.normal(size=(count, 3)) * small[:, None] * 0.5).astype(np.int64)
    length = np.floor(np.sqrt((position.astype(np.float64) ** 2).sum(axis=1))).astype(np.int64)
    d2 = random.integers(1 << (width - 3), top - 2 * small.max(), count)
    d1 = d2 + np.rint(length * random.choice([-1.0, 1.0, 0.5, 0.0], count)).astype(np.int64)
    # a long upper arm along z
    d2 = np.where(near, d2, small)
    d1 = np.where(near, d1, top - small - random.integers(0, 3, count))
    direction = random.normal(size=(count, 3))
    direction *= (small * random.uniform(0, 1, count) / np.linalg.norm(direction, axis=1))[:, None]
    arm = np.column_stack([np.zeros((count, 2)), random.choice([-1.0, 1.0], count) * d1])
    position = np.where(near[:, None], position, np.rint(direction + arm).astype(np.int64))
    phi = random.integers(-top - 1, top + 1, count)
    rows = np.column_stack([np.clip(position, -top - 1, top), phi, d1, d2])
    return rows[expected_flags(rows, width) & UNREACHABLE == 0]


def extremes(count: int, width: int, seed: int) -> np.ndarray:
    """Return targets (N, 6) whose words are at or next to the ends of the range, around 0, or random."""
    random = np.random.default_rng((seed, width, 3))
    low, top = -(1 << (width - 1)), (1 << (width - 1)) - 1
    edge = random.choice([low, low + 1, -1, 0, 1, top - 1, top], (count, len(FIELDS)))
    anything = random.integers(low, top + 1, (count, len(FIELDS)))
    return np.where(random.random((count, len(FIELDS))) < 0.6, edge, anything)


def special(width: int) -> tuple[int, ...]:
    """Return twelve words: at both ends of the range, around 0, around 1.0, -1.0 itself, and alternating bits."""
    low, one, top = -(1 << (width - 1)), 1 << (width - 2), (1 << (width - 1)) - 1
    return (low, low + 1, -one, -1, 0, 1, top // 3, one - 1, one, one + 1, top - 1, top)


SPECIAL = 12 ** len(FIELDS)  # number of targets that consist of special words


def of_special(first: int, count: int, width: int) -> np.ndarray:
    """Return up to ``count`` targets of :func:`special` words, from number ``first`` on; x varies fastest."""
    numbers = np.arange(first, min(first + count, SPECIAL))
    return np.array(special(width))[numbers[:, None] // 12 ** np.arange(len(FIELDS)) % 12]


def mixed(count: int, width: int, seed: int) -> np.ndarray:
    """Return shuffled targets: all corners; of the rest, half reachable, a quarter clamped, a quarter extreme."""
    random = np.random.default_rng((seed, width, 4))
    rows = np.array(list(corners(width).values()), dtype=np.int64)
    rest = max(0, count - len(rows))
    others = [kind(rest // 4, width, seed) for kind in (unreachable, extremes)]
    reachable = random_reachable(rest - 2 * (rest // 4), width, seed)
    return random.permutation(np.concatenate([random.permutation(rows)[:count], reachable, *others]))


REGIONS = {
    "anywhere": "any direction, any distance from closed to stretched",
    "near the z axis": "0.1 to 1e-9 rad off it or on it, above and below",
    "near full stretch": "0.1 to 1e-10 of the reach short of it, or at it",
    "near a closed elbow": "0.1 to 1e-10 of the reach beyond it, or at it, either length the longer",
    "near the shoulder": "0.1 to 1e-9 of the reach off it",
    "unequal lengths": "1:5 to 1:20",
    "most unequal lengths": "1:20 and beyond, down to a length of 1 lsb",
    "short lengths": "of 1 to 60 lsb",
    "stretched near the z axis": "both at once",
    "closed near the z axis": "both at once",
    "elbow near the z axis": "0.1 to 1e-9 rad off it or on it, above and below",
    "where a branch changes": "x, y, z, the cosine at the shoulder or the k part of Qs within a few lsb of 0",
}
"""Region of the reachable workspace -> description; most are near singular poses."""


def region(name: str, count: int, width: int, seed: int) -> np.ndarray:
    """Return reachable targets of one of the ``REGIONS``.

    Unless REGIONS states otherwise, lengths have all sizes and differ by a factor of up to 20. A quarter of the swivel
    angles is within 2 lsb of a multiple of an eighth of a turn.
    """
    random = np.random.default_rng((seed, width, 10, list(REGIONS).index(name)))
    rows = np.zeros((0, len(FIELDS)), dtype=np.int64)
    while len(rows) < count:
        more = _region(name, random, count + 16, width)
        more = more[(more == wrap(more, width)).all(axis=1)]  # all words fit
        rows = np.concatenate([rows, more[expected_flags(more, width) & UNREACHABLE == 0]])
    return rows[:count]


def right_angles(count: int, width: int, seed: int) -> np.ndarray:
    """Return up to ``count`` reachable targets for which errors of roots and roundings matter most: near the x axis,
    with nearly a right angle between the target and a short upper arm. Most |p| are just below a power of 2, most d1
    just below a power of 4: reciprocal roots of such mantissas have the largest relative errors."""
    random, top = np.random.default_rng((seed, width, 11)), (1 << width - 1) - 1

    def small():
        return random.choice([-1, 1], count) * np.exp2(-random.uniform(3, width, count))

    def below(exponent, most):
        return np.exp2(exponent) * (1 - random.uniform(0, most, count) ** 2)

    p = below(width - 1 - random.integers(0, 2, count), 0.5)
    d1 = np.minimum(below(2 * (width // 2 - random.integers(1, width // 2, count)), 0.8), p / 2)
    d2, y, z = np.sqrt(p * p + d1 * d1 - 2 * p * d1 * small()), p * small(), p * small()
    x = random.choice([-1, 1], count) * np.sqrt(p * p - y * y - z * z)
    words = np.rint(np.column_stack([x, y, z, random.integers(-top, top, count), d1, d2])).clip(-top, top)
    words = words.astype(np.int64)
    return words[expected_flags(words, width) & UNREACHABLE == 0]


def _region(name: str, random, count: int, width: int) -> np.ndarray:
    eighth = 1 << (width - 3)
    phi = random.integers(-4 * eighth, 4 * eighth, count)
    special = random.integers(-4, 4, count) * eighth + random.integers(-2, 3, count)
    phi = np.where(random.random(count) < 0.25, np.clip(special, -4 * eighth, 4 * eighth - 1), phi)

    mild = random.random(count) < 0.5
    ratio = np.exp(np.where(mild, random.uniform(-0.5, 0.5, count), random.uniform(-1, 1, count) * np.log(20)))
    if "unequal" in name:
        ends = (np.log2(20), width - 2) if "most" in name else (np.log2(5), np.log2(20))
        ratio = np.exp2(random.uniform(*ends, count) * random.choice([-1, 1], count))
    share = ratio / (1 + ratio)
    bits = np.where(random.random(count) < 0.5, width - 1, random.uniform(4, width - 1, count))
    if name == "short lengths":
        bits = random.uniform(1, 7, count)
    reach = np.exp2(bits) * random.uniform(0.5, 1, count) * np.where(mild & (random.random(count) < 0.5), 1.4, 1)
    d1, d2 = (np.maximum(np.rint(reach * part), 1).astype(np.int64) for part in (share, 1 - share))
    gap = np.where(random.random(count) < 0.9, 10 ** random.uniform(-10, -1, count), 0)

    direction = _near_z(random, count) if "the z axis" in name else random.normal(size=(count, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    distance = random.uniform(np.abs(d1 - d2), d1 + d2)
    if name == "near the shoulder":
        distance = reach * 10 ** random.uniform(-9, -1, count)
    elif "closed" in name:
        distance = random.uniform(0, 0.9, count) * reach
    position = np.rint(direction * distance[:, None]).astype(np.int64)
    if name == "elbow near the z axis":
        return _elbow_near_z(random, width, d1, d2)
    if name == "where a branch changes":
        return _branches(random, width, position, phi, d1, d2)
    if "closed" in name or "stretch" in name or "shoulder" in name:
        squares = (position.astype(object) ** 2).sum(axis=1)
        floor = np.array([isqrt(s) for s in squares])
        if "stretch" in name:
            total = floor + (floor.astype(object) ** 2 < squares) + np.floor(gap * floor).astype(np.int64)
            d1 = np.clip(np.rint(total * share).astype(np.int64), 1, np.maximum(total - 1, 1))
            d2 = total - d1
        else:  # change only the longer bone
            part = random.uniform(-1, 1, count) if "shoulder" in name else 1 - gap
            longer = np.minimum(d1, d2) + np.rint(floor * part).astype(np.int64)
            d1, d2 = np.where(d1 < d2, d1, longer), np.where(d1 < d2, longer, d2)
    return np.column_stack([position, phi, d1, d2])


def _near_z(random, count: int) -> np.ndarray:
    """Return directions (N, 3) near or on the z axis."""
    off = np.where(random.random(count) < 0.9, 10 ** random.uniform(-9, -1, count), 0)
    return _directions(off, random.uniform(-np.pi, np.pi, count)) * random.choice([(1, 1, -1), (1, 1, 1)], count)


def _directions(off, azimuth) -> np.ndarray:
    """Return unit vectors (N, 3) at angles ``off`` (rad) from the z axis."""
    return np.column_stack([np.sin(off) * np.cos(azimuth), np.sin(off) * np.sin(azimuth), np.cos(off)])


def _elbow_near_z(random, width: int, d1, d2) -> np.ndarray:
    """Return targets with the elbow near the z axis: phi is near 0, or half a turn for an elbow below the shoulder."""
    count = len(d1)
    elbow = _near_z(random, count) * d1[:, None]
    # A forearm that points away from the wrist's side would put the elbow on the other side.
    side = _directions(random.uniform(0, np.pi, count), random.uniform(-np.pi, np.pi, count))
    off = np.where(random.random(count) < 0.9, 10 ** random.uniform(-9, -1, count) * random.choice([-1, 1], count), 0)
    phi = binary_angles(off, width) + (elbow[:, 2] <= 0) * (1 << width - 1)
    return np.column_stack([np.rint(elbow + side * d2[:, None]).astype(np.int64), wrap(phi, width), d1, d2])


def _branches(random, width: int, position, phi, d1, d2) -> np.ndarray:
    """Return targets of five kinds in rotation: x, y, z, the cosine of the shoulder angle, or k of Qs is near 0."""
    count = len(phi)
    kind = np.arange(count) % 5
    few = random.integers(-4, 5, count)
    position = np.where(kind[:, None] == np.arange(3), few[:, None], position)
    squares = (position.astype(object) ** 2).sum(axis=1) + d1.astype(object) ** 2  # cos a = 0: d2^2 = s + d1^2
    d2 = np.where(kind == 3, np.array([isqrt(s) for s in squares]) + few, d2)
    rows = np.column_stack([position, phi, d1, d2])
    rows[kind == 4] = _k_around_0(random, width, rows[kind == 4])
    return rows


def _k_around_0(random, width: int, rows: np.ndarray) -> np.ndarray:
    """Return the targets with new swivel angles that make k of Qs near 0.

    Qs = q_0 cos(phi/2) + q_pi sin(phi/2), where q_0 and q_pi are +-Qs at phi = 0 and pi: both relative signs are tried.
    """
    x, y, z, _, d1, d2 = rows.T.astype(float)
    at_0, at_pi = (solve_lean(x, y, z, phi, d1, d2)["qs_k"] for phi in (0.0, np.pi))
    both = [2 * np.arctan2(-at_0, side * at_pi) for side in (1, -1)]
    k = [solve_lean(x, y, z, phi, d1, d2)["qs_k"] for phi in both]
    phi = binary_angles(np.where(k[0] < k[1], *both), width)
    rows[:, 3] = wrap(phi + random.integers(-2, 3, len(rows)), width)
    return rows


# ---- the whole arm: columns are ARM_FIELDS of model.io.words --------------------------------------------------------


def hand_poses(targets: np.ndarray, width: int, seed: int) -> np.ndarray:
    """Return hand poses (N, 11) with wrists at reachable targets (N, 6).

    A third of the poses have any orientation. The others have th6 near 0 or half a turn, a tenth of them exactly. The
    tool is no longer than the arm, and short enough that the hand's point fits the format.
    """
    random, count, top = np.random.default_rng((seed, width, 4)), len(targets), (1 << width - 1) - 1
    near = np.exp2(random.uniform(-34, -3, count)) * (random.random(count) < 0.9)
    bent = np.choose(np.arange(count) % 3, (random.uniform(0, np.pi, count), near, np.pi - near))
    x, y, z, phi, d1, d2 = targets.T
    pose = solve_lean(x, y, z, phi * (2 * np.pi / (1 << width)), d1, d2)
    shoulder = np.column_stack([pose[f"qs_{c}"] for c in "wijk"])
    elbow = np.column_stack([-pose["qe_i"], pose["qe_w"], *np.zeros((2, count))])
    wrist = turned(random.uniform(-np.pi, np.pi, count), bent, random.uniform(-np.pi, np.pi, count)).T
    hand = multiply(multiply(shoulder, elbow), wrist) * random.choice((-1, 1), (count, 1))
    words = np.clip(np.rint(hand * (1 << width - 2)), -top - 1, top).astype(np.int64)
    tool = random.uniform(-1, 1, count) * (d1 + d2) * (random.random(count) < 0.8)
    axis = rotate(hand, (0.0, 0.0, 1.0))
    for _ in range(width + 1):
        tool = np.rint(np.clip(tool, -top, top))
        moved = targets[:, :3] + np.rint(tool[:, None] * axis)
        fits = (np.abs(moved) <= top).all(axis=1)
        point, tool = np.where(fits[:, None], moved, targets[:, :3]), np.where(fits, tool, tool / 2)
    return np.column_stack([point, targets[:, 3:], np.where(fits, tool, 0), words]).astype(np.int64)


def arm_corners(width: int) -> np.ndarray:
    """Return hand poses (N, 11) with a quaternion length just in or out of its range, or a wrist beyond the format."""
    one, top, half = 1 << width - 2, (1 << width - 1) - 1, round((1 << width - 2) * 0.5**0.5)
    ends = [one + side * (one >> 8) - less for side in (1, -1) for less in (0, 1)]
    rows = [(one >> 2, 0, 0, 0, one >> 1, one >> 1, 0, 0, end, 0, 0) for end in ends]
    along = (half, 0, half, 0), (half, -half, 0, 0), (one, 0, 0, 0)  # the hand's z axis along x, y, z
    for side in (1, -1):
        points = side * top * np.eye(3, dtype=np.int64)
        rows += [(*p, 0, one >> 1, one >> 1, -side * top, *q) for p, q in zip(points, along, strict=True)]
    return np.array(rows)


def arm_targets(count: int, width: int, seed: int) -> np.ndarray:
    """Return words and branches (N, 12) of shuffled hand poses: half are in reach, a quarter are arbitrary words, and a
    quarter are arbitrary words except for a unit quaternion. Large sets include the corners."""
    random, kind = np.random.default_rng((seed, width, 6)), np.arange(count)[:, None] // 2 % 4
    anything, corners = any_hands(count, width, seed), arm_corners(width)
    poses = hand_poses(random_reachable(count, width, seed), width, seed)
    rows = np.where(kind < 2, poses, anything)
    rows[:, 7:] = np.where(kind < 3, rows[:, 7:], poses[:, 7:])
    if count > 2 * len(corners):
        rows[: len(corners)] = corners
    return np.column_stack([random.permutation(rows), random.integers(8, size=count)])


def referenced(words: np.ndarray, width: int, seed: int) -> np.ndarray:
    """Return words (N, 19): ``words`` (N, 12) with arbitrary reference joints inserted between hand pose and branch."""
    references = np.random.default_rng((seed, width, 8)).integers(-(1 << width - 1), 1 << width - 1, (len(words), 7))
    return np.insert(words, [len(ARM_FIELDS)] * 7, references, axis=1)


def hands(words: np.ndarray, width: int, seed: int) -> np.ndarray:
    """Return words and branches (N, 12) of hand poses whose wrists are at the targets ``words`` (N, 6).

    One pose in eight has an arbitrary, non-unit quaternion. Large sets begin with the poses of :func:`arm_corners`.
    """
    random, named = np.random.default_rng((seed, width, 7)), arm_corners(width)
    reachable = np.flatnonzero((expected_flags(words, width) & UNREACHABLE) == 0)
    rows = any_hands(len(words), width, seed)
    rows[:, :6] = words
    posed = hand_poses(words[reachable], width, seed)
    kept = random.random(len(words)) < 7 / 8
    if len(posed):  # wrists out of reach get hands and tools of poses in reach
        rows[kept, 6:] = posed[random.integers(len(posed), size=kept.sum()), 6:]
        rows[reachable[kept[reachable]]] = posed[kept[reachable]]
    if len(rows) > 100 * len(named):
        rows[: len(named)] = named
    return np.column_stack([rows, random.integers(8, size=len(words))])


def arm_limits(width: int, long: bool = False) -> list[tuple[int, int]]:
    """Return limits (low, high) of seven joints, in words: arcs of all lengths, some across half a turn (low > high).
    ``long``: the arcs are so long that some branches of a pose are within all seven; one arc is a whole turn."""
    half = 1 << width - 1
    arcs = (0.9, -0.8), (-0.7, 0.95), (-1.0, 0.0), (-0.4, 0.5), (0.2, 0.3), (-0.99, 0.6), (0.7, 0.4)
    if long:
        arcs = (-0.95, 0.9), (0.1, 0.0), (-1.0, 1.0), (-0.9, 0.7), (0.6, 0.55), (-0.97, 0.93), (-1.0, 0.99)
    return [(round(low * half), min(round(high * half), half - 1)) for low, high in arcs]


def any_hands(count: int, width: int, seed: int) -> np.ndarray:
    """Return words (N, 11) of hand poses: targets of :func:`mixed`, with arbitrary words for tool and hand. In every
    second pose, each of these words is -1, 0 or 1, at an end of the format, or halfway to an end."""
    random, low = np.random.default_rng((seed, width, 5)), -(1 << width - 1)
    anything = random.integers(low, -low, (count, 5))
    edge = random.choice([low, -1, 0, 1, -low // 2, low // 2, -low - 1], (count, 5))
    return np.column_stack([mixed(count, width, seed), np.where(np.arange(count)[:, None] % 2, edge, anything)])
