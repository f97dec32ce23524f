# SPDX-License-Identifier: Apache-2.0
"""The Makefile: its help, and what it hands on to commands, as it was typed."""

import json
import re
import shutil
import subprocess
import sys

import pytest

from scripts.setup.tests.test_bootstrap import script
from tb.sim.env import ROOT, environment


def make(*words, cwd=ROOT, **env):
    command = ["make", *words]
    env = dict(environment(), **env)
    env.pop("SIM", None)
    return subprocess.run(command, cwd=cwd, env=env, capture_output=True, text=True, timeout=60, check=False)


def test_help_lists_every_target():
    said = make("help").stdout
    assert make().stdout == said
    text = (ROOT / "Makefile").read_text()
    phony = next(line for line in text.splitlines() if line.startswith(".PHONY:")).split()[1:]
    assert [line.split()[1] for line in said.splitlines()] == phony
    assert all(len(line.split(None, 2)) == 3 for line in said.splitlines())


@pytest.mark.parametrize("target", ["test", "run", "setup"])
def test_unknown_simulator_is_one_line_and_status_2(target):
    done = make(target, "SIM=questa")
    assert done.returncode == 2 and done.stdout == ""
    assert done.stderr.count("\n") == 1 and "SIM=questa" in done.stderr


VALUED = ("run", "follow", "report", "soak", "formal", "fpga", "table6")
"""Targets that hand values on to the command of their name."""


@pytest.fixture
def stand_in(tmp_path):
    """A checkout whose set-up is done and whose command line only prints what it was given."""
    root = tmp_path / "a checkout"
    (root / "scripts" / "setup").mkdir(parents=True)
    shutil.copy(ROOT / "Makefile", root)
    (root / "scripts" / "setup" / "bootstrap.py").write_text("")
    for command in ("pytest", *(f"scripts/{name}" for name in VALUED)):
        (root / f"{command}.py").write_text(
            "import json, os, sys\nprint(json.dumps([sys.argv[1:], bool({'OUT', 'WAVES'} & set(os.environ))]))\n"
        )
    (root / ".venv" / "bin").mkdir(parents=True)
    script(root / ".venv" / "bin" / "python", f'exec "{sys.executable}" "$@"\n')

    def run(*words, target="run", **env):
        done = make(target, *words, cwd=root, **env)
        assert done.returncode == 0, done.stderr
        arguments, leaked = json.loads(done.stdout)
        assert not leaked or env
        there = {p.name for p in root.iterdir()} - {"__pycache__"}  # of pytest.py
        assert there == {".venv", "Makefile", "pytest.py", "scripts"}
        return arguments

    return run


def test_run_passes_only_what_is_set(stand_in):
    assert stand_in() == ["--sim", "icarus"]
    assert stand_in("SIM=verilator") == ["--sim", "verilator"]
    assert stand_in("OUT=", "WAVES=0") == ["--sim", "icarus"]
    assert stand_in(OUT="x", WIDTH="3") == ["--sim", "icarus"]  # only make's command line counts
    words = "TRAJECTORY=all OUT=o DATAPATH=paper WIDTH=32 D1=0.3 D2=0.2 PHI=-0.5 WAVES=1"
    given = "--trajectory=all --out=o --datapath=paper --width=32 --d1=0.3 --d2=0.2 --phi=-0.5 --waves"
    assert stand_in(*words.split()) == ["--sim", "icarus", *given.split()]


def test_a_checkout_with_a_space_is_refused_from_another_folder(stand_in, tmp_path):
    done = make("-f", str(tmp_path / "a checkout" / "Makefile"), "run", cwd=tmp_path)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert "make -f takes no path with spaces: use make -C" in done.stderr


@pytest.mark.parametrize("target", VALUED)
def test_every_variable_that_a_target_takes_reaches_its_command(stand_in, target):
    """Those that it says it takes."""
    taken = set(re.search(r"it takes (.*)\.  Stop", make(target, "NOTHING_LIKE=1").stderr)[1].split(", "))
    own = {"SIM=verilator": "--sim verilator", "CORES=digit": "--cores digit", "WAVES=1": "--waves", "KEEP=1": "--keep",
           "SPECIAL=1": "--special"}  # fmt: skip
    own = {word: said for word, said in own.items() if word.split("=")[0] in taken}
    valued = sorted(taken - {word.split("=")[0] for word in own})
    given = stand_in(*own, *(f"{name}=a {name}" for name in valued), target=target)
    said = [part for words in own.values() for part in words.split()]
    assert sorted(given) == sorted([*said, *(f"--{name.lower()}=a {name}" for name in valued)])


def test_variables_of_another_python_are_of_no_use(stand_in, tmp_path):
    (tmp_path / "json.py").write_text("raise SystemExit('a wrong json')")
    assert stand_in(PYTHONPATH=str(tmp_path), PYTHONHOME="/nowhere", PYTHONSAFEPATH="1") == ["--sim", "icarus"]


@pytest.mark.parametrize(
    ("words", "marks"),
    [
        ("test", "not release and not slow"),
        ("test SIM=verilator", "not release and sim and not slow"),
        ("test-all", "not release"),
        ("test-all SIM=verilator", "not release and sim"),
    ],
)
def test_the_quick_gate_and_all_of_it(stand_in, words, marks):
    target, *options = words.split()
    assert stand_in(*options, target=target)[-2:] == ["-m", marks]


def test_only_is_a_file_or_an_expression(stand_in):
    """Slow cases included, as somebody works on them."""
    for value in ("scripts/run.py", "scripts/run.py::test_x[1]"):
        assert stand_in("ONLY=" + value, target="test")[-3:] == [value, "-m", "not release"]
    for value in ("ik_mul and not 'x'", "a $(touch made) \"b"):
        assert stand_in("ONLY=" + value, target="test")[-4:] == ["-k", value, "-m", "not release"]
    assert stand_in("ONLY=x", "SIM=verilator", target="test")[-2:] == ["-m", "not release and sim"]


@pytest.mark.parametrize(
    "value",
    [
        "a folder/with spaces ",
        "a'b",
        'a"b',
        "$(touch made)",
        "$(shell touch made)",
        "`touch made`",
        "${HOME}$HOME$$",
        "; touch made",
        "a\\",
        "#a, b)",
        "*",
        "a\ntouch made",
    ],
)
def test_run_passes_a_value_as_it_was_typed(stand_in, value):
    assert stand_in("OUT=" + value) == ["--sim", "icarus", "--out=" + value]
