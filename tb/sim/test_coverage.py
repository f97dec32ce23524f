# SPDX-License-Identifier: Apache-2.0
"""Tests of coverage counting."""

from pathlib import Path

import pytest

from tb.axi.instances import echoing
from tb.sim import coverage
from tb.sim.coverage import Point, counted, read, totals, written
from tb.sim.env import ROOT
from tb.sim.seeded_bugs import Bug, copy_rtl
from tb.sim.sources import with_rules

FIFO, AXIS = "rtl/lib/ik_fifo.v", "rtl/ik_axis.v"
BUG = Bug("lost", FIFO, "m_valid <= !empty", "m_valid <= empty")


def line(file, page, row, what, count):
    fields = {"f": file, "l": row, "n": 3, "page": page, "o": what, "h": "top.u"}
    return "C '" + "".join(f"\1{key}\2{value}" for key, value in fields.items()) + f"' {count}"


def test_instances_and_parameters_are_added(tmp_path):
    text = "\n".join(
        [
            "# SystemC::Coverage-3",
            line(ROOT / FIFO, "v_toggle/ik_fifo", 13, "clk:0->1", 2),
            line(ROOT / FIFO, "v_toggle/ik_fifo__W8", 13, "clk:0->1", 3),
            line(ROOT / FIFO, "v_branch/ik_fifo", 40, "if", 0),
            line(tmp_path / "top.v", "v_line/top", 1, "block", 7),
        ]
    )
    counts = totals(text, ROOT, {FIFO})
    assert counts == {Point(FIFO, 13, 3, "toggle", "clk:0->1"): 5, Point(FIFO, 40, 3, "branch", "if"): 0}
    for name in ("a.txt", "b.txt"):
        (tmp_path / name).write_text(written(counts))
    assert read(tmp_path) == {point: 2 * count for point, count in counts.items()}


def test_a_copy_with_rules_is_the_file_as_far_as_its_end(tmp_path):
    (copy,) = [path for path in with_rules([ROOT / AXIS], tmp_path) if path.parent == tmp_path]
    rows = [number for number, row in enumerate(copy.read_text().splitlines(), 1) if "assign s_axis_tready" in row]
    rows += [number for number, row in enumerate(copy.read_text().splitlines(), 1) if "ik_rules_channel" in row]
    assert len(rows) > 1
    text = "\n".join(line(copy, "v_toggle/ik_axis", row, "clk:0->1", 1) for row in rows)
    assert totals(text, ROOT, {AXIS}) == {Point(AXIS, rows[0], 3, "toggle", "clk:0->1"): 1}


def test_a_bug_counts_nothing_and_a_stand_in_counts_for_others(tmp_path):
    everything = counted(ROOT)
    assert FIFO in everything and "rtl/lean/ik_lean.v" in everything
    assert counted(echoing(tmp_path / "echo")["root"]) == everything - {"rtl/lean/ik_lean.v"}
    assert counted(copy_rtl(tmp_path / "bug", BUG)) is None


def test_only_what_goes_through_is_kept(tmp_path, monkeypatch):
    monkeypatch.setenv("IK_COVERAGE", str(tmp_path / "counts"))

    def run(fails=False, root=ROOT):
        with coverage.counting(root) as arguments:
            for word in arguments:
                Path(word.rpartition("+")[2]).write_text(line(ROOT / FIFO, "v_line/ik_fifo", 1, "block", 1))
            assert not fails

    with pytest.raises(AssertionError):
        run(fails=True)
    run(root=copy_rtl(tmp_path / "bug", BUG))
    assert not read(tmp_path / "counts")
    run()
    run()
    assert set(read(tmp_path / "counts").values()) == {2} and not list((tmp_path / "counts").glob("*.raw"))
