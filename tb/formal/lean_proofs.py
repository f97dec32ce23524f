# SPDX-License-Identifier: Apache-2.0
"""Proofs by z3 over the reals of the ranges and errors of the whole arm's dataflow, at every word length.

The dataflow states the exact range of a node with its reason (``Within``), and the facts that prove it (``Node.proof``,
``Dataflow.lemma``). :class:`Rules` proves each range from these facts and the equations of :class:`Exact`.
:class:`Rounded` proves the errors of :mod:`model.bounds.ranges`, which checks that range and error together fit the
node's format.

In :class:`Exact`, each node is a real number that satisfies the formulas of its operation (``Operation.facts``).  A
count e is stated as 2^e, so a shift is a product.  The datapath decides on rounded words; here, the sign of a rounded
word and every other decision on a rounded word are free, so a proof holds for any outcome of rounding.  A node that
takes operands' words as exact (``Dataflow.words``) uses ``n_w``, the word of operand n. The word differs from n's exact
value by at most n's error.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace

from model.bounds.ranges import LeanRanges, on_grid
from model.dataflow.expressions import FLOOR, JAM, Compared, Constant, FreeError, number
from model.dataflow.fixed import dataflow
from model.dataflow.formats import WIDTHS
from model.dataflow.nodes import Limited, Node, Within
from model.io.words import ARMS
from tb.formal.smt import formula, smt
from tb.formal.task import Question, digest_of, no_circle
from tb.formal.tools import ask_each

SOLVER = "(check-sat-using qfnra-nlsat)"
LINEAR = "(check-sat-using (then simplify smt))"  # for sums of squares with linear facts
LIMIT = 60  # seconds for one question and its assumptions
SEEDED = "wi_0"  # the node whose claim is made too narrow

BY_WORDS = ("m_q",)
"""Nodes whose range depends on a decision on rounded words; :class:`Rounded` proves these ranges."""

CLAMPED: dict[str, tuple[str, ...]] = {
    "bend": ("case", "=bend_c", "=bend_s", "=bend_sq"),
    "bend_sq": ("case", "=bend_sq"),
    "bend_dif": ("case", "=bend_dif", "=bend_sq"),
    "bend_sum": ("case", "=bend_sum", "=bend_sq"),
    "qe_w": ("case", "=qe_w"),
    "qe_i": ("case", "=qe_i"),
    "|Qe|": ("case", "=qe_w", "=qe_i"),
}
SHOULDER = ("case", "=x_sq", "=y_sq", "=z_sq", "=rho_sq", "=s", "=m_rho", "=m_s", "=at_shoulder")
AT_SHOULDER: dict[str, tuple[str, ...]] = {
    "tilt": (*SHOULDER, "=tilt_c", "=tilt_s", "=tilt_sq", "=cos_el", "=root_rho"),
    "tilt_sq": ("case", "=tilt_sq"),
    "sin_el": (*SHOULDER, "=sin_el", "=z_n"),
    "cos_el": (*SHOULDER, "=cos_el", "=root_rho"),
    "n_el": (*SHOULDER, "=n_el", "=e_rho", "=e_s"),
}
CASES: dict[str, tuple[str, dict[str, tuple[str, ...]]]] = {
    # case -> assumption about the target; node or lemma -> facts instead of the dataflow's
    "reachable": ("(not clamp)", {}),
    "clamped": ("(and clamp (not at_shoulder))", CLAMPED),
    "at the shoulder": ("(and clamp at_shoulder)", CLAMPED | AT_SHOULDER),
}
"""Cases of the target. If the target is clamped, Qs and Qe are still outputs; the triangle's other words are unused."""

REACHABLE = next(iter(CASES))


def between(low: float, term: str, high: float, below: bool = False) -> str:
    """Return the condition low <= term <= high; with ``below``, low <= term < high."""
    return f"(and (<= {number(low)} {term}) ({'<' if below else '<='} {term} {number(high)}))"


