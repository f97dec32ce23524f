# SPDX-License-Identifier: Apache-2.0
"""Step 12 of docs/generated/lean.md: the operations of the lean form and of the matrix form."""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from scripts.derive.lean_forms import (
    TEX,
    Tables,
    line_tex,
    lines,
    rsqrt,
    symbols,
    tree,
)  # fmt: skip
from scripts.derive.lean_proofs import (
    Relations,
    Step,
    rotation_matrix,
    run_lines,
)  # fmt: skip


@dataclass(frozen=True)
class Ops:
    """Numbers of operations. Signs, absolute values and factors of 2 and 1/2 are wiring."""

    mul: int = 0
    add: int = 0
    root: int = 0

    def __add__(self, other: Ops) -> Ops:
        return Ops(self.mul + other.mul, self.add + other.add, self.root + other.root)


def operations(expression: sp.Expr) -> Ops:
    """The operations of one expression tree."""
    if expression.is_Symbol or expression.is_Number:
        return Ops()
    inside = sum((operations(a) for a in expression.args), Ops())
    if expression.is_Add:
        return inside + Ops(add=len(expression.args) - 1)
    if expression.is_Mul:
        return inside + Ops(mul=max(sum(not a.is_number for a in expression.args) - 1, 0))
    if expression.is_Pow and expression.args[1] == 2:
        return inside + Ops(mul=1)
    if expression.is_Pow and expression.is_number:  # 1/2
        return Ops()
    if isinstance(expression, rsqrt):
        return inside + Ops(root=1)
    if isinstance(expression, sp.Abs):
        return inside
    raise ValueError(f"no rule for {expression}")


def _factors_flat(expression: sp.Expr) -> sp.Expr:
    """The tree with products of products as one product, as operations() wants them."""
    if not expression.args:
        return expression
    arguments = [_factors_flat(a) for a in expression.args]
    if expression.is_Mul:
        arguments = [f for a in arguments for f in (a.args if a.is_Mul else (a,))]
    return expression.func(*arguments, evaluate=False)


def count(table: dict[str, str]) -> Ops:
    """The lines as they are written."""
    return sum((operations(_factors_flat(tree(text))) for text in table.values()), Ops())


def count_shared(table: dict[str, str]) -> Ops:
    """The lines after sympy.cse over all of them at once."""
    common, rest = sp.cse([tree(text).doit() for text in table.values()], order="canonical")
    return sum((operations(e) for e in [e for _, e in common] + rest), Ops())


def counts(tables: Tables) -> Step:
    r = symbols("r_w r_i r_j r_k")
    turned = rotation_matrix(r)
    step = Step("12. Operations")
    values = {f"{v}_{axis}": (-1 if v == "n" else 1) * turned[m, column]
              for v, column in (("n", 0), ("f", 1), ("e", 2)) for m, axis in enumerate("xyz")}  # fmt: skip
    sums = run_lines(tables.matrix, ["Four sums and what goes with them"], values)
    unit: Relations = {"|r|^2 = 1": (r[0], 1 - r[1] ** 2 - r[2] ** 2 - r[3] ** 2)}
    parts = dict(zip("wijk", r, strict=True))
    for name in tables.matrix["Four sums and what goes with them"]:
        a, b = (name[-1], name[-1]) if name.startswith("sum_") else name.split("_")
        right = f"4 r_{a}^2" if a == b else f"4 r_{a} r_{b}"
        step.equal(f"{TEX[name]} = {line_tex(lines(tables.matrix)[name])} = {right}", sums[name],
                   4 * parts[a] * parts[b], unit)  # fmt: skip
    # The row of the largest sum 4 r_a^2 is (4 r_a^2, 4 r_a r_b, ...): over twice the sum's root, r but for its sign.
    row = dict(zip(("largest", "other_1", "other_2", "other_3"), [4 * r[0] * v for v in r], strict=True))
    result = run_lines(tables.matrix, ["The row of the largest sum"], row | {"g_q": 1 / (2 * r[0])})
    step.equal(r"(q_0, q_1, q_2, q_3) = (r_w, r_i, r_j, r_k) \text{ of the row of } \Sigma_w,\ g_\Sigma = 1/(2 r_w)",
               [result[f"q_{n}"] for n in range(4)], list(r))  # fmt: skip

    def rows(table: dict, groups: list[str], title: str) -> Ops:
        total = Ops()
        for group in groups:
            one = count(table[group])
            total += one
            step.extra.append(f"| {group} | {one.mul} | {one.add} | {one.root} |")
        step.extra.append(f"| **{title}** | {total.mul} | {total.add} | {total.root} |")
        return total

    step.extra += ["| lines | x | +, - | reciprocal roots |", "| --- | --: | --: | --: |"]
    own = ["Lengths of the half angle quaternions, squared", "Product", "Root, second level"]
    chosen = ["Half angle quaternions", "Half the swivel angle"]  # choices, and what both forms look up
    head = [group for group in tables.lean if group not in own + chosen]
    both = rows(tables.lean, head, "both forms, to the triangle")
    lean = rows(tables.lean, own, "shoulder, lean form")
    matrix = rows(tables.matrix, list(tables.matrix), "shoulder, matrix form")
    shared = []
    for name, table, groups, head, plain in (
        ("lean form", tables.lean, own, both, lean), ("matrix form", tables.matrix, list(tables.matrix), both, matrix)
    ):  # fmt: skip
        less = count_shared({n: text for group in groups for n, text in table[group].items()})
        shared.append(less)
        for label, ops in ((f"{name}, whole", head + plain), (f"{name}, whole, common subexpressions", head + less)):
            step.extra.append(f"| {label} | {ops.mul} | {ops.add} | {ops.root} |")
    step.true(
        rf"\text{{the lean form has }} {shared[1].mul - shared[0].mul} \text{{ multiplications and }} "
        rf"{shared[1].add - shared[0].add} \text{{ additions less}}",
        shared[0].mul < shared[1].mul and shared[0].add < shared[1].add and shared[0].root == shared[1].root,
        "counts with common subexpressions (`sympy.cse`), as many roots",
    )  # fmt: skip
    return step
