# SPDX-License-Identifier: Apache-2.0
"""Starts the tests of ``tb/units/ik_trig.py``."""

import pytest

from tb.units.unit import run_unit, sets, title

# F goes with W as in the datapath: min(W + 3, 31). Up to F = 21 the core has fewer tiles.
SETS = sets(*({"W": w, "F": min(w + 3, 31)} for w in (16, 18, 24, 27, 32)), icarus=[{"W": 19, "F": 22}])


@pytest.mark.parametrize("parameters", SETS, ids=title)
def test_ik_trig(parameters):
    run_unit("ik_trig", parameters)
