# SPDX-License-Identifier: Apache-2.0
"""Table 4 again: the operations of equations (10)-(19) and of the elaborated RTL, counted; docs/operations.md.

    python -m scripts.pages.opcounts      counts and writes the page

Expressions are those of model/reference/printed.py.  The RTL is elaborated by Verilator (``--json-only``), and the
instances and the written + and - in the tree that it gives are counted; nothing is simulated or compiled.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import textwrap
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
import sympy

from model.dataflow import fixed
from model.dataflow.nodes import FormatError
from model.dataflow.paper import SECTIONS, paper
from model.reference.printed import PRINTED, symbol
from model.targets.words import FIELDS
from tb.sim.env import GENERATED, ROOT, environment
from tb.sim.sources import includes, sources

PAGE = GENERATED / "operations.md"
WIDTH = 32


@dataclass(frozen=True)
class Ops:
    """Numbers of operations; ``scale`` are multiplications by a constant, ``trig`` sines and cosines."""

    add: int = 0
    mul: int = 0
    root: int = 0
    div: int = 0
    scale: int = 0
    trig: int = 0

    def __add__(self, other: Ops) -> Ops:
        return Ops(*(getattr(self, f.name) + getattr(other, f.name) for f in fields(self)))


UNOPTIMIZED, OPTIMIZED = Ops(147, 87, 8, 16), Ops(69, 42, 8, 10)
"""Table 4 as printed."""


# -- expressions -----------------------------------------------------------------------------------------------------


def count(expression: sympy.Expr) -> Ops:
    """The operations of one expression tree, nothing shared."""
    if expression.is_Symbol or expression.is_Number:
        return Ops()
    inside = sum((count(a) for a in expression.args), Ops()) if not expression.is_Mul else Ops()
    if expression.is_Add:
        return inside + Ops(add=len(expression.args) - 1)
    if expression.is_Mul:
        return _product(expression)
    if expression.is_Pow:
        return _power(*expression.args)
    if isinstance(expression, (sympy.cos, sympy.sin)):
        return Ops(trig=1)  # half an angle is wiring
    if isinstance(expression, sympy.Abs):
        return inside  # a change of sign
    raise ValueError(f"no rule for the operation {expression.func.__name__}")


def _factors(expression: sympy.Expr) -> Iterator[sympy.Expr]:
    for a in expression.args:
        yield from _factors(a) if a.is_Mul else (a,)


def _product(expression: sympy.Expr) -> Ops:
    above, below, total = 0, 0, Ops()
    for f in _factors(expression):
        negative = f.is_Pow and f.args[1].is_number and f.args[1] < 0
        if f.is_number:  # 2, 1/2: wiring
            total += Ops(scale=int(abs(f.doit()) != 1))
        elif negative:
            below += 1
            total += _power(f.args[0], -f.args[1])
        else:
            above += 1
            total += count(f)
    return total + Ops(mul=max(above - 1, 0) + max(below - 1, 0), div=int(below > 0))


def _power(base: sympy.Expr, exponent: sympy.Expr) -> Ops:
    own = count(base)
    if exponent < 0:
        return _power(base, -exponent) + Ops(div=0 if base.is_number else 1)
    if exponent == sympy.Rational(1, 2):
        return own + Ops(root=1)
    if not exponent.is_Integer:
        raise ValueError(f"no rule for the power {exponent}")
    # by repeated squaring: x^2 is one multiplication, x^3 and x^4 are two
    n = int(exponent)
    return own + Ops(mul=n.bit_length() - 1 + n.bit_count() - 1)


def total(expressions: Iterable[sympy.Expr]) -> Ops:
    """The operations of several expressions, nothing shared between them."""
    return sum((count(e) for e in expressions), Ops())


def shared(lines: dict[str, sympy.Expr]) -> Ops:
    """The operations after ``sympy.cse`` over all lines at once."""
    names = sympy.numbered_symbols("shared_")
    common, rest = sympy.cse(
        [e.doit() for e in lines.values()], symbols=names, optimizations="basic", order="canonical"
    )
    return total([e for _, e in common] + rest)


def printed_lines(*numbers: str) -> dict[str, sympy.Expr]:
    """The lines of the given equations, in order; of all of (10)-(18) if none is given."""
    return {n: e for k in numbers or [k for k in PRINTED if k != "(19)"] for n, e in PRINTED[k].items()}


def lines_with_19() -> dict[str, sympy.Expr]:
    """(10)-(18) with (19) in place of the last six lines of (12): (13) follows by substitution."""
    lines = printed_lines()
    to_19 = {}
    for m in "123":
        plus, minus = symbol(f"pp_{m}_plus"), symbol(f"pp_{m}_minus")
        to_19 |= {symbol(f"pp_{m}5"): (plus + minus) / 2, symbol(f"pp_{m}4"): (plus - minus) / 2}
    result = {}
    for name, e in lines.items():
        if name in PRINTED["(13)"]:
            e = e.doit().subs(to_19)
            result[name] = sympy.expand(e) if name == "tmp1" else e
        elif name in [s.name for s in to_19]:
            result |= PRINTED["(19)"]
        else:
            result[name] = e
    return result


# -- the elaborated RTL ----------------------------------------------------------------------------------------------


def elaborate(root: Path = ROOT, width: int = WIDTH) -> list[dict]:
    """The modules of ``ik_paper`` as Verilator has elaborated them, the top first.

    RuntimeError with Verilator's own message when the sources do not elaborate.
    """
    with tempfile.TemporaryDirectory() as folder:
        command = ["verilator_bin", "--json-only", "--no-json-edit-nums", "--Mdir", folder, "--prefix", "top"]
        command += ["--top-module", "ik_paper", f"-GW={width}", "-Wno-fatal", "-Wno-lint"]
        command += [f"-I{folder}" for folder in includes(root)] + [str(p) for p in sources(root)]
        done = subprocess.run(command, env=environment(), capture_output=True, text=True)
        if done.returncode:
            raise RuntimeError(f"ik_paper does not elaborate:\n{done.stderr}")
        return json.loads((Path(folder) / "top.tree.json").read_text())["modulesp"]


def _walk(tree) -> Iterator[dict]:
    if isinstance(tree, dict):
        yield tree
        tree = list(tree.values())
    if isinstance(tree, list):
        for child in tree:
            yield from _walk(child)


def _parameter(module: dict, name: str) -> int:
    for item in module["stmtsp"]:
        if item["type"] == "VAR" and item["name"] == name:
            return int(item["valuep"][0]["name"].split("h")[-1], 16)
    raise RuntimeError(f"module {module['name']} has no parameter {name}")


LIBRARY = ("ik_mul", "ik_sum2", "ik_sum3", "ik_half", "ik_div", "ik_root", "ik_sincos", "ik_norm", "ik_lzc", "ik_shift")
"""What sections are made of.  Of what stands inside of one of these only the delays of its operands are counted."""


def _operand_bits(operator: dict, by_address: dict[str, dict]) -> int:
    """Bits of the delays of an operator's operands: of operand a in instance u_a, and so on."""
    ports = [f"u_{n['name']}" for n in operator["stmtsp"] if n["type"] == "VAR" and n.get("direction") == "INPUT"]
    cells = [n for n in _walk(operator["stmtsp"]) if n.get("type") == "CELL" and n["name"] in ports]
    return sum(_parameter(by_address[c["modp"]], "W") * _parameter(by_address[c["modp"]], "N") for c in cells)


