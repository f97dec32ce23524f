# SPDX-License-Identifier: Apache-2.0
"""Tests of error growth in selections, shifts and sums (`grows` at the node), with large operand errors."""

import numpy as np
import pytest

from model.dataflow import fixed
from model.dataflow.annotations import Within
from model.dataflow.datapaths import DATAPATHS
from model.io.stimuli import REGIONS, random_reachable, region
from model.io.words import FIELDS

OFF = 1024
"""Operand error in ulps, up or down; the operations' own rounding is small compared with it."""


class Moved(fixed.Bits):
    """Compares every integer operation with its real counterpart on operands with errors; the guard's nodes are exact.
    ``beyond``: node -> observed error / stated error, where it exceeds 1."""

    def __init__(self, width, datapath):
        super().__init__(width, datapath)
        self.random, self.seen, self.beyond = np.random.default_rng(width), 0, {}

    def apply(self, name, operands, fmt, bits, real):
        value = super().apply(name, operands, fmt, bits, real)
        if real is None:
            return value
        off = [OFF * n.format.ulp if n.section != "guard" and n.format.frac else 0.0 for n in operands]
        usual = ~np.asarray(self.nodes["clamp"].value).astype(bool)
        exact = []
        for node, error in zip(operands, off, strict=True):
            if error:  # no decision that the error could reverse
                usual = usual & (np.abs(node.value) > 2 * OFF)
            moved = node.value * node.format.ulp if node.format.frac else node.value
            if isinstance(within := node.facts.within, Within):  # a word rounded beyond its range is not a real value
                usual = usual & (moved >= within.low) & (moved <= within.high)
            exact.append(moved + error * self.random.choice((-1, 1), len(usual)) if error else moved)
        worst = np.abs(np.asarray(value * fmt.ulp - real(*exact), dtype=np.float64))[usual].max(initial=0.0)
        self.seen += 1
        if worst > self.facts[name].grows(off, fmt.ulp) * (1 + 1e-9):
            self.beyond[name] = worst / self.facts[name].grows(off, fmt.ulp)
        return value


@pytest.mark.parametrize("width", (17, 18, 24, 32))
@pytest.mark.parametrize("datapath", DATAPATHS)
def test_errors_grow_no_more_than_the_dataflow_says(datapath, width):
    words = np.concatenate([random_reachable(2000, width, 9), *(region(name, 500, width, 9) for name in REGIONS)])
    domain = Moved(width, datapath)
    DATAPATHS[datapath].flow(domain, domain.inputs(lambda name, fmt: words[:, FIELDS.index(name)]))
    assert domain.seen > 20 and domain.beyond == {}
