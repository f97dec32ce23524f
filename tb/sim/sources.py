# SPDX-License-Identifier: Apache-2.0
"""Verilog that simulations compile: files of the lists ``rtl/ik_axis.f``, ``ik_axi.f`` and ``ik_arm.f``, copies of them
with AXI rules added, and a generated top. Also digests of files.

The lists use the simulators' format (``verilator -F``): one file per line, relative to the list's folder, or
``+incdir+`` and a header folder. Lists do not nest, because Icarus 11 cannot read nested lists. ``root`` is the
checkout, or a folder with a copy of its ``rtl/``.
"""

import hashlib
import io
import re
import tokenize
from collections.abc import Iterable
from functools import cache
from pathlib import Path

from tb.sim.env import ROOT

LIST = "rtl/ik_axis.f"
MEMORY = "rtl/ik_axi.f"  # list of the memory wrapper around the core
ARM = "rtl/ik_arm.f"  # list of the whole arm around the core
INCLUDE = "+incdir+"


def _entries(root: Path) -> tuple[list[Path], list[Path]]:
    """Return header folders and files, in list order. A copy of the checkout may have only the first list."""
    folders, files = {}, []
    for path in [root / LIST, *(path for path in (root / MEMORY, root / ARM) if path.exists())]:
        for line in path.read_text(encoding="utf-8").splitlines():
            entry = line.partition("//")[0].strip()
            if entry.startswith(INCLUDE):
                folders[(path.parent / entry.removeprefix(INCLUDE))] = None
            elif entry:
                files.append(path.parent / entry)
    return list(folders), files


def sources(root: Path = ROOT) -> list[Path]:
    """Return the Verilog files, one module each."""
    return _entries(root)[1]


def includes(root: Path = ROOT) -> list[Path]:
    return _entries(root)[0]


def headers(root: Path = ROOT) -> list[Path]:
    return [path for folder in includes(root) for path in sorted(folder.glob("*.vh"))]


def nets(text: str) -> str:
    """Return a header with the rows of its read-only memory as constant nets."""
    begin = re.compile(r"^( *)initial begin\n((?:\1  .*\n)*)\1end\n", re.M)
    text = begin.sub(lambda block: block[2].replace("  rom[", "  assign rom["), text)
    return re.sub(r"^reg( \[.*\] rom)", r"wire\1", text, flags=re.M)


def closure(top: str, root: Path = ROOT, instead: Iterable[Path] = (), without: Iterable[str] = ()) -> list[Path]:
    """Return the file of module ``top``, then the files of everything that it instantiates or includes. A file in
    ``instead`` replaces the listed file of the same name; modules named in ``without`` are left out."""
    listed = [*sources(root), *headers(root), *instead]
    known = {path.name: path for path in listed if path.stem not in without}
    wanted, files = [f"{top}.v"], {}
    while wanted:
        name = wanted.pop(0)
        if name in known and name not in files:
            files[name] = known[name]
            wanted += _named(known[name].read_text(encoding="utf-8"))
    return list(files.values())


@cache
def _named(text: str) -> list[str]:
    """Return the names of the files that may contain the headers and modules named in a Verilog text."""
    text = re.sub(r"//[^\n]*", "", text)
    return re.findall(r'`include\s+"([^"]+)"', text) + [f"{word}.v" for word in re.findall(r"\bik_\w+\b", text)]


def header(text: str) -> str:
    """Return the header of the module in ``text``."""
    return text[: text.index("\n);\n")] + "\n);\nendmodule\n"


RULES = ROOT / "tb" / "axi" / "rules"
"""Folder of AXI rules. Icarus 11 has no ``bind``, so NAME.vh is inserted before the end of a copy of module NAME."""

END = "\nendmodule\n"


def with_rules(files: list[Path], folder: Path) -> list[Path]:
    """Return the files, then ik_rules.v. Copies with AXI rules replace the files that have rules. The copies
    are kept in ``folder`` and rewritten only if they change."""
    copies = {}
    for path in files:
        if (added := RULES / f"{path.stem}.vh").exists():
            text = path.read_text(encoding="utf-8")
            if text.count(END) != 1:
                raise LookupError(f"{path} does not contain exactly one endmodule")
            text = text.replace(END, f"\n/* verilator coverage_off */\n{added.read_text(encoding='utf-8')}{END}")
            copies[path] = copy = folder / f"{path.stem}_rules.v"
            if not (copy.exists() and copy.read_text(encoding="utf-8") == text):
                copy.write_text(text, encoding="utf-8")
    return [*(copies.get(path, path) for path in files), RULES / "ik_rules.v"]


TOP = "ik_wrapper_top"
"""Name of a generated top that instantiates several modules, so that one simulation tests all of them."""

HEADER = re.compile(r"^module (\w+) #\((.*?)^\) \((.*?)^\);", re.DOTALL | re.MULTILINE)
PORT = re.compile(r"^\s*(input|output)\s+(?:wire|reg)\b\s*((?:signed\s*)?(?:\[.*?\])?)\s*(\w+)", re.MULTILINE)


def top_of(instances: dict[str, tuple[str, dict[str, int]]]) -> str:
    """Return the text of :data:`TOP`, with a wrapper for each of ``instances``, name -> (module, parameters).

    A wrapper around a module has registers for its inputs and wires for its outputs, with the same names, so that a
    bench can use the wrapper like the module. Each wrapper has its own clock: only the module under test runs.
    """
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


C_LIKE = re.compile(r'("(?:\\.|[^"\\\n])*")|//[^\n]*|/\*.*?\*/|\s+', re.S)


@cache
def _code(text: str, python: bool) -> str:
    """Return a text without comments and blanks. A Python text loses docstrings as well; its indentation stays."""
    if not python:
        return C_LIKE.sub(lambda found: found[1] or "", text)
    lines = text.splitlines(keepends=True)
    cut, statement = [], True
    tokens = list(tokenize.generate_tokens(io.StringIO(text).readline))
    for token, after in zip(tokens, [*tokens[1:], tokens[-1]], strict=True):
        docstring = statement and token.type == tokenize.STRING and after.type == tokenize.NEWLINE
        if token.type == tokenize.COMMENT or docstring:
            cut.append((token.start, token.end))
        if token.type not in (tokenize.COMMENT, tokenize.NL):
            statement = token.type in (tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENCODING)
    for (row, column), (last, end) in reversed(cut):
        lines[row - 1 : last] = [lines[row - 1][:column] + lines[last - 1][end:]]
    return "\n".join(line.rstrip() for line in "".join(lines).splitlines() if line.strip())


def code(path: Path) -> str:
    """Return the text of a Verilog, C++ or Python file without comments and blanks, which do not affect behaviour."""
    return _code(path.read_text(encoding="utf-8"), path.suffix == ".py")


def digest(paths: Iterable[Path]) -> str:
    """Return 16 digits of a SHA-256 over the files' names and code. The order of ``paths`` has no effect."""
    whole = hashlib.sha256()
    for path in sorted(paths, key=lambda path: path.name):
        whole.update(f"{path.name}\0{code(path)}\0".encode())
    return whole.hexdigest()[:16]
