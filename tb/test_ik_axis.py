# SPDX-License-Identifier: Apache-2.0
"""Builds ``ik_axis`` at several word lengths and runs tb/ik_axis.py on it."""

import pytest

from tb.runner import simulate


@pytest.mark.parametrize(("width", "tag_width"), [(32, 8), (18, 3)])
def test_streams(width, tag_width):
    simulate("ik_axis", "tb.ik_axis", parameters={"W": width, "TAG_W": tag_width}, seed=1)
