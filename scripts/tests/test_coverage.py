# SPDX-License-Identifier: Apache-2.0
"""Tests of the findings of make coverage on synthetic counts."""

import json

import pytest

from scripts import coverage
from tb.core.functional_coverage import AXES, NAME
from tb.coverage import waivers
from tb.coverage.waivers import Waiver
from tb.sim.coverage import Point, written
from tb.sim.env import ROOT
from tb.sim.sources import sources

FIFO = "rtl/lib/ik_fifo.v"
PLACE = next(k for k, text in enumerate((ROOT / FIFO).read_text().splitlines(), 1) if "m_valid <= !empty;" in text)
WHY = {"file": "rtl/*/ik_fifo.v", "text": "m_valid<=!empty;", "kind": "line|toggle"}


@pytest.fixture
def judged(tmp_path, monkeypatch, command):
    """Return a function that judges counts: a point in every file, points of one FIFO line, waivers, cross hits."""
    monkeypatch.setattr(coverage, "COUNTS", tmp_path / "counts")
    monkeypatch.setattr(coverage, "HTML", tmp_path / "index.html")
    monkeypatch.setattr(coverage, "PAGE", tmp_path / "coverage.md")
    monkeypatch.setattr(waivers, "WAIVERS", tmp_path / "waivers.json")
    monkeypatch.setattr(coverage, "merged", lambda _: hits)
    hits = {tuple(bins[0] for bins in AXES.values()): 3}

    def judge(points, given=(), others=(), words=("--again",)):
        counts = {Point(str(path.relative_to(ROOT)), 1, 1, "line", "block"): 1 for path in sources()}
        counts |= {Point(FIFO, PLACE, 7, kind, what): count for (kind, what), count in points.items()}
        (tmp_path / "counts").mkdir(exist_ok=True)
        (tmp_path / "counts" / "a.txt").write_text(written(counts))
        (tmp_path / "waivers.json").write_text(json.dumps({"a test": list(given)}))
        hits.update(others)
        return command(coverage.main, *words)

    return judge


def test_what_is_reached_is_no_finding(judged, tmp_path):
    status, out, err = judged({("line", "block"): 1, ("toggle", "m_valid:0->1"): 2}, words=["--again", "--keep"])
    assert (status, err) == (0, []) and out[-1] == "wrote coverage.md"
    assert "| all |" in (tmp_path / "coverage.md").read_text()


def test_what_is_not_reached_is_one(judged):
    missed = {
        ("line", "block"): 0,
        **{("toggle", f"q[{bit}]:{way}"): 0 for bit in (0, 2, 3) for way in ("0->1", "1->0")},
    }
    status, out, _ = judged(missed, words=["--again", "--keep"])
    assert status == 1 and not coverage.PAGE.exists()
    assert out[-2:] == [
        f"{FIFO}:{PLACE}: line block: m_valid <= !empty;",
        f"{FIFO}:{PLACE}: toggle q[3:2,0]: m_valid <= !empty;",
    ]
    page = coverage.HTML.read_text()
    assert "2 findings" in page and "// toggle q[3:2,0]" in page


def test_a_waiver_excuses_its_points_only(judged):
    missed = {("line", "block"): 0, ("toggle", "q[1]:0->1"): 0, ("toggle", "q[2]:0->1"): 0}
    assert judged(missed, [WHY])[0] == 0
    assert "// waived: a test" in coverage.HTML.read_text()
    status, out, _ = judged(missed, [WHY | {"what": "block; q[1]"}])
    assert status == 1 and out[-1] == f"{FIFO}:{PLACE}: toggle q[2] 0->1: m_valid <= !empty;"


@pytest.mark.parametrize(
    "change", [{"text": "m_valid <= full;"}, {"file": "rtl/lib/ik_ring.v"}, {"kind": "branch"}, {"what": "q"}]
)
def test_a_waiver_that_excuses_nothing_is_a_finding(judged, change):
    status, out, _ = judged({("line", "block"): 0}, [WHY, WHY | change])
    assert status == 1 and "excuses nothing" in out[-1] and change.popitem()[1] in out[-1]


def test_a_bin_or_a_file_that_nobody_has_is_a_finding(judged, monkeypatch):
    status, out, _ = judged({}, others={("-", "fold", "axis", "gap"): 0})
    assert status == 1 and out[-1] == "cross not hit: - x fold x axis x gap"
    monkeypatch.setattr(coverage, "sources", lambda: [*sources(), ROOT / "rtl" / "lib" / "ik_new.v"])
    assert "rtl/lib/ik_new.v: no simulation has it" in judged({})[1]


def test_nothing_is_judged_when_a_test_fails(judged, monkeypatch):
    monkeypatch.setattr(coverage, "run", lambda only: 1)
    status, out, err = judged({}, words=[])
    assert (status, out, err) == (1, [], ["coverage: pytest ended with status 1"])


@pytest.mark.parametrize(
    ("by", "which"),
    [
        ("q", {"q[0]:0->1", "q[0]:1->0", "q[3]:0->1"}),
        ("q[3:1]", {"q[3]:0->1"}),
        ("q[7,0] 0->1", {"q[0]:0->1"}),
        ("r", {"r:0->1"}),
        ("g[1].q", set()),
        ("(a==1) => 0", {"(a==1) => 0"}),
    ],
)
def test_names_of_a_waiver(by, which):
    points = ["q[0]:0->1", "q[0]:1->0", "q[3]:0->1", "r:0->1", "(a==1) => 0"]
    assert {point for point in points if waivers.named(point, by)} == which


def test_waivers_of_the_tree_have_reasons():
    given = waivers.waivers()
    assert given == list(dict.fromkeys(given)) and all(isinstance(one, Waiver) and len(one.reason) > 8 for one in given)


def test_regions_of_targets():
    from tb.core.functional_coverage import regions

    assert NAME and regions((300, 200, 100, 5, 300, 200)) == ["regular"]
    assert regions((0, 0, 400, 0, 300, 200)) == ["axis"]
    assert regions((0, 0, 0, 0, 300, 300)) == ["axis", "shoulder", "folded"]
    assert regions((500, 0, 0, 0, 300, 200)) == ["stretched"] and regions((101, 0, 0, 0, 300, 200)) == ["folded"]
