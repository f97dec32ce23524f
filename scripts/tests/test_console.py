# SPDX-License-Identifier: Apache-2.0
"""scripts/console.py: what no command's own test looks at."""

import contextlib
import io
import re
import signal
import threading

import pytest
from rich.progress import Progress

from scripts import console
from scripts.console import InputError, Meter, Parser, exit_status, pace, progress, writing


def test_a_mistake_is_one_line_and_status_2(capsys):
    parser = Parser("some", "Does things.")
    parser.add_argument("--count", type=console.whole(2))
    assert exit_status("some", lambda: parser.parse_args(["--count", "1"]).count) == 2
    assert capsys.readouterr().err == "some: argument --count: '1' is not a whole number of at least 2\n"


@pytest.mark.parametrize("error, status", [(InputError("no"), 2), (KeyboardInterrupt(), 130)])
def test_what_is_raised_becomes_a_status(error, status, capsys):
    def work():
        raise error

    assert exit_status("some", work) == status
    assert capsys.readouterr().err.startswith("some: ")


def test_a_full_disk_is_an_input_error():
    with pytest.raises(InputError, match="^cannot write 'a/b': No space left on device$"), writing():
        raise OSError(28, "No space left on device", "a/b")


@pytest.fixture
def clock(monkeypatch):
    """Seconds that pass as the test says."""
    now = [100.0]
    monkeypatch.setattr(console.time, "monotonic", lambda: now[0])
    return now


def test_without_a_terminal_a_line_now_and_then(clock, capsys):
    with progress("some", 5000, first=1000, every=30) as meter:
        clock[0] += 20
        meter(1200)
        clock[0] += 20
        meter(3000, "half")
        clock[0] += 20
        meter(4000)
    assert capsys.readouterr().err == "some: half: 3000 of 5000 done, 50/s, 40 s left\n"


def test_what_is_left_is_estimated_by_the_last_minutes(clock, capsys):
    """Not by what was there before, also while nothing gets done; slow work has a rate, too."""
    meter = Meter("some", 1250, every=300)
    for done in (999, 1000):
        meter(done)
    clock[0] += 360
    meter.beat()
    for done in range(1001, 1005):
        clock[0] += 100
        meter(done)
    said = ["some: 1000 of 1250 done, 10/h, 90000 s left", "some: 1003 of 1250 done, 36/h, 24700 s left"]
    assert capsys.readouterr().err.splitlines() == said
    assert [pace(rate) for rate in (0.0, 0.999, 1 / 60, 0.01, 50.4)] == ["0/s", "60/min", "1/min", "36/h", "50/s"]


def test_a_line_also_while_nothing_gets_done(clock, capsys):
    """A compiler works."""
    meter = Meter("some", 100, every=5)
    meter(0, "compiling")
    for _ in range(4):
        clock[0] += 3
        meter.beat()
    assert capsys.readouterr().err == "some: compiling: 6 s so far\nsome: compiling: 12 s so far\n"


def test_without_a_terminal_something_asks_for_that_line(monkeypatch):
    """Whatever the command waits for: here for that very thing."""
    asked = threading.Event()
    monkeypatch.setattr(Meter, "beat", lambda meter: asked.set())
    with progress("some", 100, every=0.01):
        assert asked.wait(60)


def test_an_error_without_a_name_and_one_with_it(capsys):
    def work(*arguments):
        raise OSError(28, "No space left on device", *arguments)

    assert exit_status("some", lambda: work("a/b")) == exit_status("some", work) == 2
    reason = "No space left on device"
    assert capsys.readouterr().err.splitlines() == [
        f"some: cannot read or write 'a/b': {reason}", f"some: cannot read or write a file: {reason}",
    ]  # fmt: skip


@pytest.mark.parametrize("number", console.SIGNALS)
def test_a_second_signal_does_not_stop_the_way_out(number, capsys):
    cleaned = []

    def work():
        try:
            signal.raise_signal(number)
        finally:
            signal.raise_signal(number)
            cleaned.append(True)

    before = signal.signal(number, signal.default_int_handler)
    try:
        assert exit_status("some", work) == 128 + number
    finally:
        signal.signal(number, before)
    assert cleaned == [True]


def test_output_that_came_to_nothing(tmp_path):
    """Only new folders go, and only empty ones."""
    (tmp_path / "old").mkdir()
    with pytest.raises(KeyboardInterrupt), console.output(tmp_path / "old/a/b", [tmp_path / "old/a/c/file"]):
        assert (tmp_path / "old/a/c").is_dir()
        raise KeyboardInterrupt
    assert list(tmp_path.rglob("*")) == [tmp_path / "old"]
    with console.output(tmp_path / "old/a/b", []):
        (tmp_path / "old/a/b/file").touch()
    assert (tmp_path / "old/a/b/file").exists()


def test_the_inner_of_two_meters_speaks_and_none_twice(clock, capsys):
    """A command says how long it works where nothing in it says more."""
    with progress("some", 0, every=5) as outer:
        clock[0] += 4
        with progress("inner", 10, every=5) as inner:
            clock[0] += 2
            inner(1)
        outer.beat()
        clock[0] += 5
        outer.beat()
        inner.line("some: target 3 is wrong")
    said = ["inner: 1 of 10 done, 30/min, 18 s left", "some: 11 s so far", "some: target 3 is wrong"]
    assert capsys.readouterr().err.splitlines() == said


def test_an_outer_meter_is_silent_while_an_inner_one_is_there(monkeypatch):
    beats = []
    monkeypatch.setattr(Meter, "beat", lambda meter: beats.append(meter.name))
    with progress("some", 0, every=0.05), progress("inner", 1, every=0.05):
        beats.clear()
        threading.Event().wait(0.2)
        within = set(beats)
    assert within == {"inner"}


def test_every_command_says_that_it_is_at_work(monkeypatch):
    monkeypatch.setattr(console, "progress", lambda name, total: contextlib.nullcontext(said.append(name)))
    said = []
    assert exit_status("some", lambda: 3) == 3 and said == ["some"]


def test_on_a_terminal_a_bar_with_the_same_figures(clock):
    out = io.StringIO()
    bar = Progress(console=console.Console(file=out, force_terminal=True), auto_refresh=False)
    meter = Meter("some", 100, bar=bar)
    clock[0] += 2
    meter(50, "half [3/4]")
    (task,) = bar.tasks
    assert (task.completed, task.total, task.fields["rate"], task.description) == (50, 100, "25/s", "half [3/4]")
    meter.line("some: [a] line")
    assert re.search(r"some: \[a\] line", out.getvalue())
