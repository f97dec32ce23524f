# SPDX-License-Identifier: Apache-2.0
"""Test the proved ranges: they fit the formats and contain the words of random targets, and a node whose format is too
short is reported by name. Test that the error growth stated by nodes covers operands with large errors."""

from dataclasses import replace

import numpy as np
import pytest

from model.bounds import ranges
from model.bounds.predict import Real
from model.bounds.tolerances import REGULAR_DISTANCE
from model.dataflow import fixed
from model.dataflow.datapaths import DATAPATHS
from model.dataflow.formats import WIDTHS as ALL_WIDTHS
from model.dataflow.nodes import Within
from model.dataflow.paper_operations import Saturating
from model.io.scoring import singular_distance
from model.io.stimuli import REGIONS, corners, edges, extremes, hand_poses, random_reachable, region, unreachable
from model.io.words import from_words

WIDTHS = (16, 18, 24, 32)


@pytest.mark.parametrize("widths", [(16, 32), pytest.param(ALL_WIDTHS[1:-1], marks=pytest.mark.slow)])
def test_nothing_saturates_but_by_design(widths):
    """Check that only t_e (for clamped targets, which have no elbow) and c4_quo (limited by (14)) saturate."""
    for width in widths:
        only_clamped: dict[str, bool] = {}
        for case in ranges.cases(width):
            run = ranges.Ranges(width, case)
            assert not run.failed, f"W = {width}"
            for name in run.saturated:
                if run.flow.nodes[name].kind in ("sum", "div"):
                    only_clamped[name] = case.clamped and only_clamped.get(name, True)
        assert only_clamped == {"t_e": True, "c4_quo": False}, f"W = {width}"


@pytest.mark.parametrize("width", WIDTHS)
def test_random_targets_stay_inside_the_proved_ranges(width):
    """Check that saturation is intended and words are in the proved ranges. In section ``swivel``, where no word counts
    as exact yet, check also errors against double precision in regular poses."""
    some = random_reachable(20000, width, 7), edges(5000, width, 7), unreachable(5000, width, 7)
    words = np.concatenate([*some, extremes(5000, width, 7), np.array(list(corners(width).values()), dtype=np.int64)])
    nodes = fixed.run(words, width, "paper").nodes
    value = {name: np.broadcast_to(node.value, len(words)) for name, node in nodes.items()}
    clamped = value["clamp"].astype(bool)
    with np.errstate(all="ignore"):
        real = Real(nodes, {}).values
    regular = ~clamped
    regular[regular] = singular_distance(from_words(words[regular], 0, width, "random")) >= REGULAR_DISTANCE
    for name, proof in ranges.analyse(width)[0].items():
        node, fmt = proof.node, proof.node.format
        word = node.op.unlimited(node, value) if isinstance(node.op, Saturating) else value[name]
        out = (word < fmt.low) | (word > fmt.high)
        if node.limited:
            out = out & ~clamped & node.limited.clamped
        assert not out.any(), f"{name} of {words[np.argmax(out)]} is beyond its format"
        if fmt.width > 1:
            low, high = int(value[name].min()), int(value[name].max())
            assert proof.low <= low * fmt.ulp and high * fmt.ulp <= proof.high, name
        if node.section == "swivel":
            exact = np.broadcast_to(real[name], len(words))[regular] / fmt.ulp
            worst = np.abs(value[name][regular] - exact).max()
            assert worst <= proof.error_ulps * (1 + 1e-6) + 1e-3, name
    j, lz = value["scale_j"], value["lz_r"]
    assert j.min() >= 0 and j.max() <= width and (j[lz > 0] < width).all()
    units = {j for c in ranges.cases(width) if c.long for j in range(c.j[0], c.j[1] + 1)}
    assert units == set(range(width + 1)), "a unit of the target is in no case"