class Exact:
    """Formulas of the whole arm's dataflow at one word length."""

    def __init__(self, width: int) -> None:
        self.flow = dataflow("arm", width)
        self.nodes = dict(self.flow.nodes)
        self.errors = {name: bound.error for name, bound in LeanRanges(width, datapath="arm").bounds.items()}
        self.equations = {"ulp": [f"(= ulp {number(self.flow.word(1).ulp)})"]}
        self.lemmas = {name: (smt(text) if text else "", uses) for name, (text, uses) in self.flow.lemmas.items()}
        self.equations |= {name: [f"(= {name} {smt(text)})"] for name, text in self.flow.definitions.items()}
        self._node = next(iter(self.nodes.values()))  # the node whose formulas are being written
        for name, node in self.nodes.items():
            for operand in node.as_words:
                self._take_word(self.nodes[operand])
            self.equations[name] = self._facts(node)

    def _facts(self, node: Node) -> list[str]:
        """Return the formulas of a node: none for a decision that is free."""
        if node.kind == "input":
            fmt = node.format
            return [between((1 if node.name in ARMS else fmt.low) * fmt.ulp, node.name, fmt.high * fmt.ulp)]
        self._node = node
        try:
            return node.op.facts(node, self)
        except FreeError:
            if node.format.width == 1:
                return []
            raise

    def _take_word(self, node: Node) -> None:
        """Add a node's word as an error-free number in the word's range."""
        error, within, fmt = self.errors[node.name], node.within, node.format
        ends = fmt.low * fmt.ulp, fmt.high * fmt.ulp
        if self.equations[node.name]:
            ends = on_grid((within.low - error, within.high + error), fmt)
        word = f"{node.name}_w"
        self.equations[word], self.errors[word] = [between(ends[0], word, ends[1])], 0.0

    # ---- called by operations --------------------------------------------------------------------------------------

    def name(self, node: Node) -> str:
        """Return the name of an operand's exact value or word, whichever the formulas being written use."""
        return self.operand(self._node, node)

    @staticmethod
    def operand(node: Node, operand: Node) -> str:
        """Return the name of an operand's exact value or word, whichever the formulas of ``node`` use."""
        return f"{operand.name}_w" if operand.name in node.as_words else operand.name

    def operands(self, name: str) -> list[str]:
        return [self.operand(self.nodes[name], operand) for operand in self.nodes[name].operands]

    def compared(self, relation: Compared) -> str:
        """Return a comparison as a formula. Raises FreeError for rounded words, except if only their sign matters."""
        left, right = relation.parts
        rounded = [node for node in relation.operands if self.errors[self.name(node)]]
        if not rounded:
            return f"({relation.relation} {left.formula(self)} {right.formula(self)})"
        negative = f"neg_{rounded[0].name}"
        zeros = [isinstance(part, Constant) and part.value == 0 for part in (left, right)]
        if zeros[1] and relation.relation == "<":
            return negative
        if zeros[0] and relation.relation == "<=":
            return f"(not {negative})"
        raise FreeError(relation.text())

    # ---- facts -----------------------------------------------------------------------------------------------------

    def on_words(self, mask: Node) -> str:
        """Return the fact that a mask equals its comparison, applied to the operands' words."""
        left, right = (part.formula(self) if isinstance(part, Constant) else f"{part.name}_w" for part in mask.op.parts)
        return f"(= {mask.name} ({mask.op.relation} {left} {right}))"

    def near(self, name: str) -> str:
        """Return the fact that a node's word differs from the node's exact value by at most the node's error."""
        error = self.errors[name]
        return between(-error, f"(- {name}_w {name})", error) if error else f"(= {name}_w {name})"

    def claim(self, name: str) -> str:
        """Return the claim that a node's exact value is in its range; for a count, that it is above -1 and below 64."""
        within = self.nodes[name].within
        if not self.nodes[name].frac:  # a count e, stated as 2^e: -1 < e < 64
            return f"(and (< 0.5 {name}) (< {name} {number(2.0 ** (within.high + 1))}))"
        return between(within.low, name, within.high, within.below)

    def known(self, name: str) -> str:
        """Return the fact that follows from a proved :meth:`claim`. A count is an integer: > -1 becomes >= 0."""
        return self.claim(name) if self.nodes[name].frac else between(1.0, name, 2.0 ** self.nodes[name].within.high)

    def places(self, name: str) -> str:
        """Return the formula "|word| is 0 ulp, 1 ulp, or at least 2 ulps". Raises LookupError if the word is
        rounded."""
        if self.errors[name]:
            raise LookupError(f"{name} is rounded")
        ulp = self.nodes[name].format.ulp
        size = f"(ite (< {name} 0.0) (- {name}) {name})"
        return f"(or (= {name} 0.0) (= {size} {number(ulp)}) (<= {number(2 * ulp)} {size}))"

    def formula(self, facts: list[str], goal: str) -> str:
        """Return the formula "all facts hold and the goal does not", with a declaration of each name."""

        def sort(name: str) -> str:
            mask = name.startswith("neg_") or (name in self.nodes and self.nodes[name].format.width == 1)
            return "Bool" if mask else "Real"

        return formula(facts, goal, sort)

    @property
    def claimed(self) -> list[str]:
        """Nodes with a claimed range and with formulas from which to prove it."""
        return [n for n, node in self.nodes.items() if isinstance(node.within, Within) and self.equations[n]]


