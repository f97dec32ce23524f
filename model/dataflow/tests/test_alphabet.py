# SPDX-License-Identifier: Apache-2.0
"""Tests that the lean table, the lean dataflow and rtl/lean give the same names the same numbers."""

import re
from pathlib import Path

import numpy as np

from model.dataflow import fixed
from model.dataflow.datapaths import DATAPATHS
from model.reference.lean_equations import NUMBER

LEAN = DATAPATHS["lean"]
ROOT = Path(__file__).parents[3]
NODES = fixed.run(np.array([[1 << 29] * 6]), 32, "lean").bits.nodes

DECLARED = re.compile(
    r"^\s*(?:output\s+)?(?:wire|reg)\s+(?:signed\s+)?(?:\[[^]]*\]\s*)?(?P<name>\w+)[^/\n]*(?://(?P<comment>.*))?$",
    re.MULTILINE,
)
"""Declaration of an output, a wire or a register, and the comment after it."""


def numbers(section: str) -> dict[str, list[str]]:
    """Return the declarations in the module of a section of rtl/lean: name -> the numbers in its comment."""
    text = (ROOT / LEAN.folder / f"{LEAN.module(section)}.v").read_text(encoding="utf-8")
    return {m["name"]: re.findall(r"\(L\d+\)", m["comment"] or "") for m in DECLARED.finditer(text)}


def test_every_line_is_the_node_of_its_name():
    assert {name: NODES[name].equation for name in NUMBER if name in NODES} == NUMBER


def test_a_node_has_a_number_of_the_table_or_is_a_decision():
    for node in NODES.values():
        decision = node.format.width == 1 and not node.equation
        assert node.equation in NUMBER.values() or decision or node.op == "input", f"{node.name}: {node.equation!r}"


def test_the_verilog_has_each_number_at_the_nodes_declaration():
    for section in LEAN.sections:
        if section == "results":  # has no module
            continue
        own = [n for n in NODES.values() if n.section == section and n.operands]
        in_model = {n.name: [n.equation] if n.equation else [] for n in own}
        in_rtl = numbers(section)
        assert in_model == {name: in_rtl.get(name) for name in in_model}, LEAN.module(section)
        extra = {name for name, found in in_rtl.items() if found and name not in in_model}
        assert not extra, f"{LEAN.module(section)}: numbers at what is no node: {extra}"
