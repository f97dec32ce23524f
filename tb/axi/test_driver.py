# SPDX-License-Identifier: Apache-2.0
"""Tests of the C driver: on a register model, and on a simulated ``ik_axi``, mostly with an echo as datapath."""

import ctypes
import errno
import os
import signal
import socket
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

from model.io.words import ARM_RECORDS, FIELDS, RECORDS, TargetError, Targets, limit_words, result_values, to_words
from tb.axi.binding import CODES, FLAGS, REGISTER, SOURCE, Driver, Uio, compiled, uio_device
from tb.axi.ik_regs import OFFSETS
from tb.axi.instances import echoing, named
from tb.sim.env import simulator
from tb.sim.shared import passes

COUNT = 400  # capacity of each buffer in records of 32 bytes; the longest call has more targets

BYTES = RECORDS.size
TAGS = np.arange(9)

pytestmark = pytest.mark.needs("cc")


class RegisterModel:
    """Model of a core's registers. Each job ends at once, with random result words."""

    def __init__(self, width: int = 32, identity: int = 0x494B0100, arm: int = 0) -> None:
        config, self.arm = 0x01204000 | width | arm << 26, arm
        self.registers = dict.fromkeys(OFFSETS, 0) | {"ID": identity, "CONFIG": config}
        self.memory = ctypes.create_string_buffer(2 * COUNT * BYTES)
        self.random = np.random.default_rng(1)
        self.jobs: list[bytes] = []  # target records of each job
        self.words: list[np.ndarray] = []
        self.results: list[bytes] = []  # result records of each job
        at = ctypes.addressof(self.memory)
        self.areas = (at, 0x1000), (at + COUNT * BYTES, 0x8000)

    def read(self, offset: int) -> int:
        return self.registers[REGISTER[offset]]

    def write(self, offset: int, value: int) -> None:
        name = REGISTER[offset]
        if name == "CONTROL" and value == 1:
            self.run(self.registers["COUNT"])
        elif name == "IRQ_STATUS":
            self.registers[name] &= ~value
        else:
            self.registers[name] = value

    def run(self, count: int) -> None:
        assert self.registers["SOURCE_LO"] == 0x1000 and self.registers["DESTINATION_LO"] == 0x8000
        layout = ARM_RECORDS if self.arm else RECORDS
        self.jobs.append(self.memory.raw[: count * layout.size])
        words = self.random.integers(-(2**31), 2**31, (count, len(layout.results)))
        words[:2, :6] = (-(2**31), 2**31 - 1, 2**30, -(2**30), 0, -1)
        tags = np.frombuffer(self.jobs[-1], "<u4").reshape(-1, layout.size // 4)[:, layout.tag] & 0xFFFFFF
        self.results.append(layout.written(words, words[:, 0] & 0xFF, tags, 32))
        ctypes.memmove(self.areas[1][0], self.results[-1], len(self.results[-1]))
        self.words.append(words)
        self.registers["IRQ_STATUS"] = 1


def random_targets(random: np.random.Generator, count: int, decades: int) -> dict[str, np.ndarray]:
    """Return targets: lengths in any unit, coordinates up to and beyond the scaling limit, and phi of any size."""
    unit = 10.0 ** random.uniform(-decades, decades)
    spread = 10.0 ** random.uniform(-3, 1.3)
    columns = dict(zip("xyz", unit * spread * random.normal(0, 1, (3, count)), strict=True))
    some = random.random(count) < 0.3
    columns["phi"] = random.normal(0, 4, count) * 10.0 ** (random.integers(-20, 20, count) * some)
    columns |= dict(zip(("d1", "d2"), unit * 10.0 ** random.uniform(-random.uniform(0, 5), 0, (2, count)), strict=True))
    return columns


def corners() -> list[dict[str, np.ndarray]]:
    """Return sets of targets: rounding ties, ends of the format, largest and smallest double, whole and half turns."""
    ulp = 2.0**-30
    fractions = np.array([0.5, 1.5, 2.5, 0.5 - 2**-20, 0.5 + 2**-20, 1 - 2**-22]) * ulp
    lengths = np.concatenate([fractions, -fractions, [0, -0.0, -2, 2 - ulp, 2 - ulp / 2, 2 - ulp / 4, 1, -1, 1e-310]])
    turns = np.array([0, 1, 2, 3, 2**31 - 0.5, 2**31 + 0.5, 2**31 - 0.25, 2**32, 0.25, 7e25, 7e35, 7e45, 1e300]) / 2**32
    phi = np.resize(np.concatenate([turns, -turns[-4:]]) * (2 * np.pi), len(lengths))
    plain = {"x": lengths, "y": lengths[::-1], "z": np.roll(lengths, 1), "phi": phi, "d1": 1.0, "d2": 0.75}
    one = {name: np.array([0.25]) for name in FIELDS}
    tiny, huge = 5e-324, float(np.finfo(np.float64).max)
    return [
        {name: values * scale if name != "phi" else values for name, values in plain.items()}
        for scale in (1.0, 2.0**-1000, 2.0**1000)
    ] + [
        one | {"d1": tiny, "d2": tiny, "x": tiny, "y": -2 * tiny, "z": 0.0},
        one | {"d1": huge / 2, "d2": huge / 2, "x": huge, "y": -huge},
        one | {"d1": huge, "d2": huge},
        one | {"d1": 1.0, "d2": 1.0 - 2**-53},  # a reach that rounds up to 2
        one | {"d1": 1.0, "d2": 2.0**-31},
        one | {"d1": 1.0, "d2": 2.0**-31 + 2.0**-60},
        *(one | {"d1": 0.5, "d2": 0.5, "x": x} for x in (-2.0, 2.0, -32.0, 32.0, -33.0, 32.0 - 2**-48, 31.9)),
    ]


def check(driver: Driver, core: RegisterModel, columns: dict, tags: np.ndarray) -> str:
    """Solve targets, compare every bit with the model and return the name of the code that the driver returns."""
    core.jobs.clear(), core.words.clear()
    columns = {name: np.broadcast_to(np.asarray(values), len(tags)) for name, values in columns.items()}
    targets = driver.targets(columns, tags)
    wide = Targets(name="test", **{name: targets[name].astype(np.float64) for name in FIELDS})
    code, results = driver.solve(targets)
    try:
        words, _ = to_words(wide, 32)
    except TargetError as error:
        assert code == ("too_short" if "too short" in str(error) else "too_far_out"), f"{code}: {error}"
        assert not core.jobs and (code == "too_far_out" or f"target {driver.core.bad}," in str(error))
        return code
    assert code == "none", f"{code} for target {driver.core.bad}"
    assert len(core.jobs) == -(-len(tags) // COUNT)
    assert b"".join(core.jobs) == RECORDS.packed(words, tags), "words of targets"
    solved = np.concatenate(core.words)
    values = result_values(solved, 32).astype(results["qs"].dtype)
    assert (results["qs"] == values[:, :4]).all() and (results["qe"] == values[:, 4:]).all()
    assert (results["tag"] == tags & 0xFFFFFF).all() and (results["flags"] == solved[:, 0] & 0xFF).all()
    return code


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    return compiled(tmp_path_factory.mktemp("driver"), str(SOURCE / "ik_uio.c"))


@pytest.mark.parametrize(
    "compiler", ["cc", pytest.param("clang", marks=[pytest.mark.release, pytest.mark.needs("clang")])]
)
@pytest.mark.parametrize("real", ["double", "float"])
def test_compiles_freestanding_without_warnings(compiler, real, tmp_path):
    """The driver compiles freestanding and references no external function except memcpy and memset. ik_words.c
    compiles without floating-point registers and does not call the compiler's floating-point functions."""
    parts = {"ik.c": [f"-DIK_REAL={real}"], "ik_words.c": ["-mgeneral-regs-only"]}
    for name, options in parts.items():
        command = [compiler, *FLAGS, "-ffreestanding", "-c", *options, "-o", tmp_path / f"{name}.o", SOURCE / name]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0 and not done.stderr, done.stderr
    subprocess.run([compiler, *FLAGS, f"-DIK_REAL={real}", "-fsyntax-only", SOURCE / "ik_uio.c"], check=True)

    def symbols(name: str, *options: str) -> set[str]:
        words = ["nm", "-j", *options, tmp_path / f"{name}.o"]
        return set(subprocess.run(words, capture_output=True, text=True, check=True).stdout.split())

    memory = {"memcpy", "memset"}  # a compiler may emit calls to these
    assert symbols("ik_words.c", "-u") <= memory
    assert symbols("ik.c", "-u") <= memory | symbols("ik_words.c", "--defined-only")


@pytest.mark.parametrize("real", ["double", "float"])
def test_numbers(real, tmp_path, capfd):
    """Solve 120 sets of 1000 random targets and, if ``real`` is double, the corners; check for undefined behaviour."""
    core = RegisterModel()
    library = compiled(tmp_path, f"-DIK_REAL={real}", "-fsanitize=undefined")
    driver = Driver(library, core, COUNT, real=real, polls=3)
    assert driver.start_up() == "none"
    random = np.random.default_rng(7)
    sets = corners() if real == "double" else []
    sets += [random_targets(random, 1000, 300 if real == "double" else 35) for _ in range(120)]
    codes = []
    for columns in sets:
        tags = random.integers(0, 2**32, max(np.size(values) for values in columns.values()))
        codes.append(check(driver, core, columns, tags))
    assert {"none", "too_far_out", *(["too_short"] if real == "double" else [])} == set(codes)
    assert codes.count("none") > 100
    assert "runtime error" not in capfd.readouterr().err


@pytest.mark.parametrize("arm", [False, True])
def test_bad_targets_are_refused(library, arm):
    """A bad target or hand pose is refused before any job starts; the driver sets ``bad`` to its index."""
    core = RegisterModel(width=18, arm=arm)
    driver = Driver(library, core, COUNT // 2, arm=arm)
    good = driver.targets(dict.fromkeys(FIELDS, 0.25) | ({"tool": 0.25, "hand": [1.0, 0, 0, 0]} if arm else {}), TAGS)
    assert driver.solve(good)[0] == "no_core", "before ik_init"
    assert driver.start_up() == "none"
    reals, parts = (*FIELDS, *["tool"] * arm), range(4 * arm)
    cases = [(name, 0, value, "not_finite") for name in reals for value in (np.nan, np.inf, -np.inf)]
    cases += [(name, 0, value, "not_an_arm") for name in ("d1", "d2") for value in (0.0, -0.25, -5e-324)]
    cases += [(name, 0, value, "too_far_out") for name in ("x", "y", "z", *reals[6:]) for value in (16.0, -16.1)]
    cases += [(name, 0, 0.5 * 2.0**-18, "too_short") for name in ("d1", "d2")]  # at W = 18
    cases += [("hand", part, value, "not_a_hand") for part in parts for value in (np.nan, -np.inf, 2.0, -2.1)]
    for k, (name, part, value, code) in enumerate(cases):
        bad = good.copy()
        bad[name].reshape(9, -1)[k % 9, part] = value
        assert (driver.solve(bad)[0], driver.core.bad) == (code, k % 9), f"{name} {part} {value}"
    assert driver.solve(good[:0])[0] == "no_targets"
    check_null_pointers(driver, "ik_solve_arm" if arm else "ik_solve")
    assert not core.jobs
    good["d1"] = 2.0**-19  # half an ulp at W = 18; the core rounds it up
    assert driver.solve(good)[0] == "none" and len(core.jobs) == 1


def check_null_pointers(driver: Driver, name: str) -> None:
    """Check that a function of the driver refuses a null pointer as any of its three arguments."""
    some = (ctypes.c_double * 7)()
    for null in range(3):
        pointers = [None if k == null else one for k, one in enumerate((ctypes.byref(driver.core), some, some))]
        assert getattr(driver.linked, name)(*pointers, ctypes.c_size_t(9)) == CODES["null"]


def test_each_solve_function_refuses_the_core_of_the_other(library):
    core, wrists, ends = RegisterModel(arm=1), RegisterModel(), [(ctypes.c_double * 7)(*[k] * 7) for k in (0, 1)]
    driver, other = (Driver(library, one, COUNT // 2, arm=one is core) for one in (core, wrists))
    poses = driver.targets(dict.fromkeys((*FIELDS, "tool"), 0.25) | {"hand": [1.0, 0, 0, 0]}, TAGS)
    limits = "ik_limits", "ik_limits_words"
    assert {driver.call(name, *ends) for name in limits} == {CODES["no_core"]}
    assert driver.start_up() == other.start_up() == "none"
    for name in limits:
        check_null_pointers(driver, name)
    driver.arm, other.arm = False, True
    assert driver.solve(poses)[0] == other.solve(poses)[0] == "other_core"
    assert {other.call(name, *ends) for name in limits} == {CODES["other_core"]} and not core.jobs + wrists.jobs


@pytest.mark.parametrize("width", [18, 32])
def test_joint_limits(library, width):
    """ik_limits rounds inward to core words, like `model.io.words.limit_words`, and calls ik_limits_words. Bad limits
    change no register."""
    core, random = RegisterModel(width, arm=1), np.random.default_rng(3)
    driver = Driver(library, core, COUNT, arm=True)
    assert driver.start_up() == "none"
    low = random.uniform(-4, 4, 7)
    high = low + random.uniform(0, 5, 7)
    high[2], low[4] = low[2] + 2 * np.pi, -np.inf
    words = np.array(limit_words(np.column_stack([low, high]), width)).T % (1 << width)
    reals = [(ctypes.c_double * 7)(*ends) for ends in (low, high)]
    for wrong in (None, np.nan, low[3] - 1, low[3] + 2.0**-60):  # no word is between low[3] and the last value
        if wrong is not None:
            reals[1][3] = wrong
        code = driver.call("ik_limits", *reals)
        assert (code, driver.core.bad) == ((0, 0) if wrong is None else (CODES["bad_limits"], 3))
        written = [[core.registers[f"LIMIT_{name}{k}"] for k in range(1, 8)] for name in ("LOW", "HIGH")]
        np.testing.assert_array_equal(np.array(written) >> 32 - width, words)


def test_start_up(library):
    codes = {0x494B0100: "none", 0x494B01FF: "none", 0x494B0200: "version"}
    for identity, code in (codes | dict.fromkeys((0x494A0100, 0, 0xFFFFFFFF), "no_core")).items():
        core = RegisterModel(identity=identity)
        driver = Driver(library, core, COUNT)
        assert driver.start_up() == code
        solved = driver.solve(driver.targets({name: np.ones(1) for name in FIELDS}, np.ones(1)))[0]
        assert solved == ("none" if code == "none" else "no_core")
    core = RegisterModel()
    core.registers["STATUS"] = 1  # never cleared
    assert Driver(library, core, COUNT, polls=9).start_up() == "timeout"
    core = RegisterModel()
    for name in ("read", "write", "source", "destination", "records"):
        driver = Driver(library, core, COUNT)
        setattr(driver.bus, name, type(getattr(driver.bus, name))())
        assert driver.start_up() == "null", name
    assert driver.call("ik_init", None) == CODES["null"]
    assert driver.linked.ik_init(None, ctypes.byref(driver.bus)) == CODES["null"]


@pytest.mark.parametrize("arm", [False, True])
def test_words_in_place(library, arm):
    """A solve call in words starts one job and does not change the records. It refuses zero or too many records, a busy
    core, a core of the other kind (wrist targets or hand poses), and a core before ik_init."""
    core, other = RegisterModel(arm=arm), RegisterModel(arm=not arm)
    driver, wrong = (Driver(library, one, COUNT >> arm, arm=arm) for one in (core, other))
    assert driver.solve_words(1) == "no_core" and driver.start_up() == wrong.start_up() == "none"
    records = np.random.default_rng(5).bytes(COUNT * BYTES)
    ctypes.memmove(core.areas[0][0], records, len(records))
    assert driver.solve_words(COUNT >> arm) == "none" and driver.core.written == COUNT >> arm
    assert core.jobs == [records]
    results = ctypes.string_at(core.areas[1][0], COUNT * BYTES)
    assert results == core.results[0] and driver.solve_words(3) == "none"
    assert [driver.solve_words(count) for count in (0, (COUNT >> arm) + 1)] == ["no_targets", "too_many"]
    core.registers["STATUS"], before = 1, core.memory.raw
    assert driver.solve_words(1) == "busy" and driver.linked.ik_busy(ctypes.byref(driver.core))
    assert core.memory.raw == before
    assert wrong.solve_words(1) == "other_core" and len(core.jobs) == 2 and not other.jobs
    for name in ("ik_solve_words", "ik_solve_arm_words"):
        assert getattr(driver.linked, name)(None, ctypes.c_size_t(1)) == CODES["null"]


def test_missing_result(library):
    """A job that reports done but has not written the result buffer returns the code ``lost``."""
    core = RegisterModel()
    elsewhere = ctypes.create_string_buffer(COUNT * BYTES)
    driver = Driver(library, core, COUNT)
    driver.bus.destination.at = ctypes.addressof(elsewhere)
    assert driver.start_up() == "none"
    code, results = driver.solve(driver.targets({name: np.ones(7) for name in FIELDS}, np.arange(7)))
    assert (code, len(results)) == ("lost", 0)


def test_texts(library):
    """Each code has its own text; all unknown codes have the same text."""
    driver = Driver(library, RegisterModel(), COUNT)
    texts = [driver.linked.ik_error_text(code) for code in (*CODES.values(), -1, 10, 15, max(CODES.values()) + 1)]
    assert len(set(texts)) == len(CODES) + 1 and len(set(texts[-4:])) == 1
    assert all(text.endswith(b".") for text in texts[:-4])


@pytest.mark.parametrize("arm", [0, 1])
def test_uio_maps_registers_and_buffer(library, tmp_path, arm):
    linked, uio, paths = ctypes.CDLL(str(library)), Uio(), uio_device(tmp_path, arm)
    assert linked.ik_uio_open(ctypes.byref(uio), *paths, 20) == 0
    user, bus, page = ctypes.addressof(uio), uio.bus, os.sysconf("SC_PAGESIZE")
    bus.write(user, OFFSETS["COUNT"], 77)
    for area, at, text in ((bus.source, 0x40, b"targets"), (bus.destination, 0x340, b"results")):
        ctypes.memmove(area.at, text, len(text))
        assert area.address == 0x10000000 + at and (tmp_path / "uio0").read_bytes()[page + at :].startswith(text)
    words = np.frombuffer((tmp_path / "uio0").read_bytes(), np.uint32)
    assert bus.records == 24 >> arm and words[0] == 1, "the interrupt stays masked"
    assert words[OFFSETS["COUNT"] // 4] == bus.read(user, OFFSETS["COUNT"]) == 77
    linked.ik_uio_close(ctypes.byref(uio))
    assert uio.file == -1 and str(tmp_path) not in Path("/proc/self/maps").read_text()


BAD = [("map1/addr", "none"), ("map1/addr", "0x10000010"), ("map1/size", "0x40"), ("map1/size", "0x7f")]
BAD += [("map1/offset", "0x42"), ("uio0", "fifo"), ("map1/size", None)]


@pytest.mark.parametrize(("name", "text"), BAD)
def test_uio_reports_what_is_missing(library, tmp_path, name, text):
    """A missing file, an unmappable file and a bad map attribute each return an error; nothing stays open or mapped."""
    uio, paths = Uio(), uio_device(tmp_path)
    (tmp_path / name).unlink()
    if text == "fifo":
        os.mkfifo(tmp_path / name)
    elif text:
        (tmp_path / name).write_text(text)
    error = {None: errno.ENOENT, "fifo": errno.ENODEV}.get(text, errno.EINVAL)
    before = os.listdir("/proc/self/fd")
    assert ctypes.CDLL(str(library)).ik_uio_open(ctypes.byref(uio), *paths, 20) == -error
    assert uio.file == -1 and os.listdir("/proc/self/fd") == before
    assert str(tmp_path) not in Path("/proc/self/maps").read_text()


ENDS = {"arrives": None, "silent": 0, "gone": errno.EIO, "signal": errno.EINTR}


@pytest.mark.parametrize("error", ENDS.values(), ids=ENDS)
def test_uio_wait_ends(library, tmp_path, error):
    """A wait ends on an interrupt (and unmasks it), on timeout, when the device disappears, and on an abort."""
    core, uio = RegisterModel(), Uio()
    if error is not None:
        core.run = lambda count: None  # no job ends
    driver = Driver(library, core, COUNT, polls=9)
    paths, patience = uio_device(tmp_path), 9000 if error == errno.EINTR else 20
    assert driver.linked.ik_uio_open(ctypes.byref(uio), *paths, patience) == 0
    driver.core, driver.bus.user, driver.bus.wait = uio.core, uio.bus.user, uio.bus.wait
    assert driver.start_up() == "none"
    kernel, descriptor = socket.socketpair()
    with descriptor:
        os.dup2(descriptor.fileno(), uio.file)
    thread, before = threading.get_ident(), signal.signal(signal.SIGUSR1, lambda *_: None)

    def abort():
        driver.linked.ik_abort(ctypes.byref(uio.core))
        signal.pthread_kill(thread, signal.SIGUSR1)

    if error == errno.EINTR:
        threading.Timer(0.1, abort).start()
    elif error is None:
        kernel.send(bytes(4))
    elif error:
        kernel.close()
    code, _ = driver.solve(driver.targets({name: np.ones(1) for name in FIELDS}, np.ones(1)))
    signal.signal(signal.SIGUSR1, before)
    expected = {None: "none", errno.EINTR: "aborted"}.get(error, "timeout")
    assert (code, uio.error) == (expected, error or 0)
    if error is None:
        kernel.settimeout(9)
        assert kernel.recv(9) == (1).to_bytes(4, sys.byteorder), "the interrupt stays masked"
        assert core.registers["IRQ_STATUS"] == 0, "the interrupt is not acknowledged"
    driver.linked.ik_uio_close(ctypes.byref(uio))


ICARUS = simulator() == "icarus"
FEW = "ik_init|solves/interrupt=.*/stalled=False|bus_error/.*=slverr|aborted/interrupt=False"
SMALL = {"W": 18, "ADDR_W": 20}
ARM = {"W": 18, "DATA_W": 128, "ARM": 1}
INSTANCES = [SMALL] if ICARUS else [SMALL, {"W": 18, "DATA_W": 128, "ADDR_W": 64, "LOG2_BURST": 4}, ARM]


def run(library, tests: str, parameters: dict[str, int], core: str, **options) -> None:
    env = {"IK_DRIVER": str(library), "COCOTB_TEST_FILTER": tests, "IK_AXI_CORE": core}
    options |= {"toplevel": "ik_axi", "module": "tb.axi.driver", "parameters": parameters, "env": env}
    passes(f"driver-{core}-{named(parameters)}", **options)


@pytest.mark.sim
@pytest.mark.cost(20)
@pytest.mark.parametrize("parameters", INSTANCES, ids=named)
def test_around_the_core(library, tmp_path, parameters):
    run(library, FEW if ICARUS else "", parameters, "echo", **echoing(tmp_path))


@pytest.mark.sim
@pytest.mark.cost(30)
@pytest.mark.skipif(ICARUS, reason="Verilator runs the same tests in a tenth of the time")
@pytest.mark.parametrize("parameters", [{}, pytest.param(ARM, marks=pytest.mark.slow)], ids=named)
def test_with_the_core(library, parameters):
    run(library, "solves/interrupt=True/stalled=False", parameters, "core")
