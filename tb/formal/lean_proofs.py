# SPDX-License-Identifier: Apache-2.0
"""Proofs by z3 over the reals of the lean dataflow's ranges and errors, at every width.

The dataflow states a range of each node with the reason (``Within``). :class:`Rules` proves each range from the
equations of :mod:`tb.formal.lean_exact` and the lemmas of :mod:`tb.formal.lean_lemmas`; :class:`Rounded` proves the
errors of :mod:`model.bounds.ranges`. A test checks that range and error together fit the node's format.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial

from model.dataflow.annotations import Limited
from model.dataflow.nodes import FLOOR, JAM, WIDTHS, Node
from tb.formal.arithmetic import Question
from tb.formal.lean_exact import Exact, between, number
from tb.formal.lean_lemmas import BY_WORDS, GEOMETRY, SQUARES, USES
from tb.formal.task import digest_of, no_circle
from tb.formal.unrolled import ask

SOLVER = "(check-sat-using qfnra-nlsat)"
LIMIT = 60  # seconds for one question
SEEDED = "wi_0"  # the node whose claim is made too narrow


class Questions:
    """Questions at one word length: each is a set of facts and a claim that follows from them."""

    def __init__(self, width: int) -> None:
        self.exact = Exact(width)

    def question(self, name: str) -> str:
        """Return the formula that z3 must refute."""
        return self.exact.formula(self.facts(name), self.claim(name))

    def assumed(self, name: str) -> str:
        """Return the formula of the facts alone, which z3 must satisfy."""
        return self.exact.formula(self.facts(name), "false")


class Rules(Questions):
    """Questions about the exact ranges."""

    def __init__(self, width: int) -> None:
        super().__init__(width)
        self.lemmas = [name for name, (_, uses) in GEOMETRY.items() if uses]
        no_circle({name: [used for used in self.uses(name) if used[0] not in "=#"] for name in self.names()})

    def names(self) -> list[str]:
        """Return the names of the lemmas and of the nodes with a range in exact arithmetic."""
        return [*self.lemmas, *(name for name in self.exact.claimed if name not in BY_WORDS)]

    def uses(self, name: str) -> list[str]:
        """Return the names of the facts that a question uses."""
        if name in self.lemmas:
            return GEOMETRY[name][1]
        if name in USES:
            return USES[name]
        operands = [node.name for node in self.exact.nodes[name].operands]
        return [f"={name}", *(n for n in operands if n in self.exact.claimed)]

    def says(self, name: str) -> str:
        """Return the meaning of a question, for the full table."""
        return GEOMETRY[name][0] if name in self.lemmas else self.exact.nodes[name].facts.within.why

    def claim(self, name: str) -> str:
        return GEOMETRY[name][0] if name in self.lemmas else self.exact.claim(name)

    def facts(self, name: str) -> list[str]:
        return [fact for used in self.uses(name) for fact in self._fact(used)]

    def _fact(self, name: str) -> list[str]:
        if name[0] == "#":
            return [self.exact.places(name[1:])]
        if name[0] == "=":
            if name[1:] in SQUARES:
                return [f"(= {name[1:]} {SQUARES[name[1:]]})"]
            return self.exact.equations[name[1:]]
        return [GEOMETRY[name][0] if name in GEOMETRY else self.exact.known(name)]


class Rounded(Questions):
    """Questions about the errors of the words.

    A word is the node's operation applied to its operands' words, plus rounding (:meth:`rounding`). Each operand's word
    is within its own error of its exact value, which lies in its range (:class:`Rules`). The node's error of
    :mod:`model.bounds.ranges` follows. ``n_w`` is the word of node n, ``n_f`` the word before rounding.
    """

    def names(self) -> list[str]:
        """Return the nodes that have a fraction and are not exact."""
        nodes = self.exact.nodes
        return [name for name in self.exact.claimed if nodes[name].format.frac and self.exact.ranges[name].value.error]

    def rounding(self, node: Node) -> tuple[float, float]:
        """Return the bounds of the rounding error in ulps: one ulp in either direction for an operation that drops
        bits, as a difference reverses the sign of an operand's rounding."""
        return JAM if node.error == FLOOR and node.op == "choose" else node.error

    def _near(self, node: Node) -> list[str]:
        """Return the known facts of a node: its range and its word's error; an exact word equals its value."""
        name, error = node.name, self.exact.ranges[node.name].value.error
        known = [self.exact.claim(name)] if name in self.exact.claimed and name != "m_q" else []
        if not error:
            return [*known, f"(= {name}_w {name})"]
        return [*known, between(-error, f"(- {name}_w {name})", error)]

    def facts(self, name: str) -> list[str]:
        node = self.exact.nodes[name]
        fractions = [n for n in node.operands if n.format.frac]
        facts = [fact for n in node.operands if n.format.frac for fact in self._near(n)]
        facts += [self.exact.known(n.name) for n in node.operands if n.name in self.exact.claimed and not n.format.frac]
        facts += self.exact.equations[name]
        words = {n.name: f"{n.name}_w" for n in fractions}
        lowest, highest = (number(e * node.format.ulp) for e in self.rounding(node))
        if node.op in ("even", "trig") or (node.op == "rsqrt" and fractions[0].op == "even"):
            # truncating a mantissa is part of the root's error
            return [*facts, f"(<= {lowest} (- {name}_w {name}) {highest})"]
        words[name] = f"{name}_f"
        facts += [
            re.sub(r"[a-z]\w*", lambda found: words.get(found[0], found[0]), text)
            for text in self.exact.equations[name]
        ]
        top = number(node.format.high * node.format.ulp)
        held = f"(ite (< {top} {name}_f) {top} {name}_f)" if isinstance(node.facts.limited, Limited) else f"{name}_f"
        facts.append(f"(<= {lowest} (- {name}_w {held}) {highest})")
        if "low" in {n.name for n in node.operands}:  # the only decision that does not depend on signs alone
            facts.append("(= low (< length_sq_w 0.25))")
        if name == "inv_q":
            facts += self.facts("m_q")
        return facts

    def claim(self, name: str) -> str:
        """Return the error claim, and the word's range if a decision on words limits it."""
        value = self.exact.ranges[name].value
        claim = between(-value.error, f"(- {name}_w {name})", value.error)
        if name == "m_q":
            return f"(and {claim} {between(value.low - value.error, 'm_q_w', value.high + value.error)})"
        return claim

    def says(self, name: str) -> str:
        """Return the meaning of a question, for the full table."""
        node = self.exact.ranges[name]
        return f"within {node.value.error / node.format.ulp:.6g} ulps of its exact value"


