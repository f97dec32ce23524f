# SPDX-License-Identifier: Apache-2.0
"""Headers of the fold datapath: program, codes and bit positions of a step's fields, table, nodes."""

from __future__ import annotations

import re
from collections.abc import Iterator

from model.dataflow import cores, trig
from model.dataflow.fold import steps as timing
from model.dataflow.fold.program import CODES, FIELDS, WIDTH, program
from model.dataflow.fold.shown import Shown, shown
from model.dataflow.fold.steps import Operand, Pick, Selector
from model.dataflow.nodes import ROOT_FRACS, Node
from model.dataflow.quadratic import Form

STEP_BITS = sum(FIELDS.values())


def _name(code: str | Selector) -> str:
    """Convert a code to part of an identifier."""
    return (code.code if isinstance(code, Selector) else code.replace("-", "minus_") or "none").upper()


def codes() -> str:
    """Return ``ik_fold_codes.vh``."""
    lines = [
        "// For the body of every module that a field of the step goes to: the codes. _BY_: flags that choose.",
        "",
        "/* verilator lint_off UNUSEDPARAM */  // a module uses those of its own",
        f"localparam integer STEP_W = {STEP_BITS};  // bits of a step",
    ]
    for name, values in CODES.items():
        start, end = f"localparam [{FIELDS[name] - 1}:0] {name.upper()}_", f" = {FIELDS[name]}'d"
        lines += ["", *(f"{start}{_name(code)}{end}{n};" for n, code in enumerate(values))]
    return "\n".join([*lines, "", "/* verilator lint_on UNUSEDPARAM */"])


def fields() -> str:
    """Return ``ik_fold_fields.vh``."""
    lines, at = ["// For the body of ik_fold: the fields of the step.", ""], 0
    for name, bits in FIELDS.items():
        where = f"{at + bits - 1}:{at}" if bits > 1 else f"{at}"
        lines.append(f"wire {f'[{bits - 1}:0] ' if bits > 1 else ''}f_{name} = step[{where}];")
        at += bits
    return "\n".join(lines)


def _operand(of: Operand | None) -> str:
    if not isinstance(of, Pick):
        return of or "c2"
    return f"{of.pair}{'+1' * of.second}{f' ({of.flag})' * bool(of.flag)}"


