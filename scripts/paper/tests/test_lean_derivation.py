# SPDX-License-Identifier: Apache-2.0
"""Derivation of the lean dataflow: the page is current; a wrong line on either side is detected."""

import pytest
import sympy

from model.reference import cga
from model.reference.lean_equations import HALF, LEAN
from scripts.paper.derivation import lean as derive_lean
from scripts.paper.derivation import lean_counts, lean_geometry, lean_quaternion, printed
from scripts.paper.derivation.lean_forms import Tables, symbols
from scripts.paper.derivation.lean_proofs import Step, known_root, turn

pytestmark = pytest.mark.cost(100)


@pytest.fixture(scope="module")
def steps():
    return derive_lean.derive()


def test_page_is_up_to_date(steps):
    assert derive_lean.PAGE.read_text(encoding="utf-8") == derive_lean.page(steps), "run `make paper ONLY=derivation`"


def test_all_statements_hold(steps):
    assert derive_lean.unexpected(steps) == []
    assert len(steps) == 12 and all(step.checks for step in steps), "every step has statements"


STEP_OF = {step.__name__: step for step in derive_lean.STEPS}


def spoil(table, name, right, wrong):
    group = next(lines for lines in table.values() if name in lines)
    assert right in group[name], f"{name} has no {right}"
    group[name] = group[name].replace(right, wrong, 1)


def assert_found(step, tables):
    found = derive_lean.unexpected([STEP_OF[step](tables)])
    assert found and "does not hold" in found[0], "the wrong line passes"


