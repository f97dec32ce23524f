# SPDX-License-Identifier: Apache-2.0
"""Write the generated Verilog headers: node formats and clocks, tables, the program of the fold datapath.

python -m scripts.generate.headers      writes the headers that are out of date
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np

from model.dataflow import cores as lean_cores
from model.dataflow import trig as lean_trig
from model.dataflow.datapaths import CONFIGURATIONS, DATAPATHS
from model.dataflow.fixed import SINCOS_GUARD, TABLE_BITS, Bits, atan_table, cordic_gain, run
from model.dataflow.nodes import GUARD, INNER_FRAC, ROOT_FRACS, WIDTHS, Latency, Node
from model.dataflow.quadratic import Form
from model.io.words import RESULT_FIELDS
from scripts.generate import fold_headers
from tb.sim.env import ROOT

NOTE = """// SPDX-License-Identifier: Apache-2.0
// Written by `python -m scripts.generate.headers` from {source}; do not edit.
"""


def traced(datapath: str) -> dict[int, Bits]:
    """Run a dataflow at every width on one target; formats and clocks do not depend on the target."""
    one = {w: 1 << (w - 3) for w in CONFIGURATIONS[datapath].widths}
    return {w: run(np.array([[d, 0, 0, 0, d, d]]), w, datapath).bits for w, d in one.items()}


def _start(operands: tuple[Node, ...], runs: dict[int, Bits]) -> str:
    """Return the T_ of the last ready operand, or the maximum of two if it depends on the width."""
    times = {}
    for node in operands:
        if node.name:  # constants are always ready
            times.setdefault(tuple(run.nodes[node.name].time for run in runs.values()), f"T_{node.name.upper()}")
    last = tuple(max(column) for column in zip(*times, strict=True))
    if last in times:
        return times[last]
    for (a, first), (b, second) in itertools.combinations(times.items(), 2):
        if tuple(map(max, a, b)) == last:
            return f"({first} > {second} ? {first} : {second})"
    raise ValueError(f"no two of {sorted(times.values())} are the last at every width")


def nodes_header(datapath: str) -> str:
    """Return the text of ``ik_<datapath>_nodes.vh``."""
    runs = traced(datapath)
    nodes = runs[WIDTHS[-1]].nodes
    used = {node.latency for node in nodes.values()}
    lines = [
        NOTE.format(source="model/dataflow/paper.py" if datapath == "paper" else f"model/dataflow/{datapath}.py"),
        "// For the body of a module with parameter W. F_<NODE>: fraction bits of the node. T_<NODE>: the clock in",
        "// which it is valid, counted from the clock in which its target is at the datapath's input.",
        "// LAT_<OPERATION>: clocks of an operation.",
        "",
    ]
    if datapath == "paper":
        lines.append(f"localparam integer GUARD = {GUARD};  // more fraction bits of a product that waits for its sum")
    else:
        lines[1] = lines[1].replace("parameter W.", "parameters W and TILE.")
        lines.append('`include "ik_lean_formats.vh"')
    for kind, (_, _, why) in Latency.TABLE.items():
        if kind in used:
            lines.append(f"localparam integer LAT_{kind.upper()} = {Latency.expression(kind)};  // {why}")
    section = None
    for node in nodes.values():
        if node.section != section:
            section = node.section
            lines += ["", f"// {DATAPATHS[datapath].sections[section]}"]
        name = node.name.upper()
        waits_for = (*node.operands, node.after) if node.after else node.operands
        clocks = [f"LAT_{node.latency.upper()}"] if node.latency else []
        if node.operands and any(o.time for o in node.operands):
            clocks.insert(0, _start(waits_for, runs))
        parts = [f"T_{name} = {' + '.join(clocks) or '0'}"]
        if node.format.signed:
            parts.insert(0, f"F_{name} = {node.format.frac_expr}")
        comment = f"  // {node.equation}" if node.equation else ""
        lines.append(f"localparam integer {', '.join(parts)};{comment}")
    outputs = _start(tuple(nodes[n] for n in RESULT_FIELDS), runs)
    lines += ["", "// All results leave together.", f"localparam integer T_OUT = {outputs};", ""]
    return "\n".join(lines)


def formats_header() -> str:
    """Return ``rtl/include/ik_lean_formats.vh``."""
    least, most = WIDTHS[0], INNER_FRAC
    short, long = ROOT_FRACS
    return f"""{NOTE.format(source="model/dataflow/nodes.py")}
