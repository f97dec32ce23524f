# SPDX-License-Identifier: Apache-2.0
"""Fixtures for tests of commands; a model that replaces the simulators."""

from functools import partial
from pathlib import Path
from shutil import which

import numpy as np
import pytest
from vcd.writer import VCDWriter

from model.dataflow.datapaths import MODELS
from scripts import console, run, trajectory
from scripts.report.tests.browser import WIDE, Page
from scripts.waves import model_bits, place, variable
from tb.core import worst_targets
from tb.sim import native_run
from tb.sim.job import Run, answer

LATENCY = 44


def admissions(count):
    """Return the admission clock of each target: the first is 6, and 3 clocks are idle after target 1."""
    return [6 + k + 3 * (k > 1) for k in range(count)]


def nodes_of(words, datapath="lean", width=32, limits=None):
    return answer(words, width, datapath, limits).shown


class FakeSimulator:
    """Replacement for `simulate` that returns the model's results. `calls` records the arguments of each call; `spoil`
    may change the runs; `wrong` lists the (node, target) pairs that get a wrong bit in the recording."""

    def __init__(self):
        self.calls, self.wrong = [], []
        self.spoil = lambda *runs: None

    @property
    def words(self):
        """Words of the first job of each call."""
        return [call["jobs"][0] for call in self.calls]

    def __call__(self, jobs, *, datapath, width, waves=None, **others):
        self.calls.append({"jobs": jobs, "datapath": datapath, "width": width, **others})
        if waves:
            assert waves.is_absolute(), "the simulator runs in another folder"
            self.record(waves, jobs, datapath, width, others.get("limits"))
        runs = []
        for job in jobs:
            model = answer(job, width, datapath, others.get("limits"))
            runs.append(Run(model.results.copy(), model.flags.copy(), LATENCY, LATENCY + len(job), 0, None))
        self.spoil(*runs)
        return runs

    def record(self, path, jobs, datapath, width, limits=None):
        """Write a VCD of a single job; for several jobs, only the first target's words are shown."""
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
                bits = {"clk": 1, "rst": clock < 4, "s_axis_tready": 1, "s_axis_tvalid": clock in admitted}
                for name, bit in bits.items():
                    writer.change(lines[name], rise, int(bit))
                for node in nodes:
                    bits = "x"
                    if clock - node.time in admitted:
                        target = admitted.index(clock - node.time)
                        bits = model_bits(node, target)
                        if (node.name, target) in self.wrong:
                            bits = format(int(bits, 2) ^ 1, f"0{len(bits)}b")
                    writer.change(lines[node.name], rise, bits)
                writer.change(lines["clk"], 10_000 * clock, 0)


def without_rtl(patch):
    """Replace the simulator by the bit-true model, and the predicted errors by a ramp; return the fake simulator."""
    fake = FakeSimulator()
    for module in (trajectory, worst_targets):
        patch.setattr(module, "simulate", fake)
    patch.setattr(native_run, "program", lambda datapath, width: None)
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


@pytest.fixture(scope="session")
def chromium():
    """Start the installed Chromium with Playwright; no browser is downloaded."""
    from playwright.sync_api import sync_playwright  # `make test` does not install it

    with sync_playwright() as playwright:
        options = ["--disable-gpu", "--disable-dev-shm-usage"]
        yield playwright.chromium.launch(executable_path=which("chromium"), args=options)


@pytest.fixture
def browser(chromium):
    """Return a function browser(address, size, **features) that opens a page. A problem of a page fails the test."""
    pages = []

    def browser(address, size=WIDE, **features):
        pages.append(Page(chromium, *size, **features))
        return pages[-1].open(address)

    yield browser
    for page in pages:
        page.close()
    assert [page.problems for page in pages] == [[] for _ in pages]
