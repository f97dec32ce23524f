# SPDX-License-Identifier: Apache-2.0
"""scripts/console.py: exit status, signals, folders, progress."""

import io
import signal
import threading

import click
import pytest
from rich.progress import Progress

from scripts import console
from scripts.console import InputError, Meter, exit_status, pace, progress, writing


def raising(error):
    """Return a function that raises `error`."""

    def work():
        raise error

    return work


def parsing():
    parser = click.Command("some", params=[console.option("--count", "", console.whole(2))])
    return console.parse(parser, "", ["--count", "1"]).count


@pytest.mark.parametrize(
    ("work", "status", "message"),
    [
        (parsing, 2, "argument --count: 1 is not in the range 2<=x<=1000000000000000."),
        (raising(InputError("no")), 2, "no"),
        (raising(KeyboardInterrupt()), 130, "interrupted"),
        (raising(OSError(28, "disk full", "a/b")), 2, "cannot read or write 'a/b': disk full"),
        (raising(OSError(28, "disk full")), 2, "cannot read or write a file: disk full"),
    ],
)
def test_errors_become_a_status_and_one_line(work, status, message, capsys):
    assert exit_status("some", work) == status
    assert capsys.readouterr().err == f"some: {message}\n"


def test_a_full_disk_is_an_input_error():
    with pytest.raises(InputError, match="^cannot write 'a/b': disk full$"), writing():
        raise OSError(28, "disk full", "a/b")


@pytest.mark.parametrize("number", console.SIGNALS)
@pytest.mark.usefixtures("interruptible")
def test_a_second_signal_does_not_stop_the_clean_up(number):
    cleaned = []

    def work():
        try:
            signal.raise_signal(number)
        finally:
            signal.raise_signal(number)
            cleaned.append(True)

    before = signal.getsignal(number)
    assert exit_status("some", work) == 128 + number and cleaned == [True]
    assert signal.getsignal(number) is before


def test_new_empty_folders_are_removed(tmp_path):
    (tmp_path / "old").mkdir()
    with pytest.raises(KeyboardInterrupt), console.output(tmp_path / "old/a/b", [tmp_path / "old/a/c/file"]):
        assert (tmp_path / "old/a/c").is_dir()
        raise KeyboardInterrupt
    assert list(tmp_path.rglob("*")) == [tmp_path / "old"]
    with console.output(tmp_path / "old/a/b", []):
        (tmp_path / "old/a/b/file").touch()
    assert (tmp_path / "old/a/b/file").exists()


@pytest.fixture
def clock(monkeypatch):
    """Clock in seconds, set by the test."""
    now = [100.0]
    monkeypatch.setattr(console.time, "monotonic", lambda: now[0])
    return now


def test_lines_of_progress_without_a_terminal(clock, capsys):
    """The inner of two meters reports; its rate covers the last minutes and excludes an earlier run's work."""
    with progress("some", 0, every=30) as outer:
        clock[0] += 20
        with progress("inner", 5000, first=1000, every=30) as inner:
            inner(1000)
            clock[0] += 20
            inner(3000, "half")
            clock[0] += 200
            inner(3100, "slow")
        outer.beat()
        clock[0] += 40
        outer.beat()
    assert capsys.readouterr().err.splitlines() == [
        "inner: half: 3000 of 5000 done, 100/s, 20 s left",
        "inner: slow: 3100 of 5000 done, 30/min, 3800 s left",
        "some: 280 s so far",
    ]
    assert [pace(rate) for rate in (0.0, 0.999, 1 / 60, 0.01, 50.4)] == ["0/s", "60/min", "1/min", "36/h", "50/s"]


def test_lines_appear_while_nothing_gets_done(monkeypatch):
    beaten = threading.Event()
    monkeypatch.setattr(Meter, "beat", lambda meter: beaten.set())
    with progress("some", 100, every=0.01):
        assert beaten.wait(60)


def test_a_bar_on_a_terminal(clock):
    out = io.StringIO()
    bar = Progress(console=console.Console(file=out, force_terminal=True), auto_refresh=False)
    meter = Meter("some", 100, bar=bar)
    clock[0] += 2
    meter(50, "half [3/4]")
    (task,) = bar.tasks
    assert (task.completed, task.total, task.fields["rate"], task.description) == (50, 100, "25/s", "half [3/4]")
    meter.line("some: [a] line")
    assert "some: [a] line" in out.getvalue()
