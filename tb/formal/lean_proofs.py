# SPDX-License-Identifier: Apache-2.0
"""The parts of :mod:`tb.formal.arithmetic` about the lean datapath's ranges, at every width, and their seeded bugs."""

from __future__ import annotations

from collections.abc import Iterator
from types import ModuleType

from model.dataflow import lean
from model.dataflow.nodes import WIDTHS
from tb.formal.arithmetic import Part, Question
from tb.formal.lean_rounded import Rounded
from tb.formal.lean_rules import GEOMETRY, Rules
from tb.formal.range_bugs import FULL
from tb.sim.env import ROOT
from tb.sim.seeded_bugs import Bug

LEAN = "model/dataflow/lean.py"


def seeded(bug: Bug) -> ModuleType:
    """The dataflow with a bug in it, without a file."""
    module = ModuleType(lean.__name__)
    module.__package__ = lean.__package__
    exec(compile(bug.seeded((ROOT / bug.file).read_text()), bug.what, "exec"), module.__dict__)
    return module


def rules(widths=WIDTHS, dataflow=lean) -> Iterator[Question]:
    """Geometry, and every range in exact arithmetic; a question that is the same at several widths once."""
    known: set[str] = set()
    for width in sorted(widths, reverse=True):
        asked = Rules(width, dataflow)
        if circle := asked.circle():
            raise RuntimeError(f"claims rest on each other: {circle}")
        for name in asked.names():
            text = asked.question(name)
            if text in known:
                continue
            known.add(text)
            says = GEOMETRY[name][0] if name in asked.lemmas else asked.exact.nodes[name].facts.within.why
            rests = ", ".join(asked.uses(name))
            label = name if width == FULL else f"{name}, W={width}"
            yield Question(label, says, rests, lambda r=asked, n=name: r.ask(n), lambda r=asked, n=name: r.meet(n))


def errors(widths=WIDTHS, dataflow=lean) -> Iterator[Question]:
    """The error of every word."""
    known: set[str] = set()
    for width in sorted(widths, reverse=True):
        asked = Rounded(width, dataflow)
        for name in asked.names():
            text = asked.question(name)
            if text in known:
                continue
            known.add(text)
            node = asked.exact.ranges[name]
            says = f"within {node.value.error / node.format.ulp:.6g} places of its exact value"
            label = name if width == FULL else f"{name}, W={width}"
            yield Question(label, says, "", lambda r=asked, n=name: r.ask(n), lambda r=asked, n=name: r.meet(n))


RULE_BUGS = (
    Bug("coordinate shifted a place further", LEAN, "unit = Shift(-2, 1,", "unit = Shift(-1, 1,", "direction"),
    Bug("both parts of a half angle for one sign", LEAN, "HalfPart(lambda c: c < 0)",
        "HalfPart(lambda c: c >= 0)", "tilt"),
    Bug("K of the difference alone", LEAN, '"sum_dif", (d_sum, d_dif)', '"sum_dif", (d_dif, d_dif)', "K^2 + A B"),
    Bug("B of the sum", LEAN, '"b_near", ("s", "d_dif_sq")', '"b_near", ("s", "d_sum_sq")', "A + B"),
    Bug("shift to the arms' unit two places short", LEAN,
        "Count((1, -1, -1), 2 + f.odd)", "Count((1, -1, -1), f.odd)", "n_far"),
    Bug("shift to the law's unit without the elbow's second arm", LEAN,
        "Count((1, 1, -2, -1), 2 + f.odd)", "Count((1, 1, -1, -1), 2 + f.odd)", "n_ab in lengths"),
    Bug("a pair of parts is below 5/4", LEAN, "PAIR = Within(-1.5, 1.5,", "PAIR = Within(-1.25, 1.25,", "wi_0"),
    Bug("K below 3/2 in its unit", LEAN, "K_UNIT = Within(-2.0, 2.0,", "K_UNIT = Within(-1.5, 1.5,", "k_scaled"),
    Bug("less than 2 in the law's unit", LEAN, "LAW_UNIT = Within(0.0, 2.0,", "LAW_UNIT = Within(0.0, 1.99,",
        "inv_law_ab_raw"),
    Bug("less than 2 in the arms' unit", LEAN, "ARMS_UNIT = Within(0.0, 2.0,", "ARMS_UNIT = Within(0.0, 1.5,",
        "inv_12_far_raw"),
    Bug("azimuth and swivel added in the cosine", LEAN,
        '"c_plus", ("cc", "ss"), f.inner, "mux", minus, minus', '"c_plus", ("cc", "ss"), f.inner, "mux", plus, plus',
        "az + phi"),
    Bug("turned the other way", LEAN, "PartSum(-1)), (53", "PartSum(1)), (53", "swap"),
    Bug("a root of twice its argument", LEAN, '"root_rho", n["inv_rho"], n["m_rho"], f.inner, scale=1',
        '"root_rho", n["inv_rho"], n["m_rho"], f.inner, scale=2', "root of m_rho"),
)  # fmt: skip

ERROR_BUGS = (
    Bug("an error raised by less than its shift", LEAN,
        "grows=Growth((8.0, 0.0))", "grows=Growth((4.0, 0.0))", "inv_12_far_raw"),
    Bug("the same in the law's unit", LEAN,
        "within=LAW_UNIT, grows=Growth((4.0, 0.0))", "within=LAW_UNIT, grows=Growth((2.0, 0.0))", "inv_law_ab_raw"),
    Bug("a sum's errors not added", LEAN,
        'f"{both}_0", parts, f.inner, "mux", plus, plus, within=PAIR, grows=SUM',
        'f"{both}_0", parts, f.inner, "mux", plus, plus, within=PAIR', "wi_0"),
    Bug("a mantissa's error that does not grow", LEAN,
        'Within(0.25, 1.0, "mantissa"), grows=Growth((4.0, 0.0))', 'Within(0.25, 1.0, "mantissa")', "m_q"),
)  # fmt: skip

RULES_ABOUT = """\
What `model/dataflow/lean.py` says of a node's exact value, with a sentence why, is asked of z3 over the reals (nlsat),
at every width from 16 to 32. The equations are those of the dataflow, run on formulas (`tb/formal/lean_exact.py`): a
count e is the number 2^e, a shift a product. A decision is taken on a rounded word, so it is free where it is not of
exact words: the ranges hold whichever way it goes. Clamped targets are left out. `=node`: what a node is; `node`: its
range; `#node`: an exact word is of whole places; other names are lemmas of the same table.

A count above -1 is 0 or more: it is an integer. `e_far of d1` is the other place where integers count: an arm that is
folded exactly (B = 0) has a root_ab of 0, and one whose lengths differ by a single place reaches 2 in the law's unit.
`m_q` is decided by a word, and is with the errors."""

ERRORS_ABOUT = """\
How far a word can be from its exact value, as `model/bounds/lean_ranges.py` counts it: from its operands' words, each
within its own error of a value in its range, by what the operation makes of words and by what rounding adds. A word is
then in its exact range and that error, which is the range of [the other page](ranges_proofs.md). Of roots and sines of
exact words the error is their own, proved in `model/dataflow/cores.py` and `trig.py`."""

RULES = Part(
    "rules", "Ranges of the lean datapath in exact arithmetic", RULES_ABOUT,
    rules, lambda bug: rules((FULL,), seeded(bug)), RULE_BUGS,
)  # fmt: skip
ERRORS = Part(
    "errors", "Errors of the lean datapath's words", ERRORS_ABOUT,
    errors, lambda bug: errors((FULL,), seeded(bug)), ERROR_BUGS,
)  # fmt: skip
