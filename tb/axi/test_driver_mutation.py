# SPDX-License-Identifier: Apache-2.0
"""Bugs that are put into the C driver are caught, each by the test that is there for it."""

import shutil

import pytest

from tb.axi import test_driver_c as without_core
from tb.axi.binding import SOURCE, compiled
from tb.axi.test_driver import run
from tb.sim.env import ROOT, simulator
from tb.sim.mutants import Bug

FILE = str((SOURCE / "ik.c").relative_to(ROOT))

NUMBERS = [  # fails: a function of test_driver_c
    Bug("ties up", FILE, "rest > half || (rest == half && (word & 1))", "rest >= half", "numbers"),
    Bug("cuts off", FILE, "word += rest > half ||", "word += 0 * rest > half ||", "numbers"),
    Bug("2 becomes -2", FILE, " - (word == UINT64_C(1) << 31)", "", "numbers"),
    Bug("-2 does not fit", FILE, "(is.negative && power ? 2 : 1)", "(is.negative && power ? 1 : 1)", "numbers"),
    Bug("scales too much", FILE, "HEADROOM = 4", "HEADROOM = 5", "numbers"),
    Bug("scales too little", FILE, "HEADROOM = 4", "HEADROOM = 3", "numbers"),
    Bug("subnormals are half as large", FILE, "(biased ? biased : 1) - 1075", "biased - 1075", "numbers"),
    Bug("half a turn is one", FILE, "t->phi / TURN, 32", "t->phi / TURN, 33", "numbers"),
    Bug("shifts far", FILE, "up < 64 ? is.digits << up : 0", "is.digits << (up & 63)", "numbers"),
    Bug("coordinates do not scale", FILE, "furthest < longest ? furthest : longest", "longest", "numbers"),
    Bug("the first reach scales", FILE, "if (fits(reach) < longest)", "if (k == 0)", "numbers"),
    Bug("no negative words", FILE, "(word >> 31 ? 4.0 : 0.0)", "0.0", "numbers"),
    Bug("y is x", FILE, "length_word(t->y", "length_word(t->x", "numbers"),
    Bug("d2 is d1", FILE, "length_word(t->d2", "length_word(t->d1", "numbers"),
    Bug("flags of the tag", FILE, "record[6] >> 24", "record[6] >> 16", "numbers"),
    Bug("the whole tag", FILE, "record[6] & 0xffffffu", "record[6]", "numbers"),
    Bug("targets from the start", FILE, "targets + done, results", "targets, results", "numbers"),
    Bug("results from the start", FILE, "results + done", "results", "numbers"),
    Bug("no look at phi", FILE, " && finite(t->phi)", "", "test_refused"),
    Bug("infinity is finite", FILE, "< 0x7ff - 1075", "<= 0x7ff - 1075", "test_refused"),
    Bug("no look at d2", FILE, " && t->d2 > 0", "", "test_refused"),
    Bug("words of 32 bits are meant", FILE, "(32 - core->width)", "(32 - 32)", "test_refused"),
    Bug("a word of the core is short", FILE, "< ulp - ulp / 2", "<= ulp - ulp / 2", "test_refused"),
    Bug("names no short arm", FILE, "core->bad = shortest;", "", "test_refused"),
    Bug("names no far target", FILE, "core->bad = far;", "", "test_refused"),
    Bug("nothing is to do", FILE, "if (!n) return", "if (0) return", "test_refused"),
    Bug("any core", FILE, "!= IK_ID_MAGIC_RESET", "== 0", "test_start_up"),
    Bug("any version", FILE, "!= IK_ID_MAJOR_RESET", "== 0", "test_start_up"),
    Bug("no look at buffers", FILE, " || !bus->records", "", "test_start_up"),
    Bug("a buffer that is not written", FILE, "[(size_t)k * WORDS + 7] != k", "[(size_t)k * WORDS + 7] == 1 << 30",
        "test_result_that_is_not_there"),
    Bug("a text is missing", FILE, '[IK_LOST] = "A result', '[IK_NULL] = "A result', "test_texts"),
]  # fmt: skip

