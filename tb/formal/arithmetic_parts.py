# SPDX-License-Identifier: Apache-2.0
"""The parts of :mod:`tb.formal.arithmetic`, and digests of what they are about."""

from __future__ import annotations

import hashlib

from tb.formal.floors import FLOORS
from tb.formal.lean_proofs import ERRORS, RULES
from tb.formal.paper_rules import PAPER_RULES
from tb.formal.rsqrt_stages import STAGES
from tb.sim.env import ROOT
from tb.sim.sources import digest

ARITHMETIC = (RULES, ERRORS, PAPER_RULES, FLOORS, STAGES)

FILES = (
    *(f"model/dataflow/{name}.py" for name in ("annotations", "lean", "lean_words", "nodes", "cores", "paper",
    "paper_turns", "interval_cases")),
    *(f"model/bounds/{name}.py" for name in ("lean_ranges", "ranges")),
    *(f"tb/formal/{name}.py" for name in ("lean_exact", "lean_rules", "lean_rounded", "paper_rules", "floors",
    "rsqrt_stages")),
    "model/dataflow/quadratic.py",
    *("rtl/lib/ik_rsqrt.v", "rtl/include/ik_rsqrt_table.vh", "rtl/lib/ik_quadratic.v", "rtl/lib/ik_delay.v"),
    "tb/formal/ik_div_digit.vh",
    "tb/formal/ik_root_digit.vh",
)


def digests() -> dict[str, str]:
    """What is proved, a file: a digest of it."""
    found = {name: digest([ROOT / name]) for name in FILES}
    bugs = repr([(part.name, part.bugs) for part in ARITHMETIC])
    return {**found, "questions and seeded bugs": hashlib.sha256(bugs.encode()).hexdigest()[:16]}
