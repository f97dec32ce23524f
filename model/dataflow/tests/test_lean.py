# SPDX-License-Identifier: Apache-2.0
"""The lean datapath, bit-true: errors of hand and angles all over the reachable workspace, unit quaternions, flags.

A result word is rounded, half an ulp (2^(2 - W)) each; that alone can move the hand by 3.2 ulps of the reach, with an
upper arm of a twentieth of the forearm. So the bars are also given in ulps.
"""

from functools import cache

import numpy as np
import pytest
from hypothesis import event, example, given, settings, target
from hypothesis import strategies as st

from model.bounds import predict, tolerances
from model.dataflow import fixed
from model.dataflow.nodes import WIDTHS
from model.io.flags import AT_SHOULDER, FLAGS, SATURATED, UNREACHABLE
from model.io.scoring import singular_distance
from model.io.stimuli import (
    REGIONS,
    SINGULAR,
    at_distance,
    corners,
    extremes,
    mixed,
    random_reachable,
    region,
    unreachable,
)
from model.io.tests.test_flags import in_python_integers
from model.io.words import FIELDS, RESULT_FIELDS, from_words, result_values
from model.reference.equations import solve_clamped
from model.reference.kinematics import angle_between, forward
from model.reference.lean_equations import solve_lean

TESTED = (16, 18, 24, 27, 32)
COUNT = 9000
"""Targets of a region and width: 108,000 a width."""

WORST = {
    16: (-32753, -3, -22, -19265, 73, 32752),
    18: (58796, 28913, -498, 66209, 867, 65679),
    24: (8252900, -970, 709, -494258, 39409, 8273971),
    27: (67077117, 0, 768, -67108864, 49495, 67108861),
    32: (2043587052, -2652, 1444, 84162352, 65595619, 2049611425),
}
"""The worst targets that `python -m scripts.climb` has found, 2.03e-4, 5.07e-5, 8.0e-7, 9.9e-8 and 1.60e-8: half angles
of azimuth, tilt and shoulder all next to where their branch changes, so that the unit length rests on words of 0.35,
and every rounding to one side. 5.07e-5 is past the tolerance of 18 bits, as correctly rounded results are
(`bounds/tests/test_tolerances.py`)."""

ANGLE_ULPS = {16: 3, 18: 3, 24: 3, 27: 3, 32: 21}
"""Shoulder and elbow angle: 2e-8 rad for W = 32."""


def ulp(width: int) -> float:
    """Of a result."""
    return 2.0 ** (2 - width)


# -- a run and what it is held against


def exact_flags(words: np.ndarray) -> list[int]:
    return [in_python_integers(*row) for row in words.tolist()]


def as_quaternions(qe: np.ndarray) -> np.ndarray:
    return np.column_stack([qe, np.zeros_like(qe)])


class Run:
    """Words and what the model makes of them: errors in parts of |d1| + |d2| (that of the hand against the pose where
    the target is out of reach), rad, and ulps."""

    def __init__(self, words: np.ndarray, width: int, solve=solve_lean) -> None:
        self.words = words
        self.answer = fixed.run(words, width, "lean")
        self.values = result_values(self.answer.results, width)
        self.targets = asked = from_words(words, 0, width, "words")
        qs, qe = self.values[:, :4], self.values[:, 4:]
        pose = solve(asked.x, asked.y, asked.z, asked.phi, asked.d1, asked.d2)
        pose = np.column_stack([pose[name] for name in RESULT_FIELDS])
        elbow, wrist = forward(qs, qe, asked.d1, asked.d2)
        pose_elbow, pose_wrist = forward(pose[:, :4], pose[:, 4:], asked.d1, asked.d2)
        reached = (self.answer.flags & UNREACHABLE) == 0
        reach = np.maximum(np.abs(asked.d1) + np.abs(asked.d2), ulp(width))
        aim = np.where(reached[:, None], asked.position, pose_wrist)
        self.hand = np.linalg.norm(wrist - aim, axis=1) / reach
        self.elbow = np.linalg.norm(elbow - pose_elbow, axis=1) / reach
        self.shoulder_angle = angle_between(qs, pose[:, :4])
        self.elbow_angle = angle_between(as_quaternions(qe), as_quaternions(pose[:, 4:]))
        self.norms = tuple(np.abs((q**2).sum(axis=1) - 1) / ulp(width) for q in (qs, qe))

    def below(self, error: np.ndarray, bar: float, what: str) -> None:
        """Fails with the worst target."""
        n = int(np.argmax(error))
        assert error[n] <= bar, f"{what} {error[n]:.3g} > {bar:.3g} at x, y, z, phi, d1, d2 = {self.words[n].tolist()}"

    def check(self, width: int) -> None:
        """What holds for any words: unit quaternions, exact flags, words that fit their formats."""
        self.check_norms(width)
        expected = np.array(exact_flags(self.words))
        wrong = np.flatnonzero(self.answer.flags != expected)
        assert not len(wrong), (
            f"flags of {self.words[wrong[0]].tolist()}: {self.answer.flags[wrong[0]]}, not {expected[wrong[0]]}"
        )
        for name, node in self.answer.bits.nodes.items():
            value = np.asarray(node.value)
            assert ((value >= node.format.low) & (value <= node.format.high)).all(), f"{name} leaves its format"

    def check_norms(self, width: int) -> None:
        """Both quaternions have unit length and the core's signs."""
        for name, off, bar in zip(("Qs", "Qe"), self.norms, tolerances.LEAN_NORMS[width], strict=True):
            self.below(off, bar, f"ulps that the squared length of {name} is off 1:")
        results = self.answer.results
        assert (results[:, 3] >= 0).all(), "the k part of Qs is negative"
        assert (results[:, 4] >= 0).all() and (results[:, 5] <= 0).all(), "signs of Qe"


