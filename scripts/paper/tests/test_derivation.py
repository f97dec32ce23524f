# SPDX-License-Identifier: Apache-2.0
"""Symbolic derivation of the paper: the page is current; errors in the print or the geometry are detected."""

import copy

import pytest
import sympy

from model.reference import cga, geometry
from scripts.paper.derivation import paper as derive
from scripts.paper.derivation import paper_steps
from scripts.paper.derivation.printed import PRINTED, symbols

pytestmark = pytest.mark.cost(60)


@pytest.fixture(scope="module")
def sections():
    return derive.derive()


def rows(sections):
    return {(row.equation, row.name): row for section in sections for row in section.rows}


def test_page_is_up_to_date(sections):
    assert derive.PAGE.read_text(encoding="utf-8") == derive.page(sections), "run `make paper ONLY=derivation`"


def test_verdicts_are_the_known_ones(sections):
    assert derive.unexpected(sections) == []


def test_every_printed_row_is_compared(sections):
    assert set(rows(sections)) == {(equation, name) for equation, table in PRINTED.items() for name in table}


def test_misprint_of_11_is_found_and_mended(sections):
    row = rows(sections)["11", "pi_x"]
    c, p_wy = symbols("c p_wy")
    assert row.verdict == "differs"
    assert sympy.expand(row.difference - 2 * p_wy * c * (c - 1)) == 0, "cos^2 against cos"
    mended = [fact for section in sections for fact in section.facts if fact.equation == "11 mended"]
    assert len(mended) == 2 and all(fact.holds for fact in mended)


SECTION_OF = {
    "10": paper_steps.swivel_plane,
    "11": paper_steps.swivel_plane,
    "12": paper_steps.point_pair,
    "19": paper_steps.sums,
    "13": paper_steps.elbow_point,
    "14": paper_steps.elbow_quaternion,
    "15": paper_steps.rotate_to_elbow,
    "17": paper_steps.rotate_to_wrist,
    "18": paper_steps.product,
}


@pytest.mark.slow
@pytest.mark.parametrize(
    "equation, name, right, wrong",
    [
        ("10", "L_sw", "p_wz**2", "2*p_wz**2"),
        ("11", "pi_z", "-2*", "2*"),
        ("12", "PP_34", "d1**2 - 1", "1 - d1**2"),
        ("12", "PP_i", "+ d1**2 - d2**2", "- d1**2 + d2**2"),
        ("19", "PP_2p", "2*d1**2", "d1**2"),
        ("13", "tmp1", "- PP_34**2", "+ PP_34**2"),
        ("13", "p_ey", "+ tmp_sqr", "- tmp_sqr"),
        ("13", "inf_PP", "(PP_14 - PP_15)", "(PP_14 + PP_15)"),
        ("14", "c_4", "- p_ez*p_wz", "+ p_ez*p_wz"),
        ("14", "qe_i", "-sqrt", "sqrt"),
        ("15", "tmp2", "2*d1**2*p_ex**2*p_ey**2", "d1**2*p_ex**2*p_ey**2"),
        ("15", "q12_j", "d1 - p_ez", "d1 + p_ez"),
        ("17", "c_3", "q12_j*pi_y", "q12_i*pi_y"),
        ("17", "side", "q12_k*p_wz", "q12_k*p_wx"),
        ("17", "q3_k", "1 - c_3", "1 + c_3"),
        ("18", "qs_j", "-(", "("),
    ],
)
def test_an_error_in_print_is_found(equation, name, right, wrong):
    printed = copy.deepcopy(PRINTED)
    assert right in printed[equation][name]
    printed[equation][name] = printed[equation][name].replace(right, wrong, 1)
    section = SECTION_OF[equation](printed)
    row = rows([section])[equation, name]
    assert row.verdict == "differs" and row.difference != 0 and row.method == "a point where they differ"
    assert any(said.startswith(f"({equation}) {name}:") for said in derive.unexpected([section]))


def other_way_round(function, first, second):
    """Return the function with two of its arguments exchanged."""

    def exchanged(*arguments):
        arguments = list(arguments)
        arguments[first], arguments[second] = arguments[second], arguments[first]
        return function(*arguments)

    return exchanged


@pytest.mark.slow
@pytest.mark.parametrize(
    "name, spoiled, section",
    [
        ("swivel_plane", lambda f: lambda P_w, phi: f(P_w, -phi), paper_steps.swivel_plane),
        ("elbow_point_pair", lambda f: other_way_round(f, 2, 3), paper_steps.point_pair),
        ("elbow_point", lambda f: lambda PP: f(-PP), paper_steps.elbow_point),
        ("elbow_quaternion", lambda f: other_way_round(f, 0, 1), paper_steps.elbow_quaternion),
        ("elbow_rotation", lambda f: lambda P_e, d1: f(P_e, 2 * d1), paper_steps.rotate_to_elbow),
        ("wrist_rotation", lambda f: lambda Q, plane, P_w: f(Q, -plane, P_w), paper_steps.rotate_to_wrist),
    ],
)
def test_an_error_in_the_geometry_is_found(monkeypatch, name, spoiled, section):
    monkeypatch.setattr(geometry, name, spoiled(getattr(geometry, name)))
    assert derive.unexpected([section(PRINTED)])


@pytest.mark.slow
def test_an_error_in_the_algebra_is_found(monkeypatch):
    half_angle = cga.half_angle
    monkeypatch.setattr(cga, "half_angle", lambda cosine: half_angle(cosine)[::-1])
    assert derive.unexpected([paper_steps.elbow_quaternion(PRINTED)])


def test_command_writes_the_page(tmp_path, monkeypatch, sections):
    monkeypatch.setattr(derive, "derive", lambda: sections)
    monkeypatch.setattr(derive, "PAGE", tmp_path / "derivation.md")
    assert derive.write() == 0
    assert derive.PAGE.read_text(encoding="utf-8") == derive.page(sections)