def rtl_counts(root: Path = ROOT) -> dict[str, Counter]:
    """Section -> how many of each library module, of written ``+`` and ``-``, and bits that wait."""
    modules = elaborate(root)
    by_address = {m["addr"]: m for m in modules}
    tops = [m for m in modules if m["origName"] == "ik_paper"]
    counts: dict[str, Counter] = {}

    def visit(module: dict, section: str) -> None:
        mine = counts.setdefault(section, Counter())
        mine["operator"] += sum(n.get("type") in ("ADD", "SUB") for n in _walk(module["stmtsp"]))
        for cell in _walk(module["stmtsp"]):
            if cell.get("type") != "CELL":
                continue
            inner = by_address[cell["modp"]]
            kind = inner["origName"]
            if kind in LIBRARY:
                mine[kind] += 1
                mine["delay_bits"] += _operand_bits(inner, by_address)
            elif kind == "ik_pick":
                continue  # a choice and a sign change, which neither table 4 nor the dataflow counts
            elif kind in ("ik_delay", "ik_ring"):
                mine["delay_bits"] += _parameter(inner, "W") * _parameter(inner, "N")
            elif kind.removeprefix("ik_") in SECTIONS:
                visit(inner, kind.removeprefix("ik_"))
            else:
                raise RuntimeError(f"{module['name']}: no rule for the module {kind} of instance {cell['name']}")

    visit(tops[0], "results")
    return {s: counts.get(s, Counter()) for s in SECTIONS}