@cache
def region_run(name: str, width: int) -> Run:
    return Run(region(name, COUNT, width, seed=1), width)


# -- the reachable workspace

everywhere = pytest.mark.parametrize("name", REGIONS)
every_width = pytest.mark.parametrize("width", TESTED)


def test_a_width_has_more_than_100000_targets():
    assert COUNT * len(REGIONS) >= 100_000


@every_width
@everywhere
def test_hand_is_at_its_target(name, width):
    run = region_run(name, width)
    assert not (run.answer.flags & UNREACHABLE).any(), "in reach"
    run.below(run.hand, tolerances.lean(width), "hand error / reach")


@every_width
@everywhere
def test_elbow_is_where_the_swivel_angle_puts_it(name, width):
    run = region_run(name, width)
    run.below(run.elbow, tolerances.lean(width), "elbow error / reach")


@every_width
@everywhere
def test_angles_are_exact_everywhere(name, width):
    """No distance from singular targets is asked for: against the words, the error does not grow toward any."""
    run = region_run(name, width)
    bar = ANGLE_ULPS[width] * ulp(width)
    assert width != 32 or bar < 1e-7
    run.below(run.shoulder_angle, bar, "shoulder angle error (rad)")
    run.below(run.elbow_angle, bar, "elbow angle error (rad)")


@every_width
@everywhere
def test_answers_are_well_formed(name, width):
    run = region_run(name, width)
    run.check(width)


@pytest.mark.parametrize("at", (-10, -9, -8, -7, -5, -3, -1))
@pytest.mark.parametrize("pose", SINGULAR)
def test_angles_do_not_get_worse_toward_a_singular_target(pose, at):
    """W = 32, a decade of distance from the singular target each; nearer than an lsb it is at it."""
    run = Run(at_distance(pose, 10.0**at, 3000, 32, seed=2), 32)
    run.below(run.shoulder_angle, ANGLE_ULPS[32] * ulp(32), "shoulder angle error (rad)")
    run.below(run.elbow_angle, ANGLE_ULPS[32] * ulp(32), "elbow angle error (rad)")
    run.below(run.hand, tolerances.lean(32), "hand error / reach")


@every_width
def test_angles_agree_with_the_paper_away_from_its_singular_poses(width):
    """0.01 rad off each of them double precision of the printed equations is exact to 1e-9."""
    run = Run(random_reachable(30000, width, seed=3), width, solve_clamped)
    away = singular_distance(run.targets) > 0.01
    assert away.mean() > 0.3
    bar = ANGLE_ULPS[width] * ulp(width) + 1e-9
    run.below(np.where(away, run.shoulder_angle, 0), bar, "shoulder angle error (rad)")
    run.below(np.where(away, run.elbow_angle, 0), bar, "elbow angle error (rad)")


