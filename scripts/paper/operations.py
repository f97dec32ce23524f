# SPDX-License-Identifier: Apache-2.0
"""Table 4 of the paper: operation counts of equations (10)-(19) and of the elaborated RTL; operations.md.

Expressions come from model/reference/printed.py. Verilator elaborates the RTL (``--json-only``); instances and inline
+ and - in its tree are counted. Nothing is simulated or compiled.
"""

from __future__ import annotations

import json
import operator
import subprocess
import sys
import tempfile
import textwrap
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import sympy

from model.dataflow.fixed import latency
from model.dataflow.paper import SECTIONS, paper
from model.reference.printed import PRINTED, symbol
from scripts.generate.flow import WIDTH, operations
from scripts.generate.render import render, table
from tb.sim.env import GENERATED, ROOT, environment
from tb.sim.sources import includes, sources

PAGE = GENERATED / "operations.md"


class Ops(NamedTuple):
    """Operation counts; ``scale`` counts multiplications by a constant, ``trig`` sines and cosines."""

    add: int = 0
    mul: int = 0
    root: int = 0
    div: int = 0
    scale: int = 0
    trig: int = 0

    def __add__(self, other: Ops) -> Ops:
        return Ops(*map(operator.add, self, other))


UNOPTIMIZED, OPTIMIZED = Ops(147, 87, 8, 16), Ops(69, 42, 8, 10)
"""Table 4 as printed."""


# -- expressions -----------------------------------------------------------------------------------------------------


def count(expression: sympy.Expr) -> Ops:
    """Count the operations of an expression tree, without sharing."""
    if expression.is_Symbol or expression.is_Number:
        return Ops()
    if expression.is_Mul:
        return _product(expression)
    if expression.is_Pow:
        return _power(*expression.args)
    if isinstance(expression, (sympy.cos, sympy.sin)):
        return Ops(trig=1)  # half an angle is wiring
    own = {"Add": Ops(add=len(expression.args) - 1), "Abs": Ops(), "rsqrt": Ops(root=1)}.get(expression.func.__name__)
    if own is None:
        raise ValueError(f"no rule for the operation {expression.func.__name__}")
    return own + total(expression.args)


def _factors(expression: sympy.Expr) -> list[sympy.Expr]:
    return [f for a in expression.args for f in (_factors(a) if a.is_Mul else [a])]


def _product(expression: sympy.Expr) -> Ops:
    above, below, inside = 0, 0, Ops()
    for f in _factors(expression):
        if f.is_number:  # 2, 1/2: wiring
            inside += Ops(scale=int(abs(f.doit()) != 1))
        elif f.is_Pow and f.args[1].is_number and f.args[1] < 0:
            below += 1
            inside += _power(f.args[0], -f.args[1])
        else:
            above += 1
            inside += count(f)
    return inside + Ops(mul=max(above - 1, 0) + max(below - 1, 0), div=int(below > 0))


def _power(base: sympy.Expr, exponent: sympy.Expr) -> Ops:
    if exponent < 0:
        return _power(base, -exponent) + Ops(div=0 if base.is_number else 1)
    if exponent == sympy.Rational(1, 2):
        return count(base) + Ops(root=1)
    if not exponent.is_Integer:
        raise ValueError(f"no rule for the power {exponent}")
    # by repeated squaring: x^2 is one multiplication, x^3 and x^4 are two
    n = int(exponent)
    return count(base) + Ops(mul=n.bit_length() - 1 + n.bit_count() - 1)


def total(expressions: Iterable[sympy.Expr]) -> Ops:
    """Count the operations of several expressions, without sharing."""
    return sum(map(count, expressions), Ops())


def shared(lines: dict[str, sympy.Expr]) -> Ops:
    """Count the operations after ``sympy.cse`` over all lines at once."""
    trees, names = [e.doit() for e in lines.values()], sympy.numbered_symbols("shared_")
    common, rest = sympy.cse(trees, symbols=names, optimizations="basic", order="canonical")
    return total([e for _, e in common] + rest)


def printed_lines(*numbers: str) -> dict[str, sympy.Expr]:
    """Return the lines of the given equations in order, by default (10)-(18)."""
    return {n: e for k in numbers or [k for k in PRINTED if k != "(19)"] for n, e in PRINTED[k].items()}


