# SPDX-License-Identifier: Apache-2.0
"""Four-pin wrapper for a module that is placed alone."""

from __future__ import annotations

import re

HEADER = re.compile(r"^module\s+(\w+)\s*(?:#\s*\((.*?)\n\)\s*)?\((.*?)\n\);", re.M | re.S)
PORT = re.compile(r"^\s*(input|output)\s+(?:wire|reg)?\s*(?:signed)?\s*(\[[^\]]+\])?\s*(\w+)")


def wrapper(text: str, values: dict) -> str:
    """Return a four-pin module fpga_top around the module in ``text``.

    One shift register drives the inputs and another captures the outputs, so every path of the module lies between
    registers and no part of it can be optimized away.
    """
    text = re.sub(r"//[^\n]*", "", text)
    name, parameters, ports = HEADER.search(text).groups()
    parameters = parameters or "parameter integer NONE = 0"
    parameters = re.sub(r"(\w+)\s*=\s*([^,\n]+)", lambda m: f"{m[1]} = {values.get(m[1], m[2])}", parameters)
    inputs, outputs, wires, joined = [], [], [], []
    for line in ports.splitlines():
        port = PORT.match(line)
        if not port:
            continue
        way, span, label = port.groups()
        joined.append(f".{label}({label})")
        if label == "clk":
            continue
        (inputs if way == "input" else outputs).append((label, span))
        wires.append(f"  wire {span or ''} {label};")

    def bits(of):
        return " + ".join(f"({span[1:-1].split(':')[0]}) + 1" if span else "1" for _, span in of)

    passed = [] if "NONE" in parameters else [f".{p}({p})" for p in re.findall(r"(\w+)\s*=", parameters)]
    return "\n".join(
        [
            f"module fpga_top #({parameters}) (input wire clk, input wire in, input wire load, output wire out);",
            f"  localparam integer IN = {bits(inputs)};",
            f"  localparam integer OUT = {bits(outputs)};",
            *wires,
            "  reg [IN-1:0] in_q;",
            "  reg [OUT-1:0] out_q;",
            "  reg load_q;",
            "  always @(posedge clk) begin",
            "    in_q <= {in_q[IN-2:0], in};",
            "    load_q <= load;",
            f"    out_q <= load_q ? {{{', '.join(label for label, _ in outputs)}}} : {{out_q[OUT-2:0], 1'b0}};",
            "  end",
            f"  assign {{{', '.join(label for label, _ in inputs)}}} = in_q;",
            "  assign out = out_q[OUT-1];",
            f"  {name} {'#(' + ', '.join(passed) + ') ' if passed else ''}dut ({', '.join(joined)});",
            "endmodule",
            "",
        ]
    )
