# SPDX-License-Identifier: Apache-2.0
"""The datapaths by name: what everything that runs, checks or draws one of them needs to know of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from . import lean, paper
from .nodes import WIDTHS


@dataclass(frozen=True)
class Datapath:
    """One dataflow and where its Verilog is.

    ``flow(domain, target)`` is the whole of it, ``after_guard(domain, phi)`` what follows the exact decisions.
    ``sections`` maps a section to what it is, ``widths`` are the word lengths that it can be built with.
    """

    name: str
    flow: Callable
    after_guard: Callable
    sections: dict[str, str]
    widths: range = WIDTHS

    @property
    def folder(self) -> Path:
        """Of its Verilog, from the root of the repository."""
        return Path("rtl") / self.name

    def module(self, section: str) -> str:
        """The Verilog module of a section."""
        return f"ik_{section}" if self.name == "paper" else f"ik_{self.name}_{section}"


DATAPATHS = {
    "lean": Datapath("lean", lean.lean, lean.sections, lean.SECTIONS, lean.WIDTHS),
    "paper": Datapath("paper", paper.paper, paper.sections, paper.SECTIONS),
}
"""All of them by name; the first is what a user gets who does not choose."""