// For the body of a module with parameter W: fraction bits of the inner words of ik_lean and ik_fold.

localparam integer WX = (W < {least}) ? {least} : W;  // the word length that formats follow
localparam integer FRAC = (WX < {short - 5}) ? {short} : (WX < {most - 5}) ? WX + 5 : {most};  // of an inner word
localparam integer ROOT_FRAC = (W < 19) ? {short} : ((FRAC < {long}) ? FRAC : {long});  // of a reciprocal root
"""


def latency_header() -> str:
    """Return ``rtl/include/ik_latency.vh``."""
    cases = []
    for name, key in {"lean": 100, "paper": 0, "lean16": 1100}.items():
        for width, bits in traced(name).items():
            clocks = max(node.time for node in bits.nodes.values())
            cases.append(f"      {key + width}: datapath_latency = {clocks};")
    return f"""{NOTE.format(source="model/dataflow/paper.py and model/dataflow/lean.py")}
// For the body of ik_axis: clocks of a datapath, T_OUT of its own header. lean: 1 for the lean one, 0 for the paper's,
// which ignores the tile.

function integer datapath_latency(input integer lean, input integer w, input integer tile);
  begin
    case (100 * lean + w + ((lean == 1 && tile < 18) ? 1000 : 0))
{chr(10).join(cases)}
      default: datapath_latency = 0;
    endcase
  end
endfunction
"""


def sincos_header() -> str:
    """Return ``rtl/include/ik_sincos_table.vh``."""
    entries = "\n".join(f"      {i:2d}: atan_turn = {TABLE_BITS}'d{a};" for i, a in enumerate(atan_table()))
    return f"""{NOTE.format(source="model/dataflow/fixed.py")}
// For the body of ik_sincos: atan(2^-i)/pi and the CORDIC's gain as fractions with TABLE_BITS bits.

localparam integer TABLE_BITS = {TABLE_BITS};
localparam integer SINCOS_GUARD = {SINCOS_GUARD};
localparam [{TABLE_BITS - 1}:0] GAIN = {TABLE_BITS}'d{cordic_gain()};

function [{TABLE_BITS - 1}:0] atan_turn(input integer i);
  begin
    case (i)
{entries}
      default: atan_turn = {TABLE_BITS}'d0;
    endcase
  end
endfunction
"""


def table_header(
    module: str,
    source: str,
    most: int,
    forms: Sequence[Form],
    tables: Sequence[Sequence[tuple]],
    rounding: str,
    besides: Sequence[str],
) -> str:
    """Return the table header of a module around ``ik_quadratic``. The first form and table serve results of up to
    ``most`` fraction bits F, the second longer results, the third tiles below 18 bits. ``rounding`` is added to c0;
    ``besides`` names further parameters of the module."""
    numbers = [numbers_of(form, besides) for form in forms]
    values = "\n".join(
        f"localparam integer {k} = SMALL ? {numbers[2][k]} : LONG ? {numbers[1][k]} : {numbers[0][k]};"
        for k in numbers[0]
    )
    short, long, small = (rom(form, table) for form, table in zip(forms, tables, strict=True))
    return f"""{NOTE.format(source=source)}
// For the body of {module}: the words of ik_quadratic (model/dataflow/quadratic.py, Form), and {{c0, c1, c2}} of each
// segment, c0 with what rounds the result. What its words have no places for, LOWEST, stands below them.