def _question(asked: Questions, name: str) -> Question:
    text, assumed = asked.question(name), asked.assumed(name)
    label = f"{name}, W={asked.exact.width}"
    return Question(label, asked.says(name), partial(ask, text, SOLVER, LIMIT), partial(ask, assumed, SOLVER, LIMIT))


def questions(kind: type[Questions], widths: Sequence[int] = WIDTHS) -> Iterator[Question]:
    """Yield each question; one that recurs at several widths only once."""
    known: set[str] = set()
    for width in sorted(widths, reverse=True):
        asked = kind(width)
        for name in asked.names():
            if (text := asked.question(name)) not in known:
                known.add(text)
                yield _question(asked, name)


def digest(kind: type[Questions]) -> str:
    """Return the digest of all questions."""
    return digest_of(SOLVER, *(asked.question(name) for asked in map(kind, WIDTHS) for name in asked.names()))


def too_narrow(kind: type[Questions]) -> Iterator[Question]:
    """Yield a question whose claim does not hold: a range of 5/6, an error of half its size."""
    asked = kind(max(WIDTHS))
    exact = asked.exact
    node, ranged = exact.nodes[SEEDED], exact.ranges[SEEDED]
    within = replace(node.facts.within, low=node.facts.within.low * 5 / 6, high=node.facts.within.high * 5 / 6)
    exact.nodes[SEEDED] = replace(node, facts=replace(node.facts, within=within))
    exact.ranges[SEEDED] = replace(ranged, value=replace(ranged.value, error=ranged.value.error / 2))
    yield _question(asked, SEEDED)
