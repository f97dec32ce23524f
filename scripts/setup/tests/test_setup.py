# SPDX-License-Identifier: Apache-2.0
"""Test scripts/setup/bootstrap.py (without network), imports of commands and tests, and the Makefile."""

import ast
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from scripts.setup import bootstrap
from tb.sim.env import ROOT, environment


def script(path, text):
    path.write_text("#!/bin/sh\n" + text)
    path.chmod(0o755)


@pytest.fixture
def path(tmp_path, monkeypatch):
    """Enter an empty checkout that is set up for Icarus. Return the only folder in PATH; its programs do nothing."""
    root, path = tmp_path / "check out", tmp_path / "bin"
    for folder in (root / ".venv" / "bin", root / "requirements", path):
        folder.mkdir(parents=True)
    for program in {program for need in ("icarus", "verilator") for program in bootstrap.PROGRAMS[need]}:
        script(path / program, "exit 0\n")
    (root / ".venv" / "bin" / "python").symlink_to(sys.executable)
    monkeypatch.setenv("PATH", str(path))
    monkeypatch.chdir(root)
    for name in ("run", "checkout", "fpga", "table6"):
        Path(bootstrap.LOCK.format(name)).write_text("numpy==1.0\n")
    bootstrap.write_stamp(["icarus"])
    return path


@pytest.fixture
def pip(path, monkeypatch):
    """Replace pip; return the list of installed lock files. If a test adds "bad" to it, installations fail."""
    installed = []
    monkeypatch.setattr(
        bootstrap, "pip_install", lambda lock: installed.append(lock) or "no hash" * ("bad" in installed)
    )
    monkeypatch.setattr(bootstrap, "make_venv", lambda: pytest.fail("makes .venv again"))
    return installed


def refused(capsys, call, *arguments):
    """Return the last line on stderr of a call that ends with status 2."""
    with pytest.raises(SystemExit) as stopped:
        call(*arguments)
    assert stopped.value.code == 2
    return capsys.readouterr().err.splitlines()[-1]


@pytest.mark.usefixtures("path")
def test_a_change_invalidates_the_stamp():
    for path, text in ((bootstrap.STAMP, "{"), (bootstrap.LOCK.format("run"), "numpy==1.1\n")):
        assert bootstrap.is_ready(["icarus"])
        before = Path(path).read_text()
        Path(path).write_text(text)
        assert not bootstrap.is_ready([])
        Path(path).write_text(before)
    os.rename(os.getcwd(), os.getcwd() + "2")
    assert not bootstrap.is_ready([])


def test_a_missing_program_is_named(path, capsys):
    (path / "vvp").unlink()
    assert not bootstrap.is_ready(["icarus"]) and bootstrap.missing(["icarus", "verilator"]) == ["vvp"]
    assert refused(capsys, bootstrap.set_up, ["graphviz"]).endswith("apt-get install -y graphviz")
    assert "unknown requirement 'netscape'" in refused(capsys, bootstrap.main, ["netscape"])


def test_an_extra_is_added_once_and_again_after_its_lock_has_changed(pip):
    for lock in ("z3-solver==1.0\n", "z3-solver==1.1\n"):
        Path(bootstrap.LOCK.format("fpga")).write_text(lock)
        bootstrap.set_up(["verilator"])  # must not mark packages of another lock file ready
        assert bootstrap.is_ready(["icarus", "verilator"]) and not bootstrap.is_ready(["fpga"])
        bootstrap.set_up(["fpga"])
        bootstrap.set_up(["fpga"])
    assert pip == ["fpga", "fpga"] and bootstrap.is_ready(["icarus", "verilator", "fpga"])


def test_an_extra_that_does_not_install(pip, capsys):
    """Set-up fails without fpga; without table6, which is optional, it only prints a line. Other needs stay ready."""
    pip.append("bad")
    assert "no hash" in refused(capsys, bootstrap.set_up, ["fpga"])
    bootstrap.set_up(["table6"])
    assert "could not add the packages of requirements/table6.lock" in capsys.readouterr().err
    assert bootstrap.is_ready(["icarus"]) and not bootstrap.is_ready(["fpga"]) and not bootstrap.is_ready(["table6"])


@pytest.mark.usefixtures("path")
def test_a_half_finished_environment_leaves_no_stamp(tmp_path, monkeypatch, capsys):
    script(tmp_path / "pip", 'echo "ERROR: no network" >&2; exit 1\n')
    venv = f'PATH=/usr/bin:/bin\nrm -rf "$5"; mkdir -p "$5/bin"; cp "{tmp_path}/pip" "$5/bin/python"'
    script(tmp_path / "python", venv)
    monkeypatch.setattr(sys, "executable", str(tmp_path / "python"))
    assert "could not make .venv: ERROR: no network (more" in refused(capsys, bootstrap.make_venv)
    assert not os.path.exists(bootstrap.STAMP)


