# SPDX-License-Identifier: Apache-2.0
"""The search for word lengths: its page, its prediction, its model of area; and what it found, in the core."""

import json
import re

import numpy as np
import pytest

from model.bounds import ranges
from model.dataflow import fixed, short
from model.io.stimuli import mixed
from scripts.fpga import area, search
from tb.sim.env import ROOT

DATA = json.loads(search.FIGURES.read_text())


@pytest.fixture(scope="module")
def prediction():
    return search.Prediction(search.regular_words())


def test_page_is_that_of_the_figures():
    assert search.PAGE.read_text() == search.page(DATA), "run `python -m scripts.fpga.search --page`"
    assert search.FIGURES.read_text() == search.written(DATA)


def test_sums_that_saturate_are_those_of_the_rtl():
    text = "".join(path.read_text() for path in (ROOT / "rtl" / "paper").glob("*.v"))
    sums = re.findall(r"ik_sum[23] #\((.*)\) u_(\w+) \(", text)
    assert {name for values, name in sums if ".SAT(0)" not in values} == set(area.SATURATING)


# -- the search ------------------------------------------------------------------------------------------------------


def test_the_core_has_what_was_found(prediction):
    assert short.CUTS == search.cuts_of(DATA["steps"])
    assert list(short.CUTS) == [name for name in prediction.nodes if name in short.CUTS]


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
    for cuts in ({}, short.CUTS):
        pushed = sum(prediction.pushed(name, cuts.get(name, 0)) for name in prediction.whole)
        linear = prediction.errors(pushed).max(axis=1)
        assert linear == pytest.approx(search.predicted(words, cuts), rel=0.02)


@pytest.mark.slow
def test_steps_are_taken_back_until_the_prediction_in_full_allows_them():
    words = search.regular_words()[::40]
    steps = [("l_sw", 1, 0.0, 0.0), ("l_m", 9, 0.0, 0.0)]
    limit = 1.5 * max(search.predicted(words, {}))
    assert search.kept(words, steps, limit) == steps[:1]


@pytest.mark.slow
def test_outcome_is_what_the_model_says(prediction):
    """Predicted within the limit, seen below what is predicted, no flag changed, no word out of its format."""
    words = search.regular_words()
    assert search.predicted(words, short.CUTS) == pytest.approx(DATA["predicted"]["shortened"])
    assert max(DATA["predicted"]["shortened"]) <= search.LIMIT < max(DATA["predicted"]["uniform"]) * 2
    errors, _ = search.errors_of(fixed.run(words, search.WIDTH, "short"), words)
    assert errors.max() <= DATA["predicted"]["shortened"][1]
    assert search.observed(short.CUTS) == DATA["outcome"]
    assert DATA["outcome"]["flags"] == 0 and DATA["outcome"]["beyond"] == []
    for name, cuts in (("whole", {}), ("shortened", short.CUTS)):
        assert search.size(prediction.nodes, cuts) == DATA["sizes"][name]


# -- the model of area -----------------------------------------------------------------------------------------------


def test_what_a_cut_wins_is_found_at_its_readers(prediction):
    nodes = prediction.nodes
    whole = area.luts(nodes, {})
    for group in ("l_sw", "e_x_quo", "c4_quo", "l_m", "q3_abs", "sin_h"):
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
    counted = DATA["alone"]
    assert [row[:3] for row in counted] == [list(row) for row in search.ALONE]
    for module, values, model, seen in counted:
        assert model == pytest.approx(seen, rel=0.1), (module, values)


# -- shorter words ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("node", "cut"), [("l_sw", 5), ("pi_swivel_x", 4), ("sin_h", 3), ("e_x_quo", 2), ("tmp_sqr", 3), ("l_m", 6)]
)
def test_a_shorter_word_is_near_to_the_whole_one_and_ends_in_zeros(node, cut):
    words = search.regular_words()[::10]
    whole = fixed.run(words, search.WIDTH).bits.nodes[node]
    cuts = {node: cut} | ({"cos_h": cut} if node == "sin_h" else {})
    found = fixed.answer(words, fixed.Bits(search.WIDTH, cuts=cuts)).bits.nodes
    shorter = found[node]
    low, high = search.ROUNDINGS[whole.op]
    assert shorter.error == (low * 2**cut, high * 2**cut)
    assert (shorter.value % 2**cut == 0).all() and (shorter.value != whole.value).any()
    off = shorter.value - whole.value
    assert off.min() >= low * 2**cut - max(map(abs, whole.error)) - 1 and off.max() <= high * 2**cut + 2
    if node == "e_x_quo":
        assert (found["p_e_x"].value % 2**cut == 0).all()


def test_no_word_leaves_its_format_on_any_input():
    """Proved on intervals; with an elbow point that is off by an eighth it could not be."""
    assert ranges.analyse(search.WIDTH, cuts=short.CUTS)[1] == {}
    assert ranges.analyse(search.WIDTH, cuts={**short.CUTS, "e_x_quo": 27})[1] != {}


def test_a_clamped_elbow_is_off_by_no_more_than_is_said():
    nodes = fixed.run(mixed(2000, search.WIDTH, 1), search.WIDTH, "short").bits.nodes
    clamped = nodes["clamp"].value.astype(bool)
    for axis in "xyz":
        elbow, target = nodes[f"p_e_{axis}"], nodes[f"p_w_{axis}"]
        off = np.abs(np.abs(elbow.value * elbow.format.ulp) - np.abs(target.value * target.format.ulp / 2))[clamped]
        assert elbow.format.ulp < off.max() <= elbow.facts.grows((0.0,), elbow.format.ulp)


def test_other_lengths_are_not_shortened():
    with pytest.raises(ValueError, match="^width 31: "):
        fixed.run(mixed(1, 31, 1), 31, "short")


def test_nothing_is_cut_unless_said():
    words = mixed(500, search.WIDTH, 1)
    whole, same = fixed.run(words, search.WIDTH), fixed.answer(words, fixed.Bits(search.WIDTH, cuts={}))
    for name, node in whole.bits.nodes.items():
        assert np.array_equal(node.value, same.bits.nodes[name].value) and node.error == same.bits.nodes[name].error
