# SPDX-License-Identifier: Apache-2.0
"""Work over processes ends with the block."""

import functools
import time

import pytest

from scripts.spread import spread

JOBS = 2


def begin(folder, number):
    (folder / str(number)).touch()
    time.sleep(20)


def test_what_has_not_begun_does_not_begin(tmp_path):
    with pytest.raises(KeyboardInterrupt), spread(JOBS) as each:
        each(functools.partial(begin, tmp_path), range(8))
        while len(list(tmp_path.iterdir())) < JOBS:
            time.sleep(0.01)
        raise KeyboardInterrupt
    assert len(list(tmp_path.iterdir())) == JOBS


def test_keeps_the_order():
    with spread(JOBS) as each:
        assert list(each(pow, range(5), range(5))) == [number**number for number in range(5)]
