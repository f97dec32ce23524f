# SPDX-License-Identifier: Apache-2.0
"""Tests of all commands: bad input gives one line and status 2, help lists the options, make passes variables on."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from scripts import coverage, follow, formal, run, soak
from scripts.fpga import measure
from scripts.paper import __main__ as paper
from scripts.playground import page as playground
from scripts.report import page
from tb.core import hardest
from tb.sim.env import ROOT, environment

MAINS = {
    "run": run.main,
    "follow": follow.main,
    "report": page.main,
    "soak": soak.main,
    "formal": formal.main,
    "paper": paper.main,
    "fpga": measure.main,
    "playground": playground.main,
    "coverage": coverage.main,
}

BAD_INPUT = [
    ("run --sim modelsim", "argument --sim: unknown simulator 'modelsim'; valid: icarus, verilator"),
    ("run --datapath lean2", "argument --datapath: unknown datapath 'lean2'; valid: lean, "),
    ("run --datapath lean,lean", "argument --datapath: 'lean,lean' is not up to 3 different ones"),
    ("run --datapath lean,", "argument --datapath: unknown datapath ''"),
    ("run --width 33", "argument --width: unknown width '33'; valid: 16 to 32 bits"),
    ("run --width x", "argument --width: unknown width 'x'"),
    ("run --datapath lean,fold --width 23", "argument --width: the fold datapath has words of 20, 22, "),
    ("run --cores fast", "argument --cores: unknown cores 'fast'; valid: behavioural, digit"),
    ("run --speed 9", "--speed"),
    ("run --traj reach", "--traj"),
    ("run --out", "--out"),
    ("run --out=", "argument --out: the name of a folder is empty"),
    ("run --out file", "argument --out: cannot write in 'file': File exists"),
    ("run --out file/sub", "argument --out: cannot write in 'file/sub': Not a directory"),
    ("run --out o", "argument --out: 'o/score.json' is a folder"),
    ("run --out locked", "argument --out: cannot write in 'locked': Permission denied"),
    ("run --trajectory reech", "argument --trajectory: unknown trajectory 'reech'; valid: all, reach, circle, "),
    ("run --trajectory none.csv", "none.csv: no such file"),
    ("run --trajectory none/none", "none/none: no such file"),
    ("run --trajectory folder", "folder: is a directory"),
    ("run --trajectory locked.csv", "locked.csv: cannot be read: Permission denied"),
    ("run --trajectory bad.csv", "bad.csv: row 3, column y: 'two' is not a number"),
    ("run --trajectory none.bvh", "none.bvh: cannot be read: No such file"),
    ("run --trajectory t.csv --d1 0", "argument --d1: '0' is not positive"),
    ("run --trajectory t.csv --d1 nan", "argument --d1: 'nan' is not a finite number"),
    ("run --trajectory t.csv --phi abc", "argument --phi: 'abc' is not a number"),
    ("run --trajectory reach --d1 0.4", "argument --d1: goes with a CSV file, not with a built-in trajectory (reach)"),
    ("run --trajectory none.bvh --d1 1", "argument --d1: goes with a CSV file, not with a BVH clip"),
    ("run --trajectory none.bvh --arm up", "argument --arm: unknown arm 'up'; valid: both, left, right"),
    ("run --trajectory t.csv --axis torso", "argument --axis: torso goes with a BVH clip, not with a CSV file"),
    ("run --trajectory t.csv --phi clip", "argument --phi: clip goes with a BVH clip"),
    ("run --joints a,b,c", "argument --joints: goes with a BVH clip"),
    ("run --axis up", "argument --axis: axis 'up' is none of z, -z, x"),
    ("run --bar 0", "argument --bar: '0' is not positive"),
    ("report --waves", "--waves"),
    ("report --out o", "argument --out: 'o/report.html' is a folder"),
    ("follow", "--target"),
    ("follow --target -1", "argument --target: '-1' is not a whole number of at least 0"),
    ("follow --target 1e1", "argument --target: '1e1' is not a whole number"),
    ("follow --target 100", "argument --target: reach has targets 0 to 99, not 100"),
    ("follow --target 0 --trajectory all", "argument --trajectory: "),
    ("follow --target 0 --datapath lean,paper", "argument --datapath: unknown datapath 'lean,paper'"),
    ("follow --target 0 --waves --out file", "argument --out: cannot write in 'file': File exists"),
    ("soak --targets 0", "argument --targets: '0' is not a whole number of at least 1"),
    (f"soak --targets {'9' * 400}", "argument --targets: "),
    ("soak --seed -1", "argument --seed: "),
    ("soak --from 1.5", "argument --from: "),
    ("soak --out o", "argument --out: 'o/hardest.csv' is a folder"),
    ("soak --again none.csv", "none.csv: cannot be read: No such file"),
    ("soak --again file --seed 0", "argument --seed: "),
    ("soak --farm x", "argument --farm: "),
    ("coverage --only x --keep", "argument --keep: not with --only"),
    ("formal --only nothing", "argument --only: "),
    ("paper --only table7", "argument --only: unknown part 'table7'"),
    ("playground --width 17", "no such machine; there are lean-W32, "),
    ("fpga --datapath lean2", "unknown datapath 'lean2'"),
]


@pytest.fixture
def inputs():
    """Files and folders named in BAD_INPUT; calls drop root's rights, which override permissions."""
    for folder in ("folder", "o/score.json", "o/report.html", "o/hardest.csv"):
        Path(folder).mkdir(parents=True)
    for folder in (".", "o"):
        Path(folder).chmod(0o777)
    Path("locked").mkdir(mode=0o500)
    Path("file").touch()
    Path("locked.csv").touch(mode=0o200)
    Path("t.csv").write_text("x,y,z\n0.3,0.1,-0.2\n", encoding="utf-8")
    Path("bad.csv").write_text("x,y,z\n.1,.2,.3\n.1,two,.3\n", encoding="utf-8")
    user = os.geteuid()
    yield lambda: os.seteuid(user or 65534)
    os.seteuid(user)