class Questions:
    """Questions at one word length about one of :data:`CASES`: does a claim follow from a set of facts?"""

    cases = tuple(CASES)

    def __init__(self, exact: Exact, case: str = REACHABLE) -> None:
        self.exact = exact
        self.case = case
        self.assumption, self.other = CASES[case]
        self.lemmas = [name for name, (_, uses) in exact.lemmas.items() if uses]
        self.proved = self._proved()

    def _proved(self) -> list[str]:
        """Return the lemmas and nodes to prove: all for a reachable target, else those on which Qs and Qe depend."""
        ranges = [name for name in self.exact.claimed if name not in BY_WORDS]
        if self.case == REACHABLE:
            return [*self.lemmas, *ranges]
        nodes, needed = self.exact.nodes, {}
        left = ["words of Qs", "words of Qe", *(n for n in ranges if nodes[n].section in ("direction", "turn"))]
        left += [n for n in ranges if self.decided(n)]
        while left:
            if (name := left.pop()) not in needed and name in {*self.lemmas, *ranges}:
                needed[name] = True
                left += self.uses(name)
        return list(needed)

    def decided(self, name: str) -> bool:
        """Return whether ``clamp``, which the case decides, is an operand of a node."""
        return "clamp" in self.exact.operands(name)

    def uses(self, name: str) -> list[str]:
        """Return the names of the facts from which a range or a lemma must follow."""
        if name in self.other:
            return list(self.other[name])
        if name in self.exact.lemmas:
            return list(self.exact.lemmas[name][1])
        if (proof := self.exact.nodes[name].proof) is not None:
            return list(proof)
        return [f"={name}", *(operand for operand in self.exact.operands(name) if operand in self.exact.claimed)]

    def question(self, name: str) -> str:
        """Return the formula "the facts hold and the claim does not", which z3 must refute."""
        return self.exact.formula(self.facts(name), self.claim(name))


class Rules(Questions):
    """Questions about the lemmas and the exact ranges."""

    def names(self) -> list[str]:
        """Return the lemmas and nodes to prove. Raises RuntimeError if a proof depends on its own claim."""
        no_circle({name: [used for used in self.uses(name) if used[0] not in "=#~"] for name in self.proved})
        return self.proved

    def says(self, name: str) -> str:
        """Return a sentence for the table in build/proofs: what question ``name`` proves."""
        return self.claim(name) if name in self.lemmas else self.exact.nodes[name].within.why

    def claim(self, name: str) -> str:
        return self.exact.lemmas[name][0] if name in self.lemmas else self.exact.claim(name)

    def facts(self, name: str) -> list[str]:
        return [fact for used in self.uses(name) for fact in self._fact(used)]

    def _fact(self, name: str) -> list[str]:
        if name[0] in "#~":
            return [(self.exact.places if name[0] == "#" else self.exact.near)(name[1:])]
        if name[0] == "=":
            return self.exact.equations[name[1:]]
        if name == "case":
            return [self.assumption]
        return [self.exact.lemmas[name][0] if name in self.exact.lemmas else self.exact.known(name)]


