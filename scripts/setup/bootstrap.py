# SPDX-License-Identifier: Apache-2.0
"""Set-up: what `make` runs before everything else. Standard library only.

    python3 scripts/setup/bootstrap.py [icarus] [verilator] [chromium] [graphviz] [fpga]

makes `.venv` from requirements.lock and sees that the named simulators, the browser or graphviz can run. `fpga` adds
the tools of requirements-fpga.lock, for synthesis and proofs, to the same `.venv`. What the system lacks is installed
with apt-get where that is allowed (root, or sudo without a password); otherwise one line says what to install and
the exit status is 2. When all is in place it prints nothing and takes a few milliseconds.

    .venv/cga-ik.json   the stamp: written last, and only by a set-up that went through
    build/setup.log     what pip and apt-get said

This file has to parse on the oldest Python somebody may start it with, so that it can say what is wrong:
no f-strings, no annotations.
"""

import os
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
OLDEST, NEWEST = (3, 10), (3, 14)  # what the lock files were resolved for
PROGRAMS = {"icarus": ["iverilog", "vvp"], "verilator": ["perl", "make", "g++"], "chromium": ["chromium"]}
PROGRAMS["graphviz"] = ["dot"]
PROGRAMS["fpga"] = []  # all from requirements-fpga.lock
PACKAGE = {"vvp": "iverilog", "dot": "graphviz"}  # others are named as their program
PERL_MODULES = ["-MGetopt::Long", "-MFindBin", "-MPod::Usage", "-MIO::File", "-MCwd"]  # of bin/verilator


def say(text):
    sys.stderr.write("cga-ik: " + text + "\n")
    sys.stderr.flush()


def die(text):
    say(text)
    sys.exit(2)


def which(program):
    for folder in os.environ.get("PATH", os.defpath).split(os.pathsep):
        path = os.path.join(folder or ".", program)
        if os.path.isfile(path) and os.access(path, os.X_OK):
            return path
    return None


# -- which Python ----------------------------------------------------------------------------------


def version_ok(version):
    return OLDEST <= tuple(version[:2]) <= NEWEST


def is_distributions():
    """Is this the Python of the system's packages, so that apt-get can complete it?"""
    return os.path.realpath(sys.executable).startswith("/usr/bin/") and which("apt-get") is not None


def shared_library():
    """The shared libpython of this Python, which a simulator loads to run cocotb; None if there is none."""
    import sysconfig

    name = sysconfig.get_config_var("INSTSONAME") or ""
    if ".so" not in name:
        return None
    multiarch = sysconfig.get_config_var("MULTIARCH") or ""
    folders = [sysconfig.get_config_var("LIBDIR") or "/usr/lib", os.path.join(sys.base_prefix, "lib")]
    for folder in folders + [os.path.join(f, multiarch) for f in folders]:
        if os.path.exists(os.path.join(folder, name)):
            return os.path.join(folder, name)
    return None


def suits():
    """Can a virtual environment that runs cocotb be made from this Python, perhaps with apt-get's help?"""
    return version_ok(sys.version_info) and (shared_library() is not None or is_distributions())


def other_python():
    """Another Python of this machine that suits, or None. Each is asked by running this file in it."""
    names = ["python3.%d" % minor for minor in (13, 12, 11, 10, 14)] + ["/usr/bin/python3", "python3"]
    for name in names:
        path = name if os.path.isabs(name) else which(name)
        if path is None or not os.path.exists(path):
            continue
        with open(os.devnull, "r+b") as null:
            asked = [path, "-ES", os.path.abspath(__file__), "--suits"]
            if subprocess.call(asked, stdin=null, stdout=null, stderr=null) == 0:
                return path
    return None


def choose_python(arguments):
    """Return if this Python will do; otherwise start over in one that will, or say that there is none."""
    if suits():
        return
    path = other_python()
    if path is not None:
        os.execv(path, [path, "-ES", os.path.abspath(__file__)] + arguments)
    mine = "%d.%d" % tuple(sys.version_info[:2])
    this = "%s (Python %s)" % (sys.executable, mine)
    if tuple(sys.version_info[:2]) < OLDEST:
        die("Python 3.10 or later is needed, %s is too old: install a newer python3" % this)
    if tuple(sys.version_info[:2]) > NEWEST:
        die("Python 3.10 to 3.14 is needed, %s is too new: install one of those" % this)
    die("%s lacks the shared libpython that cocotb needs: install the system's python3" % this)


# -- the system's packages -------------------------------------------------------------------------


