# SPDX-License-Identifier: Apache-2.0
"""Write the generated Verilog headers: node formats and clocks, tables, the program of the fold datapath.

python -m scripts.generate.headers      writes the headers that are out of date
"""

import re
from collections.abc import Iterable, Sequence
from pathlib import Path

from model.dataflow import angles
from model.dataflow.datapaths import MODELS
from model.dataflow.fixed import SINCOS_GUARD, TABLE_BITS, atan_table, cordic_gain, nodes
from model.dataflow.fold import steps as timing
from model.dataflow.fold.program import PROGRAMS, SCHEDULES, WIDTH, codes, fields, program
from model.dataflow.fold.shown import Shown, shown
from model.dataflow.fold.steps import Operand, Pick, Selector
from model.dataflow.nodes import GUARD, INNER_FRAC, ROOT_FRACS, WIDTHS, Latency, Node, inner_frac
from model.dataflow.quadratic import INVERSE_ROOT, SINE, Form, Table, table_rows
from scripts.generate.render import update
from tb.sim.env import ROOT

NOTE = """// SPDX-License-Identifier: Apache-2.0
// Written by `python -m scripts.generate.headers` from {source}; do not edit.

{text}
"""


# -- formats and clocks of nodes -----------------------------------------------------------------------------------


def traced(datapath: str) -> dict[int, dict[str, Node]]:
    """Return the nodes of a dataflow at every width, with their formats and clocks."""
    return {w: nodes(datapath, w) for w in MODELS[datapath].widths}


def _start(operands: tuple[Node, ...], runs: dict[int, dict[str, Node]]) -> str:
    """Return the T_ of the last ready operand. Raises ValueError if it depends on the width."""
    times = {}
    for node in operands:
        if node.name:  # constants are always ready
            times.setdefault(tuple(run[node.name].time for run in runs.values()), f"T_{node.name.upper()}")
    last = tuple(max(column) for column in zip(*times, strict=True))
    if last not in times:
        raise ValueError(f"none of {sorted(times.values())} is the last at every width")
    return times[last]


def lean_formats() -> str:
    least, (short, long) = WIDTHS[0], ROOT_FRACS
    more = inner_frac(24) - 24
    return f"""\
// For the body of a module with parameter W: fraction bits of the inner words of ik_lean and ik_fold.

localparam integer WX = (W < {least}) ? {least} : W;  // the word length that formats follow
localparam integer FRAC = (WX < {short - more}) ? {short} : (WX < {INNER_FRAC - more}) ? WX + {more} : {INNER_FRAC};\
  // of an inner word
localparam integer ROOT_FRAC = (W < 19) ? {short} : ((FRAC < {long}) ? FRAC : {long});  // of a reciprocal root"""


def node_formats(datapath: str) -> str:
    """Return the text of ``ik_<datapath>_nodes.vh``."""
    runs = traced(datapath)
    nodes = runs[WIDTHS[-1]]
    used = {node.latency for node in nodes.values()}
    parameters = "parameter W" if datapath == "paper" else "parameters W and TILE"
    lines = [
        f"// For the body of a module with {parameters}. F_<NODE>: fraction bits of the node. T_<NODE>: the clock in",
        "// which it is valid, counted from the clock in which its target is at the datapath's input.",
        "// LAT_<OPERATION>: clocks of an operation.",
        "",
    ]
    if datapath == "paper":
        lines.append(f"localparam integer GUARD = {GUARD};  // more fraction bits of a product that waits for its sum")
    else:
        lines.append('`include "ik_lean_formats.vh"')
    for kind, (_, _, why) in Latency.TABLE.items():
        if kind in used:
            lines.append(f"localparam integer LAT_{kind.upper()} = {Latency.expression(kind)};  // {why}")
    section = None
    for node in nodes.values():
        if node.section != section:
            section = node.section
            lines += ["", f"// {MODELS[datapath].sections[section]}"]
        name = node.name.upper()
        waits_for = (*node.operands, node.after) if node.after else node.operands
        clocks = [f"LAT_{node.latency.upper()}"] if node.latency else []
        if any(o.time for o in waits_for):
            clocks.insert(0, _start(waits_for, runs))
        parts = [f"F_{name} = {node.format.frac_expr}"] if node.format.signed else []
        parts.append(f"T_{name} = {' + '.join(clocks) or '0'}")
        lines.append(f"localparam integer {', '.join(parts)};{_comment(node)}")
    outputs = _start(tuple(nodes[n] for n in (*MODELS[datapath].results, *MODELS[datapath].flags)), runs)
    return "\n".join([*lines, "", "// All results leave together.", f"localparam integer T_OUT = {outputs};"])