class Rounded(Questions):
    """Questions that bound the errors of the words.

    A node's word is the node's operation applied to its operands' words, plus rounding (:meth:`rounding`). The
    error that :mod:`model.bounds.ranges` states for the node must follow from each operand's range (:class:`Rules`)
    and from the error of the operand's word. ``n_w`` is the word of node n, ``n_f`` the same before rounding.
    """

    def names(self) -> list[str]:
        """Return the rounded nodes to prove. CORDICs are left out: model/dataflow/angles.py bounds their errors."""
        nodes = self.exact.nodes
        names = [name for name in (*self.proved, *BY_WORDS) if name in nodes and nodes[name].kind != "vector"]
        return [name for name in names if nodes[name].frac and self.exact.errors[name]]

    def rounding(self, node: Node) -> tuple[float, float]:
        """Return the bounds of the rounding error in ulps. An expression ("choose") that drops bits can be off by an
        ulp in either direction, because a difference reverses the sign of an operand's rounding."""
        return JAM if node.error == FLOOR and node.kind == "choose" else node.error

    def _near(self, node: Node, of: Node) -> list[str]:
        """Return the proved facts about ``node``, an operand of node ``of``: its range, and the error of its word."""
        name = self.exact.operand(of, node)
        if node.kind == "input" or name != node.name:
            return [*self.exact.equations[name], self.exact.near(name)]
        if name in BY_WORDS:
            return [self.exact.near(name)]
        return [self.exact.claim(name), self.exact.near(name)] if name in self.proved else []

    def facts(self, name: str) -> list[str]:
        node, equations = self.exact.nodes[name], self.exact.equations
        fractions = [operand for operand in node.operands if operand.frac]
        integers = [operand for operand in node.operands if not operand.frac]
        facts = [fact for operand in fractions for fact in self._near(operand, node)]
        facts += [self.exact.known(count.name) for count in integers if count.name in self.proved]
        facts += [*equations[name], *([self.assumption] if self.decided(name) else [])]
        operands = {self.exact.operand(node, operand) for operand in fractions}
        words = {operand: f"{operand}_w" for operand in operands}
        lowest, highest = (number(e * node.format.ulp) for e in self.rounding(node))
        if node.kind in ("even", "trig") or (node.kind == "rsqrt" and fractions[0].kind == "even"):
            # the error of a root includes the truncation of its mantissa
            return [*facts, f"(<= {lowest} (- {name}_w {name}) {highest})"]
        words[name] = f"{name}_f"
        facts += [re.sub(r"[a-z]\w*", lambda match: words.get(match[0], match[0]), text) for text in equations[name]]
        top = number(node.format.high * node.format.ulp)
        held = f"(ite (< {top} {name}_f) {top} {name}_f)" if isinstance(node.limited, Limited) else f"{name}_f"
        facts.append(f"(<= {lowest} (- {name}_w {held}) {highest})")
        # decisions that exact arithmetic leaves free
        facts += [self.exact.on_words(mask) for mask in integers if mask.kind == "choose" and not equations[mask.name]]
        if name == "inv_q":
            facts += self.facts("m_q")
        return facts

    def claim(self, name: str) -> str:
        """Return the claim about the error of a node's word; for ``m_q`` also the claim about the word's range."""
        claim, error, within = self.exact.near(name), self.exact.errors[name], self.exact.nodes[name].within
        if name == "m_q":
            return f"(and {claim} {between(within.low - error, 'm_q_w', within.high + error)})"
        return claim

    def says(self, name: str) -> str:
        return f"within {self.exact.errors[name] / self.exact.nodes[name].format.ulp:.6g} ulps of its exact value"


def _question(asked: Questions, name: str) -> Question:
    both = asked.exact.formula(asked.facts(name), "false"), asked.question(name)
    label = f"{name}, W={asked.exact.flow.width}" + ("" if asked.case == REACHABLE else f", {asked.case}")
    solver = LINEAR if name.startswith("words of") else SOLVER
    met, said = (lambda k=k: ask_each(both, solver, LIMIT)[k] for k in range(2))
    return Question(label, asked.says(name), said, met)


def _all(kind: type[Questions], widths: Sequence[int]) -> Iterator[tuple[Questions, str]]:
    for width in sorted(widths, reverse=True):
        exact = Exact(width)
        for asked in (kind(exact, case) for case in kind.cases):
            yield from ((asked, name) for name in asked.names())


def questions(kind: type[Questions], widths: Sequence[int] = WIDTHS) -> Iterator[Question]:
    """Yield all questions; yield a question only once if cases or word lengths share it."""
    known: set[str] = set()
    for asked, name in _all(kind, widths):
        if (text := asked.question(name)) not in known:
            known.add(text)
            yield _question(asked, name)


def digest(kind: type[Questions]) -> str:
    return digest_of(SOLVER, LINEAR, *(asked.question(name) for asked, name in _all(kind, WIDTHS)))


def too_narrow(kind: type[Questions]) -> Iterator[Question]:
    """Yield a question with a false claim: that node :data:`SEEDED` has only 5/6 of its range and half of its error."""
    asked = kind(Exact(max(WIDTHS)))
    exact = asked.exact
    within = exact.nodes[SEEDED].within
    narrow = replace(within, low=within.low * 5 / 6, high=within.high * 5 / 6)
    exact.nodes[SEEDED] = replace(exact.nodes[SEEDED], within=narrow)
    exact.errors[SEEDED] /= 2
    yield _question(asked, SEEDED)
