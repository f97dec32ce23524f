# SPDX-License-Identifier: Apache-2.0
"""The search for word lengths: its page, its prediction, its model of area, and the RTL with the words found."""

import json

import numpy as np
import pytest

from model.dataflow import fixed
from model.dataflow.shortened import ROUNDINGS, Shortened
from model.targets.stimuli import mixed
from scripts.fpga import area, search
from scripts.fpga.shorten import shortened_rtl
from tb.sim.env import simulator
from tb.sim.simulate import Job, simulate

DATA = json.loads(search.FIGURES.read_text())
CUTS = search.cuts_of(DATA["steps"])


@pytest.fixture(scope="module")
def prediction():
    return search.Prediction(search.regular_words())


def test_page_is_that_of_the_figures():
    assert search.PAGE.read_text() == search.page(DATA), "run `python -m scripts.fpga.search --page`"
    assert search.FIGURES.read_text() == search.written(DATA)


def test_verdict_follows_the_figures():
    assert "there is none" in search.verdict(0.15)
    assert "there is none" not in search.verdict(0.16)


# -- the search ------------------------------------------------------------------------------------------------------


def test_search_starts_as_the_figures_say(prediction):
    first = search.search(prediction, most=4)
    assert [step[:2] for step in first] == [tuple(step[:2]) for step in DATA["steps"][:4]]


def test_search_stops_at_the_limit(prediction):
    """With hardly more than the whole words' error allowed, it goes on to the limit and not beyond."""
    limit = 1.00001 * prediction.errors(prediction.start).max()
    steps = search.search(prediction, limit, most=12)
    assert steps and all(error <= limit for *_, error in steps)
    assert search.search(prediction, 0.9 * limit) == []


@pytest.mark.slow
def test_first_order_agrees_with_the_prediction_in_full(prediction):
    words = search.regular_words()
    for cuts in ({}, CUTS):
        pushed = sum(prediction.pushed(name, cuts.get(name, 0)) for name in prediction.whole)
        linear = prediction.errors(pushed).max(axis=1)
        assert linear == pytest.approx(search.predicted(words, cuts), rel=0.02)


@pytest.mark.slow
def test_steps_are_taken_back_until_the_prediction_in_full_allows_them():
    words = search.regular_words()[::40]
    steps = [("s", 1, 0.0, 0.0), ("tmp1", 6, 0.0, 0.0)]
    limit = 1.5 * max(search.predicted(words, {}))
    assert search.kept(words, steps, limit) == steps[:1]


@pytest.mark.slow
def test_outcome_is_what_the_model_says(prediction):
    """Predicted within the limit, seen below what is predicted, no flag changed, no word out of its format."""
    words = search.regular_words()
    assert search.predicted(words, CUTS) == pytest.approx(DATA["predicted"]["shortened"])
    assert max(DATA["predicted"]["shortened"]) <= search.LIMIT < max(DATA["predicted"]["uniform"]) * 2
    errors = search.hand_errors(fixed.answer(words, Shortened(search.WIDTH, CUTS)), words)
    assert errors.max() <= DATA["predicted"]["shortened"][1]
    assert search.observed(CUTS) == DATA["outcome"]
    assert DATA["outcome"]["flags"] == 0 and DATA["outcome"]["beyond"] == []
    for name, cuts in (("whole", {}), ("shortened", CUTS)):
        assert search.size(prediction.nodes, cuts) == DATA["sizes"][name]


def test_nodes_that_decide_a_sign_stay_whole(prediction):
    assert not {"sg_r", "sg_y", "sg_z", "sg", "sg_g", "sign"} & set(prediction.groups)
    assert {"pp_1_m", "c3", "q3_abs", "s"} <= set(prediction.groups)


# -- the model of area -----------------------------------------------------------------------------------------------