def _comment(node: Node) -> str:
    return f"  // {node.equation}" if node.equation else ""


def latencies() -> str:
    """Return the text of ``ik_latency.vh``."""
    cases = [
        f"      {key + width}: datapath_latency = {max(node.time for node in found.values())};"
        for name, key in {"lean": 100, "paper": 0, "lean16": 1100}.items()
        for width, found in traced(name).items()
    ]
    return f"""\
// For the body of ik_axis: clocks of a datapath, T_OUT of its own header. lean: 1 for the lean one, 0 for the paper's,
// which ignores the tile.

function integer datapath_latency(input integer lean, input integer w, input integer tile);
  begin
    case (100 * lean + w + ((lean == 1 && tile < 18) ? 1000 : 0))
{chr(10).join(cases)}
      default: datapath_latency = 0;
    endcase
  end
endfunction"""


# -- tables --------------------------------------------------------------------------------------------------------


def sincos_table() -> str:
    entries = "\n".join(f"      {i:2d}: atan_turn = {TABLE_BITS}'d{a};" for i, a in enumerate(atan_table()))
    return f"""// For the body of ik_sincos: atan(2^-i)/pi and the CORDIC's gain as fractions with TABLE_BITS bits.

localparam integer TABLE_BITS = {TABLE_BITS};
localparam integer SINCOS_GUARD = {SINCOS_GUARD};
localparam [{TABLE_BITS - 1}:0] GAIN = {TABLE_BITS}'d{cordic_gain()};

function [{TABLE_BITS - 1}:0] atan_turn(input integer k);
  begin
    case (k)
{entries}
      default: atan_turn = {TABLE_BITS}'d0;
    endcase
  end
endfunction"""


def vector_table() -> str:
    return f"""\
// For the body of a module with parameter W: iterations in which X changes, and all; bits of X, Y and the angle;
// the angle of iteration k, one turn = 2^ZW, of those after HEAD half the one before.

/* verilator lint_off UNUSEDPARAM */  // the gain
/* verilator lint_off UNUSEDSIGNAL */  // bits of a turn above 1/4
`include "ik_sincos_table.vh"

localparam integer HEAD = (W + 1) / 2 - 1;
localparam integer LAST = (HEAD + 16 < W + 1) ? HEAD + 16 : W + 1;
localparam integer XW = W + {angles.GUARD};
localparam integer YW = W + {angles.GUARD + 2};
localparam integer ZW = W + {angles.ANGLE};

function [ZW-1:0] turn(input integer k);
  reg [TABLE_BITS-1:0] rounded;
  begin
    rounded = (atan_turn(k < HEAD ? k : HEAD) + ({TABLE_BITS}'d1 << (TABLE_BITS - ZW))) >> (TABLE_BITS - ZW + 1);
    turn = rounded[ZW-1:0] >> (k < HEAD ? 0 : k - HEAD);
  end
endfunction
/* verilator lint_on UNUSEDSIGNAL */
/* verilator lint_on UNUSEDPARAM */"""


def _choose(numbers: dict[str, dict[str, int]]) -> str:
    """Return parameters whose values depend on conditions. numbers: condition in lower case -> values; the last one
    holds otherwise."""
    *conditions, otherwise = numbers
    return "\n".join(
        f"localparam integer {key} = "
        + "".join(f"{name.upper()} ? {numbers[name][key]} : " for name in conditions)
        + f"{value};"
        for key, value in numbers[otherwise].items()
    )


def _rom(last: str, tables: dict[str, Iterable[str]]) -> str:
    """Return a memory of rows 0 to ``last``. tables: condition, as in ``_choose`` -> assigned values."""
    *conditions, _ = tables
    lines = ['(* rom_style = "block", ram_style = "block" *)', f"reg [ROW_BITS-1:0] rom[0:{last}];", "generate"]
    before = "  "
    for name, rows in tables.items():
        condition = f"if ({name.upper()}) " if name in conditions else ""
        lines += [f"{before}{condition}begin : g_{name}_table", "    initial begin"]
        lines += [*(f"      rom[{n}] = {row};" for n, row in enumerate(rows)), "    end"]
        before = "  end else "
    return "\n".join([*lines, "  end", "endgenerate"])


def _row(words: Iterable[int], bits: Sequence[int], add: str) -> str:
    """Join the words of a row, each cut to its bits."""
    row = 0
    for word, size in zip(words, bits, strict=True):
        row = row << size | word % (1 << size)
    return f"{sum(bits)}'h{row:0{-(-sum(bits) // 4)}x} + {add}"


