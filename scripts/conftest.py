# SPDX-License-Identifier: Apache-2.0
"""Fixtures for tests of commands: a fake simulator that returns the model's results, and headless Chromium windows."""

from functools import partial
from pathlib import Path
from shutil import which

import numpy as np
import pytest
from vcd.writer import VCDWriter

from model.dataflow.datapaths import MODELS
from scripts import console, run, trajectory
from scripts.waves import model_bits, place, variable
from tb.core import worst_targets
from tb.sim import native_run
from tb.sim.job import Run, answer

LATENCY = 44


def admissions(count):
    """Return each target's admission clock: one target per clock from clock 6, with 3 idle clocks after target 1."""
    return [6 + k + 3 * (k > 1) for k in range(count)]


def nodes_of(words, datapath="lean", width=32, limits=None):
    return answer(words, width, datapath, limits).shown


class FakeSimulator:
    """Replacement for `simulate` that returns the model's results. `calls` records the arguments of each call.
    `spoil` may change the returned runs. Each (node, target) in `wrong` gets a wrong bit in the recording."""

    def __init__(self):
        self.calls, self.wrong = [], []
        self.spoil = lambda *runs: None

    @property
    def words(self):
        """Input words of each call's first job."""
        return [call["jobs"][0] for call in self.calls]

    def __call__(self, jobs, *, datapath, width, waves=None, limits=None, **others):
        self.calls.append({"jobs": jobs, "datapath": datapath, "width": width, "limits": limits, **others})
        if waves:
            assert waves.is_absolute(), "the simulator runs in another folder"
            self.record(waves, jobs, datapath, width, limits)
        runs = []
        for job in jobs:
            model = answer(job, width, datapath, limits)
            runs.append(Run(model.results.copy(), model.flags.copy(), LATENCY, LATENCY + len(job), 0, None))
        self.spoil(*runs)
        return runs

    def record(self, path, jobs, datapath, width, limits=None):
        """Write a VCD of jobs[0]; if there are more jobs, it contains only the words of the first target of jobs[0]."""
        nodes, of = nodes_of(jobs[0], datapath, width, limits), MODELS[datapath]
        top = (of.top,)
        admitted = admissions(len(jobs[0])) if len(jobs) == 1 else [0]
        core = (*top, f"g_{of.rtl}", "u_core")
        sizes = {(*top, name): 1 for name in ("clk", "rst")} | {(*core, name): 1 for name in ("in_valid", "out_valid")}
        for side, words in (("s", of.inputs), ("m", of.results)):
            bits = {"tvalid": 1, "tready": 1, "tuser": 8, "tdata": len(words) * width}
            sizes |= {(*top, f"{side}_axis_{name}"): count for name, count in bits.items()}
        sizes |= {(*top, *place(datapath, node)): node.format.width for node in nodes}
        with open(path, "w", encoding="ascii") as stream, VCDWriter(stream, timescale="1 ps") as writer:
            lines = {name[-1]: variable(writer, name, size) for name, size in sizes.items()}
            for clock in range(1, admitted[-1] + max(node.time for node in nodes) + 9):
                rise = 10_000 * clock - 5_000
                stream = {"clk": 1, "rst": clock < 4, "s_axis_tready": 1, "s_axis_tvalid": clock in admitted}
                for name, bit in stream.items():
                    writer.change(lines[name], rise, int(bit))
                for node in nodes:
                    if clock - node.time in admitted:
                        target = admitted.index(clock - node.time)
                        bits = model_bits(node, target)
                        wrong = (node.name, target) in self.wrong
                        writer.change(lines[node.name], rise, int(bits, 2) ^ wrong)
                writer.change(lines["clk"], 10_000 * clock, 0)


def without_rtl(patch):
    """Replace simulations by the bit-true model, and predicted errors by a ramp; return the fake simulator."""
    fake = FakeSimulator()
    for module in (trajectory, worst_targets):
        patch.setattr(module, "simulate", fake)
    patch.setattr(native_run, "program", lambda datapath, width: None)
    patch.setattr(console, "installed", lambda need: False)
    patch.setattr(trajectory, "predicted_error", lambda w, width, _: np.linspace(1, 2, len(w)) * 2.0 ** (8 - width))
    return fake


@pytest.fixture
def simulator(monkeypatch):
    return without_rtl(monkeypatch)


