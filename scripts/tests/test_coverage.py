# SPDX-License-Identifier: Apache-2.0
"""Test `make coverage`: counts in Verilator's files, waivers, findings."""

from pathlib import Path

import pytest

from scripts import coverage
from tb.axi.instances import echoing
from tb.core.functional_coverage import BINS, KINDS, bin_of, examples, kinds_of, regions
from tb.sim.coverage import Point, counting, read, write
from tb.sim.env import ROOT
from tb.sim.sources import sources, with_rules

FIFO = "rtl/lib/ik_fifo.v"
ROW = next(n for n, line in enumerate((ROOT / FIFO).read_text().splitlines(), 1) if "m_valid <= !empty;" in line)


@pytest.mark.parametrize("datapath", KINDS)
def test_each_kind_of_target_has_an_example(datapath):
    missing = [kind for kind in KINDS[datapath] if kind not in examples(18, datapath)]
    assert not missing, f"tb/core/functional_coverage.py: {missing} in neither examples nor IMPOSSIBLE"


def simulate(root, *points, fails=False):
    """Write a coverage file in Verilator's format. points: (file, page, line, what, count) each."""
    lines = []
    for file, page, row, what, count in points:
        fields = {"f": file, "l": row, "n": 3, "page": page, "o": what, "h": "top.u"}
        lines.append("C '" + "".join(f"\1{key}\2{value}" for key, value in fields.items()) + f"' {count}\n")
    with counting(root) as (word,):
        Path(word.rpartition("+")[2]).write_text("".join(lines))
        assert not fails


def test_simulations_that_pass_are_added(tmp_path, monkeypatch):
    """Counts are added over instances and parameters; files outside of rtl/ are not counted."""
    monkeypatch.setenv("IK_COVERAGE", str(tmp_path / "counts"))
    points = [
        (ROOT / FIFO, "v_toggle/ik_fifo", 13, "clk:0->1", 2),
        (ROOT / FIFO, "v_toggle/ik_fifo__W8", 13, "clk:0->1", 3),
        (ROOT / FIFO, "v_branch/ik_fifo", 40, "if", 0),
        (tmp_path / "top.v", "v_line/top", 1, "block", 7),
    ]
    with pytest.raises(AssertionError):
        simulate(ROOT, *points, fails=True)
    simulate(ROOT, *points)
    counts = {Point(FIFO, 13, 3, "toggle", "clk:0->1"): 5, Point(FIFO, 40, 3, "branch", "if"): 0}
    assert read(tmp_path / "counts") == counts


def test_only_unchanged_files_of_a_copy_count(tmp_path, monkeypatch):
    """A copied file that is unchanged, or only has AXI rules added, counts as the original; the echo's ik_lean does
    not."""
    monkeypatch.setenv("IK_COVERAGE", str(tmp_path / "counts"))
    root = echoing(tmp_path / "echo")["root"]
    (rules,) = [path for path in with_rules([root / "rtl/ik_axis.v"], tmp_path) if path.parent == tmp_path]
    simulate(root, *((path, "v_line/x", 1, "block", 1) for path in (rules, root / FIFO, root / "rtl/lean/ik_lean.v")))
    assert {point.file for point in read(tmp_path / "counts")} == {"rtl/ik_axis.v", FIFO}


@pytest.fixture
def judge(tmp_path, monkeypatch, command):
    """Return a function that runs the command with given counts for one line of ik_fifo; all else counts as reached."""
    for name in ("COUNTS", "WAIVERS", "PAGE"):
        monkeypatch.setattr(coverage, name, tmp_path / name)

    def judge(points, waivers=""):
        counts = dict.fromkeys([Point(str(path.relative_to(ROOT)), 1, 1, "line", "block") for path in sources()], 1)
        counts |= dict.fromkeys(BINS, 3)
        counts |= {Point(FIFO, ROW, 7, *point.split(" ", 1)): count for point, count in points.items()}
        write(coverage.COUNTS / "a.json", counts)
        coverage.WAIVERS.write_text(waivers)
        return command(coverage.main, "--again", "--keep")

    return judge


MISSED = {"line block": 0, **{f"toggle q[{bit}]:{way}": 0 for bit in (0, 2) for way in ("0->1", "1->0")}}


def test_unreached_points_are_findings(judge):
    status, out, _ = judge(MISSED | {"toggle q[3]:0->1": 0, "toggle q[3]:1->0": 1})
    assert status == 1 and not coverage.PAGE.exists()
    at = f"{FIFO}:{ROW}:"
    bits = "q[0]:0->1 q[0]:1->0 q[2]:0->1 q[2]:1->0 q[3]:0->1"
    assert out == [f"{at} line block: m_valid <= !empty;", f"{at} toggle {bits}: m_valid <= !empty;"]
    assert judge({"line block": 1, "toggle m_valid:0->1": 2})[0] == 0
    assert f"| {FIFO} | 2 | 0 | 0 | 1 | 0 |" in coverage.PAGE.read_text()


@pytest.mark.parametrize(
    ("pattern", "left"),
    [
        ("line*m_valid*!empty* q[2,0]", []),
        ("line* q[2:1] q[0]:1->0", ["toggle q[0]:0->1"]),
        ("line*full* q", ["line block", "no unreached"]),
    ],
)
def test_a_waiver_matches_its_points_only(judge, pattern, left):
    status, out, _ = judge(MISSED, f"# waivers\nwaive rtl/*/ik_fifo.v {pattern} -- a test\n")
    assert status == bool(left)
    assert all(part in line for part, line in zip(left or ["no findings"], out[: len(left) or 1], strict=True))
    assert len(out) == (len(left) or 2)  # or the page


def test_a_bin_or_a_file_without_a_count_is_a_finding(judge, monkeypatch):
    monkeypatch.setattr(coverage, "sources", lambda: [*sources(), ROOT / "rtl" / "lib" / "ik_new.v"])
    monkeypatch.setattr(coverage, "BINS", [*BINS, bin_of(("new",), "lean", "none")])
    assert judge({})[1] == ["rtl/lib/ik_new.v: no simulation has it", "cross not reached: new x lean x none"]


def test_waivers_of_the_tree_can_be_parsed():
    reasons, idle = coverage.waived([])
    assert not reasons and idle


def test_regions_of_targets_and_kinds_of_poses():
    assert regions((300, 200, 100, 5, 300, 200)) == ["regular"]
    assert regions((0, 0, 400, 0, 300, 200)) == ["axis"]
    assert regions((0, 0, 0, 0, 300, 300)) == ["axis", "shoulder", "closed"]
    assert regions((500, 0, 0, 0, 300, 200)) == ["stretched"] and regions((101, 0, 0, 0, 300, 200)) == ["closed"]
    kinds = {kind for (kind,) in kinds_of([0] * 11 + [5], [256] * 17, 0, 16)}
    assert kinds > {"branch_shoulder=1", "branch_elbow=0", "branch_wrist=1", "th2 near 0", "tool 0", "bad_hand=0"}
    assert {kind for (kind,) in kinds_of([0] * 11 + [5], [32512] * 17, 0, 16)} >= {"th2 near pi", "th6 near pi"}
