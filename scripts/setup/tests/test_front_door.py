# SPDX-License-Identifier: Apache-2.0
"""The Makefile: help, values passed to commands as typed, calls from another folder."""

import json
import shutil
import subprocess
import sys

import pytest

from scripts.setup.tests.test_bootstrap import script
from tb.sim.env import ROOT, environment


def make(*words, cwd=ROOT, **env):
    env = dict(environment(), **env)
    env.pop("SIM", None)
    return subprocess.run(["make", *words], cwd=cwd, env=env, capture_output=True, text=True, timeout=60, check=False)


def test_help_is_the_default():
    printed = make("help").stdout
    assert make().stdout == printed and "make run" in printed


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
