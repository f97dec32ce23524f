# SPDX-License-Identifier: Apache-2.0
"""A proof by induction: its .sby file, its properties, and the seeded bug that breaks it."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from tb.formal.bugs import BUGS
from tb.sim.env import ROOT
from tb.sim.seeded_bugs import Bug

FORMAL = Path(__file__).parent
GATES = ("handshake", "axi_gates")
"""Files whose tasks are Yosys scripts."""
HANDSHAKE_SAYS = {
    "independent": "no gates lead from m_axis_tready or s_axis_tvalid to m_axis_tvalid or s_axis_tready",
}
"""Property of ik_axis, with each datapath."""


@dataclass(frozen=True)
class Proof:
    """A task of a .sby file of this folder, `of` and `variant`.

    says: property -> meaning; the module's other assertions are helping invariants. uses: property -> properties it
    needs in the previous clock, if not all. after: property -> properties it follows from in the same clock. Both apply
    to proofs run by :mod:`tb.formal.steps`.
    """

    of: str
    variant: str
    module: str
    width: str
    says: dict[str, str]
    uses: dict[str, list[str]] = field(default_factory=dict)
    after: dict[str, list[str]] = field(default_factory=dict)

    @property
    def name(self) -> str:
        return f"{self.of}_{self.variant}"

    @property
    def bug(self) -> Bug:
        """The seeded bug on which the proof must fail."""
        return BUGS.get(self.name) or BUGS[self.of]

    @cached_property
    def config(self) -> str:
        """The .sby file, without comments."""
        return re.sub(r"^#.*\n", "", (FORMAL / f"{self.of}.sby").read_text(), flags=re.M)

    def has(self, task: str) -> bool:
        """Return whether the file has a task prove, cover or formula for this variant."""
        return re.search(rf"^{task}_{self.variant}\b", self.config, re.M) is not None

    @property
    def engine(self) -> str:
        """sby (SymbiYosys), gates (a Yosys script in a .sby file) or steps (:mod:`tb.formal.steps`)."""
        return "gates" if self.of in GATES else "sby" if self.has("prove") else "steps"

    @property
    def files(self) -> list[Path]:
        """The .sby file, the RTL and the properties."""
        named = re.findall(r"\b(?:rtl|tb/formal)/[\w/]+\.vh?\b", self.config)
        return [FORMAL / f"{self.of}.sby", *(ROOT / name for name in dict.fromkeys(named))]
