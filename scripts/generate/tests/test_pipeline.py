# SPDX-License-Identifier: Apache-2.0
"""Pipeline pictures: every operation at its clocks, including the output FIFO."""

import re
from itertools import combinations

import pytest

from model.dataflow.datapaths import DATAPATHS
from model.dataflow.fixed import FIFO_CLOCKS
from scripts.generate.flow import design, start
from scripts.generate.pipeline import DRAWN, LEFT, bars, lanes, pipeline_svg

RECT = re.compile(r'<rect x="([\d.]+)" y="(\d+)" width="([\d.]+)".*<title>([^<]*), clocks (\d+) to (\d+): ([^<]*)<')


@pytest.mark.parametrize("datapath", DATAPATHS)
@pytest.mark.parametrize("width", [32, 18])
def test_every_operation_is_drawn_once_at_its_clocks(datapath, width):
    nodes = design(datapath, width)
    working = {n: (start(v, width), v.time) for n, v in nodes.items() if v.time > start(v, width)}
    total = max(node.time for node in nodes.values()) + FIFO_CLOCKS
    text = pipeline_svg(datapath, width)
    drawn = {}
    for x, _, wide, _, begin, end, names in RECT.findall(text):
        assert float(x) == pytest.approx(LEFT + DRAWN * int(begin) / total, abs=0.06)
        assert float(wide) == pytest.approx(DRAWN * (int(end) - int(begin)) / total, abs=0.06)
        for name in names.split(", "):
            assert name not in drawn
            drawn[name] = int(begin), int(end)
    assert drawn == {n: at for n, at in working.items() if nodes[n].section != "results"} | {
        "ik_fifo": (total - FIFO_CLOCKS, total)
    }
    assert f"{total} clocks from input to output" in text and f'class="t">{total}<' in text


@pytest.mark.parametrize("datapath", DATAPATHS)
def test_no_bar_is_over_another(datapath):
    for lane in lanes(bars(design(datapath).values())):
        for (_, begin, end, _), (_, other, last, _) in combinations(lane, 2):
            assert end <= other or last <= begin