@pytest.mark.slow
@pytest.mark.parametrize(
    "table, name, right, wrong, step",
    [
        ("lean", "d_sum", "+", "-", "directions"),
        ("lean", "d_dif", "-", "+", "directions"),
        ("lean", "rho_sq", "+", "-", "directions"),
        ("lean", "s", "+", "-", "directions"),
        ("lean", "a_far", "-", "+", "directions"),
        ("lean", "b_near", "-", "+", "directions"),
        ("lean", "k_law", "+", "-", "directions"),
        ("lean", "k_law", "+", "-", "elbow"),
        ("lean", "k_law", "+", "-", "elbow_quaternion"),
        ("lean", "inv_rho", "rho_sq", "s", "directions"),
        ("lean", "inv_1", "d1", "d2", "directions"),
        ("lean", "inv_2", "d2", "d1", "elbow_quaternion"),
        ("lean", "u_x", "x", "y", "directions"),
        ("lean", "u_y", "inv_rho", "inv_s", "directions"),
        ("lean", "sin_el", "z", "-z", "directions"),
        ("lean", "root_rho", "inv_rho", "inv_s", "directions"),
        ("lean", "cos_el", "root_rho", "rho_sq", "directions"),
        ("lean", "root_far", "inv_far", "inv_near", "elbow_quaternion"),
        ("lean", "root_near", "b_near", "a_far", "directions"),
        ("lean", "inv_12", "/2", "", "elbow_quaternion"),
        ("lean", "qe_w", "root_far", "-root_far", "elbow_quaternion"),
        ("lean", "qe_i", "-", "", "elbow_quaternion"),
        ("lean", "inv_11", "**2", "", "directions"),
        ("lean", "inv_law", "/2", "", "directions"),
        ("lean", "root_ab", "root_far", "k_law", "directions"),
        ("lean", "sin_a", "root_ab", "root_far", "directions"),
        ("lean", "u_x", "x*inv_rho", "x*inv_rho + y", "near_singular"),
        ("lean", "s", "+", "-", "near_singular"),
        ("lean", "rho_sq", "+", "-", "near_singular"),
        ("lean", "a_far", "d_sum**2", "d_sum**2/3", "near_singular"),
        ("lean", "a_far", "d_sum**2", "d_dif**2", "near_singular"),
        ("lean", "b_near", "d_dif", "d_sum", "near_singular"),
        ("lean", "az_sq", "+", "-", "length"),
        ("lean", "tilt_sq", "sin_el", "cos_el", "length"),
        ("lean", "arm_sq", "/2", "", "length"),
        ("lean", "cc", "az_c", "az_s", "product"),
        ("lean", "ss", "sin_h", "cos_h", "product"),
        ("lean", "sc", "az_s", "-az_s", "product"),
        ("lean", "cs", "az_c", "-az_c", "product"),
        ("lean", "c_plus", "-", "+", "product"),
        ("lean", "c_plus", "-", "+", "length"),
        ("lean", "s_plus", "+", "-", "product"),
        ("lean", "c_minus", "+", "-", "product"),
        ("lean", "s_minus", "-", "+", "product"),
        ("lean", "w_0", "tilt_c", "tilt_s", "product"),
        ("lean", "i_0", "c_minus", "c_plus", "product"),
        ("lean", "j_0", "s_minus", "s_plus", "product"),
        ("lean", "k_0", "tilt_c", "tilt_s", "product"),
        ("lean", "w_1", "+", "-", "product"),
        ("lean", "i_1", "-", "+", "product"),
        ("lean", "j_1", "-", "+", "product"),
        ("lean", "k_1", "+", "-", "product"),
        ("lean", "k_1", "+", "-", "length"),
        ("lean", "k_1", "j_0*arm_s", "j_0*arm_s*arm_s", "near_singular"),
        ("lean", "length_sq", "*arm_sq", "", "length"),
        ("lean", "qs_i", "i_1", "j_1", "length"),
        ("lean", "qs_k", "k_1", "-k_1", "length"),
        ("matrix", "p_x", "u_x", "u_y", "elbow"),
        ("matrix", "v_y", "sin_el", "cos_el", "swivel"),
        ("matrix", "n_x", "+", "-", "swivel"),
        ("matrix", "n_z", "-", "", "swivel"),
        ("matrix", "n_y", "-", "+", "factors"),
        ("matrix", "m_x", "-", "+", "elbow"),
        ("matrix", "m_z", "cos_phi", "-cos_phi", "factors"),
        ("matrix", "e_x", "+", "-", "elbow"),
        ("matrix", "e_z", "sin_el", "-sin_el", "factors"),
        ("matrix", "f_x", "-", "+", "factors"),
        ("matrix", "f_z", "n_x", "n_y", "factors"),
        ("matrix", "sum_w", "- n_x", "+ n_x", "counts"),
        ("matrix", "sum_k", "- f_y", "+ f_y", "counts"),
        ("matrix", "w_j", "+", "-", "counts"),
        ("matrix", "j_k", "+", "-", "counts"),
        ("matrix", "q_2", "/2", "", "counts"),
        ("printed", "10 L_sw", "p_wz**2", "2*p_wz**2", "directions"),
        ("printed", "11 pi_x", "cos(phi/2)**2)", "cos(phi/2))", "swivel"),
        ("printed", "11 pi_z", "-2*", "2*", "swivel"),
        ("printed", "12 PP_i", "- d2**2", "+ d2**2", "elbow"),
        ("printed", "12 PP_25", "1 + d1**2", "1 - d1**2", "elbow"),
        ("printed", "13 inf_PP", "(PP_14 - PP_15)", "(PP_14 + PP_15)", "elbow"),
        ("printed", "13 tmp1", "- PP_34**2", "+ PP_34**2", "elbow"),
        ("printed", "13 p_ey", "+ tmp_sqr", "- tmp_sqr", "elbow"),
        ("printed", "14 c_4", "- p_ez*p_wz", "+ p_ez*p_wz", "elbow_quaternion"),
        ("printed", "14 qe_i", "-sqrt", "sqrt", "elbow_quaternion"),
        ("printed", "14 qe_w", "1 + c_4", "1 - c_4", "elbow_quaternion"),
        ("printed", "15 tmp2", "2*d1**2*p_ex**2*p_ey**2", "d1**2*p_ex**2*p_ey**2", "shoulder"),
        ("printed", "15 q12_j", "d1 - p_ez", "d1 + p_ez", "shoulder"),
        ("printed", "15 q12_k", "+", "-", "shoulder"),
        ("printed", "17 c_3", "q12_j*pi_y", "q12_i*pi_y", "shoulder"),
        ("printed", "17 side", "q12_k*p_wz", "q12_k*p_wx", "shoulder"),
        ("printed", "17 sign", "side", "-side", "shoulder"),
        ("printed", "17 q3_s", "1 + c_3", "1 - c_3", "shoulder"),
        ("printed", "17 q3_k", "1 - c_3", "1 + c_3", "shoulder"),
        ("printed", "18 qs_w", "-", "", "shoulder"),
        ("printed", "18 qs_j", "-(", "(", "shoulder"),
    ],
)
def test_an_error_is_found(table, name, right, wrong, step):
    """An altered line of the lean form, the matrix form or a paper equation fails."""
    tables = Tables()
    *equation, name = name.split()
    spoil({k: lines for k, lines in getattr(tables, table).items() if k in (equation or [k])}, name, right, wrong)
    assert_found(step, tables)


