# SPDX-License-Identifier: Apache-2.0
"""scripts/setup/bootstrap.py without network: the stamp, the messages, the choice of Python."""

import ast
import hashlib
import json
import os
import shutil
import subprocess
import sys
import sysconfig
import zipfile
from pathlib import Path

import pytest

from scripts.setup import bootstrap
from tb.sim.env import ROOT


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
    Path(checkout.extra_lock("fpga")).write_text("z3-solver==1.0\n")
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
    Path(fpga.extra_lock("fpga")).write_text("z3-solver==1.1\n")
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


def test_software_to_compare_with_need_not_install(fpga, capsys):
    """A row of the table says what is missing; the next `make table6` tries again."""
    Path(fpga.extra_lock("table6")).write_text("numba==1.0\n")
    script(path_of(fpga) / "cc", "exit 0\n")
    fpga.pip_says = (1, "ERROR: no wheel\n")
    fpga.set_up(["table6"])
    assert "could not add the software of requirements-table6.lock, going on without" in capsys.readouterr().err
    assert fpga.is_ready(["icarus"]) and not fpga.is_ready(["table6"])
    fpga.pip_says = (0, "")
    fpga.set_up(["table6", "fpga"])
    assert fpga.is_ready(["table6", "fpga"])
    Path(fpga.extra_lock("fpga")).write_text("z3-solver==1.1\n")  # of the two extras each has its own digest
    assert fpga.is_ready(["table6"]) and not fpga.is_ready(["fpga"])


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


WHEEL = {
    "cga_probe.py": "",
    "cga_probe-1.dist-info/METADATA": "Metadata-Version: 2.1\nName: cga-probe\nVersion: 1\n",
    "cga_probe-1.dist-info/WHEEL": "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
    "cga_probe-1.dist-info/RECORD": "",
}


def test_pip_installs_into_the_environment_whatever_the_user_has_set(checkout, tmp_path, monkeypatch):
    """The real pip, with a wheel of nothing; where packages come from is as set."""
    wheel, elsewhere, config = tmp_path / "cga_probe-1-py3-none-any.whl", tmp_path / "elsewhere", tmp_path / "pip.conf"
    with zipfile.ZipFile(wheel, "w") as archive:
        for name, text in WHEEL.items():
            archive.writestr(name, text)
    lock = Path(checkout.lock_file)
    lock.write_text(f"cga-probe==1 --hash=sha256:{hashlib.sha256(wheel.read_bytes()).hexdigest()}\n")
    subprocess.run([sys.executable, "-m", "venv", "--clear", "--without-pip", checkout.venv], check=True)
    packages = next(Path(checkout.venv).glob("lib/python*/site-packages"))
    (packages / "pip.pth").write_text(sysconfig.get_path("purelib"))
    (elsewhere / "pip").mkdir(parents=True)
    (elsewhere / "pip" / "__init__.py").write_text("raise SystemExit('a wrong pip')")
    config.write_text("[global]\nuser = yes\n")
    for name in ("TARGET", "PREFIX", "ROOT"):
        monkeypatch.setenv(f"PIP_{name}", str(elsewhere))
    for name in ("CONSTRAINT", "REQUIREMENT", "EDITABLE"):
        monkeypatch.setenv(f"PIP_{name}", str(tmp_path / "none"))
    for name, value in {"USER": "1", "DRY_RUN": "1", "PYTHON": "/nowhere", "NO_INDEX": "1"}.items():
        monkeypatch.setenv(f"PIP_{name}", value)
    monkeypatch.setenv("PIP_FIND_LINKS", str(tmp_path))
    monkeypatch.setenv("PIP_CONFIG_FILE", str(config))
    monkeypatch.setenv("PYTHONPATH", str(elsewhere))
    status, said = checkout.pip_install(checkout.lock_file)
    assert status == 0 and (packages / "cga_probe.py").exists(), said
    assert os.listdir(elsewhere) == ["pip"]


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


# -- as it is called -------------------------------------------------------------------------------


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
