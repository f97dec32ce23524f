# SPDX-License-Identifier: Apache-2.0
"""Tests of the environment for simulators, the choice of dividers and roots, the start of simulations and subprocesses,
and the file lists with their digest."""

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from fnmatch import fnmatch
from pathlib import Path
from unittest.mock import patch

import pytest
from cocotb.triggers import Event
from cocotb_test.simulator import Icarus

from tb.sim import runner, shared, subprocesses
from tb.sim.env import ROOT, cores, environment, simulator, verilator_root
from tb.sim.sources import closure, code, digest, headers, sources
from tb.sim.timeout import timed_test


def test_environment_puts_the_packaged_verilator_first(tmp_path, monkeypatch):
    (tmp_path / "verilator").touch(0o755)
    base = {"PATH": f"{tmp_path}:/usr/bin", "MAKEFLAGS": " -- OUT=x", "WAVES": "1", "VERILATOR_ROOT": "/old"}
    monkeypatch.setattr(os, "environ", base)
    env = environment()
    assert env["VERILATOR_ROOT"] == str(verilator_root())
    assert shutil.which("verilator", path=env["PATH"]) == str(verilator_root() / "bin" / "verilator")
    assert "MAKEFLAGS" not in env and "WAVES" not in env
    monkeypatch.setattr(os, "environ", env)
    assert environment() == env


@pytest.mark.parametrize(
    ("choose", "variable", "default", "other", "message"),
    [
        (simulator, "SIM", "icarus", "verilator", "wrong.*icarus or verilator"),
        (cores, "IK_CORES", "behavioural", "digit", "unknown cores 'wrong': use behavioural or digit"),
    ],
)
def test_the_environment_chooses(monkeypatch, choose, variable, default, other, message):
    monkeypatch.delenv(variable, raising=False)
    assert choose() == default and choose(other) == other
    monkeypatch.setenv(variable, other)
    assert choose() == other and choose(default) == default
    monkeypatch.setenv(variable, "wrong")
    with pytest.raises(ValueError, match=message):
        choose()


def test_every_module_above_a_core_has_the_parameter():
    """Check that DIGIT reaches every divider and root: all modules above them have the parameter and pass it on."""
    texts = {path.stem: path.read_text() for path in sources()}
    have = {name for name, text in texts.items() if re.search(r"parameter integer DIGIT\b", text)}
    assert {"ik_axis", "ik_paper", "ik_div", "ik_root"} < have
    for name, text in texts.items():
        uses = re.findall(rf"\b({'|'.join(sorted(have))})\s*#\(", re.sub(r"module\s+ik_\w+\s*#\(", "", text))
        assert not uses or name in have, f"{name} uses {uses} and has no DIGIT"
        assert len(re.findall(r"\.DIGIT\s*\(DIGIT\)", text)) == len(uses), name


@pytest.fixture
def icarus():
    """Replace cocotb-test's Icarus with a mock, which records the options of each call."""
    with patch.object(runner, "Icarus") as icarus:
        yield icarus


def test_the_parameter_goes_to_tops_that_have_it(icarus, monkeypatch):
    """Check that `digit` sets DIGIT of tops that have it, unless the test sets it; `behavioural` adds no parameter."""

    def parameters(toplevel, core=None, **others):
        runner.simulate(toplevel, "tb.none", parameters=others, sim="icarus", core=core)
        return icarus.call_args.kwargs["parameters"]

    monkeypatch.setenv("IK_CORES", "digit")
    assert parameters("ik_axis", W=18, DATAPATH=0) == {"W": 18, "DATAPATH": 0, "DIGIT": 1}
    assert parameters("ik_axis", core="behavioural", W=18) == {"W": 18}
    assert parameters("ik_axis", DIGIT=0) == {"DIGIT": 0}
    assert parameters("ik_arm", W=18) == {"W": 18}


def test_handlers_of_signals_come_back(icarus):
    """Check that signal handlers are restored: cocotb-test's handlers would turn a later Ctrl-C into AssertionError."""
    before = signal.getsignal(signal.SIGINT)
    icarus().run.side_effect = lambda: signal.signal(signal.SIGINT, lambda *_: None)
    runner.simulate("ik_guard", "tb.none", sim="icarus")
    assert signal.getsignal(signal.SIGINT) is before


def test_a_changed_header_is_compiled_again(icarus, tmp_path, monkeypatch):
    """Check that a newer header forces a build; cocotb-test compares only the ages of sources."""
    monkeypatch.setattr(runner, "BUILD", tmp_path)
    folder = tmp_path / "icarus" / "ik_trig"
    built = Path(Icarus(toplevel="ik_trig", module="none", verilog_sources=[], sim_build=str(folder)).sim_file)
    built.touch()
    newest = max(path.stat().st_mtime for path in headers())
    for age in (1, -1):
        os.utime(built, (newest + age, newest + age))
        runner.simulate("ik_trig", "none", sim="icarus")
    forced = [call.kwargs["force_compile"] for call in icarus.call_args_list]
    assert forced == [False, False, True, True]  # each call compiles, then runs