def test_what_a_cut_wins_is_found_at_its_readers(prediction):
    nodes = prediction.nodes
    whole = area.luts(nodes, {})
    for group in ("l_sw", "e_x_quo", "c4_quo", "e_x_pp", "pp_1_m", "sin_h"):
        cuts = {name: 3 for name in (group, *search.TOGETHER.get(group, ()))}
        changed = {name for name, luts in area.luts(nodes, cuts).items() if luts != whole[name]}
        assert changed and changed <= set(area.readers(nodes, cuts)), group
    assert "qe_w" in area.readers(nodes, ["c4_quo"])


def test_products_leave_their_tiles_with_both_words_short(prediction):
    nodes = prediction.nodes
    assert area.multipliers(nodes, {}) == area.multipliers(nodes, {"sin_phi": 14})
    assert area.multipliers(nodes, {}) - area.multipliers(nodes, {"sin_phi": 14, "a_x": 14}) == 3
    assert area.multipliers(nodes, {}) - area.multipliers(nodes, {"pp_i": 14}) == 2  # a square


def test_model_of_area_is_near_to_what_was_counted():
    counted = DATA["synthesized"]["alone"]
    assert [row[:3] for row in counted] == [list(row) for row in search.ALONE]
    for module, values, model, seen in counted:
        assert model == pytest.approx(seen, rel=0.1), (module, values)


# -- the RTL with shorter words --------------------------------------------------------------------------------------


@pytest.mark.sim
@pytest.mark.slow
@pytest.mark.cost(60)
def test_rtl_equals_the_model_of_the_same_words(prediction, tmp_path):
    """Results and flags of targets of every kind, with dividers and roots of rows; whole words give other results."""
    words = mixed(30, search.WIDTH, 3)
    root = shortened_rtl(tmp_path, prediction.nodes, CUTS)
    (run,) = simulate(
        [Job("shortened", words)], simulator=simulator(), datapath="paper", width=search.WIDTH, root=root,
        name="shortened", cores="digit",
    )  # fmt: skip
    answer = fixed.answer(words, Shortened(search.WIDTH, CUTS))
    assert (run.results == answer.results).all() and (run.flags == answer.flags).all()
    assert (run.results != fixed.run(words, search.WIDTH).results).any()


def test_a_node_without_an_instance_is_named(prediction, tmp_path):
    with pytest.raises(LookupError, match="no instances of d_e$"):
        shortened_rtl(tmp_path, prediction.nodes, {"s": 2, "d_e": 1, "p_w_x": 1})


# -- the model of shorter words --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("node", "cut"),
    [("s_x", 3), ("s", 2), ("l_sw", 5), ("pi_swivel_x", 4), ("p_w_x", 2), ("sin_h", 3), ("p_e_x", 2), ("pp_sq", 3)],
)
def test_a_shorter_word_is_near_to_the_whole_one_and_ends_in_zeros(node, cut):
    words = search.regular_words()[::10]
    whole = fixed.run(words, search.WIDTH).bits.nodes[node]
    cuts = {name: cut for name in (node, *search.TOGETHER.get(node, ()))} | ({"cos_h": cut} if node == "sin_h" else {})
    short = fixed.answer(words, Shortened(search.WIDTH, cuts)).bits.nodes[node]
    low, high = ROUNDINGS.get(whole.op, whole.error)
    assert short.error == (low * 2**cut, high * 2**cut)
    assert (short.value % 2**cut == 0).all() and (short.value != whole.value).any()
    off = short.value - whole.value
    assert off.min() >= low * 2**cut - max(map(abs, whole.error)) - 1 and off.max() <= high * 2**cut + 2


def test_nothing_is_cut_unless_said():
    words = mixed(500, search.WIDTH, 1)
    whole, same = fixed.run(words, search.WIDTH), fixed.answer(words, Shortened(search.WIDTH, {}))
    for name, node in whole.bits.nodes.items():
        assert np.array_equal(node.value, same.bits.nodes[name].value) and node.error == same.bits.nodes[name].error
