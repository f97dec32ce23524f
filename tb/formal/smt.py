# SPDX-License-Identifier: Apache-2.0
"""SMT-LIB formulas, with declarations of all names, and a translator from Python expressions."""

import ast
import re
from collections.abc import Callable, Sequence
from fractions import Fraction

from model.dataflow.expressions import number

WORDS = {"and", "or", "not", "ite", "true", "false"}  # reserved words of SMT-LIB
COMPARISONS = {ast.Lt: "<", ast.LtE: "<=", ast.GtE: ">=", ast.Eq: "="}


def formula(facts: Sequence[str], goal: str, sort: Callable[[str], str] = lambda name: "Int") -> str:
    """Return the formula "all facts hold and the goal does not"; each name is declared with its ``sort``."""
    names = sorted({name for text in (goal, *facts) for name in re.findall(r"[A-Za-z]\w*", text)} - WORDS)
    lines = [f"(declare-const {name} {sort(name)})" for name in names]
    return "\n".join([*lines, *(f"(assert {fact})" for fact in facts), f"(assert (not {goal}))"])


def smt(
    tree: str | ast.AST, constant: Callable[[Fraction], str] = number, name: Callable[[str], str] = lambda text: text
) -> str:
    """Return a Python expression in SMT-LIB: arithmetic, comparisons, logic, ``implies(a, b)``. ``constant`` formats
    numbers, ``name`` formats names. Raises SyntaxError, or KeyError for an unsupported comparison."""

    def term(tree: ast.AST) -> str:
        match tree:
            case ast.Name() | ast.Attribute() | ast.Subscript():
                return name(ast.unparse(tree))
            case ast.Constant(value):
                return constant(Fraction(str(value)))
            case ast.BinOp(ast.Constant(high), ast.Div(), ast.Constant(low)):
                return constant(Fraction(high, low))
            case ast.BinOp(base, ast.Pow(), ast.Constant(2)):
                return f"(* {term(base)} {term(base)})"
            case ast.BinOp(base, ast.LShift(), ast.Constant(places)):
                return f"(* {term(base)} {constant(Fraction(1 << places))})"
            case ast.BinOp(base, ast.LShift(), ast.Name() as power):  # base << n, where the term of n is 2^n
                return f"(* {term(base)} {term(power)})"
            case ast.BinOp(_, ast.Add() | ast.Mult() as kind, _):
                operands = " ".join(map(term, _operands(tree, type(kind))))
                return f"({'+' if isinstance(kind, ast.Add) else '*'} {operands})"
            case ast.BinOp(left, ast.Sub(), right):
                return f"(- {term(left)} {term(right)})"
            case ast.UnaryOp(ast.USub(), part):
                return f"(- {term(part)})"
            case ast.UnaryOp(ast.Invert(), part):
                return f"(- (- 1) {term(part)})"
            case ast.UnaryOp(ast.Not(), part):
                return f"(not {term(part)})"
            case ast.Compare(left, [relation], [right]):
                return f"({COMPARISONS[type(relation)]} {term(left)} {term(right)})"
            case ast.BoolOp(kind, parts):
                return f"({'and' if isinstance(kind, ast.And) else 'or'} {' '.join(map(term, parts))})"
            case ast.IfExp(test, yes, no):
                return f"(ite {term(test)} {term(yes)} {term(no)})"
            case ast.Call(ast.Name("implies"), [left, right]):
                return f"(=> {term(left)} {term(right)})"
        raise SyntaxError(f"no formula for {ast.unparse(tree)}")

    return term(ast.parse(tree, mode="eval").body if isinstance(tree, str) else tree)


def _operands(tree: ast.AST, kind: type) -> list[ast.AST]:
    """Return the terms of a sum, or the factors of a product."""
    if isinstance(tree, ast.BinOp) and isinstance(tree.op, kind):
        return [*_operands(tree.left, kind), *_operands(tree.right, kind)]
    return [tree]


def word(name: str, width: int) -> str:
    """Return the SMT-LIB condition that the integer ``name`` fits a signed word of ``width`` bits."""
    return f"(<= (- {1 << width - 1}) {name} {(1 << width - 1) - 1})"