@pytest.mark.parametrize(("words", "message"), BAD_INPUT)
def test_bad_input_is_one_line_and_status_2(command, inputs, monkeypatch, tmp_path, words, message):
    for module in (run, follow):
        monkeypatch.setattr(module, "simulate", lambda *_, **__: pytest.fail("simulates"))
    monkeypatch.setattr(hardest, "LIST", tmp_path / "kept.csv")
    before = sorted(Path().rglob("*"))
    name, *options = words.split()
    if "locked" in words:
        inputs()
    status, out, err = command(MAINS[name], *options)
    assert (status, out, len(err)) == (2, [], 1), err
    assert err[0].startswith(f"{name}: ") and message in err[0]
    assert sorted(Path().rglob("*")) == before


OPTIONS = {
    "run": "trajectory out sim datapath width cores waves axis arm joints d1 d2 phi bar list",
    "follow": "target trajectory out sim datapath width cores waves axis arm joints d1 d2 phi bar",
    "report": "trajectory out sim datapath width d1 d2 phi",
    "soak": "targets seed from datapath width sim out keep again",
    "coverage": "only keep",
    "formal": "only",
    "fpga": "datapath width",
    "paper": "only",
    "playground": "out datapath width",
}


@pytest.mark.parametrize("name", OPTIONS)
def test_help_names_every_option(name, capsys):
    with pytest.raises(SystemExit) as stopped:
        MAINS[name](["--help"])
    printed = capsys.readouterr().out
    assert stopped.value.code == 0 and "Exit status: 0 " in printed
    assert all(f"\n  --{option}" in printed for option in OPTIONS[name].split())


def test_the_exit_status_of_the_process():
    words = [sys.executable, "-m", "scripts.run", "--trajectory", "none.csv"]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (2, "", "run: none.csv: no such file\n")


# -- make ------------------------------------------------------------------------------------------


def dry_run(*words, cwd=ROOT):
    """Run make -n without SIM in the environment."""
    env = {name: value for name, value in environment().items() if name != "SIM"}
    return subprocess.run(["make", "-n", *words], cwd=cwd, env=env, capture_output=True, text=True, check=False)


RUN = "TRAJECTORY OUT DATAPATH WIDTH AXIS ARM JOINTS D1 D2 PHI BAR"


@pytest.mark.parametrize(
    ("target", "needs", "sim", "variables", "switches"),
    [
        ("run", "icarus", "icarus", RUN, "WAVES"),
        ("report", "icarus", "icarus", RUN, ""),
        ("follow", "icarus", "icarus", f"{RUN} TARGET", "WAVES"),
        ("soak", "verilator farm", "verilator", "TARGETS SEED DATAPATH WIDTH OUT AGAIN FROM FARM", "KEEP"),
        ("coverage", "verilator coverage", "", "ONLY", "KEEP"),
        ("formal", "fpga", "", "ONLY", ""),
    ],
)
def test_make_passes_the_variables_of_a_target(target, needs, sim, variables, switches):
    given = [*(f"{name}=x" for name in variables.split()), *(f"{name}=1" for name in switches.split())]
    done = dry_run(target, *given)
    command = done.stdout.replace("\\\n", " ")
    started = command.split(" -m scripts.")[1].split()
    assert re.findall(r"bootstrap.py (.*)", command) == [needs]
    options = [f'--{name.lower()}="$CGA_{name}"' for name in variables.split()]
    options += [f"--{name.lower()}" for name in switches.split()] + (["--sim", sim] if sim else [])
    assert started[0] == target and sorted(started[1:]) == sorted(options)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("run sim=verilator", "make run takes no variable sim: perhaps SIM is meant"),
        ("report WAVES=1", "make report takes no variable WAVES: it takes ARM, AXIS, BAR, "),
        ("X=1", "make help takes no variable X: it takes none"),
        ("run WAVES=no", "WAVES=no: use 1 or 0"),
        ("run SIM=questa", "unknown simulator SIM=questa"),
        ("test CORES=fast", "unknown cores CORES=fast: use behavioural or digit"),
    ],
)
def test_make_refuses_bad_variables(words, message):
    done = dry_run(*words.split())
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1), done
    assert f"*** {message}" in done.stderr


def test_make_replaces_the_shell_by_the_command():
    """A shell in between would be ended by SIGTERM to make, while command and simulator continue."""
    text = (ROOT / "Makefile").read_text()
    last = re.findall(r"^\t@.*\$\(VENV\) .*\n(?!\t)", text, re.MULTILINE)
    assert last and all("exec $(VENV) " in line for line in last)
