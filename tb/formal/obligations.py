# SPDX-License-Identifier: Apache-2.0
"""Proofs that each lean node's guard bits equal its sign, from the ranges of its operands.

Operator, parameters and operands of a node come from the elaborated RTL (:mod:`tb.formal.netlist`), ranges from
:mod:`model.bounds.lean_ranges`. Two engines:

* bit vectors: the RTL module with properties of tb/formal/ranges appended, unrolled from any state over the clocks that
  a value needs to pass. The ranges of the inputs are the only assumption;
* integers, for products. Bit vectors prove that registers hold the products of half words and that the result is their
  sum; integers prove that a product of numbers in their ranges fits, tile by tile and as a whole.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor
from functools import partial

from model.dataflow.nodes import Latency, Node
from tb.formal import exact_values
from tb.formal.claims import Claim, Lemma, Question, Row, conjunction, corners, floor_of, inside, integers, spell, word
from tb.formal.design import CLOCKS, Elaborated, ObligationError, signals
from tb.formal.exact_values import SECTIONS
from tb.formal.netlist import Driver, NetlistError
from tb.formal.range_table import Range
from tb.formal.unrolled import Unrolled, ask

NEEDS_RANGES = "guard_bits"
"""The property that holds for operands in their ranges only, except in ik_even."""

PRODUCTS = {"ik_mul3": "mul3", "ik_exact": "product"}
"""Operator -> its kind of latency; its tiles span fewer clocks than the latency."""

ELSEWHERE = {
    "ik_rsqrt": "error bound: `model/dataflow/cores.py`, `rsqrt_error`",
    "ik_trig": "error bound: `model/dataflow/trig.py`, `error_bound`",
}
"""Cores whose results' ranges are proved elsewhere."""