SHORT = [("paper", *of, 1) for of in (("l_sw", 16), ("k_e", 24), ("inf_pp", 16), ("qs_j", 18))]
SHORT += [("arm", "u_x", 32, 2), ("arm", "k_scaled", 24, 1), ("arm", "qs_i", 16, 1)]
SHORT += [("arm", "hand_sq", 24, 3), ("arm", "off_x", 18, 1), ("arm", "qw_ij", 18, 2)]
"""(datapath, node, word length, number of bits that the node's format cannot spare)."""


@pytest.mark.parametrize(("datapath", "name", "width", "spare"), SHORT)
def test_a_format_too_short_is_named(datapath, name, width, spare, monkeypatch):
    node = fixed.nodes(datapath, width)[name]
    monkeypatch.setattr(node, "format", replace(node.format, width=node.format.width - spare))
    analyse = ranges.analyse.__wrapped__  # without its cache
    failed = analyse(width)[1] if datapath == "paper" else ranges.LeanRanges(width, "arm").failed
    assert datapath == "paper" or list(failed) == [name]
    assert all(text in failed[name] for text in (name, f"{node.format.width} bits", f"W = {width}"))


def usual_targets(nodes):
    """Return the mask (N,) of targets whose words are all used: not clamped, wrist not saturated, hand good."""
    unused = (nodes[name].value for name in ("clamp", "bad_hand", "saturated") if name in nodes)
    return ~np.any([np.asarray(value, dtype=bool) for value in unused], axis=0)


def test_a_node_without_a_rule_is_named(monkeypatch):
    monkeypatch.setattr(fixed.nodes("lean", 31)["cos_el"], "within", None)
    with pytest.raises(ranges.RangeError, match="cos_el"):
        ranges.LeanRanges(31)


OFF = 1024
"""Error added to or subtracted from each operand, in ulps; an operation's own rounding is small in comparison."""


def grown(nodes, node, random) -> tuple[float, float]:
    """Return the error of a node's word if its operands are off by OFF ulps, and the error bound that the node states.
    Words that count as exact, and operands from the section ``guard``, have no error."""
    usual = usual_targets(nodes) & np.ones(np.shape(node.value), dtype=bool)
    values, off = {}, []
    for operand in (nodes[operand.name] for operand in node.operands):
        values[operand.name], ulp = operand.value, operand.format.ulp
        if isinstance(within := operand.within, Within):  # a word rounded beyond its range is not a real value
            usual = usual & (operand.value * ulp >= within.low) & (operand.value * ulp <= within.high)
        exact = operand.section == "guard" or operand.name in node.as_words or not operand.frac
        if operand.frac:
            off.append(0.0 if exact else OFF * ulp)
            values[operand.name] = np.asarray(operand.value, dtype=np.float64)
        if not exact:  # exclude targets where the error could reverse a decision
            usual = usual & (np.abs(operand.value) > 2 * OFF)
            values[operand.name] = operand.value + OFF * random.choice((-1.0, 1.0), len(usual))
    error = np.abs(np.asarray(node.value - node.op.real_result(node, values), dtype=np.float64)) * node.format.ulp
    return float(error[usual].max(initial=0.0)), node.grows(off, node.format.ulp)


@pytest.mark.parametrize("width", (17, 32))
@pytest.mark.parametrize("datapath", [*DATAPATHS, "arm"])
def test_errors_grow_no_more_than_the_dataflow_states(datapath, width):
    words = np.concatenate([random_reachable(2000, width, 9), *(region(name, 500, width, 9) for name in REGIONS)])
    nodes = fixed.run(hand_poses(words, width, 9) if datapath == "arm" else words, width, datapath).nodes
    random, checked, beyond = np.random.default_rng(width), 0, {}
    for node in nodes.values():
        # angles wrap; a double is too short for the longest words
        if node.kind != "choose" or node.decision or node.section == "joints" or node.format.width > 60:
            continue
        error, stated = grown(nodes, node, random)
        checked += 1
        if error > stated * (1 + 1e-9):
            beyond[node.name] = error / stated
    assert checked > 20 and beyond == {}
