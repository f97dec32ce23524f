# SPDX-License-Identifier: Apache-2.0
"""Induction with one question per property: it holds in the next clock if all properties hold in this one.

Used for proofs that SymbiYosys does not finish in one question, and for seeded bugs, where a given property must fail.
"""

from __future__ import annotations

import re
from pathlib import Path

from tb.formal.unrolled import Answer, Unrolled, ask

LIMIT = 600  # seconds for one question
TACTIC = (
    "(check-sat-using (then simplify propagate-values solve-eqs smt))"  # cancels sums of ghosts before bit blasting
)


class Steps:
    """Questions about the formula of a design.

    Names of the properties that a question uses may end in a sign: for a sliced property, `name` means the adjacent
    slices, `name*` all of them and `name$` the last.
    """

    def __init__(self, path: Path) -> None:
        self.formula = Unrolled(path.read_text())
        self.names = list(self.formula.number)

    @staticmethod
    def kind(name: str) -> str:
        """Return rows_bound of g_slice[16].u.rows_bound."""
        return name.rsplit(".", 1)[-1]

    @staticmethod
    def slice(name: str) -> int:
        """Return 16 of g_slice[16].u.rows_bound, -1 outside slices."""
        found = re.match(r"g_slice\[(\d+)\]", name)
        return int(found[1]) if found else -1

    def named(self, wanted: str, of: str = "") -> list[str]:
        """Return the full names of `wanted`, as property `of` uses it."""
        kind, sign = wanted.rstrip("*$"), wanted[-1]
        names = sorted((n for n in self.names if self.kind(n) == kind), key=self.slice)
        if not names:
            raise RuntimeError(f"there is no property {kind}")
        here = self.slice(of)
        if sign == "$":
            return names[-1:]
        if sign == "*" or here < 0 or self.slice(names[0]) < 0:
            return names
        slices = sorted({self.slice(n) for n in names})
        place = slices.index(here)
        near = slices[max(place - 1, 0) : place + 2]
        return [n for n in names if self.slice(n) in near]

    def _ask(self, clocks: int, facts: list[str], claim: str) -> Answer:
        lines = [self.formula.clocks(clocks), *(f"(assert {fact})" for fact in facts), f"(assert (not {claim}))"]
        return ask("\n".join(lines), TACTIC, LIMIT)

    def first(self) -> Answer:
        """Check all properties in the first clock, with registers without an initial value arbitrary."""
        return self._ask(0, [f"|{self.formula.top}_i@0|"], f"|{self.formula.top}_a@0|")

    def step(self, name: str, uses: list[str] | None = None, after: list[str] | None = None) -> Answer:
        """Check a property in the next clock, given all properties, or those it `uses`, in this one.

        With `after`: check that it follows from these in the same clock.
        """
        rests = [n for wanted in after or uses or () for n in self.named(wanted, name)]
        facts = [self.formula.holds(n, 0) for n in rests]
        if after:
            return self._ask(0, facts, self.formula.holds(name, 0))
        return self._ask(1, facts if uses else [f"|{self.formula.top}_a@0|"], self.formula.holds(name, 1))


def no_circle(after: dict[str, list[str]]) -> None:
    """Raise RuntimeError if properties that follow from others in the same clock follow from each other."""
    done: set[str] = set()
    while len(done) < len(after):
        ready = {
            name
            for name, others in after.items()
            if name not in done and all(o.rstrip("*$") not in after or o.rstrip("*$") in done for o in others)
        }
        if not ready:
            raise RuntimeError(f"properties follow from each other: {sorted(set(after) - done)}")
        done |= ready
