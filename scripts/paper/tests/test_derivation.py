# SPDX-License-Identifier: Apache-2.0
"""Symbolic derivations: the pages are current; errors in print, geometry, algebra and lean equations are detected."""

import pytest

from model.reference import cga, geometry
from model.reference.lean_equations import HALF, LEAN, NUMBER
from scripts.paper import derivation
from scripts.paper.derivation import lean, paper, proofs
from scripts.paper.derivation.lean import MATRIX
from scripts.paper.derivation.proofs import PRINTED, Step, derive, failures

pytestmark = pytest.mark.cost(60)


@pytest.mark.parametrize("name", derivation.STEPS)
def test_all_statements_hold_and_the_page_is_up_to_date(name):
    steps = derive(derivation.STEPS[name])
    assert failures(steps) == []
    assert all(step.checks for step in steps.values())
    if name == "derivation":
        every_row = {proofs.name_tex(row) for rows in PRINTED.values() for row in rows}
        assert {row for step in steps.values() for row in step.printed} == every_row
    text = (derivation.GENERATED / f"{name}.md").read_text(encoding="utf-8")
    assert text == derivation.page(name, steps), "run `make paper ONLY=derivation`"


def replace(monkeypatch, table, name, right, wrong):
    lines = next(lines for lines in table.values() if name in lines)
    assert right in lines[name]
    monkeypatch.setitem(lines, name, lines[name].replace(right, wrong, 1))


@pytest.mark.slow
@pytest.mark.parametrize(
    "name, right, wrong, steps",
    [
        ("l_sw", "p_w_z**2", "2*p_w_z**2", [paper.swivel_plane, lean.directions]),
        ("pi_swivel_x", "*cos(phi/2))", "*sin(phi/2))", [paper.swivel_plane, lean.swivel]),
        ("pi_swivel_z", "-2*", "2*", [paper.swivel_plane, lean.swivel]),
        ("pp_34", "d1**2 - 1", "1 - d1**2", [paper.point_pair]),
        ("pp_i", "+ d1**2 - d2**2", "- d1**2 + d2**2", [paper.point_pair, lean.elbow]),
        ("pp_2_plus", "2*d1**2", "d1**2", [paper.sums]),
        ("tmp1", "- pp_34**2", "+ pp_34**2", [paper.elbow_point, lean.elbow]),
        ("p_e_y", "+ tmp_sqr", "- tmp_sqr", [paper.elbow_point, lean.elbow]),
        ("inf_pp", "(pp_14 - pp_15)", "(pp_14 + pp_15)", [paper.elbow_point]),
        ("c4", "- p_e_z*p_w_z", "+ p_e_z*p_w_z", [paper.elbow_quaternion, lean.elbow_quaternion]),
        ("qe_i", "-sqrt", "sqrt", [paper.elbow_quaternion, lean.elbow_quaternion]),
        ("tmp2", "2*d1**2*p_e_x**2*p_e_y**2", "d1**2*p_e_x**2*p_e_y**2", [paper.rotate_to_elbow, lean.shoulder]),
        ("q12_j", "d1 - p_e_z", "d1 + p_e_z", [paper.rotate_to_elbow, lean.shoulder]),
        ("c3", "q12_j*pi_swivel_y", "q12_i*pi_swivel_y", [paper.rotate_to_wrist, lean.shoulder]),
        ("sign_raw", "q12_k*p_w_z", "q12_k*p_w_x", [paper.rotate_to_wrist, lean.shoulder]),
        ("q3_k", "1 - c3", "1 + c3", [paper.rotate_to_wrist, lean.shoulder]),
        ("qs_j", "-(", "(", [paper.product, lean.shoulder]),
    ],
)
def test_an_error_in_print_is_found(monkeypatch, name, right, wrong, steps):
    replace(monkeypatch, PRINTED, name, right, wrong)
    for step in steps:
        assert failures(derive([step])), step.__name__


def test_the_misprint_of_11_does_not_pass(monkeypatch):
    monkeypatch.setattr(proofs, "MISPRINTS", {})
    assert failures(derive([paper.swivel_plane])) and failures(derive([lean.swivel]))


STEPS_OF = {
    "Lengths of the half angle quaternions, squared": [lean.length],
    "Product": [lean.product],
    "Root, second level": [lean.length],
}
CHOICES = {*LEAN["Half angle quaternions"], *LEAN["Half the swivel angle"]}


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in NUMBER if name not in CHOICES])
def test_a_doubled_lean_line_is_found(monkeypatch, name):
    group = next(group for group, lines in LEAN.items() if name in lines)
    monkeypatch.setitem(LEAN[group], name, f"2*({LEAN[group][name]})")
    assert failures(derive(STEPS_OF.get(group, [lean.directions, lean.elbow_quaternion])))