localparam [0:0] SMALL = TILE < 18;
localparam [0:0] LONG = F > {most};
{values}
localparam integer ROW_BITS = C0_BITS + C1_BITS + C2_BITS;
localparam integer SPARE = SUM_FRAC - C0_FRAC;
localparam integer ROUNDING = {rounding};
localparam [SPARE-1:0] LOWEST = ROUNDING[SPARE-1:0];
localparam [ROW_BITS-1:0] ADD = {{{{(ROW_BITS - 32) {{1'b0}}}}, ROUNDING}} >> SPARE << (C1_BITS + C2_BITS);

(* rom_style = "block", ram_style = "block" *)
reg [ROW_BITS-1:0] rom[0:ROWS-1];
generate
  if (SMALL) begin : g_small_table
    initial begin
{small}
    end
  end else if (LONG) begin : g_long_table
    initial begin
{long}
    end
  end else begin : g_short_table
    initial begin
{short}
    end
  end
endgenerate
"""


def numbers_of(form: Form, besides: Sequence[str]) -> dict[str, int]:
    """Return the parameters of a form for ``ik_quadratic`` and the module around it."""
    c2 = len(form.c_frac) > 2
    u_frac = form.u_frac - form.u_low
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
        "DROP": form.slope_frac - form.slope_low + u_frac - form.sum_frac,
        "BEND_DROP": form.c_frac[2] + u_frac - form.slope_frac if c2 else 0,
        **{name.upper(): getattr(form, name) for name in besides},
    }


def rom(form: Form, table: Sequence[tuple]) -> str:
    """Return the rows of the ROM; c0 is truncated to its word."""
    bits = sum(form.c_bits)
    lines = []
    for i, row in enumerate(table):
        word = 0
        for size, value in zip(form.c_bits, row, strict=True):
            word = word << size | value % (1 << size)
        lines.append(f"      rom[{i}] = {bits}'h{word:0{-(-bits // 4)}x} + ADD;")
    return "\n".join(lines)


def rsqrt_header() -> str:
    """Return ``rtl/include/ik_rsqrt_table.vh``."""
    forms = lean_cores.SHORT, lean_cores.LONG, lean_cores.SMALL
    return table_header(
        "ik_rsqrt",
        "model/dataflow/cores.py",
        lean_cores.SHORT_FRAC,
        forms,
        [*map(lean_cores.rsqrt_rows, forms)],
        "(3 << (SUM_FRAC - F - 3)) - (TILES + 1) / 2",
        ("tiles", "clocks"),
    )


def trig_header() -> str:
    """Return ``rtl/include/ik_trig_table.vh``."""
    forms = lean_trig.SHORT, lean_trig.LONG, lean_trig.SMALL
    return table_header(
        "ik_trig",
        "model/dataflow/trig.py",
        lean_trig.SHORT_FRAC,
        forms,
        [*map(lean_trig.sine_rows, forms)],
        "1 << (SUM_FRAC - F - 1)",
        ("clocks",),
    )


def fold_header(name: str) -> str:
    """Return the text of ``ik_fold_<name>.vh``."""
    text, source = fold_headers.HEADERS[name]
    return f"{NOTE.format(source=source)}\n{text()}\n"


HEADERS = {
    ROOT / "rtl" / "include" / "ik_paper_nodes.vh": lambda: nodes_header("paper"),
    ROOT / "rtl" / "include" / "ik_lean_nodes.vh": lambda: nodes_header("lean"),
    ROOT / "rtl" / "include" / "ik_lean_formats.vh": formats_header,
    ROOT / "rtl" / "include" / "ik_latency.vh": latency_header,
    ROOT / "rtl" / "include" / "ik_sincos_table.vh": sincos_header,
    ROOT / "rtl" / "include" / "ik_rsqrt_table.vh": rsqrt_header,
    ROOT / "rtl" / "include" / "ik_trig_table.vh": trig_header,
    **{ROOT / "rtl" / "include" / f"ik_fold_{name}.vh": partial(fold_header, name) for name in fold_headers.HEADERS},
}
"""File -> function that returns its text."""


def stale() -> list[Path]:
    """Return the headers that differ from the model."""
    return [path for path, text in HEADERS.items() if not path.exists() or path.read_text() != text()]


def main() -> None:
    """Write the headers that are out of date."""
    for path in stale():
        path.write_text(HEADERS[path]())
        print(f"wrote {path.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