@pytest.fixture
def command(tmp_path, monkeypatch, capsys):
    """Return a function that calls a main() in an empty folder and returns its exit status, stdout and stderr lines."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(console, "EVERY", 1e6)  # no lines of progress on stderr
    monkeypatch.delenv("MAKELEVEL", raising=False)

    def command(main, *arguments):
        status = main(list(arguments))
        captured = capsys.readouterr()
        return status, captured.out.splitlines(), captured.err.splitlines()

    return command


@pytest.fixture
def cli(simulator, command):
    return partial(command, run.main)


@pytest.fixture
def files():
    """Return a function that lists the files below the working folder, sorted."""
    return lambda: sorted(str(path) for path in Path().rglob("*") if path.is_file())


WIDE, NARROW = (1400, 1000), (400, 800)

# Scripts evaluated in the page.
FITS = "document.documentElement.scrollWidth <= window.innerWidth"
# Elements that overflow the window or their own box sideways, except inside scrolling boxes.
STICKING_OUT = """[...document.body.querySelectorAll("*")]
    .filter((e) => e.getBoundingClientRect().right > document.documentElement.clientWidth + 0.5
        || (e.clientWidth && e.scrollWidth > e.clientWidth + 1))
    .map((e) => e.tagName + "#" + e.id)"""

# Function that sets a control as a user does.
SET = """((name, value) => {
    const e = document.getElementById(name);
    e.value = value;
    for (const kind of ['input', 'change']) e.dispatchEvent(new Event(kind));
})"""

LIMIT = 60  # seconds per action; a loaded computer may start a browser slowly


class Page:
    """Window of `width` x `height` CSS pixels with its own browser profile. `problems` collects console messages and
    uncaught errors; `requests` collects the addresses that are loaded."""

    def __init__(self, browser, width: int, height: int, **media: str):
        self.problems: list[str] = []
        self.requests: list[str] = []
        self._context = browser.new_context()
        self._context.set_default_timeout(1000 * LIMIT)
        self._page = self._context.new_page()
        self._page.on("pageerror", lambda error: self.problems.append(str(error)))
        self._page.on("console", lambda message: self.problems.append(f"console.{message.type}: {message.text}"))
        self._page.on("request", lambda request: self.requests.append(request.url))
        self.call = self._context.new_cdp_session(self._page).send
        self.click, self.press, self.run = self._page.click, self._page.keyboard.press, self._page.evaluate
        self.close = self._context.close
        self.resize(width, height, **media)

    def resize(self, width: int, height: int, **media: str) -> None:
        self._page.set_viewport_size({"width": width, "height": height})
        self._page.emulate_media(**media)

    def open(self, url: str, before: str = "") -> "Page":
        """Load a page and wait until its scripts have run. The script `before` runs before them."""
        self._page.add_init_script(before)
        for address in ("about:blank", url):  # a change of only the #hash would not reload the page
            self.requests.clear()
            self._page.goto(address)
        return self

    def wait_for(self, script: str) -> None:
        self._page.wait_for_function(f"() => {script}")

    def choose(self, name: str, value: object) -> None:
        """Set the control whose id is `name`."""
        self.run(f"{SET}('{name}', '{value}')")

    def text(self, name: str) -> str:
        """Return the text of the element whose id is `name`."""
        return self._page.text_content(f"#{name}")

    def picture(self, name: str = "scene") -> str:
        """Return the picture on the canvas whose id is `name`."""
        return self.run(f"document.getElementById('{name}').toDataURL()")

    def drag(self, start: tuple[float, float], end: tuple[float, float], *, touch: bool = False) -> None:
        """Press the mouse or a finger at `start` and release it at `end`; with start == end it is a click."""
        middle = tuple((a + b) / 2 for a, b in zip(start, end, strict=True))
        if touch:
            for kind, points in (("Start", [start]), ("Move", [middle]), ("Move", [end]), ("End", [])):
                touched = [{"x": x, "y": y} for x, y in points]
                self.call("Input.dispatchTouchEvent", {"type": f"touch{kind}", "touchPoints": touched})
            return
        self._page.mouse.move(*start)
        self._page.mouse.down()
        self._page.mouse.move(*end, steps=2)
        self._page.mouse.up()

    def middle(self, selector: str) -> tuple[float, float]:
        """Scroll an element into view and return its centre."""
        element = self._page.locator(selector).first
        element.scroll_into_view_if_needed()
        box = element.bounding_box()
        return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


@pytest.fixture(scope="session")
def chromium():
    """Start the installed Chromium with Playwright; no browser is downloaded."""
    from playwright.sync_api import sync_playwright  # `make test` does not install it

    with sync_playwright() as playwright:
        options = ["--disable-gpu", "--disable-dev-shm-usage"]
        yield playwright.chromium.launch(executable_path=which("chromium"), args=options)


@pytest.fixture
def browser(chromium):
    """Return a function browser(address, size, **features) that opens a page. A page with problems fails the test."""
    pages = []

    def browser(address, size=WIDE, **features):
        pages.append(Page(chromium, *size, **features))
        return pages[-1].open(address)

    yield browser
    for page in pages:
        page.close()
    assert [page.problems for page in pages] == [[] for _ in pages]
