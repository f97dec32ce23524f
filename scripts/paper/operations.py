# SPDX-License-Identifier: Apache-2.0
"""Table 4 of the paper: operation counts of the datapaths, by their dataflow; operations.md."""

from typing import NamedTuple

from model.dataflow.paper import SECTIONS
from scripts.generate.flow import WIDTH, operations
from scripts.generate.render import render
from tb.sim.env import GENERATED

PAGE = GENERATED / "operations.md"


class Ops(NamedTuple):
    """Operation counts; ``scale`` counts multiplications by a constant, ``trig`` sines and cosines."""

    add: int = 0
    mul: int = 0
    root: int = 0
    div: int = 0
    scale: int = 0
    trig: int = 0


def by_section(datapath: str) -> dict[str, Ops]:
    """Return the operations of each section of a datapath; its RTL has an instance or an operator for each."""
    return {
        section: Ops(
            add=units["additions"],
            mul=units["mul"] + units["mul3"] + units["square"] + units["product"],
            root=units["root"] + units["rsqrt"],
            div=units["div"],
            trig=2 * (units["sincos"] + units["trig"]),
        )
        for section, units in operations(datapath).items()
    }


def total(sections: dict[str, Ops]) -> Ops:
    """Add the operations of sections."""
    return Ops(*map(sum, zip(*sections.values(), strict=True)))


def page() -> str:
    """Return operations.md."""
    paper = by_section("paper")
    counts = {"guard": paper["guard"], "everything": total(paper), "lean": total(by_section("lean"))}
    counts["rtl"] = total({name: ops for name, ops in paper.items() if name != "guard"})
    return render("operations", sections={SECTIONS[name]: ops for name, ops in paper.items()}, width=WIDTH, **counts)


def write() -> int:
    """Count, write operations.md and return 0."""
    PAGE.write_text(page())
    print(f"wrote {PAGE.name}")
    return 0