@pytest.mark.parametrize("branch, part", [(branch, part) for branch in HALF for part in (0, 1)])
def test_an_error_in_half_is_found(branch, part):
    tables = Tables()
    pair = list(tables.half[branch])
    pair[part] = f"-({pair[part]})"
    tables.half[branch] = tuple(pair)
    assert_found("half", tables)
    assert_found("product", tables)


def test_the_misprint_of_11_does_not_pass(monkeypatch):
    """The derivation fails without the correction that scripts/paper/derivation/paper.py proves necessary."""
    monkeypatch.setattr(printed, "KNOWN_WRONG", {})
    assert_found("swivel", Tables())


def test_an_error_in_the_turns_is_found(monkeypatch):
    for steps in (lean_geometry, lean_quaternion):
        monkeypatch.setattr(steps, "turn", lambda axis, c, s: turn(axis, c, -s))
    assert_found("factors", Tables())
    assert_found("product", Tables())


@pytest.mark.slow
def test_an_error_in_the_algebra_is_found(monkeypatch):
    rotate = cga.rotate
    monkeypatch.setattr(cga, "rotate", lambda q, v: rotate(q.reverse(), v))
    for step in ("shoulder", "product", "counts"):
        assert_found(step, Tables())


@pytest.mark.slow
def test_no_statement_holds_whatever_its_right_side_is(monkeypatch):
    """Adding 1 to the last component of the right side falsifies every equality."""
    equal = Step.equal

    def off_by_one(self, statement, left, right, *rest, **more):
        right = list(right) if isinstance(right, (list, sympy.MatrixBase)) else [right]
        right[-1] += 1
        left = left if isinstance(left, (list, sympy.MatrixBase)) else [left]
        equal(self, statement, left, right, *rest, **more)

    monkeypatch.setattr(Step, "equal", off_by_one)
    for step in derive_lean.derive():
        for check in step.checks:
            assert check.method.startswith("expansion") <= (not check.holds or "powers, for" in check.method), (
                f"step {step.title}: {check.statement}"
            )


def test_a_relation_is_not_used_where_it_is_not_given():
    c, s = symbols("c s")
    step = Step("a step")
    step.equal("c^2 + s^2 = 1", c**2 + s**2, 1)
    step.equal("c^2 + s^2 = 1", c**2 + s**2, 1, {"c^2 + s^2 = 1": (s, 1 - c**2)})
    step.equal("(c, s) = (c, c)", [c, s], [c, c])
    assert [check.holds for check in step.checks] == [False, True, False]
    assert step.checks[0].rest == "c^{2} + s^{2} - 1"
    root = known_root([c], {})
    assert root(c**2) == c and str(root(c**2 + 1)) == "unrecognized"


@pytest.mark.parametrize(
    "text, expected",
    [
        ("x", (0, 0, 0)),
        ("x**2 + y**2", (2, 1, 0)),
        ("-x*y/2", (1, 0, 0)),
        ("s + d_sum*d_dif", (1, 1, 0)),
        ("x*y*z - 1", (2, 1, 0)),
        ("(1 + Abs(c))/2", (0, 1, 0)),
        ("rsqrt(length_sq)", (0, 0, 1)),
        ("-cos_phi*v_y - sin_phi*u_x", (2, 1, 0)),
        ("inv_1**2*inv_s/2", (2, 0, 0)),
    ],
)
def test_operations_are_counted(text, expected):
    ops = lean_counts.count({"line": text})
    assert (ops.mul, ops.add, ops.root) == expected


def test_an_operation_that_the_table_does_not_show_is_not_counted_as_free():
    tables = Tables()
    spoil(tables.lean, "length_sq", "az_sq", "cos(az_sq)")
    with pytest.raises(AssertionError, match="second level: what the table does not show"):
        lean_counts.counts(tables)


def test_command_writes_the_page(tmp_path, monkeypatch, steps):
    monkeypatch.setattr(derive_lean, "derive", lambda: steps)
    monkeypatch.setattr(derive_lean, "PAGE", tmp_path / "lean.md")
    assert derive_lean.write() == 0
    assert derive_lean.PAGE.read_text(encoding="utf-8") == derive_lean.page(steps)


@pytest.mark.slow
def test_a_wrong_sign_fails_the_command_and_names_the_step(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(derive_lean, "PAGE", tmp_path / "lean.md")
    monkeypatch.setitem(LEAN["Product"], "k_1", "k_0*arm_c - j_0*arm_s")
    assert derive_lean.write() == 1
    said = capsys.readouterr().err
    assert "step 8. The product of the four quaternions: k_1 = " in said and "not written" in said
    assert not derive_lean.PAGE.exists(), "a page with a false statement is not written"
