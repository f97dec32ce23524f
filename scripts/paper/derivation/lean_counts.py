# SPDX-License-Identifier: Apache-2.0
"""Step 12 of docs/generated/lean.md: operation counts of the lean form and the matrix form."""

from __future__ import annotations

from scripts.paper.derivation.lean_forms import TEX, Tables, line_tex, lines, symbols, tree
from scripts.paper.derivation.lean_proofs import Relations, Step, rotation_matrix, run_lines
from scripts.paper.operations import Ops, shared, total


def count(table: dict[str, str]) -> Ops:
    """Count the operations of a table's lines as written."""
    return total(tree(text) for text in table.values())


def counts(tables: Tables) -> Step:
    r = symbols("r_w r_i r_j r_k")
    turned = rotation_matrix(r)
    step = Step("12. Operations")
    values = {
        f"{v}_{axis}": (-1 if v == "n" else 1) * turned[m, column]
        for v, column in (("n", 0), ("f", 1), ("e", 2))
        for m, axis in enumerate("xyz")
    }
    sums = run_lines(tables.matrix, ["Four sums and what goes with them"], values)
    unit: Relations = {"|r|^2 = 1": (r[0], 1 - r[1] ** 2 - r[2] ** 2 - r[3] ** 2)}
    parts = dict(zip("wijk", r, strict=True))
    for name in tables.matrix["Four sums and what goes with them"]:
        a, b = (name[-1], name[-1]) if name.startswith("sum_") else name.split("_")
        right = f"4 r_{a}^2" if a == b else f"4 r_{a} r_{b}"
        step.equal(
            f"{TEX[name]} = {line_tex(lines(tables.matrix)[name])} = {right}", sums[name], 4 * parts[a] * parts[b], unit
        )
    # The row of the largest sum 4 r_a^2 is (4 r_a^2, 4 r_a r_b, ...). Divided by twice the sum's root, it is +-r.
    row = dict(zip(("largest", "other_1", "other_2", "other_3"), [4 * r[0] * v for v in r], strict=True))
    result = run_lines(tables.matrix, ["The row of the largest sum"], row | {"g_q": 1 / (2 * r[0])})
    step.equal(
        r"(q_0, q_1, q_2, q_3) = (r_w, r_i, r_j, r_k) \text{ of the row of } \Sigma_w,\ g_\Sigma = 1/(2 r_w)",
        [result[f"q_{n}"] for n in range(4)],
        list(r),
    )

    def rows(table: dict, groups: list[str], title: str) -> Ops:
        whole = Ops()
        for group in groups:
            one = count(table[group])
            assert one == Ops(one.add, one.mul, one.root, 0, one.scale), f"{group}: what the table does not show"
            whole += one
            step.extra.append(f"| {group} | {one.mul} | {one.add} | {one.root} |")
        step.extra.append(f"| **{title}** | {whole.mul} | {whole.add} | {whole.root} |")
        return whole

    step.extra += ["| lines | x | +, - | reciprocal roots |", "| --- | --: | --: | --: |"]
    own = ["Lengths of the half angle quaternions, squared", "Product", "Root, second level"]
    chosen = ["Half angle quaternions", "Half the swivel angle"]  # choices; both forms look up sine and cosine
    head = [group for group in tables.lean if group not in own + chosen]
    both = rows(tables.lean, head, "both forms, to the triangle")
    lean = rows(tables.lean, own, "shoulder, lean form")
    matrix = rows(tables.matrix, list(tables.matrix), "shoulder, matrix form")
    lessened = []
    for name, table, groups, head, plain in (
        ("lean form", tables.lean, own, both, lean),
        ("matrix form", tables.matrix, list(tables.matrix), both, matrix),
    ):
        less = shared({n: tree(text) for group in groups for n, text in table[group].items()})
        lessened.append(less)
        for label, ops in ((f"{name}, whole", head + plain), (f"{name}, whole, common subexpressions", head + less)):
            step.extra.append(f"| {label} | {ops.mul} | {ops.add} | {ops.root} |")
    lean, matrix = lessened
    step.true(
        rf"\text{{the lean form has }} {matrix.mul - lean.mul} \text{{ multiplications and }} "
        rf"{matrix.add - lean.add} \text{{ additions less}}",
        lean.mul < matrix.mul and lean.add < matrix.add and lean.root == matrix.root,
        "counts with common subexpressions (`sympy.cse`), as many roots",
    )
    return step
