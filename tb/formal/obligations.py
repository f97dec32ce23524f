# SPDX-License-Identifier: Apache-2.0
"""For every node of a datapath: a proof that its guard bits equal its sign, from the ranges of what it is made of.

A node's operator, parameters and operands are those of the elaborated RTL (tb/formal/netlist.py), the operands' ranges
those of the word-length table (model/bounds/ranges.py, model/bounds/lean_ranges.py). Two engines:

* bit vectors: the module of the RTL with properties of tb/formal/ranges appended, as Yosys gives it, unrolled over as
  many clocks as a value needs to pass, from any state. Nothing is assumed but ranges of the inputs;
* integers: what multiplies. The bit vectors say that the registers hold the products of half words and that the result
  is their sum; the integers, that a product of numbers in their ranges fits, tile by tile and as a whole.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import replace
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
"""The property that holds for operands in their ranges only, except in the operators of :data:`FREE`."""

PRODUCTS = {"ik_mul": "mul", "ik_mul3": "mul3", "ik_exact": "product"}
"""Operator -> its kind. They have properties on the way: the tiles look back less than the latency, the result more."""

FREE = ("ik_even", "ik_norm", "ik_lzc", "ik_half")
"""Operators whose properties all hold for any input."""

ELSEWHERE = {
    "ik_rsqrt": "faithful, a place off 1/(2 sqrt m) at most, or two, doubled: `model/dataflow/cores.py`, `rsqrt_error`",
    "ik_trig": "error below a place: `model/dataflow/trig.py`, `error_bound`",
    "ik_sincos": "error below two places: counted in `model/dataflow/paper.py`, `CORDIC`; tested, not by a solver",
}
"""Cores whose results' ranges are shown elsewhere."""

SATURATES = "q is the floor, or the bound where it does not fit, and says so: docs/generated/proofs.md"


