# SPDX-License-Identifier: Apache-2.0
"""Symbolic check that a program computes the dataflow.

:class:`Machine` models ``rtl/fold`` register by register; it decodes the fields of a step but has no schedule.
Several targets pass through it, one per lap.  Each result, as an expression of the inputs, must equal the result of
the dataflow's steps in sequence for that target: a word read before it is written, or after the next target has
overwritten it, a field needed by two steps, or a count or flag that is not ready gives a different expression.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from .program import CODES, FIELDS, PLACES
from .steps import HALF, NO_COUNT, ONE, POWER, ZERO, Group, Operand, Pick, Step, Write
from .timing import ELBOW, FETCH, INPUTS, MADE_OF, ZEROS, roots_of, terms_of

TARGETS = 3

MARKS = ("first_result", "last_result", "hold", "last_input")


class WrongProgramError(ValueError):
    """Program whose results differ from the steps'."""


class Expressions:
    """Expressions as numbers; equal expressions have equal numbers."""

    def __init__(self) -> None:
        self.known: dict[tuple, int] = {}

    def __call__(self, *parts: Any) -> int:
        return self.known.setdefault(parts, len(self.known))

    def flag(self, name: str, registers: dict[str, int], count: int) -> Any:
        """Return a flag of the codes, or an output flag: an expression of registers, and of the count."""
        if name in ("", "always"):
            return name
        if name in (NO_COUNT, "n<bits"):
            return self(name, count)
        if (terms := terms_of(name)) != [(name, False)]:
            return self("terms", *((self.flag(term, registers, count), negated) for term, negated in terms))
        get = registers.get
        return self(name, *map(get, sorted(roots_of(name)))) if name in MADE_OF else get(name)

    def operand(self, flag: Any, second: int, words: Sequence[Any]) -> Any:
        """Return one of two words selected by a flag; words of a pair are (flag, word) each."""
        if any(isinstance(word, tuple) for word in words):
            if all(isinstance(word, tuple) and word[0] == flag for word in words):
                return words[second][1]
            return self("either", second, *words) if flag == "" else self("mixed", flag, second, *words)
        return words[second] if flag == "" else self("pick", flag, words[second], words[1 - second])


def expected(groups: list[Group], of: Expressions, target: int) -> dict[str, Any]:
    """Return the results of a target, computed step by step."""
    steps = [(group, at, step) for group in groups for at, step in group.steps]
    words: dict[str, Any] = {name: of("in", name, target) for name in INPUTS}
    pairs: dict[str, list] = {}
    registers: dict[str, Any] = {"phi<0": of("below 0", words["phi"])}
    sums: dict[tuple[int, int], Any] = {}
    addends: dict[tuple[int, int], Any] = {}
    results: dict[str, Any] = {}

    class NotYetError(Exception):
        pass

    def register(name: str) -> Any:
        if name not in registers:
            raise NotYetError
        return registers[name]

    class Registers(dict):
        def get(self, name, default=None):
            return register(name)

    def operand(name: Operand | None) -> Any:
        if isinstance(name, Pick):
            flag = of.flag(name.flag, Registers(), -1)
            if name.pair in pairs:
                pair = pairs[name.pair]
                if None in pair:
                    raise NotYetError
                return of.operand(flag, int(name.second), pair)
            return of.operand(flag, int(name.second), (operand(name.pair), of("0")))
        if name in (ZERO, ONE, HALF):
            return of(name)
        if name not in words:
            raise NotYetError
        return words[name]

    pairs |= {p.pair: [None, None] for _, _, s in steps if s.write and isinstance(p := s.write.to, Pick)}

    def run(group: Group, at: int, step: Step) -> None:
        count = -1
        if step.count:
            for number, (factor, name) in enumerate(step.count.terms):
                base = of("base", str(step.count.base)) if number == 0 else count
                count = of("n", base, register(name), factor < 0, abs(factor) == 2)
        rows = {row.function: of("row", row.function, operand(row.of)) for row in step.rows}
        row = next(iter(rows.values()), None)
        a = of("c2", row) if step.a is None else operand(step.a)
        b = of("power", count) if step.b == POWER else operand(step.b)
        if step.place:
            b = of("place", "root" if "root" in rows else "angle", step.place == "high", b)
        key = id(group), at
        flag = of.flag(step.addend_by, Registers(), count)
        if step.addend == "hold":
            addend = addends[id(group), at - 1]
        else:
            addend = addend_of(of, step.addend, flag, sums.get((id(group), at - 2)), row)
        minus = of.flag(step.minus, Registers(), count)
        addends[key] = addend
        sums[key] = total = sum_of(of, addend, product_of(of, (a, b), step.cut, Registers(), count), minus, step.carry)
        if step.write:
            flag = of.flag(step.write.double_by, Registers(), count)
            word = of("word", total, window(step.write), flag, step.write.limit, step.write.last)
            if isinstance(step.write.to, Pick):
                to = step.write.to
                pairs[to.pair][to.second] = (of.flag(to.flag, Registers(), count), word)
            else:
                words[step.write.to] = word
            if step.sign:
                registers[step.sign] = of("word below 0", word)
        elif step.sign:
            registers[step.sign] = of("sum below 0", total)
        if step.norm:
            shift = count if step.norm.kind == "count" else -1
            words[step.norm.to] = normal = of("normal", total, step.norm.kind, shift)
            if step.norm.count:
                registers[step.norm.count] = of("pairs", normal)
                if step.norm.count in ZEROS:
                    registers[ZEROS[step.norm.count]] = of("zero", normal)
        if step.result:
            ends = of.flag("fold", Registers(), -1), of.flag("clamp", Registers(), -1)
            double = "double" if step.cut == "double" else "plain"
            results[step.result] = of("result", total, double, *(ends if step.result in ELBOW else ()))

    waiting = steps
    while waiting:
        left = []
        for group, at, step in waiting:
            try:
                if (step.addend in ("T", "T_half") and (id(group), at - 2) not in sums) or (
                    step.addend == "hold" and (id(group), at - 1) not in addends
                ):
                    raise NotYetError
                run(group, at, step)
            except NotYetError:
                left.append((group, at, step))
        if len(left) == len(waiting):
            raise WrongProgramError(f"steps wait for one another: {', '.join(step.name for _, _, step in left)}")
        waiting = left
    return results