@pytest.mark.slow
@pytest.mark.parametrize(
    "name, right, wrong, step",
    [
        ("v_y", "sin_el", "cos_el", lean.swivel),
        ("n_y", "-", "+", lean.factors),
        ("m_x", "-", "+", lean.elbow),
        ("e_z", "p_z", "-p_z", lean.factors),
        ("f_x", "-", "+", lean.factors),
        ("sum_k", "- f_y", "+ f_y", lean.counts),
        ("j_k", "+", "-", lean.counts),
        ("q_2", "/2", "", lean.counts),
    ],
)
def test_an_error_in_the_matrix_form_is_found(monkeypatch, name, right, wrong, step):
    replace(monkeypatch, MATRIX, name, right, wrong)
    assert failures(derive([step]))


@pytest.mark.parametrize("branch", HALF)
def test_an_error_in_half_is_found(monkeypatch, branch):
    monkeypatch.setitem(HALF, branch, HALF[branch][::-1])
    assert failures(derive([lean.half])) and failures(derive([lean.product]))


@pytest.mark.slow
@pytest.mark.parametrize(
    "name, line, wrong",
    [
        ("Sums of the inputs", "a_far", "d_sum**2/3 - s"),
        ("Sums of the inputs", "s", "rho_sq - z**2"),
        ("Directions", "u_x", "x*inv_rho + y"),
        ("Product", "k_1", "k_0*arm_c + j_0*arm_s*arm_s"),
    ],
)
def test_a_line_that_loses_digits_is_found(monkeypatch, name, line, wrong):
    monkeypatch.setitem(LEAN[name], line, wrong)
    assert failures(derive([lean.near_singular]))


@pytest.mark.slow
@pytest.mark.parametrize(
    "name, spoiled, step",
    [
        ("swivel_plane", lambda f: lambda P_w, phi: f(P_w, -phi), paper.swivel_plane),
        ("elbow_point_pair", lambda f: lambda P_w, plane, d1, d2: f(P_w, plane, d2, d1), paper.point_pair),
        ("elbow_point", lambda f: lambda PP: f(-PP), paper.elbow_point),
        ("elbow_quaternion", lambda f: lambda P_e, P_w: f(P_w, P_e), paper.elbow_quaternion),
        ("elbow_rotation", lambda f: lambda P_e, d1: f(P_e, 2 * d1), paper.rotate_to_elbow),
        ("wrist_rotation", lambda f: lambda Q, plane, P_w: f(Q, -plane, P_w), paper.rotate_to_wrist),
    ],
)
def test_an_error_in_the_geometry_is_found(monkeypatch, name, spoiled, step):
    monkeypatch.setattr(geometry, name, spoiled(getattr(geometry, name)))
    assert failures(derive([step]))


def test_reversed_turns_are_found(monkeypatch):
    turn = lean.turn
    monkeypatch.setattr(lean, "turn", lambda axis, c, s: turn(axis, c, -s))
    assert failures(derive([lean.factors])) and failures(derive([lean.product]))


@pytest.mark.slow
def test_an_error_in_the_algebra_is_found(monkeypatch):
    half_angle, rotate = cga.half_angle, cga.rotate
    monkeypatch.setattr(cga, "half_angle", lambda cosine: half_angle(cosine)[::-1])
    assert failures(derive([paper.elbow_quaternion]))
    monkeypatch.setattr(cga, "rotate", lambda q, v: rotate(q.reverse(), v))
    for step in (lean.shoulder, lean.product, lean.counts):
        assert failures(derive([step])), step.__name__


def test_relations_and_roots_count_only_where_they_are_given():
    step = Step()
    c, s = proofs.symbols("c s")
    step.prove("c**2 + s**2 = 1", "sqrt(c**2) = c")
    step.suppose("s**2 = 1 - c**2")
    step.roots = {c: c**2}
    step.prove("c**2 + s**2 = 1", "sqrt(1 - s**2) = c", "vec(c, s) = vec(c, c)")
    assert [bool(check.wrong) for check in step.checks] == [True, True, False, False, True]
    assert [len(check.used) for check in step.checks] == [0, 0, 1, 1, 0]
    step.refute("c = s", {"c": "3/5"})
    step.refute("c**2 + s**2 = 1", {"c": "3/5"})
    assert [bool(check.wrong) for check in step.checks[-2:]] == [False, True]
    with pytest.raises(AssertionError, match="not on a relation"):
        step.refute("c = s", {"c": "3/5", "s": "3/5"})


def test_an_operation_that_the_table_does_not_show_is_not_counted_as_free(monkeypatch):
    monkeypatch.setitem(LEAN["Root, second level"], "length_sq", "az_sq*tilt_sq*cos(arm_sq)")
    with pytest.raises(AssertionError, match="second level: what the table does not show"):
        lean.counts(Step())


def test_a_false_statement_fails_the_command_and_leaves_the_page(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(derivation, "GENERATED", tmp_path)
    monkeypatch.setattr(derivation, "STEPS", {"lean": [lean.product]})
    monkeypatch.setitem(LEAN["Product"], "k_1", "k_0*arm_c - j_0*arm_s")
    assert derivation.write() == 1
    assert "step product: lean = algebra: does not hold" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
