# SPDX-License-Identifier: Apache-2.0
"""The registers of ik_axi.

Written by `python -m scripts.generate.registers` from rtl/axi/ik_axi.rdl; do not edit.
"""

from __future__ import annotations

from typing import NamedTuple


class Field(NamedTuple):
    """Bits high to low of a register. access: r, rw, w1c (writing 1 erases) or w1 (a pulse, reads as 0)."""

    high: int
    low: int
    access: str
    reset: int | None  # None: as the parameters of the instance are


OFFSETS = {
    "ID": 0x00,
    "CONFIG": 0x04,
    "PIPELINE": 0x08,
    "CONTROL": 0x0C,
    "STATUS": 0x10,
    "IRQ_ENABLE": 0x14,
    "IRQ_STATUS": 0x18,
    "COUNT": 0x1C,
    "SOURCE_LO": 0x20,
    "SOURCE_HI": 0x24,
    "DESTINATION_LO": 0x28,
    "DESTINATION_HI": 0x2C,
    "ERROR_LO": 0x30,
    "ERROR_HI": 0x34,
    "WRITTEN": 0x38,
    "CLOCKS": 0x3C,
    "READ_STALLS": 0x40,
    "WRITE_STALLS": 0x44,
}
"""Register -> its offset in bytes."""

FIELDS = {
    "ID": {
        "minor": Field(7, 0, "r", 0),
        "major": Field(15, 8, "r", 1),
        "magic": Field(31, 16, "r", 18763),
    },
    "CONFIG": {
        "width": Field(7, 0, "r", None),
        "data_width": Field(15, 8, "r", None),
        "addr_width": Field(23, 16, "r", None),
        "lean": Field(24, 24, "r", None),
        "digit": Field(25, 25, "r", None),
    },
    "PIPELINE": {
        "latency": Field(15, 0, "r", None),
        "places": Field(31, 16, "r", None),
    },
    "CONTROL": {
        "start": Field(0, 0, "w1", 0),
        "soft_reset": Field(1, 1, "w1", 0),
    },
    "STATUS": {
        "busy": Field(0, 0, "r", 0),
        "done": Field(1, 1, "r", 0),
        "error": Field(2, 2, "r", 0),
        "code": Field(11, 8, "r", 0),
    },
    "IRQ_ENABLE": {
        "done": Field(0, 0, "rw", 0),
        "error": Field(1, 1, "rw", 0),
        "refused": Field(2, 2, "rw", 0),
    },
    "IRQ_STATUS": {
        "done": Field(0, 0, "w1c", 0),
        "error": Field(1, 1, "w1c", 0),
        "refused": Field(2, 2, "w1c", 0),
    },
    "COUNT": {
        "value": Field(31, 0, "rw", 0),
    },
    "SOURCE_LO": {
        "value": Field(31, 0, "rw", 0),
    },
    "SOURCE_HI": {
        "value": Field(31, 0, "rw", 0),
    },
    "DESTINATION_LO": {
        "value": Field(31, 0, "rw", 0),
    },
    "DESTINATION_HI": {
        "value": Field(31, 0, "rw", 0),
    },
    "ERROR_LO": {
        "value": Field(31, 0, "r", 0),
    },
    "ERROR_HI": {
        "value": Field(31, 0, "r", 0),
    },
    "WRITTEN": {
        "value": Field(31, 0, "r", 0),
    },
    "CLOCKS": {
        "value": Field(31, 0, "r", 0),
    },
    "READ_STALLS": {
        "value": Field(31, 0, "r", 0),
    },
    "WRITE_STALLS": {
        "value": Field(31, 0, "r", 0),
    },
}
"""Register -> field -> where it is."""

CODES = {
    "none": 0,
    "source_misaligned": 1,
    "destination_misaligned": 2,
    "source_beyond": 3,
    "destination_beyond": 4,
    "overlap": 5,
    "read_slverr": 6,
    "read_decerr": 7,
    "write_slverr": 8,
    "write_decerr": 9,
}
"""Values of STATUS.code."""
