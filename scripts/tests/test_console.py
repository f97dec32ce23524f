# SPDX-License-Identifier: Apache-2.0
"""Test scripts/console.py: make variables, exit status, signals, progress. Test that all commands print one line on
stderr and exit with status 2 for bad input, and that --help lists the exit statuses."""

import importlib
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from scripts import console, trajectory
from tb.core import worst_targets
from tb.sim.env import ROOT, environment
from tb.sim.test_runner import alive

OPTIONS = [
    console.option("--count", "", console.whole(2), default=3),
    console.option("--from", "", str),
    console.option("--out", "", Path),
    console.switch("--keep", ""),
]


@pytest.mark.parametrize(
    ("error", "status", "message"),
    [
        (console.InputError("no"), 2, "no"),
        (console.Stopped(signal.SIGINT), 130, "interrupted"),
        (OSError(28, "disk full", "a/b"), 2, "cannot read or write 'a/b': disk full"),
        (OSError(28, "disk full"), 2, "cannot read or write a file: disk full"),
    ],
)
def test_errors_become_a_status_and_one_line(error, status, message, capsys):
    def work(_):
        raise error

    assert console.command("some", OPTIONS)(work)([]) == status
    assert capsys.readouterr().err == f"some: {message}\n"


@pytest.mark.parametrize(
    ("words", "values"),
    [
        ([], (3, None, None, False)),
        (["COUNT=5", "FROM=a=b $x", "OUT=~/x", "KEEP=1"], (5, "a=b $x", Path.home() / "x", True)),
        (["--count", "5", "FROM=", "KEEP=0"], (5, None, None, False)),
        (["COUNT=1"], "argument COUNT=: 1 is not in the range x>=2."),
        (["KEEP=yes"], "KEEP=yes: use 1 or 0"),
        (["count=5"], "unknown variable count=; known: COUNT, FROM, HELP, KEEP, OUT"),
    ],
)
def test_variables_of_make_are_options(monkeypatch, capsys, words, values):
    monkeypatch.setattr(console, "end_with_parent", lambda: None)
    monkeypatch.setenv("MAKELEVEL", "1")
    parsed = []
    status = console.command("some", OPTIONS)(lambda options: parsed.append(options) or 0)(words)
    if isinstance(values, str):
        assert (status, capsys.readouterr().err) == (2, f"some: {values}\n")
    else:
        (options,) = parsed
        assert status == 0 and (options.count, options.from_, options.out, options.keep) == values


def test_progress_is_printed_while_nothing_gets_done(monkeypatch, capsys):
    monkeypatch.setattr(console, "EVERY", 0.01)
    with console.progress("some", 5000) as meter:
        meter(1000, "half [3/4]")
        time.sleep(0.5)
    lines = capsys.readouterr().err.splitlines()
    assert lines and lines[-1].startswith("some: half [3/4]: 1000 of 5000 done after ")


COMMAND = """
import os, sys, tempfile
from scripts.console import command
from tb.sim.subprocesses import started

@command("some")
def main(_):
    with tempfile.TemporaryDirectory() as folder, started(["sleep", "600"], folder) as simulator:
        print(os.getpid(), simulator.pid, flush=True)
        return simulator.wait()

sys.exit(main())
"""


@pytest.mark.parametrize(
    ("number", "send", "message"), [(signal.SIGINT, os.killpg, "interrupted"), (signal.SIGKILL, os.kill, "terminated")]
)
def test_a_signal_ends_command_and_simulator(tmp_path, number, send, message):
    """Send SIGINT to the process group, as a terminal does, or SIGKILL to make alone."""
    (tmp_path / "command.py").write_text(COMMAND)
    (tmp_path / "Makefile").write_text(f"run:\n\t@PYTHONPATH={ROOT} exec {sys.executable} command.py\n")
    streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "start_new_session": True, "text": True}
    words = ["env", "--default-signal", f"TMPDIR={tmp_path}", "make", "run"]
    make = subprocess.Popen(words, cwd=tmp_path, env=environment(), **streams)
    processes = [int(pid) for pid in make.stdout.readline().split()]
    assert all(map(alive, processes))
    send(make.pid, number)
    assert f"some: {message}\n" in make.communicate(timeout=60)[1]  # also waits for the command, which shares stderr
    limit = time.monotonic() + 10
    while any(map(alive, processes)) and time.monotonic() < limit:
        time.sleep(0.05)
    assert not any(map(alive, processes)) and sorted(os.listdir(tmp_path)) == ["Makefile", "command.py"]


COMMANDS = {
    decorator[1]: ".".join(path.relative_to(ROOT).with_suffix("").parts)
    for path in sorted([*ROOT.glob("scripts/**/*.py"), *ROOT.glob("examples/**/*.py")])
    if "tests" not in path.parts
    and (decorator := re.search(r'^@command\(\s*"([\w.]+)"', path.read_text(), re.MULTILINE))
}
"""Command -> its module."""


