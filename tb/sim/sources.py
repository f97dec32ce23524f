# SPDX-License-Identifier: Apache-2.0
"""The Verilog of the core, from the file lists ``rtl/ik_axis.f`` and ``rtl/ik_axi.f``, and digests of sources.

A list is in the form that simulators take (``verilator -F``): a file a line, relative to the list's folder, or
``+incdir+`` and a folder of headers.  None includes another: Icarus 11 cannot.  ``root`` is the checkout or a copy laid
out alike, which holds ``rtl/``.
"""

from __future__ import annotations

import hashlib
import io
import re
import tokenize
from collections.abc import Iterable
from pathlib import Path

from tb.sim.env import ROOT

LIST = "rtl/ik_axis.f"
MEMORY = "rtl/ik_axi.f"
"""What the other list has around it."""
INCLUDE = "+incdir+"


def _entries(root: Path) -> tuple[list[Path], list[Path]]:
    """Folders of headers and files, in the order of the lists; a copy may do without the second."""
    folders, files = {}, []
    for path in [root / LIST, *(path for path in [root / MEMORY] if path.exists())]:
        for line in path.read_text(encoding="utf-8").splitlines():
            found = line.partition("//")[0].strip()
            if found.startswith(INCLUDE):
                folders[(path.parent / found.removeprefix(INCLUDE))] = None
            elif found:
                files.append(path.parent / found)
    return list(folders), files


def sources(root: Path = ROOT) -> list[Path]:
    """The Verilog files, a module each."""
    return _entries(root)[1]


def includes(root: Path = ROOT) -> list[Path]:
    """The folders in which headers are looked for."""
    return _entries(root)[0]


def headers(root: Path = ROOT) -> list[Path]:
    """The files that others include."""
    return [path for folder in includes(root) for path in sorted(folder.glob("*.vh"))]


def closure(top: str, root: Path = ROOT, instead: Iterable[Path] = ()) -> list[Path]:
    """The files of module ``top`` and of all that it instantiates or includes, its own first; a file of ``instead`` is
    taken in the place of the one of its name."""
    known = {path.name: path for path in [*sources(root), *headers(root), *instead]}
    wanted, found = [f"{top}.v"], {}
    while wanted:
        name = wanted.pop(0)
        if name in found or name not in known:
            continue
        found[name] = known[name]
        text = re.sub(r"//[^\n]*", "", known[name].read_text(encoding="utf-8"))
        wanted += re.findall(r'`include\s+"([^"]+)"', text)
        wanted += [f"{word}.v" for word in re.findall(r"\bik_\w+\b", text)]
    return list(found.values())


def header(text: str) -> str:
    """A module without what is in it."""
    return text[: text.index("\n);\n")] + "\n);\nendmodule\n"


# -- digests -----------------------------------------------------------------------------------------------------------

C_LIKE = re.compile(r'("(?:\\.|[^"\\\n])*")|//[^\n]*|/\*.*?\*/|\s+', re.S)


def _python(text: str) -> str:
    """Python without comments, docstrings and empty lines: blanks at the start of a line count."""
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
    """A source file without its comments and blanks, which cannot change what it does: Verilog, C++, Python or .sby."""
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".sby":
        return re.sub(r"^(#.*)?\n", "", text, flags=re.M)
    return _python(text) if path.suffix == ".py" else C_LIKE.sub(lambda found: found[1] or "", text)


def digest(paths: Iterable[Path]) -> str:
    """Of the names and the code of files, in any order: the start of a SHA-256."""
    whole = hashlib.sha256()
    for path in sorted(paths, key=lambda path: path.name):
        whole.update(f"{path.name}\0{code(path)}\0".encode())
    return whole.hexdigest()[:16]
