# SPDX-License-Identifier: Apache-2.0
"""Test the findings of scripts/lint.py on small modules and files."""

from importlib.util import find_spec

import pytest

from scripts import lint
from tb.sim.env import ROOT

CLEAN = (ROOT / "rtl/lib/ik_pick.v").read_text()
SLANG = pytest.mark.skipif(not find_spec("pyslang"), reason="pyslang needs Python 3.11")


@pytest.mark.parametrize(
    ("old", "new", "finding"),
    [
        pytest.param("", "", "", id="clean"),
        pytest.param("wire [W-1:0] word", "wire [31:0] word", "WIDTHEXPAND", id="at W = 18 only"),
        pytest.param("module ik_pick", "module ik_sub", "ik_pick", id="name"),
        pytest.param("word = ", "word = t;\n  wire [W-1:0] t = ", "before its declaration", marks=SLANG, id="slang"),
        pytest.param("[W-1:0] a,", "[W-(W>0):0] a,", "WIDTH", marks=pytest.mark.needs("lint"), id="5.006"),
    ],
)
def test_findings(tmp_path, old, new, finding):
    file = tmp_path / "ik_pick.v"
    file.write_text(CLEAN.replace(old, new, 1))
    line, messages = lint.lint_module(file)
    assert line == "ik_pick W=32, W=18"
    assert finding in messages if finding else not messages


def test_licences_and_lengths(tmp_path, monkeypatch):
    monkeypatch.setattr(lint, "ROOT", tmp_path)
    (tmp_path / "a.py").write_text(f"# {lint.LICENCE}\n" + "x\n" * 500)
    (tmp_path / "b.py").write_text("x\n")
    (tmp_path / "c.md").write_text("x\n" * 501)
    assert [line.split(":")[0] for line in lint.unkept(["a.py", "b.py", "c.md"]).splitlines()] == ["a.py", "b.py"]