def window(write: Write) -> str:
    """Return the code of the window where no flag selects it."""
    return write.double_by or ("plain" if write.window == 1 else "double")


def addend_of(of: Expressions, choice: str, flag: Any, total: Any, row: Any) -> int:
    """Return the addend S."""
    if choice in ("T", "T_half"):
        return of(choice, total)
    if choice in ("slope", "slope_less", "value"):
        return of(choice, row)
    return of(choice, flag) if choice in ("length", "none_or_half") else of(choice)


def product_of(of: Expressions, factors: tuple[Any, Any], cut: str, registers: dict, count: Any) -> int:
    """Return a product; with a power it also depends on whether the count is small."""
    return of("product", *factors, cut, of.flag("n<bits", registers, count) if cut == "power" else "")


def sum_of(of: Expressions, addend: Any, product: Any, minus: Any, carry: str) -> int:
    """Return the sum T."""
    return of("sum", addend, product, minus, carry if carry != "minus" or minus != "" else "")


class Machine:
    """Registers of ``rtl/fold``, holding expressions."""

    def __init__(self, of: Expressions) -> None:
        self.of = of
        self.words: list[Any] = [of("0")] * PLACES
        self.flags: dict[str, Any] = {}
        self.read: tuple[Any, Any, Any] = (None, None, None)
        self.row: Any = None
        self.operands: tuple[Any, Any] = (None, None)
        self.tiles: tuple[Any, Any] = (None, None)
        self.product: Any = None
        self.addend: Any = None
        self.minus: tuple[Any, str] = ("", "")
        self.total: Any = None
        self.normals: list[Any] = [None, None]
        self.count: Any = None
        self.results: dict[str, Any] = {}

    def word(self, place: int, flag: str) -> Any:
        if place >= PLACES:
            return self.of({63: ZERO, 1: ONE, 2: HALF}[place - PLACES])
        base = place & ~1
        chosen = self.of.flag(flag, self.flags, self.count)
        words = self.words[base : base + 2]
        if flag or any(isinstance(word, tuple) for word in words):
            return self.of.operand(chosen, place & 1, words)
        return self.words[place]

    def step(self, f: dict[str, Any], target: int) -> None:
        """Execute one clock with these fields."""
        of = self.of
        flag = lambda name: of.flag(f[name], self.flags, self.count)  # noqa: E731
        read = (
            self.word(f["a"], f["a_by"]),
            of("power", self.count) if f["b_count"] else self.word(f["b"], f["b_by"]),
            self.words[f["r"]],
        )
        row = of("row", f["r_function"], self.read[2])
        a = of("c2", self.row) if f["a_bend"] else self.read[0]
        b = self.read[1]
        if f["b_place"]:
            b = of("place", f["b_place"], bool(f["b_high"]), b)
        product = product_of(of, self.tiles, f["cut"], self.flags, self.count)
        addend = self.addend if f["s"] == "hold" else addend_of(of, f["s"], flag("s_by"), self.total, self.row)
        total = sum_of(of, self.addend, self.product, *self.minus)

        by = of.flag("low" if f["window"] == "low" else "", self.flags, self.count)
        word = of("word", self.total, f["window"], by, bool(f["limit"]), f["last"])
        kind = f["norm"]
        normal = of("normal", self.total, kind, self.count if kind == "count" else -1) if kind else None
        late = self.normals[1]
        if late and late[1] == "count" and late[2] != self.count:
            late = (of("the count has changed"), *late[1:])
        sources = {"sum": word, "normal": late[0] if late else None, "input": of("in", f["input"], target)}
        written = sources.get(f["source"])
        if f["result"]:
            double = "double" if f["window"] == "double" else "plain"
            ends = [of.flag(name, self.flags, self.count) for name in ("fold", "clamp")] if f["result"] in ELBOW else []
            self.results[f["result"]] = of("result", self.total, double, *ends)

        changed: dict[str, Any] = {}
        if f["sign"]:
            kept = of("word below 0", word) if f["source"] == "sum" else of("sum below 0", self.total)
            changed[f["sign"]] = kept
        if f["e_set"]:
            assert late
            changed[f["e_set"]] = of("pairs", late[0])
            if f["e_set"] in ZEROS:
                changed[ZEROS[f["e_set"]]] = of("zero", late[0])
        if f["source"] == "input" and f["input"] == "phi":
            changed["phi<0"] = of("below 0", written)
        if f["source"] != "none":
            to_pair = f["w_by"] != ""
            self.words[f["w"]] = (flag("w_by"), written) if to_pair else written
        self.minus = (flag("minus_by"), f["carry"])
        self.normals = [(normal, kind, self.count) if kind else None, self.normals[0]]
        self.read, self.row, self.operands, self.tiles = read, row, (a, b), self.operands
        self.product, self.addend, self.total = product, addend, total
        if f["n_e"]:
            base = self.count if f["n_base"] == "count" else of("base", f["n_base"])
            self.count = of("n", base, self.flags.get(f["n_e"]), bool(f["n_minus"]), bool(f["n_twice"]))
        self.flags |= changed