def test_an_old_python_is_refused_by_a_file_that_it_can_parse(monkeypatch, capsys):
    ast.parse((ROOT / "scripts" / "setup" / "bootstrap.py").read_text(encoding="ascii"), feature_version=(3, 7))
    monkeypatch.setattr(sys, "version_info", (3, 9, 2))
    assert "Python 3.10 to 3.14 is needed" in refused(capsys, bootstrap.make_venv)


def test_lock_files_agree():
    """All lock files are installed into one .venv, so a package must have the same version in each."""
    versions = {}
    for lock in ("run", *bootstrap.EXTRAS):
        text = (ROOT / bootstrap.LOCK.format(lock)).read_text()
        for name, version in dict(re.findall(r"^([\w.-]+)==([^\s;]+)", text, re.M)).items():
            assert versions.setdefault(name, version) == version, lock
    assert "numpy" in versions


FRESH = """import importlib, re, sys
from importlib.metadata import packages_distributions

class Absent:
    def find_spec(self, name, *_):
        of = {re.sub("[-_.]+", "-", package).lower() for package in packages.get(name, [])}
        if of and not of & locked:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

packages, locked = packages_distributions(), {"pip", "setuptools", *sys.argv[1].split()}
sys.meta_path.insert(0, Absent())
for name in sys.argv[2:]:
    importlib.import_module(name)"""


@pytest.mark.parametrize("lock", ["run", "checkout"])
def test_commands_and_tests_can_be_imported_where_only_their_lock_file_is_installed(lock):
    """Only functions, not modules, import packages of other lock files."""
    recipes = re.findall(r"\(SETUP\) (.*)((?:\n\t.*)+)", (ROOT / "Makefile").read_text())
    mine = [recipe for needs, recipe in recipes if ("checkout" in needs.split()) == (lock == "checkout")]
    modules = {name for recipe in mine for name in re.findall(r" (scripts\.[\w.]+)", recipe)}
    modules |= {f"{name}.__main__" for name in modules if (ROOT / name.replace(".", "/") / "__main__.py").exists()}
    if "scripts.test" in modules:
        tests = [path for room in ("model", "scripts", "tb") for path in (ROOT / room).rglob("*test_*.py")]
        modules |= {".".join(path.relative_to(ROOT).with_suffix("").parts) for path in tests}
    locked = re.findall(r"^([\w.-]+)==", (ROOT / bootstrap.LOCK.format(lock)).read_text(), re.M)
    assert len(modules) > 2 and "numpy" in locked
    command = [sys.executable, "-c", FRESH, " ".join(locked), *sorted(modules)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def make(*words, cwd=ROOT, **env):
    env = environment() | env
    return subprocess.run(["make", *words], cwd=cwd, env=env, capture_output=True, text=True, timeout=60, check=False)


VALUE = "a folder/with spaces 'b \" $(touch made)$(shell touch made)`touch made` ${HOME}$HOME$$; #a, b)*\ntouch made\\"


def test_only_words_of_the_command_line_are_passed_and_as_they_were_typed(tmp_path):
    """Run make in a copy of the checkout in which set-up does nothing and commands print their arguments."""
    root = tmp_path / "a checkout"
    for folder in ("scripts/setup", ".venv/bin"):
        (root / folder).mkdir(parents=True)
    shutil.copy(ROOT / "Makefile", root)
    (root / "scripts" / "setup" / "bootstrap.py").write_text("")
    for command in ("test", "run"):
        (root / "scripts" / f"{command}.py").write_text("import json, sys\nprint(json.dumps(sys.argv[1:]))\n")
    script(root / ".venv" / "bin" / "python", f'exec "{sys.executable}" "$@"\n')
    (tmp_path / "json.py").write_text("raise SystemExit('a wrong json')")
    environment = {"OUT": "x", "SIM": "verilator", "PYTHONPATH": str(tmp_path), "PYTHONHOME": "/nowhere"}
    words = ["OUT=" + VALUE, "WAVES=0", "sim=x"]
    for typed, passed in ((["run"], []), (["run", *words], words), (["test", *words], [*words, "quick"])):
        done = make(*typed, cwd=root, **environment)
        assert done.returncode == 0, done.stderr
        assert sorted(json.loads(done.stdout)) == sorted(passed)
    assert {path.name for path in root.iterdir()} - {"__pycache__"} == {".venv", "Makefile", "scripts"}


@pytest.mark.parametrize(
    ("words", "needs"),
    [
        ("run SIM=verilator", "verilator"),
        ("soak SIM=icarus FARM=x", "icarus farm"),
        ("paper ONLY=derivation", "checkout icarus"),
    ],
)
def test_needs_of_targets_from_another_folder(words, needs, tmp_path):
    done = make("-n", "-f", str(ROOT / "Makefile"), *words.split(), cwd=tmp_path)
    assert [line.split() for line in re.findall(r"bootstrap.py (.*)", done.stdout)] == [needs.split()]
    assert f"\nexec env PYTHONPATH={ROOT}/ {ROOT}/.venv/bin/python -m scripts." in done.stdout


def test_make_refuses_an_unknown_simulator():
    done = make("-n", "run", "SIM=questa")
    assert (done.returncode, done.stdout) == (2, "") and "unknown simulator SIM=questa: use icarus or" in done.stderr
