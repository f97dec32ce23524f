# SPDX-License-Identifier: Apache-2.0
"""ctypes binding of the C driver in examples/driver; Python implements the driver's platform callbacks."""

import ctypes
import os
import re
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np

from model.io.words import FIELDS
from tb.axi import ik_regs
from tb.sim.env import ROOT

SOURCE = ROOT / "examples" / "driver"

FLAGS = ("-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror", "-O2")

LISTED = re.findall(r"^    IK_(\w+)(?: = 16)?, ", (SOURCE / "ik.h").read_text(encoding="utf-8"), re.M)
CODES = ik_regs.CODES | {name.lower(): number for number, name in enumerate(LISTED, 16)}
"""Code name -> number: hardware codes from the register description, driver codes from ik.h."""

REGISTER = {offset: name for name, offset in ik_regs.OFFSETS.items()}
NAMES = {number: name for name, number in CODES.items()}

REALS = {"double": np.float64, "float": np.float32}


def compiled(folder: Path, *options: str, text: str = "") -> Path:
    """Compile the driver, and C source ``text`` if given, into one shared library in ``folder``; return its path."""
    library, sources = folder / "ik.so", [SOURCE / "ik.c", SOURCE / "ik_words.c"]
    if text:
        sources.append(folder / "text.c")
        sources[-1].write_text(text)
    command = ["cc", *FLAGS, f"-I{SOURCE}", *options, "-shared", "-fPIC", "-o", library, *sources]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0 and not done.stderr, done.stderr
    return library


POINTER, SIZE, WORD, LONG, BOOL = ctypes.c_void_p, ctypes.c_size_t, ctypes.c_uint32, ctypes.c_uint64, ctypes.c_bool
READ = ctypes.CFUNCTYPE(WORD, POINTER, WORD)
WRITE = ctypes.CFUNCTYPE(None, POINTER, WORD, WORD)
CACHE = ctypes.CFUNCTYPE(None, POINTER, POINTER, SIZE)
WAIT = ctypes.CFUNCTYPE(BOOL, POINTER)


class Area(ctypes.Structure):
    _fields_ = [("at", POINTER), ("address", LONG)]


class Bus(ctypes.Structure):
    _fields_ = [("user", POINTER), ("read", READ), ("write", WRITE), ("source", Area), ("destination", Area)]
    _fields_ += [("records", WORD), ("flush", CACHE), ("invalidate", CACHE), ("wait", WAIT), ("polls", WORD)]


class Core(ctypes.Structure):
    _fields_ = [("bus", Bus), *((name, WORD) for name in ("width", "data_width", "addr_width", "latency"))]
    _fields_ += [*((name, BOOL) for name in ("lean", "arm", "fold")), ("written", SIZE), ("bad", SIZE)]
    _fields_ += [("error_address", LONG), ("events", WORD), ("aborted", BOOL)]


class Uio(ctypes.Structure):
    _fields_ = [("core", Core), ("bus", Bus), *((name, ctypes.c_int) for name in ("patience", "error", "file"))]
    _fields_ += [("kept", POINTER * 5)]


def uio_device(folder: Path, arm: int = 0) -> tuple[bytes, bytes]:
    """Write a plain file that replaces a UIO device, and its sysfs files. Return (device file, folder of its maps).

    Map 0 is a page of registers, all 0 except CONFIG.arm. Map 1 is the buffer: 24 targets and 24 results.
    """
    registers = np.zeros(2 * os.sysconf("SC_PAGESIZE") // 4, "<u4")
    registers[ik_regs.OFFSETS["CONFIG"] // 4] = arm << ik_regs.FIELDS["CONFIG"]["arm"].low
    registers.tofile(folder / "uio0")
    for k, values in enumerate(((0x43C00000, 0x1000, 0), (0x10000000, 0x640, 0x40))):
        (folder / f"map{k}").mkdir()
        for name, value in zip(("addr", "size", "offset"), values, strict=True):
            (folder / f"map{k}" / name).write_text(f"{value:#x}\n")
    return os.fsencode(folder / "uio0"), os.fsencode(folder)


class Driver:
    """C driver of one core. ``records`` is the capacity of each buffer; if ``arm``, targets are hand poses.

    ``platform.areas`` are the source and the destination buffer, each as (CPU pointer, bus address). ``platform`` has
    the callbacks read and write; if ``interrupt``, it also has wait, flush and invalidate.
    """

    def __init__(
        self, library: Path, platform, records: int, *, interrupt=False, polls=0, real="double", arm=False
    ) -> None:
        self.linked = ctypes.CDLL(str(library))
        self.linked.ik_error_text.restype = ctypes.c_char_p
        self.raised: list[BaseException] = []
        source, destination = (Area(*area) for area in platform.areas)
        self.bus = Bus(source=source, destination=destination, records=records, polls=polls)
        self.bus.read, self.bus.write = READ(self._guarded(platform.read)), WRITE(self._guarded(platform.write))
        if interrupt:
            self.bus.flush = CACHE(self._guarded(platform.flush))
            self.bus.invalidate = CACHE(self._guarded(platform.invalidate))
            self.bus.wait = WAIT(self._guarded(platform.wait))
        self.core = Core()
        self.arm = arm
        target = [*((name, REALS[real]) for name in FIELDS), ("tag", np.uint32)]
        result = [("qs", REALS[real], 4), ("qe", REALS[real], 2), ("tag", np.uint32), ("flags", np.uint8)]
        if arm:
            target[6:6] = [("tool", REALS[real]), ("hand", REALS[real], 4)]
            target.append(("branch", np.uint8))
            result = [("th", REALS[real], 7), *result, ("over_limit", np.uint16)]
        self.target_type, self.result_type = np.dtype(target, align=True), np.dtype(result, align=True)

    def _guarded(self, function: Callable) -> Callable:
        """Wrap a callback. A ctypes callback cannot raise, so its exception is stored and `call` raises it."""

        def call(_user, *arguments):
            try:
                return function(*arguments)
            except BaseException as error:
                self.raised.append(error)
                return 0

        return call

    def call(self, name: str, *arguments) -> int:
        code = getattr(self.linked, name)(ctypes.byref(self.core), *arguments)
        if self.raised:
            raise self.raised.pop(0)
        return code

    def start_up(self) -> str:
        return NAMES[self.call("ik_init", ctypes.byref(self.bus))]

    def targets(self, columns: dict[str, np.ndarray], tags: np.ndarray) -> np.ndarray:
        targets = np.zeros(len(tags), self.target_type)
        for name, values in {**columns, "tag": tags}.items():
            targets[name] = values
        return targets

    def solve_words(self, count: int) -> str:
        """Call ik_solve_words or ik_solve_arm_words for the records in the buffer. Return the code's name."""
        return NAMES[self.call("ik_solve_arm_words" if self.arm else "ik_solve_words", ctypes.c_size_t(count))]

    def solve(self, targets: np.ndarray) -> tuple[str, np.ndarray]:
        """Call ik_solve or ik_solve_arm. Return the name of its return code and as many results as the driver
        says it has written. Check that the driver has changed no other result."""
        results = np.full(len(targets) * self.result_type.itemsize, 0xA5, np.uint8)
        name = "ik_solve_arm" if self.arm else "ik_solve"
        code = self.call(name, targets.ctypes, results.ctypes, ctypes.c_size_t(len(targets)))
        good = self.core.written * self.result_type.itemsize
        assert (results[good:] == 0xA5).all(), "a result that is not reported as written has changed"
        return NAMES[code], results[:good].view(self.result_type)
