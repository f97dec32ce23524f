# SPDX-License-Identifier: Apache-2.0
"""Proved ranges of the lean dataflow: they fit, contain random targets, and name a node whose format is too short."""

from dataclasses import replace

import numpy as np
import pytest

from model.bounds import lean_ranges
from model.dataflow import fixed, lean
from model.dataflow.nodes import WIDTHS
from model.dataflow.reals import Real
from model.io.flags import UNREACHABLE, expected_flags
from model.io.stimuli import REGIONS, region


@pytest.mark.parametrize("width", WIDTHS)
def test_every_node_fits(width):
    lean_ranges.check(width)


@pytest.mark.parametrize(
    ("name", "width"),
    [
        ("u_x", 32),
        ("inv_law_raw", 18),
        ("k_scaled", 24),
        ("length_sq", 32),
        ("qs_i", 16),
        ("rho_sq", 32),
        ("m_far", 18),
    ],
)
def test_a_format_too_short_is_named(name, width):
    fmt = lean_ranges.LeanRanges(width).nodes[name].format
    spare = {"rho_sq": 2, "length_sq": 2, "u_x": 2}.get(name, 1)  # one bit, or the spare one and one more
    failed = lean_ranges.LeanRanges(width, {name: replace(fmt, width=fmt.width - spare)}).failed
    assert list(failed) == [name] and name in failed[name] and f"W = {width}" in failed[name]


@pytest.mark.parametrize("width", (16, 18, 24, 32))
@pytest.mark.parametrize("name", REGIONS)
def test_targets_stay_inside(name, width):
    words = region(name, 3000, width, 5)
    words = words[expected_flags(words, width) & UNREACHABLE == 0]
    bits = fixed.run(words, width, "lean").bits
    usual = ~np.asarray(bits.nodes["clamp"].value).astype(bool)
    bounds = lean_ranges.LeanRanges(width).nodes
    exact = Real(bits, {}).nodes
    for node in bits.nodes.values():
        if not node.format.frac:
            continue
        bound, ulp = bounds[node.name].value, node.format.ulp
        value = np.broadcast_to(np.asarray(node.value * ulp, dtype=np.float64), usual.shape)[usual]
        slack = 1e-9 * ulp
        assert (value >= bound.low - bound.error - slack).all() and (value <= bound.high + bound.error + slack).all(), (
            node.name
        )
        if node.section not in ("guard", "results") and node.name != "phi":
            real = np.broadcast_to(np.asarray(exact[node.name].value, dtype=np.float64), usual.shape)[usual]
            # double precision has a few more digits than the longest word
            assert (np.abs(value - real) <= bound.error + 1e-13).all(), node.name


def test_a_node_without_a_rule_is_named(monkeypatch):
    monkeypatch.setattr(lean, "UPPER_HALF", None)
    with pytest.raises(lean_ranges.RangeError, match="cos_el"):
        lean_ranges.LeanRanges(32)
