# SPDX-License-Identifier: Apache-2.0
"""Builds ``ik_axis`` at several word lengths and runs tb/core/ik_axis.py on it."""

import pytest

from model.dataflow.datapaths import DATAPATHS
from tb.sim.runner import simulate


@pytest.mark.parametrize(("width", "tag_width"), [(32, 8), (18, 3)])
@pytest.mark.parametrize("datapath", DATAPATHS)
def test_streams(datapath, width, tag_width):
    parameters = {"W": width, "TAG_W": tag_width, "LEAN": int(datapath == "lean")}
    simulate("ik_axis", "tb.core.ik_axis", parameters=parameters, seed=1)