def fields(word: int) -> dict[str, Any]:
    """Return field -> name of its code, or number."""
    found: dict[str, Any] = {}
    for name, bits in FIELDS.items():
        number = word & (1 << bits) - 1
        word >>= bits
        found[name] = CODES[name][number] if name in CODES else number
    return found


def in_order(decoded: list[dict[str, Any]]) -> None:
    """Check the marks: a target's first and last result, the clock before the first, and the last word loaded."""
    period = len(decoded)
    marked = {name: [n for n, f in enumerate(decoded) if f[name]] for name in MARKS}
    for name, clocks in marked.items():
        if len(clocks) != 1:
            raise WrongProgramError(f"{name} stands in {len(clocks)} clocks")
    (first,), (last,), (hold,), (loaded,) = marked.values()
    after = sorted((clock - first) % period for clock, f in enumerate(decoded) if f["result"])
    if (first, last, hold) != ((first + after[0]) % period, (first + after[-1]) % period, (first - 1) % period):
        raise WrongProgramError("the marks of results do not stand where the first and the last one are")
    if loaded != max(n for n, f in enumerate(decoded) if f["source"] == "input"):
        raise WrongProgramError("a word is loaded after the last input")
    if last >= period - FETCH:
        raise WrongProgramError("the last result comes when the next lap is already fetched")


def check(words: list[int], groups: list[Group]) -> None:
    """Raise :class:`WrongProgramError` if the program of a lap, one word per clock, does not compute the steps."""
    of = Expressions()
    machine = Machine(of)
    decoded = [fields(word) for word in words]
    in_order(decoded)
    period, found = len(words), []
    for clock in range((TARGETS + 2) * period):
        machine.step(decoded[clock % period], clock // period)
        if decoded[clock % period]["last_result"]:
            found.append(dict(machine.results))
    found = [results for results in found if len(results) == len(ELBOW) + 4][-TARGETS:]
    owed = [expected(groups, of, target) for target in range(TARGETS + 2)]
    for results in found:
        if results not in owed:
            near = max(owed, key=lambda owes: sum(results[name] == value for name, value in owes.items()))
            wrong = [name for name, value in near.items() if results.get(name) != value]
            raise WrongProgramError(f"the program computes another {', '.join(wrong)}")
    of_targets = [owed.index(results) for results in found]
    if of_targets != list(range(of_targets[0], of_targets[0] + TARGETS)):
        raise WrongProgramError("the results are of other targets")