JOBS = [  # fails: tests of driver.py
    Bug("targets stay in the cache", FILE, "bus->flush(bus->user, from->at, (size_t)n * WORDS * 4);", "", "solves"),
    Bug("dirty lines over results", FILE, "bus->flush(bus->user, to->at, (size_t)n * WORDS * 4);", "", "solves"),
    Bug("results of the cache", FILE, "if (bus->invalidate)", "if (0)", "solves"),
    Bug("a start too many records", FILE, "set(core, IK_COUNT, n)", "set(core, IK_COUNT, n + 1)", "solves"),
    Bug("an address of 32 bits", FILE, "(uint32_t)(to->address >> 32)", "0", "solves"),
    Bug("interrupts while polling", FILE, "bus->wait ? all : 0", "all", "who_is_there"),
    Bug("leaves a job alone", FILE, "const ik_code code = give_up(core, IK_OK);", "const ik_code code = IK_OK;",
        "who_is_there"),
    Bug("the datapath is always lean", FILE, "(config & IK_CONFIG_LEAN) != 0", "config == 0", "who_is_there"),
    Bug("does not acknowledge", FILE, "set(core, IK_IRQ_STATUS, seen);", "", "solves"),
    Bug("knows the end of the last job", FILE, "core->events = 0;", "", "solves"),
    Bug("keeps an old interrupt", FILE,
        "set(core, IK_IRQ_STATUS, IK_IRQ_STATUS_DONE | IK_IRQ_STATUS_ERROR | IK_IRQ_STATUS_REFUSED);", "", "busy"),
    Bug("starts while busy", FILE, "if (get(core, IK_STATUS) & IK_STATUS_BUSY) return IK_BUSY;", "", "busy"),
    Bug("is not refused", FILE, "if (core->events & IK_IRQ_STATUS_REFUSED) return IK_BUSY;", "", "busy"),
    Bug("overlooks an error", FILE, "if (!(core->events & IK_IRQ_STATUS_ERROR)) return IK_OK;", "return IK_OK;",
        "error_on_the_bus|refused_areas"),
    Bug("half an address", FILE, "(uint64_t)get(core, IK_ERROR_HI) << 32 | ", "", "error_on_the_bus"),
    Bug("all are written", FILE, "code ? get(core, IK_WRITTEN) : n", "n", "error_on_the_bus"),
    Bug("none is written", FILE, "code ? get(core, IK_WRITTEN) : n", "code ? 0 : n", "error_on_the_bus"),
    Bug("hears no abort", FILE, "if (core->aborted) return give_up(core, IK_ABORTED);", "", "aborted"),
    Bug("aborts ever after", FILE, "core->aborted = false;", "", "aborted"),
    Bug("no soft reset", FILE, "set(core, IK_CONTROL, IK_CONTROL_SOFT_RESET);", "", "memory_hangs"),
    Bug("does not wait for the bus", FILE, "if (core->bus.polls && !--left) return IK_TIMEOUT;", "break;", "aborted"),
]  # fmt: skip

pytestmark = pytest.mark.skipif(not shutil.which("cc"), reason="no C compiler")


def name(bug: Bug) -> str:
    return bug.what.replace(" ", "_")


def seeded(bug: Bug, folder):
    return compiled(folder, "-w", text=bug.seeded((ROOT / bug.file).read_text()))  # it may leave something unused


def test_bugs_can_be_seeded():
    for bug in NUMBERS + JOBS:
        assert bug.seeded((ROOT / bug.file).read_text())


@pytest.mark.slow
@pytest.mark.parametrize("bug", [pytest.param(bug, marks=pytest.mark.cost(1)) for bug in NUMBERS], ids=name)
def test_wrong_numbers(bug, tmp_path):
    with pytest.raises(AssertionError):
        getattr(without_core, bug.fails)(seeded(bug, tmp_path))


@pytest.mark.sim
@pytest.mark.slow
@pytest.mark.skipif(simulator() != "icarus", reason="the same tests; Icarus builds them in a second")
@pytest.mark.parametrize("bug", [pytest.param(bug, marks=pytest.mark.cost(6)) for bug in JOBS], ids=name)
def test_wrong_jobs(bug, tmp_path):
    with pytest.raises(SystemExit, match=r"^FAILED \d+ tests"):
        run(tmp_path, seeded(bug, tmp_path), bug.fails, W=18, DATA_W=128, ADDR_W=64, LOG2_BURST=4)
