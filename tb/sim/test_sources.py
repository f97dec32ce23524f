# SPDX-License-Identifier: Apache-2.0
"""Tests of the file lists, and of the digest, which ignores comments and blanks."""

import re
import shutil

import pytest

from tb.sim.env import ROOT
from tb.sim.sources import closure, code, digest, headers, includes, sources

RTL = ROOT / "rtl"


def test_the_list_names_every_file_once():
    assert sorted(sources()) == sorted(RTL.rglob("*.v"))


def test_every_header_is_found():
    assert sorted(headers()) == sorted(RTL.rglob("*.vh"))
    wanted = {
        name for path in [*sources(), *headers()] for name in re.findall(r'`include\s+"([^"]+)"', path.read_text())
    }
    assert wanted == {path.name for path in headers()}
    assert all(folder.is_dir() for folder in includes())


def test_a_copy_has_its_own_files(tmp_path):
    shutil.copytree(RTL, tmp_path / "rtl")
    assert [path.relative_to(tmp_path) for path in sources(tmp_path)] == [path.relative_to(ROOT) for path in sources()]


def test_closure_is_all_a_module_needs_and_no_more():
    files = closure("ik_lean")
    names = {path.name for path in files}
    assert files[0] == RTL / "lean/ik_lean.v"
    assert {"ik_rsqrt.v", "ik_rsqrt_table.vh", "ik_delay.v", "ik_lean_nodes.vh"} <= names
    assert not names & {"ik_axis.v", "ik_div.v", "ik_paper.v"}
    assert closure("ik_none") == []


VERILOG = ("assign q = a & b;\n", "// a comment\nassign q = /* another,\n of two lines */ a &\n    b;  // and one\n")
PYTHON = (
    'def f(a):\n    return f"{a} # no comment"\n',
    '"""What it is for."""\n\n# a comment\ndef f(a):  # another\n    """What f is\n    for."""\n\n'
    '    return f"{a} # no comment"\n',
)


@pytest.mark.parametrize(("name", "texts"), [("a.v", VERILOG), ("a.vh", VERILOG), ("a.cpp", VERILOG), ("a.py", PYTHON)])
def test_comments_and_blanks_do_not_count(tmp_path, name, texts):
    path = tmp_path / name
    digests = []
    for text in texts:
        path.write_text(text)
        digests.append(digest([path]))
    assert digests[0] == digests[1], code(path)


@pytest.mark.parametrize(
    ("name", "before", "after"),
    [
        ("a.v", VERILOG[0], VERILOG[0].replace("&", "|")),
        ("a.v", '$display("a  // b");', '$display("a // b");'),
        ("a.cpp", 'f("//", 1);', 'f("//", 2);'),
        ("a.py", PYTHON[0], PYTHON[0].replace("# no", "# a")),
        ("a.py", "if a:\n    b()\nc()\n", "if a:\n    b()\n    c()\n"),
        ("a.py", 'a = """one"""\n', 'a = """two"""\n'),
    ],
)
def test_code_counts(tmp_path, name, before, after):
    path = tmp_path / name
    path.write_text(before)
    was = digest([path])
    path.write_text(after)
    assert digest([path]) != was
    assert digest([path, path]) != digest([path]), "and so does a file more"
