# SPDX-License-Identifier: Apache-2.0
"""Formula from Yosys (`write_smt2`), unrolled over several clocks: each signal is a constant in each clock.

Yosys writes functions of a state. With constants, z3 recognizes equal expressions without reasoning about products.
"""

import re
import time
from functools import cache, lru_cache
from typing import NamedTuple

from tb.formal.tools import call

LIMIT = 120  # seconds for one question
TACTIC = "(check-sat-using (then simplify propagate-values solve-eqs smt))"  # cancels sums before bit blasting


class Answer(NamedTuple):
    """Answer of z3: ``said`` is "unsat", "sat", "timeout", "unknown" or an error message."""

    said: str
    seconds: float


@lru_cache(maxsize=4096)
def ask_each(texts: tuple[str, ...], check: str = "(check-sat)", limit: int = LIMIT) -> list[Answer]:
    """Append ``check`` to each text, run one z3 on all for at most ``limit`` seconds, and return its answers."""
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