class Design(Elaborated):
    """The proofs about an elaborated datapath."""

    # ---- bit vectors -------------------------------------------------------------------------------------------------

    def prove_lemma(self, key: tuple[str, tuple]) -> Lemma:
        """Prove the properties of an operator that hold for any input, from any state, and in its first clocks."""
        module, parameters = key
        formula, depth = self.unrolled[key], CLOCKS[module]
        lemma = Lemma(module, parameters)
        mine = [name for name in formula.number if "." not in name]
        held = " ".join(formula.holds(name, clock) for name in mine for clock in range(depth))
        first = f"{formula.clocks(depth)}\n{formula.start()}\n(assert (not (and {held})))"
        lemma.claims.append(Claim("first clocks", "bit vectors", depth, ask(first)))
        for name in sorted(mine):
            if name != NEEDS_RANGES or module == "ik_even":
                text = f"{formula.clocks(depth)}\n(assert (not {formula.holds(name, depth)}))"
                lemma.claims.append(Claim(name, "bit vectors", depth, ask(text)))
        lemma.claims += [Claim(name, "integers", 0, ask(text)) for name, text in self._tiles(key)]
        return lemma

    def _tiles(self, key: tuple[str, tuple]) -> list[tuple[str, str]]:
        """Prove that products of half words fit their registers in the elaborated module, and add up to a * b."""
        module, parameters = key
        if module not in PRODUCTS:
            return []
        width, square = self.unrolled[key].local, bool(dict(parameters).get("SQUARE"))
        low = {side: width[f"ghost_{side}_lo"] - 1 for side in "ab"}
        high = {side: width[f"ghost_{side}_hi"] for side in "ab"}
        facts = [word(f"{s}h", high[s]) for s in "ab"] + [inside(f"{s}l", 0, (1 << low[s]) - 1) for s in "ab"]
        facts += ["(= bh ah)", "(= bl al)"] if square else []
        names = "ah al bh bl"
        tiles = [("hh", "(* ah bh)"), ("hl", "(* ah bl)")] + ([] if square else [("lh", "(* al bh)")])
        found = [(f"{tile} fits", integers(names, facts, word(product, width[tile]))) for tile, product in tiles]
        if module == "ik_mul3":
            # the product of the highest two bits of the low parts is at most the omitted tile
            parts = [f"(<= (* {1 << low[s]} {s}t) (* 4 {s}l))" for s in "ab"]
            parts += [inside(f"{s}t", 0, 3) for s in "ab"]
            least = f"(<= (* {1 << (low['a'] + low['b'])} (* at bt)) (* 16 (* al bl)))"
            found.append(("guess is no more than ll", integers(f"{names} at bt", [*facts, *parts], least)))
        else:
            # the sum concatenates its low bits with hh
            most = (1 << min(low["a"] + low["b"], width["ll"])) - 1
            found.append(("ll fits", integers(names, facts, inside("(* al bl)", 0, most))))
        if module == "ik_exact":
            both = "(+ (* ah bl) (* al bh))"
            found.append(("inner fits", integers(names, facts, word(both, width["inner"]))))
        a, b = (f"(+ (* {1 << low[s]} {s}h) {s}l)" for s in "ab")
        outer = f"(+ (* {1 << (low['a'] + low['b'])} ah bh) (* al bl))"
        inner = f"(+ (* {1 << low['a']} ah bl) (* {1 << low['b']} al bh))"
        if square:  # the operands are one, and hl counts twice
            a, outer, inner = b, outer.replace("a", "b"), f"(* {1 << (low['b'] + 1)} bh bl)"
        found.append(("tiles make a b", integers(names, [], f"(= (* {a} {b}) (+ {outer} {inner}))")))
        return found

    def _settle(self, row: Row, own: Range, question: Question) -> None:
        """Prove fit and range from the operands' ranges; failing that, only the fit; then use the node's rule."""
        row.engine, row.depth = question.engine, question.depth
        tries = [(False, True), (False, False)] + ([(True, True)] if own.rule else [])
        for ruled, ranged in tries:
            assumed = question.facts + question.rule * ruled
            answer = question.ask(assumed, [*question.fits, *[question.in_range] * ranged])
            row.seconds += answer.seconds
            if answer.said == "unsat":
                if (met := ask(question.text(assumed, ["false"])).said) != "sat":
                    row.problem = f"its assumptions cannot be met: {met}"
                row.fits = own.rule if ruled else "operands"
                row.range = "operands" if ranged and not ruled else own.rule
                if row.range == "":
                    row.problem = "fits, but no reason for the range of the table"
                return
            if answer.said != "sat":
                row.problem = answer.said
                return
        row.problem = "does not fit" + (f", even with '{own.rule}'" if own.rule else ", and there is no rule")

    # ---- one node ----------------------------------------------------------------------------------------------------

    def prove(self, name: str) -> Row:
        """Return the row of one node."""
        node = self.nodes[name]
        row = Row(name)
        if node.op == "input":
            row.module, row.fits, row.range = "input", "any word", "any word"
            return row
        driver = self.drivers[name]
        row.module = driver.module or driver.section
        row.parameters = spell(driver.parameters)
        lemma = self.lemmas.get((driver.module, driver.parameters))
        if lemma and lemma.problem:
            row.problem = lemma.problem
            return row
        try:
            if node.format.width == 1:
                row.fits, row.range = "one bit", "one bit"
            elif driver.module in ELSEWHERE:
                row.fits, row.range = ELSEWHERE[driver.module], self.ranges[name].rule or "its error"
            elif driver.module == "ik_even":
                self._even(row, name, driver)
            elif driver.module in PRODUCTS:
                self._product(row, name, driver)
            elif driver.module:
                self._operator(row, name, driver)
            else:
                self._local(row, name, driver)
            if not row.problem:
                self._check_sources(row, node, driver)
            if not row.problem and self.finer(name, driver):
                row.problem = "its format is not the model's"
        except (ObligationError, NetlistError, ValueError) as error:
            row.problem = str(error)
        return row

    def _check_sources(self, row: Row, node: Node, driver: Driver) -> None:
        """Check that netlist and model agree on a node's operands, and that all belong to one target.

        The clock of a node is the model's; delays are the netlist's.
        """
        sources = [s for s in row.sources if s.node]
        if not sources:
            return
        if driver.module:
            found, wanted = {s.node for s in sources}, {n.name for n in node.operands if n.name}
            if found != wanted:
                row.problem = f"made of {', '.join(sorted(found))}, in the model of {', '.join(sorted(wanted))}"
        takes = CLOCKS.get(driver.module)
        if kind := PRODUCTS.get(driver.module):
            square = kind == "product" and driver.values["SQUARE"]
            takes = Latency(self.width)["square" if square else kind]
        takes = driver.values.get("LAT", takes) if driver.module else SECTIONS[driver.section][row.node].clocks
        late = [s for s in sources if self.nodes[s.node].time + s.clocks + takes != node.time]
        if late and not row.problem:
            row.problem = ", ".join(
                f"{s.node} of clock {self.nodes[s.node].time} is used at {node.time - takes}, {s.clocks} later"
                for s in late
            )

    def _even(self, row: Row, name: str, driver: Driver) -> None:
        """Compare the range with the result of an operator whose properties hold for any input."""
        own, fmt = self.ranges[name], self.nodes[name].format
        operand = self.netlist.operand(driver.path, "v")
        self.port(operand)
        can = Range(0, driver.values["VW"] // 2 - 1) if driver.port == "k" else Range(fmt.low, fmt.high)
        self._made_of(row, [operand])
        row.engine, row.depth = "bit vectors", CLOCKS[driver.module]
        row.fits, row.range = "any input", "operands"
        if can.low < own.low or can.high > own.high:
            row.range = own.rule
            row.problem = "" if own.rule else "its range is narrower than the operator's results"

    def _operator(self, row: Row, name: str, driver: Driver) -> None:
        """Prove a sum or a shift: bit vectors from the operands' ranges."""
        key = driver.module, driver.parameters
        formula, depth = self.unrolled[key], CLOCKS[driver.module]
        own, stated = self.held(name, self.finer(name, driver))
        ports = ["a", "b"] if driver.module == "ik_wide" else ["d", "count"]
        found = self.ports(driver, *ports)
        self._made_of(row, [operand for _, operand, _ in found])
        facts = [
            formula.between(port, clock, r.low, r.high, port != "count")
            for port, _, r in found
            for clock in range(depth + 1)
        ]
        ruled = self._ruled(formula, "ghost_value", stated, depth)
        goal = [formula.holds(NEEDS_RANGES, depth), *self._not_negative(formula, "q", name, depth)]
        in_range = formula.between("q", depth, own.low, own.high, self.nodes[name].format.signed)

        text = self._text(formula, depth)
        self._settle(row, own, Question("bit vectors", depth, text, facts, ruled, goal, in_range))

    @staticmethod
    def _text(formula: Unrolled, depth: int) -> Callable[[list[str], list[str]], str]:
        def text(facts: list[str], claims: list[str]) -> str:
            lines = [formula.clocks(depth), *(f"(assert {fact})" for fact in facts)]
            return "\n".join([*lines, f"(assert (not (and {' '.join(claims)})))"])

        return text

    def _ruled(self, formula: Unrolled, signal: str, r: Range, depth: int) -> list[str]:
        """Return a node's rule: the exact value of its operands lies in the table's range, in every clock."""
        return [formula.between(signal, clock, r.low, r.high, True) for clock in range(depth + 1)]

    def _not_negative(self, formula: Unrolled, signal: str, name: str, depth: int) -> list[str]:
        """Return the claim that the node is not negative, if the table's range was tightened."""
        tightened = self.ranges[name] != self.table[name]
        most = self.nodes[name].format.high
        return [formula.between(signal, depth, 0, most, self.nodes[name].format.signed)] if tightened else []

    def _product(self, row: Row, name: str, driver: Driver) -> None:
        """Prove a product: integers from the operands' ranges and the operator's lemma about its tiles."""
        key, values = (driver.module, driver.parameters), driver.values
        own, stated = self.held(name, self.finer(name, driver))
        width = self.unrolled[key].widths
        (_, first, a), (_, second, b) = self.ports(driver, "a", "b")
        square = bool(values.get("SQUARE")) or first == second
        if values.get("SQUARE"):
            second, b = first, a
        self._made_of(row, [first, second])
        low, high = corners(a, b, square)
        out = values["OW"] if "OW" in values else 2 * values["W"]
        shift = values.get("SH", 0)
        factors = "a b"
        facts = [inside("a", a.low, a.high), inside("b", b.low, b.high), *(["(= a b)"] if square else [])]
        bound = integers(factors, facts, inside("(* a b)", low, high))
        row.seconds += (answer := ask(bound)).seconds
        row.engine, row.depth = "integers", CLOCKS[driver.module]
        if answer.said != "unsat":
            row.problem = f"the product is not bounded by its corners: {answer.said}"
            return
        facts = [inside("p", low, high)]
        if driver.module == "ik_mul3":
            names = "p v fh fa fb hh hl lh ll two guess"
            cut = {side: width[f"ghost_{side}_lo"] - 1 for side in "ab"}
            facts.append(inside("ll", 0, ((1 << cut["a"]) - 1) * ((1 << cut["b"]) - 1)))
            facts.append(f"(= p (+ (* {1 << sum(cut.values())} hh) (* {1 << cut['a']} hl) (* {1 << cut['b']} lh) ll))")
            up = sum(cut.values()) - shift + 2
            if up > 0:  # the guess at ll, in sixteenths: see 'guess is no more than ll'
                facts.append(f"(and (<= 0 two) (<= (* {1 << sum(cut.values())} two) (* 16 ll)))")
                facts.append(floor_of("guess", f"(* {1 << up} two)", 4))
                facts.append(f"(= fh (+ (* {1 << up} hh) guess))")
            else:
                facts.append(floor_of("fh", f"(* {1 << sum(cut.values())} hh)", shift - 2))
            facts.append(floor_of("fa", f"(* {1 << cut['a']} hl)", shift - 2))
            facts.append(floor_of("fb", f"(* {1 << cut['b']} lh)", shift - 2))
            facts.append(floor_of("v", "(+ fh fa fb 2)", 2))
            goal = "true"
            if a.low >= 0 and b.low >= 0:  # parts of numbers that are not negative
                facts += ["(<= 0 hh)", "(<= 0 hl)", "(<= 0 lh)"]
        else:
            names = "p v"
            facts.append(floor_of("v", f"(+ p {(1 << shift) >> 1})", shift))
            goal = "true"
        goal = f"(and {goal} {word('v', out)} {'(<= 0 v)' if own != stated else 'true'})"
        ruled = inside("v", stated.low, stated.high)
        in_range = inside("v", own.low, own.high)

        text = partial(conjunction, names)
        self._settle(row, own, Question("integers", CLOCKS[driver.module], text, facts, [ruled], [goal], in_range))

    def _local(self, row: Row, name: str, driver: Driver) -> None:
        """Prove a node that the section computes: bit vectors on the section without its instances."""
        node = self.nodes[name]
        if not node.facts.exact:
            raise ObligationError(f"{name}: no exact value in the dataflow")
        expression = SECTIONS[driver.section][name].expression
        key, own = (driver.section, ()), self.ranges[name]
        formula = self.unrolled[key]
        depth = exact_values.depth(driver.section, name)
        early = " ".join(formula.holds(f"holds_{name}", clock) for clock in range(depth))
        first = f"{formula.clocks(depth)}\n{formula.start()}\n(assert (not (and true {early})))"
        if (answer := ask(first)).said != "unsat":
            row.problem = f"first clocks: {answer.said}"
            return
        facts = [
            formula.between(signal, clock, r.low, r.high, signed)
            for signal, r, signed in self._signals(driver.path)
            for clock in range(depth + 1)
        ]
        # a rule may bound operands in the same section
        for other in exact_values.inner(driver.section, name):
            r = self.ranges[other]
            if r.rule:
                facts += [formula.between(f"exact_{other}", c, r.low, r.high, True) for c in range(depth + 1)]
        self._made_of(row, self._named(driver.path, expression))
        goal = [formula.holds(f"holds_{name}", depth), *self._not_negative(formula, name, name, depth)]
        in_range = formula.between(name, depth, own.low, own.high, node.format.signed)
        ruled = self._ruled(formula, f"exact_{name}", self.table[name], depth)

        text = self._text(formula, depth)
        one_bit = (s for s in signals(expression) if formula.widths.get(s) == 1)
        cases = tuple(formula.at(signal, 0) for signal in one_bit)
        question = Question("bit vectors", depth, text, facts, ruled, goal, in_range, cases)
        self._settle(row, own, question)
        if not row.problem and row.fits == own.rule:
            # with a wrong expression, the rule could exclude the values for which the claim fails
            last, width = exact_values.last(driver.section, name), node.format.width
            low = f"(= ((_ extract {width - 1} 0) {formula.at(last, depth)}) {formula.at(name, depth)})"
            row.seconds += (answer := question.ask(facts, [low])).seconds
            if answer.said != "unsat":
                row.problem = f"without its rule it is not the low bits of its exact value: {answer.said}"
        if node.facts.limited and not row.problem:
            row.fits += f"; limited: {node.facts.limited.why}"

    def _signals(self, path: str) -> list[tuple[str, Range, bool]]:
        """Return a section's input signals that are nodes, with the node's range.

        Signals that the section has cut, shifted or extended are left out: that logic is to be proved.
        """
        found = []
        module = self.netlist.modules[self.netlist.paths[path]]
        for signal, what in module["netnames"].items():
            if "$" in signal or "." in signal or len(what["bits"]) == 1:
                continue
            if not self.netlist.from_outside(path, what["bits"]):
                continue
            try:
                operand = self.netlist.value(signal, path, what["bits"])
                plain = (operand.shift, operand.low, operand.width) == (0, 0, len(what["bits"]))
                if operand.node and plain and operand.width == self.nodes[operand.node].format.width:
                    r = self.port(operand)
                    if self.unrolled[self.netlist.kind(path), ()].widths.get(signal) == len(what["bits"]):
                        found.append((signal, r, operand.signed))
            except (NetlistError, ObligationError):
                continue  # not a node's word: any value
        return found

    # ---- all of them -------------------------------------------------------------------------------------------------

    def run(self, names: list[str], pool: Executor, progress: Callable[[str], None]) -> list[Row]:
        """Prove the nodes `names` and their operators; call `progress` with the problem of each."""
        drivers = [self.drivers[n] for n in names if n in self.drivers]
        operators = sorted({(d.module, d.parameters) for d in drivers if d.module in CLOCKS})
        sections = sorted(
            {
                self.drivers[n].section
                for n in names
                if n in self.drivers and not self.drivers[n].module and self.nodes[n].format.width > 1
            }
        )
        self.formulas(operators, sections)
        for lemma in pool.map(self.prove_lemma, operators):
            self.lemmas[lemma.module, lemma.parameters] = lemma
            progress(lemma.problem)
        rows = []
        for row in pool.map(self.prove, names):
            rows.append(row)
            progress(f"{row.node}: {row.problem}" if row.problem else "")
        return rows
