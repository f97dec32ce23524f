# SPDX-License-Identifier: Apache-2.0
"""Tests that follow docs/debugging.md word for word in a copy of the checkout and compare the printed lines."""

import json
import os
import re
import shutil
import subprocess

import pytest

from tb.sim.env import ROOT

PAGE = ROOT / "docs" / "debugging.md"
pytestmark = pytest.mark.release

COMMAND = re.compile(r"(sed|make|gtkwave|\.venv/bin/python) ")


def blocks(text):
    """Yield the indented blocks of a page: (whether it holds commands, its lines)."""
    found = re.findall(r"(?:^    .*\n)(?:^(?:    .*)?\n)*", text, re.MULTILINE)
    for block in found:
        lines = [line.removeprefix("    ") for line in block.rstrip().splitlines()]
        yield bool(COMMAND.match(lines[0])), lines


def missing(lines, said):
    """Return the first line missing from the output `said`; lines between `...` must be contiguous, in order."""
    begin = 0
    for piece in "\n".join(lines).split("\n...\n"):
        wanted = piece.splitlines()
        ends = [k for k in range(begin, len(said) - len(wanted) + 1) if said[k : k + len(wanted)] == wanted]
        if not ends:
            return next((line for line in wanted if line not in said), wanted[0])
        begin = ends[0] + len(wanted)
    return None


@pytest.fixture(scope="module")
def checkout(tmp_path_factory):
    """A copy of the tracked and unignored files with the same Python; set-up requires a .venv that is no link."""
    copy = tmp_path_factory.mktemp("checkout")
    listed = ["git", "ls-files", "--cached", "--others", "--exclude-standard", "-z"]
    names = subprocess.run(listed, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    for name in filter(None, names.split("\0")):
        if (ROOT / name).is_file():
            (copy / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, copy / name)
    venv, stamp = copy / ".venv", "cga-ik.json"
    venv.mkdir()
    for entry in (ROOT / ".venv").iterdir():
        if entry.name != stamp:
            (venv / entry.name).symlink_to(entry)
    made = json.loads((ROOT / ".venv" / stamp).read_text(encoding="utf-8"))
    (venv / stamp).write_text(json.dumps(made | {"venv": str(venv)}), encoding="utf-8")
    # No window can be opened here: replace gtkwave with a script that requires its files.
    tools = copy / "build" / "tools"
    tools.mkdir(parents=True)
    (tools / "gtkwave").write_text('#!/bin/sh\nset -e\nfor file; do test -s "$file"; done\necho shows "$@"\n')
    (tools / "gtkwave").chmod(0o755)
    return copy


@pytest.fixture(scope="module")
def said(checkout):
    """Run the page; return each block of commands with its result and the output shown on the page."""
    drop = {"SIM", "MAKEFLAGS", "MAKELEVEL", "MFLAGS", "PYTEST_ADDOPTS", "PYTEST_CURRENT_TEST", "IK_CORES"}
    env = {name: value for name, value in os.environ.items() if name not in drop and "XDIST" not in name}
    env["PATH"] = f"{checkout / 'build' / 'tools'}{os.pathsep}{env['PATH']}"
    steps = []
    for commands, lines in blocks(PAGE.read_text(encoding="utf-8")):
        if not commands:
            steps[-1][2].append(lines)
            continue
        script = "\n".join(lines)
        # bash, the shell of most readers, reads test_sections[lean-32] as a pattern that matches no file
        done = subprocess.run(
            ["bash", "-c", script],
            cwd=checkout,
            env=env,
            text=True,
            check=False,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
        )
        steps.append((script, done, []))
    return steps


@pytest.mark.cost(40)
def test_what_the_page_says_is_printed_is_printed(said):
    """All commands run, simulations find the bug, and every line on the page is printed."""
    assert [step[0].split()[0] for step in said] == [
        "sed",
        "make",
        "gtkwave",
        "gtkwave",
        ".venv/bin/python",
        ".venv/bin/python",
    ]
    assert sum(len(shown) for _, _, shown in said) == 3
    for script, done, shown in said:
        finds = script.splitlines()[-1].startswith(("make", ".venv/bin/python -m pytest"))
        assert bool(done.returncode) == finds, f"{script}\n{done.stdout}"
        assert "cga-ik: " not in done.stdout, "set-up found something to do"
        lines = [line.rstrip() for line in done.stdout.splitlines()]
        if "pytest" in script:  # each line has a logger's prefix
            lines = [re.sub(r"^INFO +cocotb:\S+ +", "", line) for line in lines]
        for expected in shown:
            assert missing(expected, lines) is None, f"{script}\n{missing(expected, lines)}\n{done.stdout}"


def test_the_marker_stands_where_the_page_says(said, checkout):
    """Both save files mark the node and time named on the page and have its labels."""
    text = PAGE.read_text(encoding="utf-8")
    for name, says in (
        ("aligned", r"column of the first target that differs, at (\d+) ns"),
        ("waves", r"The marker stands in clock \d+, at (\d+) ns"),
    ):
        lines = (checkout / "build" / "follow" / f"{name}.gtkw").read_text(encoding="utf-8").splitlines()
        (at,) = re.findall(says, " ".join(text.split()))
        assert f"*-15.000000 {at}000 " in "\n".join(lines), name
        assert "+{i_1 (L53) +34} " in lines[lines.index("[color] 1") + 1] + lines[lines.index("[color] 1") + 2]
        assert sum(bool(re.match(r"\+{(wi_c \(L52\)|w_sum \(L53\)) \+33} ", line)) for line in lines) == 2
    assert all(label in text for label in ("`i_1 (L53) +34`", "`wi_c` and `w_sum` have the label +33"))


def test_a_line_that_is_not_printed_is_missing():
    """Test `missing` itself: pieces must be contiguous and in order."""
    said = ["a", "b", "c", "d"]
    assert missing(["a", "b", "...", "d"], said) is None
    assert missing(["a", "c"], said) == "a"
    assert missing(["c", "...", "a"], said) == "a"
    assert missing(["x"], said) == "x"