class Design(Elaborated):
    """The proofs about an elaborated datapath."""

    # ---- bit vectors -------------------------------------------------------------------------------------------------

    def prove_lemma(self, key: tuple[str, tuple]) -> Lemma:
        """All properties of an operator that hold for any input, from any state; and in its first clocks."""
        module, parameters = key
        formula, depth = self.unrolled[key], CLOCKS[module]
        lemma = Lemma(module, parameters)
        mine = [name for name in formula.number if "." not in name]
        held = " ".join(formula.holds(name, clock) for name in mine for clock in range(depth))
        first = f"{formula.clocks(depth)}\n{formula.start()}\n(assert (not (and {held})))"
        lemma.claims.append(Claim("first clocks", "bit vectors", depth, ask(first)))
        for name in sorted(mine):
            if name != NEEDS_RANGES or module in FREE:
                text = f"{formula.clocks(depth)}\n(assert (not {formula.holds(name, depth)}))"
                lemma.claims.append(Claim(name, "bit vectors", depth, ask(text)))
        lemma.claims += [Claim(name, "integers", 0, ask(text)) for name, text in self._tiles(key)]
        return lemma

    def _tiles(self, key: tuple[str, tuple]) -> list[tuple[str, str]]:
        """That products of half words fit the registers that the elaborated module has for them, and make a * b."""
        module, parameters = key
        if module not in ("ik_mul", "ik_mul3", "ik_exact"):
            return []
        width, values = self.unrolled[key].local, dict(parameters)
        square = bool(values.get("SQUARE"))
        if "product" in width:  # one tile
            facts = [word("a", values["AW"]), word("b", values["BW"]), *(["(= b a)"] if square else [])]
            return [("product fits", integers("a b", facts, word("(* a b)", width["product"])))]
        low = {side: width[f"ghost_{side}_lo"] - 1 for side in "ab"}
        high = {side: width[f"ghost_{side}_hi"] for side in "ab"}
        facts = [word(f"{s}h", high[s]) for s in "ab"] + [inside(f"{s}l", 0, (1 << low[s]) - 1) for s in "ab"]
        facts += ["(= bh ah)", "(= bl al)"] if square else []
        names = "ah al bh bl"
        tiles = [("hh", "(* ah bh)"), ("hl", "(* ah bl)")] + ([] if square else [("lh", "(* al bh)")])
        found = [(f"{tile} fits", integers(names, facts, word(product, width[tile]))) for tile, product in tiles]
        if module == "ik_mul3":
            # a low part is its highest two bits and a rest: what they make is no more than the tile left out
            parts = [f"(<= (* {1 << low[s]} {s}t) (* 4 {s}l))" for s in "ab"]
            parts += [inside(f"{s}t", 0, 3) for s in "ab"]
            least = f"(<= (* {1 << (low['a'] + low['b'])} (* at bt)) (* 16 (* al bl)))"
            found.append(("guess is no more than ll", integers(f"{names} at bt", [*facts, *parts], least)))
        else:
            # the sum takes its low bits beside hh
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
        """Tries operands' ranges alone, for fit and range, then for the fit; then with what the node's rule says."""
        row.engine, row.depth = question.engine, question.depth
        tries = [(False, True), (False, False)] + ([(True, True)] if own.rule else [])
        for ruled, ranged in tries:
            assumed = question.facts + question.rule * ruled
            answer = question.ask(assumed, [*question.fits, *[question.in_range] * ranged])
            row.seconds += answer.seconds
            if answer.said == "unsat":
                if (met := ask(question.text(assumed, ["false"])).said) != "sat":
                    row.problem = f"can what is assumed be met? {met}"
                row.fits = own.rule if ruled else "operands"
                row.range = "operands" if ranged and not ruled else own.rule
                if row.range == "":
                    row.problem = "fits, but nothing says why its range is that of the table"
                return
            if answer.said != "sat":
                row.problem = answer.said
                return
        row.problem = "does not fit" + (f", even with '{own.rule}'" if own.rule else ", and no rule says why it should")

    # ---- one node ----------------------------------------------------------------------------------------------------

    def prove(self, name: str) -> Row:
        """The row of one node."""
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
            elif driver.module in FREE:
                self._free(row, name, driver)
            elif driver.module in ("ik_mul", "ik_mul3", "ik_exact"):
                self._product(row, name, driver)
            elif driver.module in ("ik_div", "ik_root"):
                self._quotient(row, name, driver)
            elif driver.module:
                self._operator(row, name, driver)
                if driver.values.get("SAT") == 0 and node.facts.limited:
                    row.problem = "no saturation, which its range counts on"
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
        """What the netlist makes a node of is what the model makes it of, and all of it belongs to one target.

        Ranges and rules speak of one target's operands. The clock of a node is the model's; delays are the netlist's.
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

    def _free(self, row: Row, name: str, driver: Driver) -> None:
        """Nothing to do but to look: the lemma holds for any input and says what the result can be."""
        own, values = self.ranges[name], driver.values
        fmt = self.nodes[name].format
        if driver.module == "ik_half":
            operands = [self.netlist.operand(driver.path, "c")]
            can = Range(0, 1 << (values["W"] - 1))
            row.fits = "limited to [0, 1]"
        elif driver.module == "ik_even":
            operands = [self.netlist.operand(driver.path, "v")]
            self.port(operands[0])
            can = Range(0, values["VW"] // 2 - 1) if driver.port == "k" else Range(fmt.low, fmt.high)
            row.fits = "any input"
        else:
            operands = self.netlist.operands(driver.path, "d", values["W"])
            can = Range(0, values["W"] - 1) if driver.port == "count" else Range(fmt.low, fmt.high)
            row.fits = "any input"
        self._made_of(row, operands)
        row.engine, row.depth = "bit vectors", CLOCKS[driver.module]
        row.range = "operands"
        if can.low < own.low or can.high > own.high:
            row.range = own.rule
            row.problem = "" if own.rule else "its range is narrower than what the operator can give"

    def _operator(self, row: Row, name: str, driver: Driver) -> None:
        """A sum or a shift: bit vectors from the operands' ranges."""
        key = driver.module, driver.parameters
        formula, depth = self.unrolled[key], CLOCKS[driver.module]
        own, stated = self.held(name, self.finer(name, driver))
        ports = ["a", "b"] if driver.module in ("ik_sum2", "ik_wide") else ["a", "b", "c"]
        ports = ["d", "count"] if driver.module.startswith("ik_shift") else ports
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
        """What a node's rule says: the exact value of what comes in lies in the table's range, in every clock."""
        return [formula.between(signal, clock, r.low, r.high, True) for clock in range(depth + 1)]

    def _not_negative(self, formula: Unrolled, signal: str, name: str, depth: int) -> list[str]:
        """To be proved from the operands alone where the table's range was tightened."""
        tightened = self.ranges[name] != self.table[name]
        most = self.nodes[name].format.high
        return [formula.between(signal, depth, 0, most, self.nodes[name].format.signed)] if tightened else []

    def _product(self, row: Row, name: str, driver: Driver) -> None:
        """A product: integers from the operands' ranges, on what the operator's lemma says of its tiles."""
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
            facts.append(
                f"(= p (+ (* {1 << sum(cut.values())} hh) (* {1 << cut['a']} hl) (* {1 << cut['b']} lh) ll))"
            )
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
            goal = word(f"(+ p {(1 << shift) >> 1})", values["AW"] + values["BW"]) if "AW" in values else "true"
        goal = f"(and {goal} {word('v', out)} {'(<= 0 v)' if own != stated else 'true'})"
        ruled = inside("v", stated.low, stated.high)
        in_range = inside("v", own.low, own.high)

        text = partial(conjunction, names)
        self._settle(row, own, Question("integers", CLOCKS[driver.module], text, facts, [ruled], [goal], in_range))

    def _quotient(self, row: Row, name: str, driver: Driver) -> None:
        """A quotient or a root: integers, from its being the floor."""
        values, own = driver.values, self.held(name, self.finer(name, driver))[0]
        found = self.ports(driver, *("nd" if driver.module == "ik_div" else "n"))
        self._made_of(row, [operand for _, operand, _ in found])
        n = found[0][2]
        shifted = f"(* {1 << values['SH']} n)"
        facts = [inside("n", n.low, n.high)]
        if driver.module == "ik_div":
            d = found[1][2]
            if d.low <= 0 or self.nodes[name].facts.limited:
                row.fits, row.range = f"limited: {SATURATES}", own.rule
                return
            facts += [inside("d", d.low, d.high), f"(<= (* q d) {shifted})", f"(< {shifted} (+ (* q d) d))"]
        else:
            positive = f"(ite (< n 0) 0 {shifted})"
            facts += ["(<= 0 q)", f"(<= (* q q) {positive})", f"(< {positive} (+ (* q q) q q 1))"]
        goal, ruled = word("q", values["QW"]), inside("q", own.low, own.high)

        text = partial(conjunction, "n d q")
        self._settle(row, own, Question("integers", None, text, facts, [ruled], [goal], ruled))

    def _local(self, row: Row, name: str, driver: Driver) -> None:
        """A node that the section computes itself: bit vectors on the section without its instances."""
        node = self.nodes[name]
        if not node.facts.exact:
            raise ObligationError(f"{name}: the dataflow does not say what it is in exact arithmetic")
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
        # a rule may keep nodes of the same section in range that this one is made of
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
            # Of a wrong expression, the rule could leave nothing but values for which it happens to hold.
            last, width = exact_values.last(driver.section, name), node.format.width
            low = f"(= ((_ extract {width - 1} 0) {formula.at(last, depth)}) {formula.at(name, depth)})"
            row.seconds += (answer := question.ask(facts, [low])).seconds
            if answer.said != "unsat":
                row.problem = f"without its rule it is not the low bits of its exact value: {answer.said}"
        if node.facts.limited and not row.problem:
            row.fits += f"; limited: {node.facts.limited.why}"

    def _signals(self, path: str) -> list[tuple[str, Range, bool]]:
        """A section's signals that come from outside of its own logic and are a node, with the node's range.

        Not those that the section itself has cut, shifted or extended: what it does there is to be proved.
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
                continue  # no word of a node: any value
        return found

    # ---- every format a bit shorter ----------------------------------------------------------------------------------

    def shorten(self) -> list[str]:
        """Gives every operator that rounds a shift for one integer bit fewer in its result; the nodes they make."""
        names = []
        for name, driver in self.drivers.items():
            values = driver.values
            if "SH" not in values or self.nodes[name].format.width == 1:
                continue
            values["SH"] += {"ik_div": 1, "ik_root": 2}.get(driver.module, -1)
            if values["SH"] >= 0:
                self.drivers[name] = replace(driver, parameters=tuple(sorted(values.items())))
                names.append(name)
        return names

    def spare(self, name: str) -> bool:
        """Whether a node has a leading bit that no word of its range needs, or saturates on purpose."""
        r, fmt = self.ranges[name], self.nodes[name].format
        spare = r.low >= fmt.low // 2 and r.high <= fmt.high // 2
        return spare or self.nodes[name].facts.limited is not None

    # ---- all of them -------------------------------------------------------------------------------------------------

    def run(self, names: list[str], pool: Executor, progress: Callable[[str], None]) -> list[Row]:
        """Proves the nodes `names` and the operators that make them; tells `progress` of each, and what is wrong."""
        drivers = [self.drivers[n] for n in names if n in self.drivers]
        operators = sorted({(d.module, d.parameters) for d in drivers if d.module in CLOCKS})
        sections = sorted(
            {self.drivers[n].section for n in names if n in self.drivers and not self.drivers[n].module
             and self.nodes[n].format.width > 1}
        )  # fmt: skip
        self.formulas(operators, sections)
        for lemma in pool.map(self.prove_lemma, operators):
            self.lemmas[lemma.module, lemma.parameters] = lemma
            progress(lemma.problem)
        rows = []
        for row in pool.map(self.prove, names):
            rows.append(row)
            progress(f"{row.node}: {row.problem}" if row.problem else "")
        return rows
