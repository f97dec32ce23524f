# SPDX-License-Identifier: Apache-2.0
"""Past one chip, on paper: how many lanes a large FPGA holds, and which memory or bus lets them work.

Nothing of this is measured. A lane is the lean datapath with words of 32 bits; what it takes of a chip is Yosys'
count for xc7 (docs/generated/fpga.json), of LUTs of six inputs and multipliers of 25 x 18 bits, which the chips below
have at least. Its clock is that on an ECP5, the only one that an open tool has placed.
"""

from __future__ import annotations

from dataclasses import dataclass

FILLED = 0.7
"""Part of a chip that lanes may take: the rest is for what brings targets, and for routing."""

TARGET_BYTES, RESULT_BYTES = 32, 32
"""Of a record in memory."""

POSES = 10**9

GPU = 500e6
"""Poses a second that are given for a GPU, for comparison."""


@dataclass(frozen=True)
class Chip:
    """What a card holds."""

    name: str
    luts: int
    flip_flops: int
    multipliers: int
    memories: int  # of 18 kbit
    roads: tuple[str, ...]
    source: str


DDR, HBM, PCIE_3, PCIE_4 = "DDR4", "HBM2", "PCIe 3.0 x16", "PCIe 4.0 x16"

CHIPS = (
    Chip("Alveo U250 (VU13P)", 1_728_000, 3_456_000, 12_288, 5376, (DDR, PCIE_3), "DS962, DS890"),
    Chip("Alveo U55C (VU47P)", 1_303_680, 2_607_360, 9024, 4032, (HBM, PCIE_3), "DS978, DS890"),
)


@dataclass(frozen=True)
class Road:
    """What brings targets to a chip. ``both``: reads and writes share the bytes; otherwise each direction has them."""

    name: str
    what: str
    bytes_per_second: float
    both: bool
    source: str

    @property
    def poses(self) -> float:
        """Poses a second."""
        each = TARGET_BYTES + RESULT_BYTES if self.both else max(TARGET_BYTES, RESULT_BYTES)
        return self.bytes_per_second / each


ROADS = (
    Road(DDR, "four channels of 2400 MT/s", 77e9, True, "UG1393: U250"),
    Road(HBM, "two stacks", 460e9, True, "UG1393: U55C"),
    Road(PCIE_3, "each direction", 8e9 * 128 / 130 * 16 / 8, False, "8 GT/s a lane, 128b/130b"),
    Road(PCIE_4, "each direction", 16e9 * 128 / 130 * 16 / 8, False, "16 GT/s a lane, 128b/130b"),
)
"""Peak values of the standards and data sheets; a real system stays below."""


def lane(fpga: dict) -> dict[str, int]:
    """What a lane takes of a chip of Xilinx."""
    cells = fpga["runs"]["lean-W32-xc7"]["cells"]
    return {"LUT": cells["LUT"], "FF": cells["FF"], "multipliers": cells["multipliers"], "RAM": cells["RAM"]}


def lanes(chip: Chip, takes: dict[str, int]) -> tuple[int, str]:
    """How many lanes a chip holds, and what there is too little of."""
    has = {"LUT": chip.luts, "FF": chip.flip_flops, "multipliers": chip.multipliers, "RAM": chip.memories}
    least = min(has, key=lambda kind: has[kind] / takes[kind])
    return int(FILLED * has[least] / takes[least]), least
