# SPDX-License-Identifier: Apache-2.0
"""scripts/contracts.py and the contracts of pyproject.toml, each on a checkout that breaks it."""

import shutil
import subprocess

import pytest

from scripts import contracts
from tb.sim.env import ROOT, environment


def run(folder, *command):
    return subprocess.run(command, cwd=folder, env=environment(), capture_output=True, text=True, check=False)


@pytest.fixture
def checkout(tmp_path):
    """A checkout with the settings of this one and a module a room."""
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    rooms = ("reference", "dataflow", "bounds", "motion", "io")
    for name in ("model", *(f"model/{room}" for room in rooms), "tb", "scripts"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").write_text("")
    for name in ("monte_carlo", "scoring", "stimuli", "trajectories", "files", "flags", "words"):
        (tmp_path / "model" / "io" / f"{name}.py").write_text("")
    run(tmp_path, "git", "init", "-q")
    return tmp_path


def write(checkout, name, text):
    (checkout / name).write_text(text)
    run(checkout, "git", "add", "-A")


def test_a_private_name_of_another_file_is_found(checkout):
    write(checkout, "model/dataflow/a.py", "from model.dataflow import _b\nfrom numpy import _globals\n")
    (line,) = contracts.findings(checkout)
    assert line.endswith("a.py:1: takes the private name _b of model.dataflow")


def test_a_private_name_below_a_module_is_found(checkout):
    write(checkout, "scripts/a.py", "import model\n\nmodel._b()\n")
    done = run(checkout, "ruff", "check", "--output-format=concise", ".")
    assert done.returncode == 1 and "SLF001" in done.stdout


def test_a_long_file_is_found_unless_a_command_writes_it(checkout):
    write(checkout, "scripts/a.js", "x\n" * 500)
    (checkout / "rtl").mkdir()
    write(checkout, "rtl/ik_lean_nodes.vh", "x\n" * 501)
    assert contracts.findings(checkout) == []
    write(checkout, "scripts/a.js", "x\n" * 501)
    assert contracts.findings(checkout) == ["scripts/a.js: 501 lines; split what is written by hand at 500"]


def test_a_source_without_its_licence_is_found(checkout):
    write(checkout, "rtl.f", f"// {contracts.LICENCE}\n")
    write(checkout, "notes.md", "none\n")
    assert not [line for line in contracts.unlicensed(checkout) if "rtl.f" in line or "notes.md" in line]
    write(checkout, "rtl.f", "ik_axis.v\n")
    assert f"rtl.f: no line {contracts.LICENCE}" in contracts.unlicensed(checkout)


@pytest.mark.parametrize(
    ("name", "imports"),
    [
        ("tb/a.py", "scripts"),
        ("model/bounds/a.py", "tb"),
        ("model/reference/a.py", "model.dataflow"),
        ("model/dataflow/a.py", "model.bounds"),
        ("model/bounds/a.py", "model.io.scoring"),
        ("model/dataflow/a.py", "model.motion"),
        ("model/reference/a.py", "model.io.words"),
    ],
)
def test_an_import_of_a_room_above_is_found(checkout, name, imports):
    command = ("lint-imports", "--no-cache")
    write(checkout, name, "")
    assert run(checkout, *command).returncode == 0
    write(checkout, name, f"import {imports}\n")
    assert "is not allowed to import" in run(checkout, *command).stdout


def test_a_wrong_type_in_the_model_is_found(checkout):
    write(checkout, "model/dataflow/a.py", "width: int = 32\n")
    assert run(checkout, "mypy").returncode == 0
    write(checkout, "model/dataflow/a.py", "width: int = '32'\n")
    assert "Incompatible types" in run(checkout, "mypy").stdout


def test_the_checkout_keeps_its_contracts():
    assert contracts.findings() == [] == contracts.unlicensed()
