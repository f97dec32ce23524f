# SPDX-License-Identifier: Apache-2.0
"""Proved ranges: they fit the formats, contain random targets, and name a node whose format is too short."""

from dataclasses import replace

import numpy as np
import pytest

from model.bounds import ranges
from model.dataflow import fixed, paper, paper_turns
from model.dataflow.nodes import WIDTHS as ALL_WIDTHS
from model.io import monte_carlo
from model.io.stimuli import corners, extremes, random_reachable, unreachable

WIDTHS = (16, 18, 24, 32)


def saturating(width: int) -> set[tuple[str, bool]]:
    """Return the sums and quotients that may saturate, and whether only for clamped targets."""
    found = set()
    for case in ranges.cases(width):
        run = ranges.Ranges(width, case).run()
        for name, bound in run.proved.items():
            if run.nodes[name].op in ("sum", "div") and (name in run.failed or bound.rule == "saturates by design"):
                found.add((name, case.clamped))
    return {(name, (name, False) not in found) for name, _ in found}


BY_DESIGN = {("t_e", True), ("c4_quo", False)}
"""Nodes replaced where there is no elbow, or limited to [-1, 1] by (14): all others fit, so there is no flag."""


@pytest.mark.parametrize(
    "width", [w if w in (16, 32) else pytest.param(w, marks=[pytest.mark.slow]) for w in ALL_WIDTHS]
)
def test_nothing_saturates_but_by_design(width):
    assert saturating(width) == BY_DESIGN


def test_what_saturates_is_found(monkeypatch):
    monkeypatch.setattr(paper_turns, "ROTATED", None)
    assert saturating(32) == BY_DESIGN | {("c3_num", False)}


@pytest.mark.parametrize("width", WIDTHS)
def test_proved_ranges_stay_inside_the_formats(width):
    ranges.check(width)
    for name, proof in ranges.proved(width).items():
        fmt = proof.node.format
        assert fmt.low * fmt.ulp <= proof.low <= proof.high <= fmt.high * fmt.ulp, name


@pytest.mark.parametrize(
    ("name", "width"),
    [("l_sw", 16), ("k_e", 24), ("inf_pp", 16), ("qs_j", 18)],
)
def test_a_format_one_bit_too_short_is_named(name, width):
    fmt = ranges.proved(width)[name].node.format
    found = ranges.analyse(width, {name: replace(fmt, width=fmt.width - 1)})[1]
    assert name in found
    assert name in found[name] and f"{fmt.width - 1} bits" in found[name] and f"W = {width}" in found[name]


@pytest.mark.parametrize(
    ("section", "rule"), [(paper, "HEIGHT_SQ"), (paper, "ORTHOGONAL"), (paper, "ELBOW"), (paper_turns, "PRODUCT")]
)
def test_without_a_rule_something_does_not_fit(section, rule, monkeypatch):
    monkeypatch.setattr(section, rule, None)
    try:
        found = ranges.analyse(32)[1]
    except ranges.RangeError as error:  # a divisor that may be 0
        found = {str(error): ""}
    assert found


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("kind", ["reachable", "edges", "unreachable", "extremes", "corners"])
def test_random_targets_stay_inside_the_proved_ranges(width, kind):
    words = {
        "reachable": lambda: random_reachable(20000, width, 7),
        "edges": lambda: monte_carlo.edges(5000, width, 7),
        "unreachable": lambda: unreachable(2000, width, 7),
        "extremes": lambda: extremes(5000, width, 7),
        "corners": lambda: np.array(list(corners(width).values()), dtype=np.int64),
    }[kind]()
    seen = monte_carlo.Observed()
    monte_carlo.observe(seen, words, width)
    assert not seen.beyond, seen.first
    for name, node in seen.nodes.items():
        proof = ranges.proved(width)[name]
        ulp = proof.node.format.ulp
        assert proof.low <= node.low * ulp and node.high * ulp <= proof.high, name


@pytest.mark.parametrize("width", WIDTHS)
def test_proved_errors_hold_in_the_swivel_plane(width):
    """Before the first restart the observed and the proved error are the same quantity."""
    seen = monte_carlo.monte_carlo(monte_carlo.CHUNK, width, 2).nodes
    table = ranges.proved(width)
    checked = [n for n, p in table.items() if p.node.section == "swivel" and n in seen and seen[n].count]
    assert len(checked) > 20
    for name in checked:
        assert seen[name].worst <= table[name].error_ulps * (1 + 1e-6) + 1e-3, name


def test_the_cases_hold_every_unit_of_the_target():
    for width in WIDTHS:
        parts = ranges.cases(width)
        units = {j for c in parts if c.long for j in range(c.j[0], c.j[1] + 1)}
        assert units == set(range(width + 1))
        words = np.concatenate([monte_carlo.edges(4000, width, 3), random_reachable(4000, width, 3)])
        bits = fixed.run(words, width).bits
        j, lz = bits.nodes["scale_j"].value, bits.nodes["lz_r"].value
        assert j.min() >= 0 and j.max() <= width and (j[lz > 0] < width).all()
