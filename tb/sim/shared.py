# SPDX-License-Identifier: Apache-2.0
"""cocotb tests as pytest cases: one simulation for all that pytest has selected, and a message that names the cause."""

import logging
import os
import re
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from unittest.mock import patch
from xml.etree import ElementTree

import pytest

from tb.sim import coverage
from tb.sim.waves import mark

LOGS, WAVES = coverage.build("log"), coverage.build("waves")
SECONDS = 1800.0  # time limit of a command that compiles or simulates
RULE = re.compile(r"error: (rule \w+ \([^)]+\) is broken at \S+, (\d+) ns)")
ENDED = "ended prematurely"
"""Part of cocotb's message if the simulator stops during a test; all later tests get the same message."""
NOT_RUN = "not run: "
REWRITTEN = re.compile(r"(?<=.)\nassert .*", re.S)
"""Values of the asserted expression, which cocotb 2.1 appends to the message of an assertion."""
INSTANCE = re.compile(r"(?<==)(ik_\w+)\..*")
"""Pattern in a unit test's name: the instance that the test drives, then the check."""


class Shared:
    """A simulation that several pytest cases share.

    ``label`` names the log. ``options(names)`` returns the arguments of :func:`tb.sim.runner.simulate` for the selected
    cases; ``case_of(test)`` returns the name of the case to which a cocotb test belongs. A pytest case has the
    parameters ``simulation``, an object of this class, and ``name``.
    """

    def __init__(self, label: str, options: Callable[[list[str]], dict], case_of: Callable[[str], str] = str) -> None:
        self.log, self.options, self.case_of = LOGS / f"{label}.log", options, case_of
        self.messages: dict[str, list[str]] = {}

    def check(self, request: pytest.FixtureRequest, name: str) -> None:
        """Fail with the message of the case's first cocotb test that did not pass; skip if this test was not run.

        The first case that is checked runs the simulation.
        """
        if not self.messages:
            chosen = [item.callspec.params for item in request.session.items if hasattr(item, "callspec")]
            names = [params["name"] for params in chosen if params.get("simulation") is self]
            try:
                for test, message in failures(self.log, **self.options(names)):
                    self.messages.setdefault(self.case_of(test), []).append(message)
            except SystemExit as ended:
                self.messages = dict.fromkeys(names, [str(ended)])
        judge(self.messages[name], self.log)


def passes(label: str, **options) -> None:
    """Simulate, and fail with the message of the first cocotb test that did not pass. ``label`` names the log."""
    log = LOGS / f"{label}.log"
    try:
        messages = [message for _, message in failures(log, **options)]
    except SystemExit as ended:
        messages = [str(ended)]
    judge(messages, log)


def judge(messages: list[str], log: Path) -> None:
    """Fail with the first message that is not empty; skip instead if this message reports a test that was not run."""
    if wrong := [message for message in messages if message]:
        others = sum(not message.startswith(NOT_RUN) for message in wrong[1:])
        more = f" ({others} more fail)" if others else ""
        text = f"{wrong[0]}{more}; log: {os.path.relpath(log)}"
        pytest.skip(text) if text.startswith(NOT_RUN) else pytest.fail(text, pytrace=False)


def failures(log: Path, **options) -> list[tuple[str, str]]:
    """Simulate, write the output to ``log``, and return (name, message) of each cocotb test; "" if the test passed.

    A broken bus rule ends the simulation: the test's message names the rule, and later tests are "not run".
    If IK_WAVES is set, the simulation is recorded, and each message names a GTKWave save file that marks the failure.
    Raises :class:`SystemExit` if there are no results (with the first error of the log), if no test was selected, or if
    the simulator failed after all tests had passed.
    """
    from tb.sim.runner import simulate  # benches import this module inside the simulator as well

    results, vcd, failed = log.with_suffix(".xml"), recording(log.stem), ""
    results.unlink(missing_ok=True)
    with logged(log), patch.dict(os.environ, {"COCOTB_RESULTS_FILE": str(results)}):
        try:
            simulate(**options, waves=vcd, seconds=SECONDS)
        except SystemExit as ended:
            failed = str(ended)
            if not results.exists():
                text = log.read_text()
                if rule := RULE.search(text):
                    raise SystemExit(rule[1]) from None
                lines = re.findall("^.*error.*$", text, re.I | re.M)[:1] or re.findall(r"running \S+ \(.*", text)[-1:]
                raise SystemExit(": ".join([failed, *lines])) from None
    rule = RULE.search(log.read_text())
    messages, stopped = [], ""
    for case in ElementTree.parse(results).iter("testcase"):
        name, failure, message = case.get("name"), case.find("failure"), ""
        properties = {item.get("name"): item.get("value") for item in case.iter("property")}
        start, stop = float(properties["sim_time_start"]), float(properties["sim_time_stop"])
        if failure is not None and stopped:
            message = f"{NOT_RUN}{stopped}"
        elif failure is not None:
            message = REWRITTEN.sub("", failure.get("message") or failure.get("type") or "failed")
            broken = rule is not None and int(rule[2]) <= stop
            if broken or ENDED in message:
                message = rule[1] if broken else "the simulator stopped during the test"
                stopped = f"the simulation ended in {name}"
            instance = INSTANCE.search(name)
            scope = instance[1] if instance else options["toplevel"]
            message += marked(vcd, instance[0] if instance else name, scope, moment(message, start, stop))
        messages.append((name, message))
    if not messages:
        raise SystemExit("no cocotb test has the name that was selected")
    if not any(message for _, message in messages):
        if failed:
            raise SystemExit(f"all tests pass, but: {failed}")
        if vcd:
            vcd.unlink()
    return messages


def recording(label: str) -> Path | None:
    """Return the path of the VCD that a simulation writes; None unless IK_WAVES is set."""
    if not os.environ.get("IK_WAVES"):
        return None
    WAVES.mkdir(parents=True, exist_ok=True)
    return WAVES / f"{label}.vcd"


def marked(vcd: Path | None, test: str, scope: str, time: float) -> str:
    """Write a save file that marks the time (ns) at which a test failed. Return text with the file's path, to be
    appended to the test's message; "" if ``vcd`` is None."""
    if not vcd:
        return ""
    save = vcd.with_name(f"{vcd.stem}-{test}.gtkw".replace("/", "-"))
    mark(vcd, scope, time, save)
    return f"; waves: {os.path.relpath(save)}"


def moment(message: str, start: float, stop: float) -> float:
    """Return the time in ns that a message names: "N ns", or "clock N" counted from ``start``; ``stop`` if neither."""
    if found := re.search(r"\b(?:clock (\d+)|(\d+) ns)\b", message):
        return start + 10 * int(found[1]) if found[1] else int(found[2])
    return stop


@contextmanager
def logged(path: Path) -> Iterator[None]:
    """Write the output of simulations to a file instead of pytest's report."""
    path.parent.mkdir(parents=True, exist_ok=True)
    logger = logging.getLogger("cocotb")
    with closing(logging.FileHandler(path, mode="w")) as handler:
        with patch.multiple(logger, propagate=False, handlers=[*logger.handlers, handler]):
            yield