def steps() -> str:
    """Return ``ik_fold_program.vh``."""
    _, made = program(WIDTH)
    period = made.period
    says: list[list[str]] = [[] for _ in range(period)]
    for name, clock in made.loads.items():
        says[clock].append(f"{name} loaded")
    for placed in made.steps:
        step = placed.step
        says[placed.at % period].append(f"{step.name}: {_operand(step.a)} * {_operand(step.b)}")
        if step.write:
            says[(placed.at + timing.WRITE) % period].append(f"-> {_operand(step.write.to)}")
        if step.norm:
            says[(placed.at + timing.NORM) % period].append(f"-> {step.norm.to}")
        if step.result:
            says[(placed.at + timing.WRITE) % period].append(f"-> {step.result}")
    results = [placed.at + timing.WRITE for placed in made.steps if placed.step.result]
    laps = {"HOLD": min(results) - 1, "FIRST": min(results), "LAST": max(results)}
    digits = -(-STEP_BITS // 4)
    return "\n".join(
        [
            "// For the body of ik_fold: the program. HOLD_, FIRST_ and LAST_LAP: the lap of a target, "
            "its own or the next",
            "// where the machine may wait before the first result, gives it, and gives the last.",
            "",
            f"localparam integer PERIOD = {period};  // clocks of a lap",
            f"localparam [6:0] END = 7'd{period - 1};  // the last of them",
            *(f"localparam integer {name}_LAP = {clock // period};" for name, clock in laps.items()),
            "",
            '(* rom_style = "block", ram_style = "block" *)',
            "reg [STEP_W-1:0] rom[0:PERIOD-1];",
            "initial begin",
            *(
                f"  rom[{n}] = {STEP_BITS}'h{made.word(n):0{digits}x};  // {'; '.join(says[n]) or '-'}"
                for n in range(period)
            ),
            "end",
        ]
    )


def formats() -> str:
    """Return ``ik_fold_formats.vh``."""
    numbers = [_numbers(*forms) for forms in FORMS]
    values = [f"localparam integer {k} = SMALL ? {numbers[1][k]} : {numbers[0][k]};" for k in numbers[0]]
    return f"""\
// For the body of a module with parameters W and TILE: fraction bits of words and of a table's row, the bits of its
// words and of its number, and what the sum of a polynomial leaves of the product of the
// high parts.

/* verilator lint_off UNUSEDPARAM */  // a module uses those of its own
`include "ik_lean_formats.vh"
localparam integer SINE_FRAC = (FRAC < {ROOT_FRACS[1]}) ? FRAC : {ROOT_FRACS[1]};
localparam [0:0] SMALL = TILE < 18;
{chr(10).join(values)}
/* verilator lint_on UNUSEDPARAM */"""


FORMS = (cores.LONG, trig.LONG), (cores.SMALL, trig.SMALL)
"""Forms (root, sine): for 18-bit tiles, for smaller tiles."""


def _numbers(root: Form, sine: Form) -> dict[str, int]:
    """Return the parameters of two forms that share a table; the sine's c0 counts half, as its window is double."""
    frac = sine.c_frac[0] + 1
    assert root.c_frac[1:] == sine.c_frac[1:] and root.slope_frac == sine.slope_frac and root.c_frac[0] < frac
    drop = {
        name: form.slope_frac - form.slope_low + form.u_frac - form.u_low - form.sum_frac
        for name, form in (("ROOT", root), ("SINE", sine))
    }
    return {
        "INDEX_BITS": root.index_bits,
        "C0_FRAC": frac,
        "C1_FRAC": root.c_frac[1],
        "C2_FRAC": root.c_frac[2],
        "SLOPE_FRAC": root.slope_frac,
        "C0_BITS": frac,
        "C1_BITS": root.c_bits[1],
        "C2_BITS": root.c_bits[2],
        "ROOT_DROP": drop["ROOT"],
        "SINE_DROP": drop["SINE"],
        "ROOT_SUM_FRAC": root.sum_frac,
        "SINE_SUM_FRAC": sine.sum_frac,
    }


def _rows(root: Form, sine: Form) -> Iterator[str]:
    of = _numbers(root, sine)
    up = of["C0_FRAC"] - root.c_frac[0]
    rows = [(c0 << up, c1, c2, "ROOT") for c0, c1, c2 in cores.rsqrt_rows(root)]
    rows += [(c0, c1, 2 * c2, "SINE") for c0, c1, c2 in trig.sine_rows(sine)]
    bits = [of[f"C{n}_BITS"] for n in range(3)]
    for n, (*words, add) in enumerate(rows):
        row = 0
        for word, size in zip(words, bits, strict=True):
            assert not word >> size
            row = row << size | word
        yield f"      rom[{n}] = {sum(bits)}'h{row:0{-(-sum(bits) // 4)}x} + {add};"


def table() -> str:
    """Return ``ik_fold_table.vh``."""
    long, small = (_rows(*forms) for forms in FORMS)
    return "\n".join(
        [
            "// For the body of ik_fold_table: {c0, c1, c2} of ik_rsqrt_table.vh and ik_trig_table.vh, "
            "whole and aligned",
            "// alike, c0 with what rounds the result.",
            "",
            "localparam integer ROW_BITS = C0_BITS + C1_BITS + C2_BITS;",
            "localparam integer ROOT_ROUNDING = ((3 << (ROOT_SUM_FRAC - ROOT_FRAC - 3)) - 2) >> "
            "(ROOT_SUM_FRAC - C0_FRAC);",
            "localparam integer SINE_ROUNDING = (1 << (SINE_SUM_FRAC - SINE_FRAC - 1)) >> "
            "(SINE_SUM_FRAC + 1 - C0_FRAC);",
            "localparam [ROW_BITS-1:0] ROOT = {{(ROW_BITS - 32) {1'b0}}, ROOT_ROUNDING} << (C1_BITS + C2_BITS);",
            "localparam [ROW_BITS-1:0] SINE = {{(ROW_BITS - 32) {1'b0}}, SINE_ROUNDING} << (C1_BITS + C2_BITS);",
            "",
            '(* rom_style = "block", ram_style = "block" *)',
            "reg [ROW_BITS-1:0] rom[0:(2<<INDEX_BITS)-1];",
            "generate",
            "  if (SMALL) begin : g_small_table",
            "    initial begin",
            *small,
            "    end",
            "  end else begin : g_long_table",
            "    initial begin",
            *long,
            "    end",
            "  end",
            "endgenerate",
        ]
    )


def _range(node: Node) -> str:
    """Return the Verilog range of a node's word; empty for a bit."""
    name, sign, number = re.fullmatch(r"(.*?)(?: ([+-]) (\d+))?", node.format.frac_expr).groups()
    more = int(f"{sign or '+'}{number or 0}") + node.format.width - node.format.frac - 1
    if name == "0":
        return f"[{more}:0] " if more else ""
    return f"[{name}{f' {more:+d}'.replace('+', '+ ').replace('-', '- ') if more else ''}:0] "


def nodes() -> str:
    """Return ``ik_fold_nodes.vh``."""
    lowering, made = program(WIDTH)
    blocks: dict[str, list[Shown]] = {}
    for of in shown(lowering, made).values():
        blocks.setdefault(of.node.instance, []).append(of)
    lines = ["// For the body of ik_fold: every node of the dataflow, in a register that nothing reads.", ""]
    for block, found in blocks.items():
        pad = "    " if block else ""
        lines += ["generate", f"  if (1) begin : {block}"] if block else []
        lines += [f"{pad}reg {'signed ' * of.node.format.signed}{_range(of.node)}{of.node.name};" for of in found]
        lines += [f"{pad}always @(posedge clk)", f"{pad}  if (go) begin"]
        for of in found:
            when = " || ".join(f"clock == 7'd{clock % made.period}" for clock in of.clocks)
            when = f"({when}) && {of.when}" if of.when else when
            comment = f"  // {of.node.equation}" if of.node.equation else ""
            lines.append(f"{pad}    if ({when}) {of.node.name} <= {of.text};{comment}")
        lines += [f"{pad}  end", *(["  end", "endgenerate"] if block else []), ""]
    return "\n".join(lines).rstrip()


HEADERS = {
    "codes": (codes, "model/dataflow/fold/program.py"),
    "fields": (fields, "model/dataflow/fold/program.py"),
    "formats": (formats, "model/dataflow/nodes.py"),
    "nodes": (nodes, "model/dataflow/fold/shown.py"),
    "program": (steps, "model/dataflow/fold/schedule.json and model/dataflow/lean.py"),
    "table": (table, "model/dataflow/cores.py and model/dataflow/trig.py"),
}
"""Header name -> function that returns its text, and the source it is generated from."""