@every_width
def test_worst_targets_found(width):
    """Roundings that all go one way: no bar but that of the search, and what affine prediction allows."""
    words = np.array([WORST[width]])
    run = Run(words, width)
    run.below(run.hand, tolerances.sought(width), "hand error / reach")
    run.below(run.hand, predict.hand_bar(words, width, "lean")[0], "hand error / reach")
    run.check_norms(width)


# -- any input words


def unreachable_kinds(width: int) -> np.ndarray:
    return np.concatenate([unreachable(6000, width, 4), shaken(width)])


def shaken(width: int) -> np.ndarray:
    """Targets out of reach by little or much, on every side: those of the regions with other arms or positions."""
    random = np.random.default_rng((width, 5))
    rows = np.concatenate([region(name, 500, width, 5) for name in REGIONS])
    factor = np.where(random.random((len(rows), 6)) < 0.5, 1, np.exp2(random.uniform(-4, 0.2, (len(rows), 6))))
    factor[:, 3] = 1
    rows = np.rint(rows * factor).astype(np.int64)
    signs = np.where(random.random((len(rows), 2)) < 0.05, -1, 1)
    rows[:, 4:] *= signs
    top = (1 << (width - 1)) - 1
    rows = np.clip(rows, -top - 1, top)
    flags = np.array(exact_flags(rows))
    return rows[flags & (UNREACHABLE | AT_SHOULDER) != 0]


@pytest.mark.parametrize("width", WIDTHS)
def test_every_word_has_a_unit_answer_and_exact_flags(width):
    words = np.concatenate(
        [mixed(4000, width, 6), extremes(4000, width, 6), tiny(width), np.array(list(corners(width).values()))]
    )
    run = Run(words, width)
    run.check(width)
    seen = np.bitwise_or.reduce(run.answer.flags)
    assert seen == sum(flag.bit for flag in FLAGS if flag.bit != SATURATED), "every kind of target"


def tiny(width: int) -> np.ndarray:
    """Words of a few lsb: every target and arm that there is, nearly."""
    random = np.random.default_rng((width, 7))
    words = random.integers(-3, 4, (3000, 6))
    words[:, 3] = random.integers(-(1 << (width - 1)), 1 << (width - 1), len(words))
    return words


@every_width
def test_clamped_arms_are_those_of_double_precision(width):
    run = Run(unreachable_kinds(width), width, solve_clamped)
    clamped = run.answer.flags & (UNREACHABLE | AT_SHOULDER) != 0
    assert clamped.all() and len(clamped) > 5000
    one = 1 << (width - 2)
    assert set(map(tuple, run.answer.results[:, 4:].tolist())) == {(0, -one), (one, 0)}, "Qe is -i or 1 exactly"
    run.below(run.elbow_angle, 1e-12, "elbow angle error (rad)")
    run.below(run.shoulder_angle, ANGLE_ULPS[width] * ulp(width), "shoulder angle error (rad)")
    # Lengths of opposite sign cancel: the points are held against the longer of them.
    run.below(run.elbow, tolerances.lean(width), "elbow error / reach")
    run.below(run.hand, tolerances.lean(width), "hand error / reach of the clamped pose")


@every_width
def test_agrees_with_the_paper_datapath(width):
    """The same flags for any words; the same hand on random targets, within what rounding explains of the paper's."""
    words = mixed(3000, width, seed=8)
    assert (fixed.run(words, width, "lean").flags == fixed.run(words, width).flags).all()
    words = random_reachable(400, width, seed=8)
    asked = from_words(words, 0, width, "random")
    wrists = []
    for datapath in ("paper", "lean"):
        values = result_values(fixed.run(words, width, datapath).results, width)
        wrists.append(forward(values[:, :4], values[:, 4:], asked.d1, asked.d2)[1])
    apart = np.linalg.norm(wrists[0] - wrists[1], axis=1) / asked.reach
    bar = predict.hand_bar(words, width) + tolerances.lean(width)
    n = int(np.argmax(apart / bar))
    assert apart[n] <= bar[n], f"hands {apart[n]:.3g} > {bar[n]:.3g} of the reach apart at {words[n].tolist()}"
    assert np.median(apart) < np.median(bar)


@every_width
def test_scale_does_not_matter(width):
    """Half of all lengths is the same target, with the same bits, as long as they are even."""
    words = np.concatenate([region(name, 200, width, 9) for name in REGIONS])
    lengths = [0, 1, 2, 4, 5]
    words[:, lengths] &= ~3
    words = words[(words[:, 4:] > 0).all(axis=1)]
    quarter = words.copy()
    quarter[:, lengths] >>= 2
    big, little = fixed.run(words, width, "lean"), fixed.run(quarter, width, "lean")
    assert (big.flags == little.flags).all()
    assert (big.results == little.results).all()