def lines_with_19() -> dict[str, sympy.Expr]:
    """Return (10)-(18) with (19) replacing the last six lines of (12); (13) follows by substitution."""
    to_19 = {}
    for m in "123":
        plus, minus = symbol(f"pp_{m}_plus"), symbol(f"pp_{m}_minus")
        to_19 |= {symbol(f"pp_{m}5"): (plus + minus) / 2, symbol(f"pp_{m}4"): (plus - minus) / 2}
    result = {}
    for name, e in printed_lines().items():
        if name in PRINTED["(13)"]:
            e = e.doit().subs(to_19)
            result[name] = sympy.expand(e) if name == "tmp1" else e
        else:
            result |= PRINTED["(19)"] if symbol(name) in to_19 else {name: e}
    return result


def savings() -> dict[str, tuple[Ops, Ops, str]]:
    """Return, for each part of (12) and (13) changed by (19): operations before and after, claim of section 4.2."""
    before, after, lines = printed_lines("(12)", "(13)"), printed_lines("(19)"), lines_with_19()
    six = {n: e for n, e in before.items() if n[-1] in "45"}
    elbow = [n for n in before if n.startswith("p_e_")]

    def of(*names: str) -> tuple[Ops, Ops]:
        return tuple(total(each[n].doit() for n in names) for each in (before, lines))

    return {
        "PP_m4, PP_m5 to PP_m^+, PP_m^-": (total(six.values()), total(after.values()), "the same number"),
        "the same, common subexpressions": (shared(six), shared(after), "1 + and 2 x fewer"),
        "inf_pp": (*of("inf_pp"), "an addition fewer each time"),
        "tmp_1": (*of("tmp1"), "3 + and 3 x fewer"),
        "p_e": (*of(*elbow), "an addition fewer each time"),
    }


# -- the elaborated RTL ----------------------------------------------------------------------------------------------


def elaborate(root: Path = ROOT, top: str = "ik_paper", **parameters: int) -> list[dict]:
    """Return the modules of a datapath as elaborated by Verilator, top first.

    Raises RuntimeError with Verilator's message if elaboration fails.
    """
    with tempfile.TemporaryDirectory() as folder:
        command = ["verilator_bin", "--json-only", "--no-json-edit-nums", "--Mdir", folder, "--prefix", "top"]
        command += ["--top-module", top, *(f"-G{k}={v}" for k, v in ({"W": WIDTH} | parameters).items())]
        command += ["-Wno-fatal", "-Wno-lint"]
        command += [f"-I{folder}" for folder in includes(root)] + [str(p) for p in sources(root)]
        done = subprocess.run(command, env=environment(), capture_output=True, text=True)
        if done.returncode:
            raise RuntimeError(f"{top} does not elaborate:\n{done.stderr}")
        return json.loads((Path(folder) / "top.tree.json").read_text())["modulesp"]


LIBRARY = ("ik_mul", "ik_sum2", "ik_sum3", "ik_half", "ik_div", "ik_root", "ik_sincos", "ik_norm", "ik_lzc", "ik_shift")
"""Modules that are counted, whole."""
FREE = ("ik_pick", "ik_delay", "ik_ring")
"""Selection, sign change and delays: counted neither by table 4 nor by the dataflow."""


def _walk(tree: Any) -> Iterator[dict]:
    if isinstance(tree, dict):
        yield tree
        tree = list(tree.values())
    for child in tree if isinstance(tree, list) else ():
        yield from _walk(child)


def rtl_counts(root: Path = ROOT) -> dict[str, Counter]:
    """Return for each section the counts of library modules and inline ``+`` and ``-``."""
    modules = elaborate(root)
    by_address = {m["addr"]: m for m in modules}
    counts = {section: Counter() for section in SECTIONS}

    def visit(module: dict, mine: Counter) -> None:
        for node in _walk(module["stmtsp"]):
            mine["operator"] += node.get("type") in ("ADD", "SUB")
            if node.get("type") != "CELL":
                continue
            inner = by_address[node["modp"]]
            kind = inner["origName"]
            if kind in LIBRARY:
                mine[kind] += 1
            elif kind.removeprefix("ik_") in SECTIONS:
                visit(inner, counts[kind.removeprefix("ik_")])
            elif kind not in FREE:
                raise RuntimeError(f"{module['name']}: no rule for the module {kind} of instance {node['name']}")

    visit(next(m for m in modules if m["origName"] == "ik_paper"), Counter())
    return counts


