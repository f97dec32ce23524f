# SPDX-License-Identifier: Apache-2.0
"""Write the C header and the page of ik_axi's registers.

    python -m scripts.generate.registers      writes the files that are out of date

The templates are ours, because PeakRDL's C header names registers of a shared type by a hash.
"""

import textwrap
from pathlib import Path

from scripts.generate.render import TEMPLATES, update
from tb.axi.ik_regs import ENCODED, REGISTERS, TOP, access
from tb.sim.env import GENERATED, ROOT

FILES = {ROOT / "examples" / "driver" / "ik_regs.h": "ik_regs.h.j2", GENERATED / "registers.md": "registers.md.j2"}
"""Generated file -> template."""

TEMPLATES.filters |= {
    "access": access,
    "desc": lambda of: " ".join((of.get_property("desc") or "").split()),
    "wrap": textwrap.fill,
}


def texts() -> dict[Path, str]:
    codes = [(code.name, code.value, code.rdl_desc) for code in ENCODED]
    values = {"top": TOP, "registers": REGISTERS, "codes": codes}
    return {path: TEMPLATES.get_template(name).render(values) for path, name in FILES.items()}


if __name__ == "__main__":
    update(texts())