def rtl_ops(c: Counter) -> Ops:
    """A section's instances as operations."""
    return Ops(
        add=c["ik_sum2"] + 2 * c["ik_sum3"] + c["ik_half"] + c["operator"],
        mul=c["ik_mul"],
        root=c["ik_root"],
        div=c["ik_div"],
        trig=2 * c["ik_sincos"],
    )


# -- the dataflow ----------------------------------------------------------------------------------------------------


class _Counted(np.ndarray):
    """Words that count the + and - done with them."""

    done: Counter = Counter()

    def __array_ufunc__(self, ufunc, method, *inputs, **kwargs):
        _Counted.done["+-"] += ufunc in (np.add, np.subtract)
        plain = [i.view(np.ndarray) if isinstance(i, _Counted) else i for i in inputs]
        return np.asarray(getattr(ufunc, method)(*plain, **kwargs)).view(_Counted)


class _Counting(fixed.Bits):
    """Runs the dataflow and keeps for every choice how many + and - it does with words."""

    def __init__(self, width: int) -> None:
        super().__init__(width)
        self.additions: Counter = Counter()

    def apply(self, name, operands, fmt, bits, real):
        before = _Counted.done["+-"]
        value = bits(*(np.asarray(n.value).view(_Counted) for n in operands))
        self.additions[name] = _Counted.done["+-"] - before
        return np.asarray(value).view(np.ndarray)


def counted_run(flow=paper, width: int = WIDTH) -> tuple[fixed.Bits, Counter]:
    """The dataflow after a run, and for every choice how many + and - it does."""
    d = _Counting(width)
    flow(d, {k: d.input(k, np.array([1 << (width - 3)])) for k in FIELDS})
    return d, d.additions


def dataflow_counts(flow=paper) -> dict[str, Counter]:
    """Section -> how many of each kind of operation ``flow`` makes, in the words of :func:`rtl_counts`."""
    d, additions = counted_run(flow)
    counts = {s: Counter() for s in SECTIONS}
    vectors = set()
    for node in d.nodes.values():
        mine = counts[node.section]
        if node.latency in ("mul", "div", "root", "shift", "lzc"):
            mine[f"ik_{node.latency}"] += 1
        elif node.latency in ("norm", "sincos"):  # several results of one unit
            if (key := (node.latency, tuple(o.name for o in node.operands))) not in vectors:
                vectors.add(key)
                mine[f"ik_{node.latency}"] += 1
        elif node.latency in ("sum2", "sum3"):
            mine["additions"] += int(node.latency[-1]) - 1
        elif node.latency == "mux":
            mine["additions"] += additions[node.name]
        elif node.latency:
            raise RuntimeError(f"node {node.name}: no rule for the operation {node.latency}")
    return counts


