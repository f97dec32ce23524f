# SPDX-License-Identifier: Apache-2.0
"""The hardest targets found so far (tb/core/hardest.csv) in the bit-true model, and the upkeep of the list.

test_every_node.py runs them in the RTL.
"""

import numpy as np
import pytest

from model.bounds import tolerances
from model.dataflow import fixed
from model.dataflow.datapaths import DATAPATHS
from model.io.flags import UNREACHABLE, expected_flags
from model.io.stimuli import REGIONS, region, unreachable
from tb.core import hardest

ROWS = hardest.read(hardest.LIST)
GROUPS = hardest.groups(ROWS)


def test_there_is_something_of_every_datapath():
    assert {datapath for datapath, _ in GROUPS} == set(DATAPATHS)
    assert ("lean", 32) in GROUPS and ("lean", 18) in GROUPS


def test_the_list_is_sorted_and_bounded():
    """The list is as `python -m scripts.soak --keep` writes it: no manual edits, duplicates or unreachable targets."""
    order = [(row.datapath, row.width, -row.hand_error, row.words) for row in ROWS]
    assert order == sorted(order)
    assert len({(row.datapath, row.width, row.words) for row in ROWS}) == len(ROWS)
    assert hardest.text(ROWS) == hardest.LIST.read_text(encoding="utf-8")
    for key, rows in GROUPS.items():
        assert len(rows) <= 2 * hardest.KEPT, key
        assert not (expected_flags(hardest.array(rows), key[1]) & UNREACHABLE).any(), key


@pytest.mark.parametrize(("datapath", "width"), GROUPS)
def test_errors_in_the_model(datapath, width):
    """Recorded errors equal the model's, norms are within tolerance, and the lean datapath meets its hand tolerance.

    For the paper's equations the prediction is no bound where two singular poses meet, as they do for these targets.
    """
    rows = GROUPS[datapath, width]
    words = hardest.array(rows)
    answer = fixed.run(words, width, datapath)
    hand, norm = hardest.errors(words, answer.results, width)
    np.testing.assert_allclose(
        hand,
        [row.hand_error for row in rows],
        rtol=1e-4,
        err_msg="other errors than recorded; `python -m scripts.soak --targets 1 --keep` regenerates them",
    )
    assert (norm <= tolerances.norm(width, datapath)).all(), f"norm error {norm.max():.3g}"
    assert (answer.flags == expected_flags(words, width)).all(), "flags"
    if datapath == "lean":
        worst = int(np.argmax(hand))
        assert hand[worst] <= tolerances.lean(width), f"hand error {hand[worst]:.3g}: {rows[worst]}"


# -- maintenance of the list -----------------------------------------------------------------------------------------


def of_all_kinds(width: int) -> np.ndarray:
    return np.concatenate([*(region(name, 20, width, 1) for name in REGIONS), unreachable(60, width, 1)])


def rows_of(words, width=32, datapath="lean", found="here"):
    return [hardest.Row(datapath, width, tuple(row), 0.5, found) for row in words.tolist()]


def test_merge_keeps_the_hardest_in_any_order():
    words = of_all_kinds(32)
    words = np.unique(words[expected_flags(words, 32) & UNREACHABLE == 0], axis=0)
    hand, norm = hardest.errors(words, fixed.run(words, 32, "lean").results, 32)
    kept = hardest.merge(rows_of(words))
    assert hardest.merge(rows_of(words)[::-1]) == kept and len(kept) == 20
    assert hardest.merge(kept) == kept
    error_of = dict(zip(map(tuple, words.tolist()), hand, strict=True))
    norm_of = dict(zip(map(tuple, words.tolist()), norm, strict=True))
    assert [row.hand_error for row in kept] == [error_of[row.words] for row in kept], "errors are computed anew"
    by_hand = sorted(hand, reverse=True)[:10]
    assert [row.hand_error for row in kept][:10] == by_hand
    others = {row.words for row in kept if error_of[row.words] < by_hand[-1]}
    least = min(norm_of[w] for w in others)
    assert all(n <= least or w in {row.words for row in kept} for w, n in norm_of.items())


def test_merge_keeps_groups_apart_and_nothing_twice_or_out_of_reach():
    words = of_all_kinds(18)
    twice = rows_of(words, 18, found="b") + rows_of(words, 18, found="a")
    kept = hardest.merge([*rows_of(words[:40], 20), *twice])
    assert kept == hardest.merge([*twice[::-1], *rows_of(words[:40], 20)])
    assert {(row.width, row.found) for row in kept} == {(20, "here"), (18, "a")}
    assert [row.width for row in kept] == sorted(row.width for row in kept)
    assert len({(row.width, row.words) for row in kept}) == len(kept)
    assert not any(expected_flags(np.array([row.words]), row.width)[0] & UNREACHABLE for row in kept)


def test_the_list_reads_as_it_was_written(tmp_path):
    rows = [hardest.Row("lean", 18, (1, -2, 3, 4, 5, 6), 1.5e-8, "a, b"), hardest.Row("paper", 32, (0,) * 6, None, "c")]
    path = tmp_path / "list.csv"
    path.write_text(hardest.text(rows), encoding="utf-8")
    assert hardest.read(path) == rows