def main_of(name):
    return importlib.import_module(COMMANDS[name]).main


VCD = "$scope module {} $end\n$var wire 1 ! clk $end\n$upscope $end\n$enddefinitions $end\n"

POSES = "x,y,z,qw,qx,qy,qz,t\n.1,0,.3,1,0,0,0,2\n.1,0,.3,1,0,0,0,{}\n"

BAD_INPUT = [
    ("run --datapath lean,lean", "--datapath 'lean,lean'"),
    ("run --datapath lean,fold --width 23", "--width fold 20, 22,"),
    ("run --out o", "--out 'o/score.json' folder"),
    ("run --trajectory o/results.csv --out o", "--out input 'o/results.csv'"),
    ("run --trajectory reech", "--trajectory 'reech' all, reach, circle,"),
    ("run --trajectory bad.csv", "bad.csv: row 3, column y: 'two'"),
    ("run --trajectory t.csv --d1 0", "--d1 0.0"),
    ("run --trajectory reach --d1 0.4", "--d1 (reach)"),
    ("run --trajectory t.csv --axis torso", "--axis torso (t.csv)"),
    ("run --trajectory t.csv --pole Hips", "--pole 'Hips' BVH (t.csv)"),
    ("run --axis up", "--axis 'up' z, -z, x"),
    ("run --trajectory pick_and_place --robot kuka", "--robot 'kuka' iiwa14, human, URDF"),
    ("run --trajectory pick_and_place --robot in.urdf", "--robot in.urdf: not a URDF", "<robot>"),
    ("run --trajectory pick_and_place --robot iiwa14 --base l1", "--base --tip URDF"),
    ("run --trajectory t.csv --robot iiwa14 --d1 2", "--robot and --d1"),
    ("run --trajectory circle --robot iiwa14", "--robot circle qw,qx,qy,qz"),
    ("run --trajectory in.csv --soft 0.1", "--soft wrist targets", POSES.format(3)),
    ("run --trajectory in.csv --robot iiwa14", "row 3, column t: '2' is not after '2' of row", POSES.format(2)),
    ("run --trajectory in.csv --robot iiwa14", "row 3, column t: 'noon' is not a time in", POSES.format("noon")),
    ("run --trajectory writing --rate 5", "--rate: applies to the joints of --robot"),
    ("run --trajectory pick_and_place --datapath paper", "--datapath paper whole arm"),
    ("follow --target 100", "--target reach 0 99, 100"),
    ("follow --target 0 --trajectory all", "--trajectory --target"),
    ("soak --special --from 1000000", "--from"),
    ("soak --worst 1 --datapath paper", "--worst: lean arm"),
    ("waves in.vcd paper 32 o.gtkw", "in.vcd: 1:2: Expected id code", "x y z\n"),
    ("waves in.vcd paper 32 o.gtkw", "no module ik_axis", VCD.format("top")),
    ("waves in.vcd lean 32 o.gtkw", "no ik_axis.rst", VCD.format("ik_axis")),
    ("lint ik_none", "ik_none"),
    ("mutants --only nothing", "--only 'nothing'"),
    ("mutants --only lean --keep", "--keep --only"),
    ("formal --only nothing", "--only 'nothing'"),
    ("playground --width 17", "lean-W32,"),
    ("table6 --only fortran", "c-lean-double-chain"),
    ("test quick --only ik_mull", "no module ik_mull; similar names: ik_mul,"),
]
"""Rows: command line, words of its error message, and optionally content of the input file `in.*`."""


@pytest.mark.parametrize("row", BAD_INPUT, ids=lambda row: row[0][:60])
def test_bad_input_is_one_line_and_status_2(command, files, monkeypatch, tmp_path, row):
    monkeypatch.setattr(trajectory, "simulate", lambda *_, **__: pytest.fail("simulates"))
    monkeypatch.setattr(worst_targets, "LIST", tmp_path / "kept.csv")
    Path("o/score.json").mkdir(parents=True)
    for path in ("t.csv", "o/results.csv"):
        Path(path).write_text("x,y,z\n0.3,0.1,-0.2\n", encoding="utf-8")
    Path("bad.csv").write_text("x,y,z\n.1,.2,.3\n.1,two,.3\n", encoding="utf-8")
    words, message, *content = row
    name, *options = words.split()
    for text in content:
        (file,) = (word for word in options if word.startswith("in."))
        Path(file).write_text(text, encoding="utf-8")
    before = files()
    status, out, err = command(main_of(name), *options)
    assert (status, out, len(err)) == (2, [], 1), err
    assert all(word in err[0] for word in (f"{name}: ", *message.split())), err
    assert files() == before


def test_help(command):
    for name in COMMANDS:
        status, out, err = command(main_of(name), "--help")
        assert (status, err) == (0, []) and any("Exit status: 0 " in line for line in out), name


def test_the_exit_status_of_the_process():
    words = [sys.executable, "-m", "scripts.run", "--trajectory", "none.csv"]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (2, "", "run: none.csv: no such file\n")