def run_logged(command, **kwargs):
    """Run quietly, with everything it says at the end of build/setup.log; returns status and what it said."""
    log_name = os.path.join(ROOT, "build", "setup.log")
    os.makedirs(os.path.dirname(log_name), exist_ok=True)
    with open(log_name, "a+b") as log:
        log.write(("$ " + " ".join(command) + "\n").encode())
        log.flush()
        start = log.tell()
        status = subprocess.call(command, stdin=subprocess.DEVNULL, stdout=log, stderr=log, **kwargs)
        log.seek(start)
        return status, log.read().decode("utf-8", "replace")


def apt_prefix():
    """How apt-get may be started here: [], ["sudo", "-n"], or None if it may not."""
    if which("apt-get") is None:
        return None
    if os.geteuid() == 0:
        return []
    if which("sudo"):
        quiet = {"stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        if subprocess.call(["sudo", "-n", "true"], **quiet) == 0:
            return ["sudo", "-n"]
    return None


def have_package_lists():
    try:
        return any("_Packages" in name for name in os.listdir("/var/lib/apt/lists"))
    except OSError:
        return False


def install_packages(packages):
    packages = sorted(set(packages))
    by_hand = "apt-get update && apt-get install -y " + " ".join(packages)
    prefix = apt_prefix()
    if prefix is None:
        if which("apt-get") is None:
            die("please install, then run make again (by their Debian names): " + " ".join(packages))
        die("please install as root, then run make again: " + by_hand)
    say("installing %s (apt-get) ..." % ", ".join(packages))
    get = prefix + ["env", "DEBIAN_FRONTEND=noninteractive", "NEEDRESTART_MODE=a", "LC_ALL=C", "apt-get"]
    get += ["-q", "-y", "-o", "DPkg::Lock::Timeout=300", "-o", "Dpkg::Use-Pty=0"]
    install = get + ["install", "--no-install-recommends"] + packages
    status = run_logged(install)[0] if have_package_lists() else 1
    if status:
        run_logged(get + ["update"])
        status = run_logged(install)[0]
    if status:
        die("apt-get failed, see build/setup.log; please install as root: " + by_hand)


def missing_packages(needs):
    """Debian packages without which a simulator or the browser cannot run."""
    packages = [PACKAGE.get(program, program) for need in needs for program in PROGRAMS[need] if which(program) is None]
    if "verilator" in needs and which("perl"):  # Debian's perl-base alone lacks some modules
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        if subprocess.call(["perl"] + PERL_MODULES + ["-e", "1"], **quiet):
            packages.append("perl")
    return packages


def missing_for_venv():
    """Debian packages without which this Python makes no virtual environment, or none that runs cocotb."""
    packages = []
    dotted = "%d.%d" % tuple(sys.version_info[:2])
    try:
        import ensurepip  # noqa: F401
        import venv  # noqa: F401
    except ImportError:
        packages.append("python%s-venv" % dotted)
    if shared_library() is None:
        packages.append("libpython%s" % dotted)
    return packages


# -- the virtual environment -----------------------------------------------------------------------


class Setup:
    """The state of one checkout."""

    def __init__(self, root=ROOT):
        self.root = root
        self.venv = os.path.join(root, ".venv")
        self.python = os.path.join(self.venv, "bin", "python")
        self.stamp = os.path.join(self.venv, "cga-ik.json")
        self.lock_file = os.path.join(root, "requirements.lock")
        self.fpga_lock_file = os.path.join(root, "requirements-fpga.lock")

    def digest(self, lock_file):
        import hashlib

        with open(lock_file, "rb") as f:
            return hashlib.sha256(f.read()).hexdigest()

    def key(self):
        """What the environment depends on; None while there is no working Python in it."""
        if not os.path.exists(self.python):
            return None
        return {"lock": self.digest(self.lock_file), "python": os.path.realpath(self.python), "venv": self.venv}

    def read_stamp(self):
        """The stamp if the environment is complete and made from today's lock file, else None."""
        import json

        try:
            with open(self.stamp) as f:
                stamp = json.load(f)
            key = self.key()
            good = key is not None and all(stamp[name] == value for name, value in key.items())
            return stamp if good and os.path.exists(stamp["libpython"]) else None
        except (IOError, OSError, ValueError, LookupError, TypeError):
            return None

    def write_stamp(self, libpython, ready):
        import json

        stamp = dict(self.key() or {}, libpython=libpython, ready=sorted(ready))
        if "fpga" in ready:
            stamp["fpga"] = self.digest(self.fpga_lock_file)
        with open(self.stamp + ".new", "w") as f:
            json.dump(stamp, f, indent=1)
        os.rename(self.stamp + ".new", self.stamp)

    def ready_in(self, stamp):
        """What a stamp says is in place; the tools of an older requirements-fpga.lock are not."""
        ready = set(stamp.get("ready", []) if stamp else [])
        if "fpga" in ready and stamp.get("fpga") != self.digest(self.fpga_lock_file):
            ready.remove("fpga")
        return ready

    def is_ready(self, needs):
        stamp = self.read_stamp()
        return (
            stamp is not None
            and set(needs) <= self.ready_in(stamp)
            and all(which(program) for need in needs for program in PROGRAMS[need])
        )

    def pip_environment(self):
        env = dict(os.environ, PIP_USER="0", PIP_DISABLE_PIP_VERSION_CHECK="1", PIP_NO_INPUT="1")
        for name in ("PYTHONHOME", "PYTHONPATH", "PIP_TARGET", "PIP_PREFIX", "PIP_CONSTRAINT"):
            env.pop(name, None)
        return env

    def pip_install(self, lock_file):
        """What the lock file names into .venv; returns status and what pip said."""
        pip = [self.python, "-m", "pip", "install", "--progress-bar", "off", "--no-warn-script-location"]
        return run_logged(pip + ["--require-hashes", "-r", lock_file], env=self.pip_environment())

    def give_up(self, what, said):
        lines = [line.strip() for line in said.splitlines() if line.strip()]
        wrong = [line for line in lines if line.lower().startswith("error")] or lines or ["no message"]
        if any(sign in said for sign in ("Failed to establish", "Connection broken", "timed out")):
            wrong = ["the package index cannot be reached"]
        die("could not %s: %s (more in build/setup.log)" % (what, wrong[-1]))

    def make_venv(self):
        """A fresh .venv, whatever was there; returns the path of its libpython."""
        if os.path.islink(self.venv):  # --clear would empty what it leads to, outside of this checkout
            die(".venv is a link to %s, which set-up will not overwrite: remove the link" % os.readlink(self.venv))
        dotted = "%d.%d" % tuple(sys.version_info[:2])
        say("making .venv with Python %s from requirements.lock (a minute or so) ..." % dotted)
        env = self.pip_environment()
        if os.path.exists(self.stamp):
            os.remove(self.stamp)
        status, said = run_logged([sys.executable, "-m", "venv", "--clear", self.venv], env=env)
        if status == 0:
            status, said = self.pip_install(self.lock_file)
        if status:
            self.give_up("make .venv", said)
        ask = [self.python, "-c", "import find_libpython as f; print(f.find_libpython() or '')"]
        libpython = subprocess.check_output(ask, env=env).decode().strip()
        if not libpython:
            die("cocotb finds no shared libpython for %s: use another python3" % sys.executable)
        return libpython

    def add_fpga_tools(self):
        say("adding the tools of requirements-fpga.lock to .venv (a minute or so) ...")
        status, said = self.pip_install(self.fpga_lock_file)
        if status:
            self.give_up("add the tools of requirements-fpga.lock", said)

    def set_up(self, needs):
        stamp = self.read_stamp()
        packages = missing_packages(needs) + (missing_for_venv() if stamp is None else [])
        if "verilator" in needs and which("ccache") is None and apt_prefix() is not None:
            packages.append("ccache")  # not needed, but makes the second and later builds ten times faster
        if packages:
            install_packages(packages)
        libpython = self.make_venv() if stamp is None else stamp["libpython"]
        ready = self.ready_in(stamp) | (set(needs) - set(["fpga"]))
        self.write_stamp(libpython, ready)
        if "fpga" in set(needs) - ready:  # stamped before and after: .venv is good without them
            self.add_fpga_tools()
            self.write_stamp(libpython, ready | set(["fpga"]))
            say("ready")
        elif stamp is None:
            say("ready")


def hold_lock(folder):
    """One set-up at a time in a checkout: the second waits. Held until this process ends."""
    import fcntl

    handle = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        say("waiting for another set-up of this checkout ...")
        fcntl.flock(handle, fcntl.LOCK_EX)
    except OSError:  # a file system without locks
        pass
    return handle


def main(arguments):
    if arguments == ["--suits"]:
        return 0 if suits() else 1
    for need in arguments:
        if need not in PROGRAMS:
            die("unknown requirement '%s': use %s" % (need, ", ".join(PROGRAMS)))
    setup = Setup()
    if setup.is_ready(arguments):
        return 0
    if setup.read_stamp() is None or not version_ok(sys.version_info):
        choose_python(arguments)
    try:
        hold_lock(ROOT)
        if not setup.is_ready(arguments):  # whoever we waited for may have done it
            setup.set_up(arguments)
    except OSError as error:
        die("set-up failed: %s" % error)
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except KeyboardInterrupt:
        say("set-up interrupted; the next make starts it again")
        sys.exit(130)
