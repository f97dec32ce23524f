# SPDX-License-Identifier: Apache-2.0
"""Questions about the lean dataflow's ranges and errors at every width, and a claim that is too narrow."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial

from model.dataflow.nodes import WIDTHS
from tb.formal.arithmetic import Question
from tb.formal.lean_rounded import Rounded
from tb.formal.lean_rules import Rules
from tb.formal.task import digest_of
from tb.formal.unrolled import ask

SOLVER = "(check-sat-using qfnra-nlsat)"
LIMIT = 60  # seconds for one question
SEEDED = "wi_0"
"""The node whose claim is made too narrow."""


def _question(asked: Rules | Rounded, name: str) -> Question:
    text, assumed = asked.question(name), asked.assumed(name)
    label = f"{name}, W={asked.exact.width}"
    return Question(label, asked.says(name), partial(ask, text, SOLVER, LIMIT), partial(ask, assumed, SOLVER, LIMIT))


def questions(kind: type[Rules] | type[Rounded], widths: Sequence[int] = WIDTHS) -> Iterator[Question]:
    """Yield each question; one that recurs at several widths only once."""
    known: set[str] = set()
    for width in sorted(widths, reverse=True):
        asked = kind(width)
        for name in asked.names():
            if (text := asked.question(name)) not in known:
                known.add(text)
                yield _question(asked, name)


def digest(kind: type[Rules] | type[Rounded]) -> str:
    """Return the digest of all questions."""
    return digest_of(SOLVER, *(asked.question(name) for asked in map(kind, WIDTHS) for name in asked.names()))


def too_narrow(kind: type[Rules] | type[Rounded]) -> Iterator[Question]:
    """Yield a question whose claim does not hold: a range of 5/6, an error of half its size."""
    asked = kind(max(WIDTHS))
    exact = asked.exact
    node, ranged = exact.nodes[SEEDED], exact.ranges[SEEDED]
    within = replace(node.facts.within, low=node.facts.within.low * 5 / 6, high=node.facts.within.high * 5 / 6)
    exact.nodes[SEEDED] = replace(node, facts=replace(node.facts, within=within))
    exact.ranges[SEEDED] = replace(ranged, value=replace(ranged.value, error=ranged.value.error / 2))
    yield _question(asked, SEEDED)