def differences(rtl: dict[str, Counter], flow: dict[str, Counter]) -> list[str]:
    """Where the elaborated RTL does not have the operations of the dataflow, one line each."""
    found = []
    for section in SECTIONS:
        a, b = Counter(rtl[section]), Counter(flow[section])
        a["additions"] = rtl_ops(a).add
        for kind in ("ik_mul", "ik_div", "ik_root", "ik_sincos", "ik_norm", "ik_lzc", "ik_shift", "additions"):
            if a[kind] != b[kind]:
                found.append(f"section {section}: {a[kind]} {kind} in the RTL, {b[kind]} in model/dataflow/paper.py")
    return found


# -- the page --------------------------------------------------------------------------------------------------------


def _row(name: str, o: Ops, printed: bool = False) -> str:
    rest = ["", ""] if printed else [str(o.scale), str(o.trig)]
    return f"| {' | '.join([name, str(o.add), str(o.mul), str(o.root), str(o.div), *rest])} |"


def _bullet(text: str) -> list[str]:
    return textwrap.wrap(f"- {text}", 118, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False)


def page(rtl: dict[str, Counter]) -> str:
    """docs/operations.md."""
    lines, lines_19 = printed_lines(), lines_with_19()
    print_, cse, print_19, cse_19 = total(lines.values()), shared(lines), total(lines_19.values()), shared(lines_19)
    ops = {s: rtl_ops(c) for s, c in rtl.items()}
    everything = sum(ops.values(), Ops())
    equations = sum((o for s, o in ops.items() if s != "guard"), Ops())
    spread = print_.div + 4 - 1  # 4 halvings in roots, sign/|sign|
    old, new, rtl_, cse_ = UNOPTIMIZED, OPTIMIZED, equations, cse_19
    rows = [
        "# Operations: table 4 again",
        "",
        "Written by `make operations` from `model/reference/printed.py` and from the elaborated RTL; `make test`",
        "fails when it",
        "is out of date.",
        "",
        "| what | +, - | x | root | a/b, 1/b | x constant | sin, cos |",
        "| --- | --: | --: | --: | --: | --: | --: |",
        _row("**paper, unoptimized**", UNOPTIMIZED, True),
        _row("(10)-(18) as printed", print_),
        _row("(10)-(18), common subexpressions", cse),
        _row("(10)-(18) with (19), as printed", print_19),
        _row("(10)-(18) with (19), common subexpressions", cse_19),
        _row("**paper, optimized**", OPTIMIZED, True),
        _row("RTL, sections 3.1 to 3.5", equations),
        _row("RTL, all of `ik_paper`", everything),
        "",
        "How it is counted:",
        "",
        "- *as printed*: every line is worked out on its own; only what has a name in print (|L_sw|, PP_14, tmp_1)",
        "  is shared. (16) is printed again in (17) and counted once.",
        "- *common subexpressions*: `sympy.cse` over all lines at once, optimizations `basic`, order `canonical`. It",
        "  shares reciprocals too: one 1/|L_sw| and three products in place of three quotients.",
        "- *with (19)*: the last six lines of (12) are replaced by (19) and put into (13) by substitution. tmp_1",
        "  comes out with PP_m^+ PP_m^-, as section 4.2 says.",
        "- A sum of n terms is n-1 additions; a sign is free. x^2 is one multiplication, x^3 and x^4 are two. A",
        "  product with several denominators is one division. Multiplication by 2 or 1/2 is wiring and has a column",
        "  of its own, and so have sine and cosine, which table 4 does not mention.",
        "- *RTL*: Verilator elaborates `ik_paper` for W = 32 (`verilator_bin --json-only`) and the instances in its",
        "  tree are counted; `ik_sum3` is two additions, `ik_half` is one, and each + and - written in a section is",
        "  one. Comparisons, sign changes, shifts and choices are not operations of table 4.",
        "",
        "Differences from the paper:",
        "",
        *_bullet(
            f"**Additions and multiplications.** With nothing shared at all, the printed equations have {print_.add} "
            f"additions and {print_.mul} multiplications, so these rules cannot give {old.add} additions; the paper's "
            f"numbers fit far better with the two columns exchanged ({old.add} x and {old.mul} +, then {new.add} x and "
            f"{new.mul} +), which is a guess of ours and not in the paper."
        ),
        *_bullet(
            f"**Roots.** {print_.root} everywhere, as in the paper: |L_sw|, tmp_sqr, two in (14), |L_m|, |pi_swivel| "
            "and two in (17)."
        ),
        *_bullet(
            f"**Divisions, unoptimized.** {print_.div} against {old.div}: {spread} come out if the four halvings in "
            "the roots of (14) and (17) count and sign/|sign| does not, but the paper does not state its rule."
        ),
        *_bullet(
            f"**Divisions, optimized.** {cse_.div} with shared reciprocals, {rtl_.div} in the RTL, {new.div} in the "
            "paper: the RTL divides each of the three coordinates in (11), (13) and (15), since one rounded quotient "
            "is more exact than a product with a rounded reciprocal; the paper does not say which division it does "
            "without."
        ),
        *_bullet(
            f"**RTL, multiplications.** {rtl_.mul} against {cse_.mul} by common subexpressions and {new.add} or "
            f"{new.mul} of the paper: (14) is factored to p_e (p_e - p_w) and tmp_2 to the square of a vector, which "
            "saves more than the form of (15) for an elbow above the shoulder and the product with 1/|pi_swivel| cost."
        ),
        *_bullet(
            f"**RTL, additions.** {rtl_.add} against {cse_.add} and {new.add} or {new.mul}: the factored (14) and (15) "
            "save some; 2 cos^2 - 1, whose square the print of (11) lacks, and `ik_sum2` with one term, which only "
            "rounds and saturates (two in (18), one in (11)), cost some."
        ),
        *_bullet(
            f"**RTL, domain and scale.** {ops['guard'].mul} multiplications and {ops['guard'].add} additions that the "
            "paper does not have decide exactly which targets are outside the equations' domain, and choose the units "
            "of length."
        ),
        "",
        "The RTL by section, instances and written operators:",
        "",
    ]
    kinds = [k for k in (*LIBRARY, "operator", "delay_bits") if any(c[k] for c in rtl.values())]
    words = {"operator": "written +, -", "delay_bits": "bits that wait"}
    rows.append(f"| section | {' | '.join(words.get(k, f'`{k}`') for k in kinds)} |")
    rows.append("| --- |" + " --: |" * len(kinds))
    for section, c in rtl.items():
        rows.append(f"| {SECTIONS[section]} | {' | '.join(str(c[k]) for k in kinds)} |")
    whole = sum(rtl.values(), Counter())
    rows.append(f"| all | {' | '.join(str(whole[k]) for k in kinds)} |")
    rows += [
        "",
        "`ik_sincos` gives sine and cosine; `ik_norm`, `ik_lzc` and `ik_shift` choose and apply scales; the bits that",
        "wait, in `ik_delay` and `ik_ring` and before an operator's operands, balance the paths ([the",
        "schedule](figures.md) shows them; what two operators delay alike is counted twice, and is one line after",
        "synthesis). A test compares these counts, section by section, with the operations of",
        "`model/dataflow/paper.py`.",
        "",
        "The equations as printed, one by one:",
        "",
        "| equation | +, - | x | root | a/b, 1/b | x constant | sin, cos |",
        "| --- | --: | --: | --: | --: | --: | --: |",
        *(_row(k, total(PRINTED[k].values())) for k in PRINTED),
    ]
    return "\n".join(rows) + "\n"


def main() -> int:
    argparse.ArgumentParser(prog="python -m scripts.pages.opcounts", description=__doc__.splitlines()[0]).parse_args()
    try:
        rtl, dataflow = rtl_counts(), dataflow_counts()
    except FormatError as error:
        print(error, file=sys.stderr)
        return 1
    if wrong := differences(rtl, dataflow):
        print("\n".join(wrong), file=sys.stderr)
        return 1
    PAGE.write_text(page(rtl))
    print(f"wrote {PAGE.relative_to(ROOT)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
