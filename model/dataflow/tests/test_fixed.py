# SPDX-License-Identifier: Apache-2.0
"""The bit-true model against double precision, and on every input word that there is."""

import numpy as np
import pytest

from model.bounds import predict
from model.bounds.tolerances import PAPER_NORM
from model.dataflow import fixed
from model.dataflow.nodes import GUARD, Format
from model.io.flags import BAD_LENGTH, SATURATED, TOO_FAR, TOO_NEAR, UNREACHABLE, expected_flags
from model.io.stimuli import corners, mixed, random_reachable, unreachable
from model.io.words import RESULT_FIELDS, from_words, result_values
from model.reference import equations
from model.reference.kinematics import angle_between, forward

WIDTHS = (16, 18, 24, 27, 32)


def any_words(count: int, width: int, seed: int) -> np.ndarray:
    """Input words of all sizes and signs, the ends of the format among them; most have arms with a length."""
    random = np.random.default_rng((seed, width))
    top = 1 << (width - 1)
    words = random.integers(-top, top, (count, 6))
    words = np.where(random.random((count, 6)) < 0.6, words >> random.integers(0, width, (count, 6)), words)
    ends = np.array([-top, top - 1, 0, 1, -1, top // 2, -top // 2])
    words = np.where(random.random((count, 6)) < 0.15, random.choice(ends, (count, 6)), words)
    lengths = np.clip(np.abs(words[:, 4:]), 1, top - 1)
    words[:, 4:] = np.where(random.random((count, 2)) < 0.8, lengths, words[:, 4:])
    return words


def awkward_words(count: int, width: int, seed: int) -> np.ndarray:
    """Where rounding has been seen to matter: long arms with the target a few lsb from the shoulder, and arms that are
    all upper arm with the target above or below."""
    random = np.random.default_rng((seed, width))
    top, low = (1 << (width - 1)) - 1, -(1 << (width - 1))
    phi = random.integers(low, top, count)
    long = random.integers(1 << (width - 2), top - 8, count)
    near = random.integers(-8, 9, (count, 3))
    shoulder = [*near.T, phi, long, long - random.integers(-8, 9, count)]
    upper, fore = top - random.integers(0, 50, count), random.integers(1, 50, count)
    height = np.clip((upper + random.integers(-60, 60, count)) * random.choice([-1, 1], count), low, top)
    upright = [*random.integers(-9, 10, (2, count)), height, phi, upper, fore]
    return np.concatenate([np.column_stack(shoulder), np.column_stack(upright)])


@pytest.mark.parametrize("width", WIDTHS)
def test_every_input_has_a_unit_answer_and_exact_flags(width):
    words = np.concatenate(
        [any_words(20000, width, 1), awkward_words(20000, width, 1), np.array(list(corners(width).values()))]
    )
    answer = fixed.run(words, width)
    values = result_values(answer.results, width)
    for name, q in (("Qs", values[:, :4]), ("Qe", values[:, 4:])):
        off = np.abs((q**2).sum(axis=1) - 1) * 2.0 ** (width - 2)
        n = int(off.argmax())
        assert off[n] <= PAPER_NORM, f"{name} of {words[n].tolist()} is {off[n]:.1f} ulps off unit length"
    assert (values[:, 3] >= 0).all(), "the k part of Qs is negative"
    wrong = np.flatnonzero(answer.flags != expected_flags(words, width))
    assert not len(wrong), f"flags of {words[wrong[:1]].tolist()}: {answer.flags[wrong[:1]]}"
    seen = np.bitwise_or.reduce(answer.flags)
    assert seen & (TOO_FAR | TOO_NEAR | BAD_LENGTH) == UNREACHABLE and not seen & SATURATED


@pytest.mark.parametrize("width", WIDTHS)
def test_every_node_fits_its_format(width):
    words = np.concatenate(
        [any_words(20000, width, 2), awkward_words(20000, width, 2), np.array(list(corners(width).values()))]
    )
    bits = fixed.run(words, width).bits
    for name, node in bits.nodes.items():
        assert (node.value >= node.format.low).all() and (node.value <= node.format.high).all(), name
    # t_e and what is divided from it have no meaning for a clamped arm; the cosine of the elbow is limited.
    overflows = {name: int(mask.sum()) for name, mask in bits.overflow.items() if mask.any()}
    assert set(overflows) <= {"t_e", "c4_quo"}, overflows
    assert not (bits.overflow["t_e"] & ~bits.nodes["clamp"].value).any()


def test_words_are_at_most_32_bits():
    """Excepted: products before their rounding, sums of such products, and the exact squares of the guard."""
    bits = fixed.run(random_reachable(1, 32, 1), 32).bits
    for name, node in bits.nodes.items():
        if node.format.width > 32 and node.section != "guard":
            assert node.op in ("mul", "sum"), f"{name}, a {node.op}, has {node.format.width} bits"
            assert node.format.width == 32 + GUARD, f"{name} has {node.format.width} bits"
            if node.op == "sum":
                assert {o.format.width for o in node.operands} == {32 + GUARD}, f"{name} adds words that were rounded"


@pytest.mark.parametrize(
    "width", [w if w in (18, 32) else pytest.param(w, marks=[pytest.mark.slow, pytest.mark.cost(5)]) for w in WIDTHS]
)
def test_hand_error_stays_below_its_prediction(width):
    words = random_reachable(4000, width, 3)
    answer = fixed.run(words, width)
    q = result_values(answer.results, width)
    length = 2.0 ** (2 - width)
    d1, d2 = words[:, 4] * length, words[:, 5] * length
    error = np.linalg.norm(forward(q[:, :4], q[:, 4:], d1, d2)[1] - words[:, :3] * length, axis=1) / (d1 + d2)
    ratio = error / predict.hand_bar(words, width)
    n = int(ratio.argmax())
    assert ratio[n] <= 1, f"hand error {error[n]:.3g} of {words[n].tolist()} is {ratio[n]:.2f} times the prediction"
    # A prediction that is far too wide would say nothing.
    assert np.median(ratio) > 0.05, f"the median error is {np.median(ratio):.3g} of its prediction"


def test_prediction_grows_with_the_rounding():
    coarse = random_reachable(400, 24, 4)
    ratio = predict.hand_bar(coarse, 24) / predict.hand_bar(coarse << 8, 32)
    middle = np.median(ratio)
    assert 200 < middle < 300, f"8 bits fewer cost a factor of 256 where nothing is singular, not {middle:.0f}"


def test_angles_agree_with_double_precision():
    """Away from the singular poses: one place lost in the middle, three at the edge of the domain."""
    words = random_reachable(20000, 32, 5)
    asked = from_words(words, 0, 32, "random")
    pose = equations.solve_clamped(asked.x, asked.y, asked.z, asked.phi, asked.d1, asked.d2)
    q = result_values(fixed.run(words, 32).results, 32)
    double = np.column_stack([pose[k] for k in RESULT_FIELDS])
    shoulder = angle_between(q[:, :4], double[:, :4])
    assert np.median(shoulder) < 2e-8, f"median shoulder angle error {np.median(shoulder):.3g} rad"
    assert np.quantile(shoulder, 0.99) < 2e-6, f"99 % of shoulder angle errors {np.quantile(shoulder, 0.99):.3g} rad"


@pytest.mark.parametrize("width", (18, 32))
def test_clamped_arms_are_straight_or_folded_along_the_target(width):
    words = unreachable(3000, width, 6)
    answer = fixed.run(words, width)
    asked = from_words(words, 0, width, "unreachable")
    pose = equations.solve_clamped(asked.x, asked.y, asked.z, asked.phi, asked.d1, asked.d2)
    q = result_values(answer.results, width)
    one = 1 << (width - 2)
    assert set(map(tuple, answer.results[:, 4:].tolist())) == {(0, -one), (one, 0)}, "Qe is -i or 1 exactly"
    for k, name in ((4, "qe_w"), (5, "qe_i")):
        assert np.allclose(q[:, k], pose[name], atol=1e-12), name
    shoulder = angle_between(q[:, :4], np.column_stack([pose[k] for k in RESULT_FIELDS[:4]]))
    assert np.quantile(shoulder, 0.99) < 2.0 ** (9 - width), f"{np.quantile(shoulder, 0.99):.3g} rad"


def test_scale_does_not_matter():
    """Powers of two on all lengths change nothing, down to the last bit."""
    words = random_reachable(500, 32, 7) >> 6 << 6
    words = words[(words[:, 4] > 0) & (words[:, 5] > 0)]
    words = words[expected_flags(words, 32) == 0]
    small = words.copy()
    small[:, [0, 1, 2, 4, 5]] >>= 6
    big, little = fixed.run(words, 32), fixed.run(small, 32)
    large = words[:, 4] + words[:, 5] >= 1 << 31  # the one case in which a bit of the arms is dropped
    assert (~large).sum() > 100
    assert (big.results == little.results)[~large].all()


def test_many_targets():
    """1e5 targets, every node: a matter of seconds, and the same answers as in small portions."""
    words = mixed(100_000, 32, seed=8)
    whole = fixed.run(words, 32)
    part = fixed.run(words[54_321:54_331], 32)
    assert (whole.results[54_321:54_331] == part.results).all()
    assert len(whole.bits.nodes) > 200


def test_a_width_that_is_not_built_is_refused():
    with pytest.raises(ValueError, match="width 33"):
        fixed.run(np.zeros((1, 6), dtype=np.int64), 33)


def test_formats_know_their_ends():
    assert (Format(4, 1, "").low, Format(4, 1, "").high) == (-8, 7)
    assert (Format(4, 1, "", signed=False).low, Format(4, 1, "", signed=False).high) == (0, 15)
