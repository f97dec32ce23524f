# SPDX-License-Identifier: Apache-2.0
"""The registers of ik_axi.

Written by `python -m scripts.generate.registers` from rtl/axi/ik_axi.rdl; do not edit.
"""

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
    "LIMIT_LOW1": 0x48,
    "LIMIT_LOW2": 0x4C,
    "LIMIT_LOW3": 0x50,
    "LIMIT_LOW4": 0x54,
    "LIMIT_LOW5": 0x58,
    "LIMIT_LOW6": 0x5C,
    "LIMIT_LOW7": 0x60,
    "LIMIT_HIGH1": 0x64,
    "LIMIT_HIGH2": 0x68,
    "LIMIT_HIGH3": 0x6C,
    "LIMIT_HIGH4": 0x70,
    "LIMIT_HIGH5": 0x74,
    "LIMIT_HIGH6": 0x78,
    "LIMIT_HIGH7": 0x7C,
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
        "arm": Field(26, 26, "r", None),
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
    "LIMIT_LOW1": {
        "value": Field(31, 0, "rw", 2147483648),
    },
    "LIMIT_LOW2": {
        "value": Field(31, 0, "rw", 2147483648),
    },
    "LIMIT_LOW3": {
        "value": Field(31, 0, "rw", 2147483648),
    },
    "LIMIT_LOW4": {
        "value": Field(31, 0, "rw", 2147483648),
    },
    "LIMIT_LOW5": {
        "value": Field(31, 0, "rw", 2147483648),
    },
    "LIMIT_LOW6": {
        "value": Field(31, 0, "rw", 2147483648),
    },
    "LIMIT_LOW7": {
        "value": Field(31, 0, "rw", 2147483648),
    },
    "LIMIT_HIGH1": {
        "value": Field(31, 0, "rw", 2147483647),
    },
    "LIMIT_HIGH2": {
        "value": Field(31, 0, "rw", 2147483647),
    },
    "LIMIT_HIGH3": {
        "value": Field(31, 0, "rw", 2147483647),
    },
    "LIMIT_HIGH4": {
        "value": Field(31, 0, "rw", 2147483647),
    },
    "LIMIT_HIGH5": {
        "value": Field(31, 0, "rw", 2147483647),
    },
    "LIMIT_HIGH6": {
        "value": Field(31, 0, "rw", 2147483647),
    },
    "LIMIT_HIGH7": {
        "value": Field(31, 0, "rw", 2147483647),
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
