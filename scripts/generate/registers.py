# SPDX-License-Identifier: Apache-2.0
"""Registers of ik_axi from rtl/axi/ik_axi.rdl: C header, Python constants, page.

    python -m scripts.generate.registers      writes the files that are out of date

The project has its own templates: PeakRDL's C header names registers that share a type by a hash.
"""

import textwrap
from pathlib import Path

from systemrdl import RDLCompiler
from systemrdl.node import FieldNode

from scripts.generate.render import TEMPLATES, update
from tb.sim.env import GENERATED, ROOT

SOURCE = ROOT / "rtl" / "axi" / "ik_axi.rdl"

FILES = {
    ROOT / "examples" / "driver" / "ik_regs.h": "ik_regs.h.j2",
    ROOT / "tb" / "axi" / "ik_regs.py": "ik_regs.py.j2",
    GENERATED / "registers.md": "registers.md.j2",
}
"""File -> its template."""


def access(field: FieldNode) -> str:
    """Return the access of a field: r, rw, w1c (write 1 to clear) or w1 (a pulse, reads as 0)."""
    if field.get_property("woclr"):
        return "w1c"
    if field.get_property("singlepulse"):
        return "w1"
    return "rw" if field.is_sw_writable else "r"


TEMPLATES.filters |= {
    "access": access,
    "desc": lambda of: " ".join((of.get_property("desc") or "").split()),
    "wrap": textwrap.fill,
}


def texts() -> dict[Path, str]:
    """Return file -> its text."""
    compiler = RDLCompiler()
    compiler.compile_file(str(SOURCE))
    top = compiler.elaborate().top
    registers = list(top.registers())
    encodings = [field.get_property("encode") for register in registers for field in register.fields()]
    codes = [(code.name, code.value, code.rdl_desc) for encoding in encodings if encoding for code in encoding]
    given = {"top": top, "registers": registers, "codes": codes}
    return {path: TEMPLATES.get_template(name).render(given) for path, name in FILES.items()}


if __name__ == "__main__":
    update(texts())