def _drop(form: Form) -> int:
    return form.slope_frac - form.slope_low + form.u_frac - form.u_low - form.sum_frac


def quadratic_table(name: str, table: Table, rounding: str, *more: str) -> str:
    """Return the table of a module around ``ik_quadratic``.

    rounding: the constant added to c0. more: further parameters of the module.
    """
    forms = {"small": table.small, "long": table.long, "short": table.short}
    roms = {size: [_row(row, of.c_bits, "ADD") for row in table_rows(table, of)] for size, of in forms.items()}
    return f"""\
// For the body of {name}: the parameters of ik_quadratic (model/dataflow/quadratic.py, Form) and {{c0, c1, c2}} of each
// segment. c0 includes the rounding constant, except for the bits below its last place, LOWEST.

localparam [0:0] SMALL = TILE < 18;
localparam [0:0] LONG = F > {table.short_frac};
{_choose({size: _parameters(form, *more) for size, form in forms.items()})}
localparam integer ROW_BITS = C0_BITS + C1_BITS + C2_BITS;
localparam integer SPARE = SUM_FRAC - C0_FRAC;
localparam integer ROUNDING = {rounding};
localparam [SPARE-1:0] LOWEST = ROUNDING[SPARE-1:0];
localparam [ROW_BITS-1:0] ADD = {{{{(ROW_BITS - 32) {{1'b0}}}}, ROUNDING}} >> SPARE << (C1_BITS + C2_BITS);

{_rom("ROWS-1", roms)}"""


def _parameters(form: Form, *more: str) -> dict[str, int]:
    """Return the parameters of a form for ``ik_quadratic`` and the module around it."""
    c2 = len(form.c_frac) > 2
    return {
        "ROWS": form.rows,
        "INDEX_BITS": form.index_bits,
        "U_FRAC": form.u_frac,
        "U_LOW": form.u_low,
        "C0_FRAC": form.c_frac[0],
        "C0_BITS": form.c_bits[0],
        "C1_BITS": form.c_bits[1],
        "C2_BITS": form.c_bits[2] if c2 else 0,
        "C1_UP": form.slope_frac - form.c_frac[1],
        "SLOPE_BITS": form.c_bits[1] + form.slope_frac - form.c_frac[1] + 1,
        "SLOPE_LOW": form.slope_low,
        "SUM_FRAC": form.sum_frac,
        "DROP": _drop(form),
        "BEND_DROP": form.c_frac[2] + form.u_frac - form.u_low - form.slope_frac if c2 else 0,
        **{name.upper(): getattr(form, name) for name in more},
    }


# -- fold datapath -------------------------------------------------------------------------------------------------

FOLD_FORMS = {size: (getattr(INVERSE_ROOT, size), getattr(SINE, size)) for size in ("small", "long")}
"""Forms (root, sine) of the fold datapath's table."""


def fold_codes(name: str) -> str:
    lines = [
        "// For the body of each module that reads a field of the step: codes of the fields. _BY_: selecting flags.",
        "",
        "/* verilator lint_off UNUSEDPARAM */  // each module uses some of them",
        f"localparam integer STEP_W = {sum(fields(name).values())};  // bits of a step",
    ]
    for field, values in codes(name).items():
        start, end = f"localparam [{fields(name)[field] - 1}:0] {field.upper()}_", f" = {fields(name)[field]}'d"
        lines += ["", *(f"{start}{_name(code)}{end}{n};" for n, code in enumerate(values))]
    return "\n".join([*lines, "", "/* verilator lint_on UNUSEDPARAM */"])


def _name(code: str | Selector) -> str:
    """Convert a code to part of an identifier."""
    return (code.code if isinstance(code, Selector) else code.replace("-", "minus_") or "none").upper()


def fold_fields(name: str) -> str:
    lines, at = [f"// For the body of ik_{name}: the fields of the step.", ""], 0
    for field, bits in fields(name).items():
        word, place = (f"[{bits - 1}:0] ", f"{at + bits - 1}:{at}") if bits > 1 else ("", f"{at}")
        lines.append(f"wire {word}f_{field} = step[{place}];")
        at += bits
    return "\n".join(lines)


NO_STEP = 255
"""Number of the step that does nothing, for reset."""


