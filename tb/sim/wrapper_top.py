# SPDX-License-Identifier: Apache-2.0
"""Generated top with several modules of ``rtl/`` or AXI rules side by side, so that one simulation tests all of them.

A wrapper around a module has registers for its inputs and wires for its outputs, with the same names, so that a bench
can use the wrapper like the module. Each wrapper has its own clock, so that only the module under test runs.
"""

import re
from collections.abc import Iterable

from tb.sim.sources import RULES, sources

TOP = "ik_wrapper_top"

HEADER = re.compile(r"^module (\w+) #\((.*?)^\) \((.*?)^\);", re.DOTALL | re.MULTILINE)
PORT = re.compile(r"^\s*(input|output)\s+(?:wire|reg)\b\s*((?:signed\s*)?(?:\[.*?\])?)\s*(\w+)", re.MULTILINE)


def top_of(instances: dict[str, tuple[str, dict[str, int]]]) -> str:
    """Return the text of :data:`TOP`, with a wrapper for each of ``instances``, name -> (module, parameters)."""
    text = "\n".join(path.read_text() for path in [*sources(), RULES / "ik_rules.v"])
    headers = {found[1]: found.groups() for found in HEADER.finditer(text)}
    wrappers = [_wrapper(*headers[module]) for module in sorted({module for module, _ in instances.values()})]
    lines = [
        f"  {module}_wrapper #({_by_name(parameters, parameters.values())}) {name} ();"
        for name, (module, parameters) in instances.items()
    ]
    return "\n".join(["`default_nettype none", *wrappers, f"module {TOP};", *lines, "endmodule", ""])


def _wrapper(module: str, parameters: str, ports: str) -> str:
    kinds = {"input": "reg ", "output": "wire"}
    declared = PORT.findall(ports)
    names = re.findall(r"parameter integer (\w+)", parameters)
    ports = [name for *_, name in declared]
    registers = "".join(f"  {kinds[way]} {form} {name};\n" for way, form, name in declared)
    instance = f"  {module} #({_by_name(names, names)}) u ({_by_name(ports, ports)});\n"
    return f"module {module}_wrapper #({parameters});\n{registers}{instance}endmodule"


def _by_name(names: Iterable[str], values: Iterable) -> str:
    return ", ".join(f".{name}({value})" for name, value in zip(names, values, strict=True))
