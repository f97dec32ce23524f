# SPDX-License-Identifier: Apache-2.0
"""Table 4: counting rules and the page."""

import pytest
import sympy

from model.reference.cga import symbol
from scripts.paper import operations as table4
from scripts.paper.operations import PRINTED, Ops, count

a, b, c = sympy.symbols("a b c", real=True)


@pytest.mark.parametrize(
    ("expression", "ops"),
    [
        (a + b - c, Ops(add=2)),
        (-a, Ops()),
        (-2 * a * b, Ops(mul=1, scale=1)),
        (a**2, Ops(mul=1)),
        (a**3, Ops(mul=2)),
        (a**4, Ops(mul=2)),
        (a / b, Ops(div=1)),
        (a / (b * c), Ops(mul=1, div=1)),
        (1 / b, Ops(div=1)),
        (b**-2, Ops(mul=1, div=1)),
        (a / sympy.sqrt(b), Ops(root=1, div=1)),
        (1 / sympy.sqrt(b), Ops(root=1, div=1)),
        (a / 2, Ops(scale=1)),
        (sympy.cos(a / 2) * b, Ops(mul=1, trig=1)),
        (sympy.Mul(a, 1 / sympy.Abs(a), evaluate=False), Ops(div=1)),
    ],
)
def test_rules(expression, ops):
    assert count(expression) == ops


def test_an_operation_without_a_rule_is_refused():
    with pytest.raises(ValueError, match="exp"):
        count(sympy.exp(a))
    with pytest.raises(ValueError, match="1/3"):
        count(a ** sympy.Rational(1, 3))


def test_substituting_19_changes_no_value():
    plain, with_19 = table4.printed_lines(), table4.lines_with_19()
    sums = {}
    for m in "123":
        minus, plus = symbol(f"pp_{m}4"), symbol(f"pp_{m}5")
        sums |= {symbol(f"pp_{m}_plus"): plus + minus, symbol(f"pp_{m}_minus"): plus - minus}
    for name in PRINTED["(13)"]:
        assert sympy.simplify(with_19[name].doit().subs(sums) - plain[name].doit()) == 0, name


def test_page_is_up_to_date():
    assert table4.PAGE.read_text() == table4.page(), "run `make paper ONLY=operations`"
