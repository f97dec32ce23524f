# SPDX-License-Identifier: Apache-2.0
"""Proofs by z3 over the reals of the lean dataflow's ranges and errors, at every width.

The dataflow states a range of each node with the reason (``Within``). :class:`Rules` proves each range from the
equations of :mod:`tb.formal.lean_exact` and the lemmas of :mod:`tb.formal.lean_lemmas`; :class:`Rounded` proves the
errors of :mod:`model.bounds.ranges`. A test checks that range and error together fit the node's format.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace

from model.dataflow.annotations import Limited
from model.dataflow.nodes import FLOOR, JAM, WIDTHS, Node
from tb.formal.arithmetic import Question
from tb.formal.lean_exact import Exact, between, number
from tb.formal.lean_lemmas import BY_WORDS, CASES, GEOMETRY, SQUARES, USES
from tb.formal.task import digest_of, no_circle
from tb.formal.unrolled import ask_each

SOLVER = "(check-sat-using qfnra-nlsat)"
LINEAR = "(check-sat-using (then simplify smt))"  # for sums of squares with linear facts
LIMIT = 60  # seconds for one question and its assumptions
REACHABLE = next(iter(CASES))
SEEDED = "wi_0"  # the node whose claim is made too narrow


class Questions:
    """Questions at one word length about one of :data:`CASES`: each is a set of facts and a claim that follows."""

    def __init__(self, exact: Exact, case: str = REACHABLE) -> None:
        self.exact = exact
        self.case = case
        self.assumption, self.other = CASES[case]
        self.lemmas = [name for name, (_, uses) in GEOMETRY.items() if uses]
        self.proved = self._proved()

    def _proved(self) -> list[str]:
        """Return the lemmas and nodes to prove: all for a reachable target, else those that Qs and Qe rest on."""
        ranges = [name for name in self.exact.claimed if name not in BY_WORDS]
        if self.case == REACHABLE:
            return [*self.lemmas, *ranges]
        nodes, found = self.exact.nodes, {}
        left = ["words of Qs", "words of Qe", *(n for n in ranges if nodes[n].section in ("direction", "turn"))]
        left += [n for n in ranges if self.decided(n)]
        while left:
            if (name := left.pop()) not in found and name in {*self.lemmas, *ranges}:
                found[name] = True
                left += self.uses(name)
        return list(found)

    def decided(self, name: str) -> bool:
        """Return whether a node's word depends on the case."""
        return "clamp" in {node.name for node in self.exact.nodes[name].operands}

    def uses(self, name: str) -> list[str]:
        """Return the names of the facts that a question about a range uses."""
        for table in (self.other, USES):
            if name in table:
                return table[name]
        if name in GEOMETRY:
            return GEOMETRY[name][1]
        operands = [node.name for node in self.exact.nodes[name].operands]
        return [f"={name}", *(n for n in operands if n in self.exact.claimed)]

    def question(self, name: str) -> str:
        """Return the formula that z3 must refute."""
        return self.exact.formula(self.facts(name), self.claim(name))

    def assumed(self, name: str) -> str:
        """Return the formula of the facts alone, which z3 must satisfy."""
        return self.exact.formula(self.facts(name), "false")


class Rules(Questions):
    """Questions about the exact ranges."""

    def names(self) -> list[str]:
        """Return the lemmas and nodes to prove, none of which rests on itself."""
        no_circle({name: [used for used in self.uses(name) if used[0] not in "=#~"] for name in self.proved})
        return self.proved

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
        if name[0] == "~":
            return [self.exact.near(name[1:])]
        if name[0] == "=":
            if name[1:] in SQUARES:
                return [f"(= {name[1:]} {SQUARES[name[1:]]})"]
            return self.exact.equations[name[1:]]
        if name == "case":
            return [self.assumption]
        return [GEOMETRY[name][0] if name in GEOMETRY else self.exact.known(name)]


