# SPDX-License-Identifier: Apache-2.0
"""The Makefile: help, values passed to commands as typed, calls from another folder."""

import json
import re
import shutil
import subprocess
import sys

import pytest

from scripts.setup.tests.test_bootstrap import script
from tb.sim.env import ROOT, environment


def make(*words, cwd=ROOT, **env):
    env = {name: value for name, value in environment().items() if name != "SIM"} | env
    return subprocess.run(["make", *words], cwd=cwd, env=env, capture_output=True, text=True, timeout=60, check=False)


def test_help_is_the_default():
    printed = make("help").stdout
    assert make().stdout == printed and "make run" in printed
    taken = make("-n", "run", "x=1").stderr.strip().partition(" it takes ")[2].removesuffix(".  Stop.").split()
    (line,) = (line for line in printed.splitlines() if line.startswith("  make run "))
    assert taken and [name for name in taken if f" {name}=" not in line.replace("[", " ")] == []


@pytest.fixture
def stand_in(tmp_path):
    """A checkout that is set up and whose commands print their arguments."""
    root = tmp_path / "a checkout"
    (root / "scripts" / "setup").mkdir(parents=True)
    shutil.copy(ROOT / "Makefile", root)
    (root / "scripts" / "setup" / "bootstrap.py").write_text("")
    for command in ("pytest", "scripts/run"):
        (root / f"{command}.py").write_text("import json, sys\nprint(json.dumps(sys.argv[1:]))\n")
    (root / ".venv" / "bin").mkdir(parents=True)
    script(root / ".venv" / "bin" / "python", f'exec "{sys.executable}" "$@"\n')

    def run(*words, target="run", **env):
        done = make(target, *words, cwd=root, **env)
        assert done.returncode == 0, done.stderr
        there = {path.name for path in root.iterdir()} - {"__pycache__"}
        assert there == {".venv", "Makefile", "pytest.py", "scripts"}
        return json.loads(done.stdout)

    return run


def test_only_values_on_the_command_line_are_passed(stand_in, tmp_path):
    """Environment variables have no effect, Python's included."""
    (tmp_path / "json.py").write_text("raise SystemExit('a wrong json')")
    env = {"OUT": "x", "WIDTH": "3", "PYTHONPATH": str(tmp_path), "PYTHONHOME": "/nowhere", "PYTHONSAFEPATH": "1"}
    assert stand_in("DATAPATH=", "WAVES=0", "SIM=verilator", **env) == ["--sim", "verilator"]


@pytest.mark.parametrize(
    ("target", "words", "arguments"),
    [
        ("test", [], ["-m", "not release and not slow"]),
        ("test", ["SIM=verilator"], ["-m", "not release and sim and not slow"]),
        ("test-all", ["SIM=verilator"], ["-m", "not release and sim"]),
        ("test", ["ONLY=scripts/run.py::test_x[1]"], ["scripts/run.py::test_x[1]", "-m", "not release"]),
        ("test", ['ONLY=a $(touch made) "b'], ["-k", 'a $(touch made) "b', "-m", "not release"]),
    ],
)
def test_which_tests_run(stand_in, target, words, arguments):
    assert stand_in(*words, target=target)[-len(arguments) :] == arguments


VALUE = "a folder/with spaces 'b \" $(touch made)$(shell touch made)`touch made` ${HOME}$HOME$$; #a, b)*\ntouch made\\"


def test_a_value_arrives_as_it_was_typed(stand_in):
    assert stand_in("OUT=" + VALUE) == ["--sim", "icarus", "--out=" + VALUE]


def test_make_from_another_folder(stand_in, tmp_path):
    """Paths are relative to that folder; targets that change the checkout are refused, and so are spaces."""
    for makefile, target, message in (
        (ROOT / "Makefile", "clean", "make clean works in its own folder"),
        (tmp_path / "a checkout/Makefile", "run", "make -f takes no path with spaces: use make -C"),
    ):
        done = make("-n", "-f", str(makefile), target, cwd=tmp_path)
        assert (done.returncode, done.stdout) == (2, "") and message in done.stderr
    done = make("-n", "-f", str(ROOT / "Makefile"), "run", cwd=tmp_path)
    assert f"exec env PYTHONPATH={ROOT}/ {ROOT}/.venv/bin/python -m scripts.run" in done.stdout


RUN = "TRAJECTORY OUT DATAPATH WIDTH AXIS ARM LIMB JOINTS UP TWIST SCALE D1 D2 PHI POLE SOFT BAR"


@pytest.mark.parametrize(
    ("target", "needs", "sim", "variables", "switches"),
    [
        ("run", "icarus", "icarus", RUN, "WAVES"),
        ("report", "checkout icarus", "icarus", RUN, ""),
        ("follow", "icarus", "icarus", f"{RUN} TARGET", "WAVES"),
        ("soak", "verilator farm", "verilator", "TARGETS SEED DATAPATH WIDTH OUT AGAIN FROM FARM", "KEEP"),
        ("coverage", "checkout verilator", "", "ONLY", "KEEP"),
        ("formal", "checkout fpga", "", "ONLY", ""),
    ],
)
def test_make_passes_the_variables_of_a_target(target, needs, sim, variables, switches):
    given = [*(f"{name}=x" for name in variables.split()), *(f"{name}=1" for name in switches.split())]
    done = make("-n", target, *given)
    command = done.stdout.replace("\\\n", " ")
    started = command.split(" -m scripts.")[1].split()
    assert re.findall(r"bootstrap.py (.*)", command) == [needs]
    options = [f'--{name.lower()}="$CGA_{name}"' for name in variables.split()]
    options += [f"--{name.lower()}" for name in switches.split()] + (["--sim", sim] if sim else [])
    assert started[0] == target and sorted(started[1:]) == sorted(options)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("run sim=verilator", "make run takes no variable sim: it takes ARM AXIS BAR "),
        ("report WAVES=1", "make report takes no variable WAVES: it takes ARM AXIS BAR "),
        ("X=1", "make help takes no variable X: it takes none"),
        ("run WAVES=no", "WAVES=no: use 1 or 0"),
        ("run SIM=questa", "unknown simulator SIM=questa"),
        ("test CORES=fast", "unknown cores CORES=fast: use behavioural or digit"),
    ],
)
def test_make_refuses_bad_variables(words, message):
    done = make("-n", *words.split())
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1), done
    assert f"*** {message}" in done.stderr


def test_make_replaces_the_shell_by_the_command():
    """A shell in between would be ended by SIGTERM to make, while command and simulator continue."""
    text = (ROOT / "Makefile").read_text()
    last = re.findall(r"^\t@.*\$\(VENV\) .*\n(?!\t)", text, re.MULTILINE)
    assert last and all("exec $(VENV) " in line for line in last)
