# SPDX-License-Identifier: Apache-2.0
"""Reference axis: R takes it to z, exactly for named axes."""

import re

import numpy as np
import pytest

from model.motion.axes import NAMED, AxisError, direction, parse, to_z
from model.reference.kinematics import matrix, rotate

SLANTED = [(0.3, 1, 0), (0, -1, 1), (1e-9, 0, -1), (0, 1e-200, 1), (1e200, 1e200, 0), (5e-324, 0, 0), (-3, -2, -1)]


@pytest.mark.parametrize("axis", [*NAMED, *SLANTED])
def test_axis_becomes_z(axis):
    q = to_z(axis)
    assert np.linalg.norm(q) == pytest.approx(1, abs=4e-16)
    np.testing.assert_allclose(rotate(q, direction(axis)), (0, 0, 1), atol=4e-16)
    np.testing.assert_allclose(np.linalg.det(matrix(q)), 1, atol=1e-15)


@pytest.mark.parametrize("axis", NAMED)
def test_a_named_axis_only_permutes_coordinates(axis):
    m = matrix(to_z(axis))
    assert (np.sort(np.abs(m), axis=1) == (0, 0, 1)).all()
    assert (m @ direction(axis) == (0, 0, 1)).all()
    assert set(np.abs(to_z(axis)) * 2) <= {0, 1, 2}


@pytest.mark.parametrize(("text", "axis"), [("-x", "-x"), ("0.3,1,0", (0.3, 1.0, 0.0)), (" 0, -1e3 ,2", (0, -1e3, 2))])
def test_parse(text, axis):
    assert parse(text) == axis


@pytest.mark.parametrize(
    "text", ["", "w", "Z", "+z", "--z", "1,2", "1,2,3,4", "0,0,0", "1,nan,0", "1,inf,0", "1,,0", "a,b,c"]
)
def test_parse_refuses(text):
    with pytest.raises(AxisError, match=f"^axis '{re.escape(text)}' is no"):
        parse(text)


@pytest.mark.parametrize("axis", [None, 3, (1, 2), ("a", 1, 2), [[1, 2, 3]], (0, 0, 0)])
def test_direction_refuses(axis):
    with pytest.raises(AxisError, match="no vector of three finite numbers"):
        direction(axis)
