# SPDX-License-Identifier: Apache-2.0
"""Writes the Verilog headers that Python is the source of: node formats and clocks, and the CORDIC's table.

    python -m scripts.gen_headers           writes the headers that are out of date
    python -m scripts.gen_headers --check   only names them, and exits with 1 if there are any
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

from model.dataflow import GUARD, SECTIONS, WIDTHS, Latency, Node
from model.fixed import SINCOS_GUARD, TABLE_BITS, Bits, atan_table, cordic_gain, run
from model.targets import RESULT_FIELDS

ROOT = Path(__file__).resolve().parent.parent
NOTE = """// SPDX-License-Identifier: Apache-2.0
// Written by `python -m scripts.gen_headers` from {source}; do not edit.
"""


def traced() -> dict[int, Bits]:
    """The dataflow at every width, run on one target: formats and clocks do not depend on the target."""
    one = {w: 1 << (w - 3) for w in WIDTHS}
    return {w: run(np.array([[one[w], 0, 0, 0, one[w], one[w]]]), w).bits for w in WIDTHS}


def _start(operands: tuple[Node, ...], runs: dict[int, Bits]) -> str:
    """The T_ of the operand that is ready last, at every width; ValueError where that depends on the width."""
    times = {}
    for node in operands:
        if node.name:  # constants are always ready
            times.setdefault(tuple(runs[w].nodes[node.name].time for w in WIDTHS), f"T_{node.name.upper()}")
    last = tuple(max(column) for column in zip(*times, strict=True))
    if last not in times:
        raise ValueError(f"none of {sorted(times.values())} is the last at every width")
    return times[last]


def nodes_header() -> str:
    """``rtl/paper/ik_paper_nodes.vh``."""
    runs = traced()
    nodes = runs[WIDTHS[-1]].nodes
    lines = [
        NOTE.format(source="model/dataflow.py"),
        "// For the body of a module with parameter W. F_<NODE>: fraction bits of the node. T_<NODE>: the clock in",
        "// which it is valid, counted from the clock in which its target stands at the datapath's input.",
        "// LAT_<OPERATION>: clocks of an operation.",
        "",
        f"localparam integer GUARD = {GUARD};  // more fraction bits of a product that waits for its sum",
    ]
    for kind, (_, _, why) in Latency.TABLE.items():
        lines.append(f"localparam integer LAT_{kind.upper()} = {Latency.expression(kind)};  // {why}")
    section = None
    for node in nodes.values():
        if node.section != section:
            section = node.section
            lines += ["", f"// {SECTIONS[section]}"]
        name = node.name.upper()
        if not node.latency:
            time = "0"
        elif node.operands and any(o.latency for o in node.operands):
            waits_for = (*node.operands, node.after) if node.after else node.operands
            time = f"{_start(waits_for, runs)} + LAT_{node.latency.upper()}"
        else:
            time = f"LAT_{node.latency.upper()}"
        parts = [f"T_{name} = {time}"]
        if node.format.signed:
            parts.insert(0, f"F_{name} = {node.format.frac_expr}")
        comment = f"  // {node.equation}" if node.equation else ""
        lines.append(f"localparam integer {', '.join(parts)};{comment}")
    outputs = _start(tuple(nodes[n] for n in (*RESULT_FIELDS, "saturated")), runs)
    lines += ["", "// All results leave together.", f"localparam integer T_OUT = {outputs};", ""]
    return "\n".join(lines)


def sincos_header() -> str:
    """``rtl/cores/ik_sincos_table.vh``."""
    entries = "\n".join(f"      {i:2d}: atan_turn = {TABLE_BITS}'d{a};" for i, a in enumerate(atan_table()))
    return f"""{NOTE.format(source="model/fixed.py")}
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


HEADERS = {
    ROOT / "rtl" / "paper" / "ik_paper_nodes.vh": nodes_header,
    ROOT / "rtl" / "cores" / "ik_sincos_table.vh": sincos_header,
}
"""File -> the function that gives its text."""


def stale() -> list[Path]:
    """The headers whose file does not say what the model says."""
    return [path for path, text in HEADERS.items() if not path.exists() or path.read_text() != text()]


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m scripts.gen_headers", description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="write nothing; exit with 1 if a header is out of date")
    check = parser.parse_args().check
    out_of_date = stale()
    for path in out_of_date:
        if not check:
            path.write_text(HEADERS[path]())
        print(f"{'out of date' if check else 'wrote'}: {path.relative_to(ROOT)}")
    return 1 if check and out_of_date else 0


if __name__ == "__main__":
    sys.exit(main())