def test_many_targets():
    """The same answers as in small portions."""
    words = mixed(50_000, 32, seed=10)
    whole = fixed.run(words, 32, "lean")
    part = fixed.run(words[4321:4331], 32, "lean")
    assert (whole.results[4321:4331] == part.results).all()
    assert len(whole.bits.nodes) > 100


# -- hypothesis


def words_of(draw, width: int) -> tuple[int, ...]:
    """Any six words, the ends of the format, 0 and +-1 among them, of all sizes."""
    low, top = -(1 << (width - 1)), (1 << (width - 1)) - 1
    word = st.one_of(
        st.sampled_from([low, low + 1, -1, 0, 1, top - 1, top]),
        st.integers(low, top),
        st.integers(1, width - 1).flatmap(lambda bits: st.integers(-(1 << bits), (1 << bits) - 1)),
    )
    return draw(st.tuples(*[word] * len(FIELDS)))


@st.composite
def any_input(draw):
    width = draw(st.integers(WIDTHS[0], WIDTHS[-1]))
    return width, words_of(draw, width)


@settings(max_examples=250, deadline=None)
@given(any_input())
def test_any_input_gives_a_unit_quaternion(case):
    width, words = case
    run = Run(np.array([words]), width)
    run.check(width)
    event(f"flags {int(run.answer.flags[0]):05b}")


CORNER_WORDS = {w: (-(1 << (w - 1)), (1 << (w - 1)) - 1, 0, 1, -1) for w in WIDTHS}


@pytest.mark.parametrize("width", (16, 17, 31, 32))
def test_all_words_at_the_ends_of_the_format(width):
    """Lowest, highest, 0, 1 and -1 in every place: 5^6 inputs."""
    words = np.array(np.meshgrid(*[CORNER_WORDS[width]] * len(FIELDS))).reshape(len(FIELDS), -1).T
    run = Run(words, width)
    run.check(width)


@st.composite
def reachable(draw, width):
    """A target in reach by its own numbers: arms up to 1:20, direction, distance, swivel, and a few lsb on top."""
    top = (1 << (width - 1)) - 1
    d2 = draw(st.one_of(st.integers(1, top), st.integers(top // 2, top)))
    d1 = min(top, max(1, round(d2 * 2.0 ** draw(st.floats(-4.3, 4.3)))))
    least, most = abs(d1 - d2), d1 + d2
    size = draw(st.one_of(st.floats(0, 1), st.floats(0, 1e-6), st.floats(1 - 1e-6, 1)))
    distance = least + (most - least) * size
    angle = st.one_of(st.floats(-np.pi, np.pi), st.integers(-4, 4).map(lambda k: k * np.pi / 4))
    azimuth, elevation = draw(angle), draw(angle)
    unit = (np.cos(azimuth) * np.cos(elevation), np.sin(azimuth) * np.cos(elevation), np.sin(elevation))
    few = st.integers(-(1 << (width // 2)), 1 << (width // 2))
    position = [round(distance * u) + draw(few) for u in unit]
    phi = draw(st.one_of(st.integers(-top - 1, top), st.integers(-2000, 2000)))
    return (*(min(top, max(-top - 1, p)) for p in position), phi, d1, d2)


def search(width: int):
    @settings(max_examples=250, deadline=None)
    @given(reachable(width))
    @example(WORST[width])
    def hunt(words):
        run = Run(np.array([words]), width)
        if run.answer.flags[0] & UNREACHABLE:
            return
        target(float(run.hand[0]) * 2.0**width, label="hand error in parts of 2^-W")
        run.below(run.hand, tolerances.sought(width), "hand error / reach")
        run.below(run.shoulder_angle, ANGLE_ULPS[width] * ulp(width), "shoulder angle error (rad)")
        run.below(run.elbow_angle, ANGLE_ULPS[width] * ulp(width), "elbow angle error (rad)")

    return hunt


test_no_search_finds_a_bad_hand_for_32_bits = search(32)
test_no_search_finds_a_bad_hand_for_24_bits = search(24)
test_no_search_finds_a_bad_hand_for_18_bits = search(18)