def operators(modules: list[dict]) -> Counter:
    """Count the ``add`` and ``mul`` of all instances below the top, except in constants, functions and initial blocks,
    which are tables. Verilator copies the right side of an assignment to a concatenation once per part, so
    operators with the same source location and generate block count once."""
    by_address = {m["addr"]: m for m in modules}
    kinds = {"ADD": "add", "SUB": "add", "MUL": "mul", "MULS": "mul"}

    def inside(tree: Any, block: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], str]]:
        """Yield a place and the operator or the address of the module there."""
        if isinstance(tree, list):
            for child in tree:
                yield from inside(child, block)
            return
        kind = tree.get("type")
        if kind in ("FUNC", "INITIAL"):
            return
        if kind == "CELL":
            yield (*block, tree["addr"]), tree["modp"]
        if kind == "GENBLOCK":
            block = (*block, tree["name"])
        if kind in kinds and any(side["type"] != "CONST" for side in tree["lhsp"] + tree["rhsp"]):
            yield (*block, tree["loc"]), kinds[kind]
        for name, child in tree.items():
            if isinstance(child, list) and name not in ("lsbp", "bitp"):  # indices
                yield from inside(child, block)

    def of(module: dict) -> Counter:
        found = dict(inside(module["stmtsp"], ())).values()
        return sum((of(by_address[one]) if one in by_address else Counter([one]) for one in found), Counter())

    return of(modules[0])


def rtl_ops(c: Counter) -> Ops:
    """Convert a section's instance counts to operations."""
    return Ops(
        add=c["ik_sum2"] + 2 * c["ik_sum3"] + c["ik_half"] + c["operator"],
        mul=c["ik_mul"],
        root=c["ik_root"],
        div=c["ik_div"],
        trig=2 * c["ik_sincos"],
    )


def differences(rtl: dict[str, Counter], flow: dict[str, Counter]) -> list[str]:
    """Return a line for each operation count in which the elaborated RTL and the dataflow differ."""
    found = []
    for section in SECTIONS:
        a, b = Counter(rtl[section]), flow.get(section, Counter())
        a["additions"] = rtl_ops(a).add
        for unit in ("mul", "div", "root", "sincos", "norm", "lzc", "shift", "additions"):
            kind = unit if unit == "additions" else f"ik_{unit}"
            if a[kind] != b[unit]:
                found.append(f"section {section}: {a[kind]} {kind} in the RTL, {b[unit]} in model/dataflow/paper.py")
    return found


# -- the page --------------------------------------------------------------------------------------------------------


def _bullet(text: str) -> str:
    lines = textwrap.wrap(f"- {text}", 118, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False)
    return "\n".join(lines)


def operators_at_once() -> dict[str, dict[str, int]]:
    """Return operators and clocks of the paper and lean datapaths, with dividers and roots built from rows."""
    found = {}
    for datapath, top in (("paper", "ik_paper"), ("lean", "ik_lean")):
        digit = {"DIGIT": 1} if datapath == "paper" else {}
        found[datapath] = {**operators(elaborate(top=top, **digit)), "clocks": latency(datapath, WIDTH)}
    return found


def page(rtl: dict[str, Counter]) -> str:
    """Return operations.md."""
    lines, lines_19 = printed_lines(), lines_with_19()
    ops = {s: rtl_ops(c) for s, c in rtl.items()}
    print_ = total(lines.values())
    kinds = [k for k in (*LIBRARY, "operator") if any(c[k] for c in rtl.values())]
    heads = ["written +, -" if k == "operator" else f"`{k}`" for k in kinds]
    by_section = [(SECTIONS[section], *(c[k] for k in kinds)) for section, c in rtl.items()]
    whole = sum(rtl.values(), Counter())
    return render(
        "operations",
        old=UNOPTIMIZED,
        new=OPTIMIZED,
        print=print_,
        cse=shared(lines),
        print_19=total(lines_19.values()),
        cse_19=shared(lines_19),
        rtl=sum((o for s, o in ops.items() if s != "guard"), Ops()),
        everything=sum(ops.values(), Ops()),
        spread=print_.div + 4 - 1,  # 4 halvings in roots, sign/|sign|
        guard=ops["guard"],
        sections=table(["section", *heads], [*by_section, ("all", *(whole[k] for k in kinds))]),
        equations={k: total(PRINTED[k].values()) for k in PRINTED},
        bullet=_bullet,
        savings=savings(),
        at_once=(at_once := operators_at_once()),
        together={datapath: found["add"] + found["mul"] for datapath, found in at_once.items()},
        width=WIDTH,
    )


def write() -> int:
    """Count and write operations.md; return 1 if RTL and dataflow differ."""
    rtl = rtl_counts()
    if wrong := differences(rtl, operations(paper)):
        print(*wrong, sep="\n", file=sys.stderr)
        return 1
    PAGE.write_text(page(rtl))
    print(f"wrote {PAGE.name}")
    return 0
