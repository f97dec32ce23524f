# SPDX-License-Identifier: Apache-2.0
"""LUT4 of the paper's datapath by its nodes, from word lengths alone: what the search for word lengths goes by.

Counted is what depends on the words: adders and rows have a LUT a bit, a rounding's carry and a constant none. A word
that ends in k zeros is k bits shorter wherever it is used.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from model.dataflow.fixed import SINCOS_GUARD
from model.dataflow.nodes import Node

TILE = 18
"""Bits of a multiplier block's operand; longer words of :file:`ik_mul.v` are cut above their lowest 17."""

CORDIC_MEMORY = 10
"""Iterations of ``ik_sincos`` that come from a memory."""

CARRIED = {
    **dict.fromkeys(("p_e_x", "p_e_y", "p_e_z", "c4", "h4_p", "h4_m", "h3_p", "h3_m", "qe_i", "q3_k"), 1),
    **dict.fromkeys(("m_x", "m_y"), 3),
}
"""Choices that keep the zeros at the end of their first operands, so many of them."""


SATURATING = (
    "k_e", "inf_pp", "pp_sq", "pp_pm", "tmp1", "e_x_num", "e_y_num", "e_z_num", "t_e", "c3_num",
)  # fmt: skip
"""The sums that the RTL does not build with SAT = 0."""


def zeros(nodes: Mapping[str, Node], cuts: Mapping[str, int]) -> dict[str, int]:
    """Node -> zeros that its word ends in."""
    ends: dict[str, int] = {}
    for name, node in nodes.items():
        inherited = 0
        if name in CARRIED or node.op == "normalize":
            words = node.operands[: CARRIED.get(name)]
            inherited = min(ends[word.name] for word in words if word.format.signed)
        ends[name] = max(inherited, cuts.get(name, 0))
    return ends


def readers(nodes: Mapping[str, Node], cut: Iterable[str]) -> list[str]:
    """The nodes whose size depends on how long these are, themselves included."""
    shorter, found = set(cut), []
    for name, node in nodes.items():
        if name in shorter or any(word.name in shorter for word in node.operands):
            found.append(name)
            if name in CARRIED or node.op == "normalize":
                shorter.add(name)
    return found


def luts(nodes: Mapping[str, Node], cuts: Mapping[str, int], of: Iterable[str] | None = None) -> dict[str, float]:
    """Node -> LUT4 of its operator: of all that the model knows, or of some."""
    ends = zeros(nodes, cuts)
    found = {}
    for name in nodes if of is None else of:
        node = nodes[name]
        lost, result = [ends.get(word.name, 0) for word in node.operands], node.format.width - ends[name]
        words = [word.format.width - k for word, k in zip(node.operands, lost, strict=True)]
        if node.op == "mul" and node.section != "guard":
            found[name] = product(words, lost, square=node.operands[0] is node.operands[1])
        elif node.op == "sum":
            found[name] = total(words, result if name in SATURATING else 0)
        elif node.op == "div":
            found[name] = quotient(words[0] if node.operands[0].name else 0, words[1], result)
        elif node.op == "root":
            found[name] = root(result)
        elif name == "sin_h":  # both
            found[name] = rotation(result)
        elif name.startswith("p_e_") or name in ("q3_k", "qe_i"):
            found[name] = result
        elif name.startswith(("h3_", "h4_")):
            found[name] = result + 1
    return found


def product(words: Sequence[int], lost: Sequence[int] = (0, 0), square: bool = False) -> float:
    """Of ``ik_mul``: the sum of the mixed tiles, none in a square, and that of all. ``lost``: zeros below the words."""
    if max(words) <= TILE:
        return 0
    both = sum(words) + sum(lost)
    whole = both - (TILE - 1) - min(lost)
    return whole if square else whole + both / 2 + 1 - max(lost)


def total(words: Sequence[int], saturated: int = 0) -> float:
    """Of ``ik_sum2`` and ``ik_sum3``: an adder is as long as the shorter word; ``saturated``: width of the result."""
    return sum(min(pair) + 1 for pair in zip(words, words[1:], strict=False)) + saturated


def quotient(n: int, d: int, q: int) -> float:
    """Of ``ik_div_digit``: a row a bit of the quotient; magnitude, comparison and sign. ``n`` is 0 for a constant."""
    return (q - 1) * d + q - 1 + d / 2 + n


def root(q: int) -> float:
    """Of ``ik_root_digit``: rows that grow by a bit each."""
    rows = q - 1
    return rows * (rows + 3) / 2 + rows


def rotation(width: int) -> float:
    """Of ``ik_sincos``: the vector's iterations beyond those of the memory, and the angle's."""
    inner = width + SINCOS_GUARD
    return 2 * (width - CORDIC_MEMORY) * inner + sum(inner - k for k in range(width))


def multipliers(nodes: Mapping[str, Node], cuts: Mapping[str, int]) -> int:
    """Multiplier blocks of the products that are nodes."""
    ends = zeros(nodes, cuts)
    count = 0
    for node in nodes.values():
        if node.op == "mul" and node.section != "guard":
            short = all(word.format.width - ends[word.name] <= TILE for word in node.operands)
            count += 1 if short else 3 if node.operands[0] is node.operands[1] else 4
    return count