@timed_test(0.001)
async def forever(dut):
    await Event().wait()


@timed_test()
async def busy(dut):
    time.sleep(600)


@pytest.mark.parametrize(
    ("test", "message"),
    [
        ("forever", r"no end after 0.001 ms; it waits in tb/sim/test_runner.py, line \d+: await Event\(\).wait\(\)"),
        ("busy", r"(iverilog|vvp) was ended after 3 s"),
    ],
)
def test_a_test_that_hangs_is_ended(test, message, monkeypatch):
    monkeypatch.setattr(shared, "SECONDS", 3 if test == "busy" else 60)
    options = {"sim": "icarus", "module": "tb.sim.test_runner", "env": {"COCOTB_TEST_FILTER": test}}
    with pytest.raises(pytest.fail.Exception, match=message):
        shared.passes(f"hangs-{test}", toplevel="ik_delay", **options)


RTL, CORE_PAGE = ROOT / "rtl", ROOT / "docs" / "core.md"


def test_the_lists_name_every_file_and_header_once():
    modules = sorted(RTL.rglob("*.v"))
    assert sorted(sources()) == modules, f"name each once in rtl/*.f: {sorted({*sources()} ^ {*modules})}"
    index = [f"{'*' * name.startswith('_')}{name}" for name in re.findall(r"`([\w*]+)`", CORE_PAGE.read_text())]
    missing = [path.stem for path in modules if not any(fnmatch(path.stem, name) for name in index)]
    assert not missing, f"docs/core.md, Modules, names no {missing}"
    assert sorted(headers()) == sorted(RTL.rglob("*.vh"))
    text = "".join(path.read_text() for path in [*sources(), *headers()])
    assert set(re.findall(r'`include\s+"([^"]+)"', text)) == {path.name for path in headers()}


def test_closure_is_all_a_module_needs_and_no_more():
    files = closure("ik_lean")
    names = {path.name for path in files}
    assert files[0] == RTL / "lean/ik_lean.v"
    assert {"ik_rsqrt.v", "ik_rsqrt_table.vh", "ik_delay.v", "ik_lean_nodes.vh"} <= names
    assert not names & {"ik_axis.v", "ik_div.v", "ik_paper.v"}
    assert closure("ik_none") == []


VERILOG = "assign q = a & b;\n"
COMMENTED = "// a comment\nassign q = /* another,\n of two lines */ a &\n    b;  // and one\n"
PYTHON = 'def f(a):\n    return f"{a} # no comment"\n'
DOCUMENTED = (
    '"""What it is for."""\n\n# a comment\ndef f(a):  # another\n    """What f is\n    for."""\n\n'
    '    return f"{a} # no comment"\n'
)


@pytest.mark.parametrize(
    ("name", "before", "after", "same"),
    [
        ("a.v", VERILOG, COMMENTED, True),
        ("a.py", PYTHON, DOCUMENTED, True),
        ("a.v", VERILOG, VERILOG.replace("&", "|"), False),
        ("a.v", '$display("a  // b");', '$display("a // b");', False),
        ("a.py", PYTHON, PYTHON.replace("# no", "# a"), False),
        ("a.py", "if a:\n    b()\nc()\n", "if a:\n    b()\n    c()\n", False),
        ("a.py", 'a = """one"""\n', 'a = """two"""\n', False),
    ],
)
def test_a_digest_is_of_the_code_without_comments_and_blanks(tmp_path, name, before, after, same):
    path = tmp_path / name
    path.write_text(before)
    was = digest([path])
    path.write_text(after)
    assert (digest([path]) == was) == same, code(path)
    assert digest([path, path]) != digest([path]), "a second file counts"


PARENT = """
import os, subprocess, sys, tempfile
child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
tempfile.mkstemp()
print(os.getpid(), child.pid, flush=True)
child.wait()
"""


def alive(pid: int) -> bool:
    """Return True if the process runs and is no zombie."""
    stat = Path(f"/proc/{pid}/stat")
    return stat.exists() and stat.read_text().rsplit(")", 1)[1].split()[0] != "Z"


def test_the_whole_group_ends_and_its_temporary_files_are_in_one_folder(tmp_path):
    words, pipe = [sys.executable, "-c", PARENT], {"stdout": subprocess.PIPE, "text": True}
    with pytest.raises(KeyboardInterrupt), subprocesses.started(words, tmp_path, **pipe) as process:
        pids = [int(pid) for pid in process.stdout.readline().split()]
        assert len(pids) == 2 and all(map(alive, pids))
        raise KeyboardInterrupt
    assert not any(map(alive, pids))
    assert len(list(tmp_path.iterdir())) == 1
