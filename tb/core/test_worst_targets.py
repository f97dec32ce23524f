# SPDX-License-Identifier: Apache-2.0
"""Tests of the soak's target chunks, and of the list of the hardest targets in the bit-true model.

test_every_node.py runs the list, tb/core/worst_targets.csv, in the RTL.
"""

import numpy as np
import pytest

from model.bounds import tolerances
from model.dataflow import fixed
from model.dataflow.datapaths import MODELS
from model.io.flags import UNREACHABLE, expected_flags
from model.io.stimuli import REGIONS, SPECIAL, corners, hand_poses, of_special, region, special, unreachable
from model.io.words import from_words
from model.reference.equations import solve_clamped
from tb.core import worst_targets
from tb.core.worst_targets import chunk
from tb.sim import job

ROWS = worst_targets.read(worst_targets.LIST)
GROUPS = worst_targets.groups(ROWS)


def test_special_words_are_all_that_there_are(width=16):
    """Check that chunks without a seed contain each of the 12^6 targets made of special words exactly once."""
    words = np.concatenate([chunk(n, width, None) for n in range(-(-SPECIAL // 20000))])
    numbers = np.searchsorted(sorted(special(width)), words)
    assert (np.sort(special(width))[numbers] == words).all() and len(set(special(width))) == 12
    assert (np.sort(numbers @ 12 ** np.arange(6)) == np.arange(12**6)).all() and len(of_special(SPECIAL, 5, width)) == 0
    least, one = -(1 << width - 1), 1 << width - 2
    assert {least, -one, -1, 0, 1, one - 1, one, one + 1, -1 - least} < set(special(width))


def test_a_chunk_has_all_kinds():
    """Check that the first tenth of a chunk, as in a short soak, has clamped targets, unequal lengths and every decade
    of distance to the singular poses, and that the whole chunk has every corner."""
    whole = chunk(0, 32, 1)
    assert set(corners(32).values()) <= set(map(tuple, whole.tolist()))
    words = whole[:2000]
    flags = expected_flags(words, 32)
    for bit in (1, 2, 4, 8, 16):
        assert (flags & bit).astype(bool).sum() >= 10, bit
    reach = flags & UNREACHABLE == 0
    assert 0.7 < reach.mean() < 0.9
    at = from_words(words[reach], 0, 32, "chunk")
    off_axis = np.arctan2(np.hypot(at.x, at.y), np.abs(at.z))
    distance = np.sqrt(at.x**2 + at.y**2 + at.z**2)
    pose = solve_clamped(at.x, at.y, at.z, at.phi, at.d1, at.d2)
    near = {  # distance from the pose, number of decades
        "z axis": (off_axis, 7),
        "full stretch": (1 - distance / at.reach, 8),
        "full fold": ((distance - np.abs(at.d1 - at.d2)) / at.reach, 8),
        "shoulder": (distance / at.reach, 7),
        "arms": (np.minimum(at.d1, at.d2) / np.maximum(at.d1, at.d2), 1),
        "elbow on the z axis": (np.arctan2(np.hypot(pose["p_e_x"], pose["p_e_y"]), np.abs(pose["p_e_z"])), 7),
    }
    for name, (value, decades) in near.items():
        for decade in range(1, decades + 1):
            assert (value < 10.0**-decade).sum() >= 5, f"{name}: none below 1e-{decade}"


def test_the_list_is_sorted_and_bounded():
    """Check that the list is as `python -m scripts.soak --keep` writes it, without manual edits and duplicates."""
    order = [(row.datapath, row.width, -row.hand_error, row.words) for row in ROWS]
    assert order == sorted(order)
    assert len({(row.datapath, row.width, row.words) for row in ROWS}) == len(ROWS)
    assert worst_targets.text(ROWS) == worst_targets.LIST.read_text(encoding="utf-8")
    assert max(map(len, GROUPS.values())) <= 2 * worst_targets.KEPT


@pytest.mark.parametrize(("datapath", "width"), GROUPS)
def test_errors_in_the_model(datapath, width):
    """Check that the model reproduces the recorded errors, and that norms and hand errors are in tolerance.

    Paper's hand errors are exempt: its targets are near two singular poses, where the predicted error is no bound.
    """
    rows = GROUPS[datapath, width]
    words = worst_targets.array(rows)
    answer = job.answer(words, width, datapath)
    hand, norm = worst_targets.errors(words, answer.results, width, answer.flags)
    recorded = [row.hand_error for row in rows]
    message = "other errors than recorded; `python -m scripts.soak --targets 1 --keep` regenerates them"
    np.testing.assert_allclose(hand, recorded, rtol=1e-4, atol=1e-15, err_msg=message)  # atol: roundoff of `forward`
    assert (norm <= tolerances.norm(width, datapath)).all(), f"norm error {norm.max():.3g}"
    if not MODELS[datapath].side:
        assert (answer.flags == expected_flags(words, width)).all(), "flags"
    if (most := tolerances.hand(width, datapath)) is not None:
        worst = int(np.argmax(hand))
        assert hand[worst] <= most, f"hand error {hand[worst]:.3g}: {rows[worst]}"


def rows_of(words, width, source):
    return [worst_targets.Row("lean", width, tuple(row), 0.5, source) for row in words.tolist()]


def test_merge_keeps_the_hardest_reachable_targets_of_each_group_once_in_any_order():
    words, short = (
        np.concatenate([*(region(name, 20, width, 1) for name in REGIONS), unreachable(60, width, 1)])
        for width in (32, 18)
    )
    rows = rows_of(words, 32, "here") + rows_of(short, 18, "b") + rows_of(short, 18, "a")
    kept = worst_targets.merge(rows)
    assert worst_targets.merge(rows[::-1]) == worst_targets.merge(kept) == kept
    assert [(row.width, row.found) for row in kept] == [(18, "a")] * 20 + [(32, "here")] * 20
    assert len({(row.width, row.words) for row in kept}) == len(kept)
    few = worst_targets.array(worst_targets.merge(rows_of(unreachable(60, 18, 1), 18, "a")))
    assert not (expected_flags(few, 18) & UNREACHABLE).any()
    hand, norm = worst_targets.errors(words, fixed.run(words, 32, "lean").results, 32)
    errors = {tuple(row): (h, n) for row, h, n in zip(words.tolist(), hand, norm, strict=True) if not np.isnan(h)}
    assert [row.hand_error for row in kept[20:]] == [errors[row.words][0] for row in kept[20:]], "errors are recomputed"
    by_hand = sorted((h for h, _ in errors.values()), reverse=True)[:10]
    assert [row.hand_error for row in kept[20:30]] == by_hand
    least = min(errors[row.words][1] for row in kept[30:])
    assert {row for row, (_, n) in errors.items() if n > least} <= {row.words for row in kept}


def test_tiny_arms_do_not_displace_searched_poses(width=32):
    """Merge tiny arms, whose errors are large compared with the reach or near the tolerance, with searched poses."""
    searched = [row for row in GROUPS["arm", width] if row.found == "search"]
    poses = hand_poses(region("short lengths", 1000, width, 1), width, 1)
    tiny = [worst_targets.Row("arm", width, (*pose, 0), 0.0, "soak") for pose in poses.tolist()]
    kept = worst_targets.merge(searched + tiny)
    assert max(row.hand_error for row in kept if row.found == "soak") > min(row.hand_error for row in searched)
    stay = {row.words for row in searched} & {row.words for row in kept}
    assert len(stay) >= min(len(searched), worst_targets.KEPT)