def fold_program(of: str) -> str:
    _, made = program(WIDTH, of)
    period, bits = made.period, sum(fields(of).values())
    notes: list[list[str]] = [[] for _ in range(period)]
    for name, clock in made.loads.items():
        notes[clock].append(f"{name} loaded")
    for placed in made.steps:
        step, at = placed.step, placed.at
        notes[at % period].append(f"{step.name}: {_operand(step.a)} * {_operand(step.b)}")
        if step.write:
            notes[(at + timing.WRITE) % period].append(f"-> {_operand(step.write.to)}")
        if step.norm:
            notes[(at + timing.NORM) % period].append(f"-> {step.norm.to}")
        if step.result:
            notes[(at + timing.WRITE) % period].append(f"-> {step.result}")
    for name, clock in made.shown.items():
        notes[clock % period].append(f"-> {name}")
    first, last = made.results
    laps, clock = {"HOLD": first - 1, "FIRST": first, "LAST": last}, (period - 1).bit_length()
    digits, later = -(-bits // 4), " and ".join(map(str, range(1, last // period + 1)))
    words = (f"{bits}'h{made.word(n):0{digits}x};  // {'; '.join(notes[n]) or '-'}" for n in range(period))
    lines = [
        f"// For the body of ik_{of}: the program. The lap, 0 a target's own, "
        f"{later} the next, in which the datapath may",
        "// stall before the target's first result (HOLD_LAP), writes it (FIRST_LAP) and writes the last (LAST_LAP).",
        "",
        f"localparam integer PERIOD = {period};  // clocks of a lap",
        f"localparam [{clock - 1}:0] END = {clock}'d{period - 1};  // the last of them",
        *(f"localparam integer {name}_LAP = {clock // period};" for name, clock in laps.items()),
        "",
        '(* rom_style = "block", ram_style = "block" *)',
        f"reg [STEP_W-1:0] rom[0:{'PERIOD-1' if of == 'fold' else NO_STEP}];",
        "initial begin",
        *(f"  rom[{n}] = {word}" for n, word in enumerate(words)),
        *[f"  rom[{NO_STEP}] = 0;"] * (of != "fold"),
        "end",
    ]
    return "\n".join(lines)


def _operand(of: Operand | None) -> str:
    if not isinstance(of, Pick):
        return of or "c2"
    return f"{of.pair}{'+1' * of.second}{f' ({of.flag})' * bool(of.flag)}"


def fold_formats() -> str:
    most = ROOT_FRACS[1]
    return f"""\
// For the body of a module with parameters W and TILE: fraction bits of the words and of a table row, widths of the
// words of a row and of its index, and the bits that a polynomial sum drops from the product of the high parts.

/* verilator lint_off UNUSEDPARAM */  // each module uses some of them
`include "ik_lean_formats.vh"
localparam integer SINE_FRAC = (FRAC < {most}) ? FRAC : {most};
localparam [0:0] SMALL = TILE < 18;
{_choose({size: _fold_parameters(*forms) for size, forms in FOLD_FORMS.items()})}
/* verilator lint_on UNUSEDPARAM */"""


def _fold_parameters(root: Form, sine: Form) -> dict[str, int]:
    """Return the parameters of two forms that share a table; the sine's c0 counts half, as its window is double."""
    frac = sine.c_frac[0] + 1
    assert root.c_frac[1:] == sine.c_frac[1:] and root.slope_frac == sine.slope_frac and root.c_frac[0] < frac
    return {
        "INDEX_BITS": root.index_bits,
        "C0_FRAC": frac,
        "C1_FRAC": root.c_frac[1],
        "C2_FRAC": root.c_frac[2],
        "SLOPE_FRAC": root.slope_frac,
        "C0_BITS": frac,
        "C1_BITS": root.c_bits[1],
        "C2_BITS": root.c_bits[2],
        "ROOT_DROP": _drop(root),
        "SINE_DROP": _drop(sine),
        "ROOT_SUM_FRAC": root.sum_frac,
        "SINE_SUM_FRAC": sine.sum_frac,
    }


def _fold_rows(root: Form, sine: Form) -> list[str]:
    frac = sine.c_frac[0] + 1
    bits = (frac, *root.c_bits[1:])
    roots = [_row((c0 << frac - root.c_frac[0], c1, c2), bits, "ROOT") for c0, c1, c2 in table_rows(INVERSE_ROOT, root)]
    return roots + [_row((c0, c1, 2 * c2), bits, "SINE") for c0, c1, c2 in table_rows(SINE, sine)]


def fold_table() -> str:
    return f"""\
// For the body of ik_fold_table: {{c0, c1, c2}} of ik_rsqrt_table.vh and ik_trig_table.vh, complete and
// equally aligned. c0 includes the rounding constant.

localparam integer ROW_BITS = C0_BITS + C1_BITS + C2_BITS;
localparam integer ROOT_ROUNDING = ((3 << (ROOT_SUM_FRAC - ROOT_FRAC - 3)) - 2) >> (ROOT_SUM_FRAC - C0_FRAC);
localparam integer SINE_ROUNDING = (1 << (SINE_SUM_FRAC - SINE_FRAC - 1)) >> (SINE_SUM_FRAC + 1 - C0_FRAC);
localparam [ROW_BITS-1:0] ROOT = {{{{(ROW_BITS - 32) {{1'b0}}}}, ROOT_ROUNDING}} << (C1_BITS + C2_BITS);
localparam [ROW_BITS-1:0] SINE = {{{{(ROW_BITS - 32) {{1'b0}}}}, SINE_ROUNDING}} << (C1_BITS + C2_BITS);

{_rom("(2<<INDEX_BITS)-1", {size: _fold_rows(*forms) for size, forms in FOLD_FORMS.items()})}"""


def fold_nodes(name: str) -> str:
    lowering, made = program(WIDTH, name)
    blocks: dict[str, list[Shown]] = {}
    for of in shown(lowering, made).values():
        blocks.setdefault(of.node.instance, []).append(of)
    bits = (made.period - 1).bit_length()
    lines = [f"// For the body of ik_{name}: every node of the dataflow, in an unread register, for the testbench.", ""]
    for block, found in blocks.items():
        pad = "    " if block else ""
        lines += ["generate", f"  if (1) begin : {block}"] if block else []
        lines += [f"{pad}reg {'signed ' * of.node.format.signed}{_range(of.node)}{of.node.name};" for of in found]
        lines += [f"{pad}always @(posedge clk)", f"{pad}  if (go) begin"]
        for of in found:
            when = " || ".join(f"clock == {bits}'d{clock % made.period}" for clock in of.clocks)
            when = f"({when}) && {of.when}" if of.when else when
            lines.append(f"{pad}    if ({when}) {of.node.name} <= {of.text};{_comment(of.node)}")
        lines += [f"{pad}  end", *(["  end", "endgenerate"] if block else []), ""]
    return "\n".join(lines).rstrip()


def _range(node: Node) -> str:
    """Return the Verilog range of a node's word; empty for a bit."""
    name, sign, number = re.fullmatch(r"(.*?)(?: ([+-]) (\d+))?", node.format.frac_expr).groups()
    more = int(f"{sign or '+'}{number or 0}") + node.format.width - node.format.frac - 1
    if name == "0":
        return f"[{more}:0] " if more else ""
    return f"[{name}{f' {more:+d}'.replace('+', '+ ').replace('-', '- ') if more else ''}:0] "


def texts() -> dict[Path, str]:
    """Return file -> its text."""
    folder, model = ROOT / "rtl" / "include", "model/dataflow"
    rounding = "(3 << (SUM_FRAC - F - 3)) - (TILES + 1) / 2"
    found = {
        "paper_nodes": (node_formats("paper"), f"{model}/paper.py"),
        "lean_nodes": (node_formats("lean"), f"{model}/lean.py"),
        "arm_nodes": (node_formats("arm"), f"{model}/arm.py and {model}/lean.py"),
        "lean_formats": (lean_formats(), f"{model}/nodes.py"),
        "latency": (latencies(), f"{model}/paper.py and {model}/lean.py"),
        "sincos_table": (sincos_table(), f"{model}/fixed.py"),
        "rsqrt_table": (
            quadratic_table("ik_rsqrt", INVERSE_ROOT, rounding, "tiles", "clocks"),
            f"{model}/quadratic.py",
        ),
        "trig_table": (quadratic_table("ik_trig", SINE, "1 << (SUM_FRAC - F - 1)", "clocks"), f"{model}/quadratic.py"),
        "vector_table": (vector_table(), f"{model}/angles.py"),
        "fold_formats": (fold_formats(), f"{model}/nodes.py"),
        "fold_table": (fold_table(), f"{model}/quadratic.py"),
    }
    for name in PROGRAMS:
        schedule, flow = SCHEDULES[name].name, "arm" if name == "fold_arm" else "lean"
        found |= {
            f"{name}_codes": (fold_codes(name), f"{model}/fold/program.py"),
            f"{name}_fields": (fold_fields(name), f"{model}/fold/program.py"),
            f"{name}_nodes": (fold_nodes(name), f"{model}/fold/shown.py"),
            f"{name}_program": (fold_program(name), f"{model}/fold/{schedule} and {model}/{flow}.py"),
        }
    return {folder / f"ik_{name}.vh": NOTE.format(source=source, text=text) for name, (text, source) in found.items()}


if __name__ == "__main__":
    update(texts())
