# SPDX-License-Identifier: Apache-2.0
"""The hardest targets that were ever found (tb/core/hardest.csv), through the bit-true model and through the RTL."""

import numpy as np
import pytest

from model.bounds import tolerances
from model.dataflow import fixed
from model.dataflow.datapaths import DATAPATHS
from model.targets.flags import UNREACHABLE, expected_flags
from tb.core import hardest
from tb.sim.env import simulator
from tb.sim.simulate import Job, simulate

ROWS = hardest.read(hardest.LIST)
GROUPS = hardest.groups(ROWS)

IN_RTL = [(datapath, width) for datapath in DATAPATHS for width in (32, 18)]
if simulator() == "icarus":  # a build costs nothing
    IN_RTL += [("lean", width) for width in (16, 24, 27)]
QUICK = [("lean", 32), ("paper", 32)] if simulator() == "icarus" else [("lean", 32)]


def test_there_is_something_of_every_datapath():
    assert {datapath for datapath, _ in GROUPS} == set(DATAPATHS)
    assert ("lean", 32) in GROUPS and ("lean", 18) in GROUPS


def test_the_list_is_sorted_and_bounded():
    """As `python -m scripts.soak --keep` writes it: nothing edited by hand, nothing twice, nothing out of reach."""
    order = [(row.datapath, row.width, -row.hand_error, row.words) for row in ROWS]
    assert order == sorted(order)
    assert len({(row.datapath, row.width, row.words) for row in ROWS}) == len(ROWS)
    assert hardest.text(ROWS) == hardest.LIST.read_text(encoding="utf-8")
    for key, rows in GROUPS.items():
        assert len(rows) <= 2 * hardest.KEPT, key
        assert not (expected_flags(hardest.array(rows), key[1]) & UNREACHABLE).any(), key


@pytest.mark.parametrize(("datapath", "width"), GROUPS)
def test_errors_in_the_model(datapath, width):
    """The recorded error is the model's; unit norm; and the lean datapath keeps its tolerance in any pose.

    Of the paper's equations the prediction is no bound where two singular poses meet, and these are such targets.
    """
    rows = GROUPS[datapath, width]
    words = hardest.array(rows)
    answer = fixed.run(words, width, datapath)
    hand, norm = hardest.errors(words, answer.results, width)
    np.testing.assert_allclose(
        hand, [row.hand_error for row in rows], rtol=1e-4,
        err_msg="other errors than recorded; `python -m scripts.soak --targets 1 --keep` regenerates them",
    )  # fmt: skip
    assert (norm <= tolerances.norm(width)).all(), f"norm error {norm.max():.3g}"
    assert (answer.flags == expected_flags(words, width)).all(), "flags"
    if datapath == "lean":
        worst = int(np.argmax(hand))
        assert hand[worst] <= tolerances.lean(width), f"hand error {hand[worst]:.3g}: {rows[worst]}"


@pytest.mark.sim
@pytest.mark.parametrize(
    ("datapath", "width"),
    [key if key in QUICK else pytest.param(*key, marks=pytest.mark.slow) for key in IN_RTL],
)
def test_the_rtl_equals_the_model(datapath, width):
    """Every node, natively under Verilator.  A length without rows of its own gets the longest's words, cut to it."""
    words = _words(datapath, width)
    native = simulator() == "verilator"
    (run,) = simulate([Job("hardest", words)], simulator=simulator(), datapath=datapath, width=width, native=native)
    assert run.bit_mismatches == 0, run.first_mismatch
    answer = fixed.run(words, width, datapath)
    assert (run.results == answer.results).all() and (run.flags == answer.flags).all()


def _words(datapath: str, width: int) -> np.ndarray:
    if (datapath, width) in GROUPS:
        return hardest.array(GROUPS[datapath, width])
    longest = max(w for d, w in GROUPS if d == datapath)
    return hardest.array(GROUPS[datapath, longest]) >> max(0, longest - width)