class Rounded(Questions):
    """Questions about the errors of the words.

    A word is the node's operation applied to its operands' words, plus rounding (:meth:`rounding`). Each operand's word
    is within its own error of its exact value, which lies in its range (:class:`Rules`). The node's error of
    :mod:`model.bounds.ranges` follows. ``n_w`` is the word of node n, ``n_f`` the word before rounding.
    """

    def names(self) -> list[str]:
        """Return the nodes to prove that are rounded; CORDICs have bounds of their own."""
        nodes = self.exact.nodes
        names = [name for name in (*self.proved, *BY_WORDS) if name in nodes and nodes[name].op != "vector"]
        return [name for name in names if nodes[name].format.frac and self.exact.errors[name]]

    def rounding(self, node: Node) -> tuple[float, float]:
        """Return the bounds of the rounding error in ulps: one ulp in either direction for an operation that drops
        bits, as a difference reverses the sign of an operand's rounding."""
        return JAM if node.error == FLOOR and node.op == "choose" else node.error

    def _near(self, node: Node) -> list[str]:
        """Return the proved facts of a node: its range and its word's error; an exact word equals its value."""
        name = node.name
        if node.op == "input":
            return [*self.exact.equations[name], self.exact.near(name)]
        if name in BY_WORDS:
            return [self.exact.near(name)]
        return [self.exact.claim(name), self.exact.near(name)] if name in self.proved else []

    def facts(self, name: str) -> list[str]:
        node = self.exact.nodes[name]
        fractions = [n for n in node.operands if n.format.frac]
        facts = [fact for n in node.operands if n.format.frac for fact in self._near(n)]
        facts += [self.exact.known(n.name) for n in node.operands if n.name in self.proved and not n.format.frac]
        facts += [*self.exact.equations[name], *([self.assumption] if self.decided(name) else [])]
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
        claim, error, within = self.exact.near(name), self.exact.errors[name], self.exact.nodes[name].facts.within
        if name == "m_q":
            return f"(and {claim} {between(within.low - error, 'm_q_w', within.high + error)})"
        return claim

    def says(self, name: str) -> str:
        """Return the meaning of a question, for the full table."""
        return f"within {self.exact.errors[name] / self.exact.nodes[name].format.ulp:.6g} ulps of its exact value"


def _question(asked: Questions, name: str) -> Question:
    both = asked.assumed(name), asked.question(name)
    label = f"{name}, W={asked.exact.width}" + ("" if asked.case == REACHABLE else f", {asked.case}")
    solver = LINEAR if name.startswith("words of") else SOLVER
    met, said = (lambda k=k: ask_each(both, solver, LIMIT)[k] for k in range(2))
    return Question(label, asked.says(name), said, met)


def _all(kind: type[Questions], widths: Sequence[int]) -> Iterator[tuple[Questions, str]]:
    for width in sorted(widths, reverse=True):
        exact = Exact(width)
        for asked in (kind(exact, case) for case in CASES):
            yield from ((asked, name) for name in asked.names())


def questions(kind: type[Questions], widths: Sequence[int] = WIDTHS) -> Iterator[Question]:
    """Yield each question; one that recurs in several cases or at several widths only once."""
    known: set[str] = set()
    for asked, name in _all(kind, widths):
        if (text := asked.question(name)) not in known:
            known.add(text)
            yield _question(asked, name)


def digest(kind: type[Questions]) -> str:
    """Return the digest of all questions."""
    return digest_of(SOLVER, LINEAR, *(asked.question(name) for asked, name in _all(kind, WIDTHS)))


def too_narrow(kind: type[Questions]) -> Iterator[Question]:
    """Yield a question whose claim does not hold: a range of 5/6, an error of half its size."""
    asked = kind(Exact(max(WIDTHS)))
    exact = asked.exact
    node = exact.nodes[SEEDED]
    within = replace(node.facts.within, low=node.facts.within.low * 5 / 6, high=node.facts.within.high * 5 / 6)
    exact.nodes[SEEDED] = replace(node, facts=replace(node.facts, within=within))
    exact.errors[SEEDED] /= 2
    yield _question(asked, SEEDED)
