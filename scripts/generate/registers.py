# SPDX-License-Identifier: Apache-2.0
"""Registers of ik_axi from rtl/axi/ik_axi.rdl: C header, Python constants, page.

    python -m scripts.generate.registers      writes the files that are out of date

The project has its own templates: PeakRDL's C header names registers that share a type by a hash.
"""

from __future__ import annotations

import textwrap
from dataclasses import dataclass
from pathlib import Path

from systemrdl import RDLCompiler
from systemrdl.node import FieldNode

from scripts.generate.render import TEMPLATES
from tb.sim.env import GENERATED, ROOT

SOURCE = ROOT / "rtl" / "axi" / "ik_axi.rdl"


@dataclass(frozen=True)
class Field:
    """Bit field of a register. access: r, rw, w1c (write 1 to clear) or w1 (a pulse, reads as 0)."""

    name: str
    high: int
    low: int
    access: str
    reset: int | None
    text: str

    @property
    def mask(self) -> int:
        return (2 << self.high) - (1 << self.low)

    @property
    def bits(self) -> str:
        return f"{self.high}:{self.low}" if self.high > self.low else str(self.low)


@dataclass(frozen=True)
class Register:
    """Register at a byte offset."""

    name: str
    offset: int
    title: str
    text: str
    fields: tuple[Field, ...]

    @property
    def writable(self) -> bool:
        return any(field.access != "r" for field in self.fields)


def _text(found: str | None) -> str:
    return " ".join((found or "").split())


def _access(field: FieldNode) -> str:
    if field.get_property("woclr"):
        return "w1c"
    if field.get_property("singlepulse"):
        return "w1"
    return "rw" if field.is_sw_writable else "r"


def description(path: Path = SOURCE) -> dict:
    """Return the text, the registers and the error codes (name, number, text) for the templates."""
    compiler = RDLCompiler()
    compiler.compile_file(str(path))
    top = compiler.elaborate().top
    registers, codes = [], []
    for node in top.registers():
        fields = []
        for field in node.fields():
            place = (field.inst_name, field.msb, field.lsb, _access(field), field.get_property("reset"))
            fields.append(Field(*place, _text(field.get_property("desc"))))
            if encoding := field.get_property("encode"):
                codes += [(code.name, code.value, _text(code.rdl_desc)) for code in encoding]
        named = (node.inst_name, node.address_offset, node.get_property("name"), _text(node.get_property("desc")))
        registers.append(Register(*named, tuple(fields)))
    return {"text": _text(top.get_property("desc")), "registers": registers, "codes": codes}


FILES = {
    ROOT / "examples" / "driver" / "ik_regs.h": "ik_regs.h.j2",
    ROOT / "tb" / "axi" / "ik_regs.py": "ik_regs.py.j2",
    GENERATED / "registers.md": "registers.md.j2",
}
"""File -> its template."""


def texts(source: Path = SOURCE) -> dict[Path, str]:
    """Return file -> its text."""
    TEMPLATES.filters["wrap"] = lambda text, width: textwrap.fill(text, width)
    found = description(source)
    return {path: TEMPLATES.get_template(name).render(found) for path, name in FILES.items()}


def stale(source: Path = SOURCE) -> list[Path]:
    """Return the files that differ from the description."""
    return [path for path, text in texts(source).items() if not path.exists() or path.read_text() != text]


def main() -> None:
    """Write the files that are out of date."""
    for path in stale():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(texts()[path])
        print(f"wrote {path.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
