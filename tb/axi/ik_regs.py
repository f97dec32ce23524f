# SPDX-License-Identifier: Apache-2.0
"""Registers of ``ik_axi``, read from rtl/axi/ik_axi.rdl."""

from systemrdl import RDLCompiler
from systemrdl.node import FieldNode

from tb.sim.env import ROOT


def access(field: FieldNode) -> str:
    """Return the access of a field: r, rw, w1c (write 1 to clear) or w1 (a pulse, reads as 0)."""
    if field.get_property("woclr"):
        return "w1c"
    if field.get_property("singlepulse"):
        return "w1"
    return "rw" if field.is_sw_writable else "r"


compiler = RDLCompiler()
compiler.compile_file(str(ROOT / "rtl" / "axi" / "ik_axi.rdl"))
TOP = compiler.elaborate().top
REGISTERS = list(TOP.registers())
NODES = {f"{of.inst_name}{of.current_idx[0] + 1 if of.is_array else ''}": of for of in TOP.registers(unroll=True)}
"""Register name -> RDL node. Registers of an array are numbered from 1."""

OFFSETS = {name: of.address_offset for name, of in NODES.items()}  # register -> its offset in bytes

FIELDS = {name: {field.inst_name: field for field in of.fields()} for name, of in NODES.items()}
"""Register name -> field name -> RDL node. Without the property `reset`, the value depends on the parameters."""

ENCODED = [code for of in REGISTERS for field in of.fields() for code in field.get_property("encode") or ()]
CODES = {code.name: code.value for code in ENCODED}  # values of STATUS.code
