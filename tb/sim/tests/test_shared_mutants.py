# SPDX-License-Identifier: Apache-2.0
"""Seeded bugs that model and RTL would share: wrong tables, constants, formats, roundings.  Both are made from them and
agree, bit for bit; figures of accuracy or a unit test of the model notice."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tb.sim.mutants import Bug, copy_model

FIGURES = "model/bounds/tests/test_figures.py::test_figures[{}]"
RANGES = "model/bounds/tests/test_ranges.py::test_random_targets_stay_inside_the_proved_ranges[extremes-16]"
TABLES = "model/dataflow/tests/test_fixed_primitives.py::test_cordic_tables"


def shared(what: str, file: str, old: str, new: str, notices: str) -> Bug:
    """`notices`: a group of figures, or a test."""
    return Bug(what, f"model/dataflow/{file}.py", old, new, notices if "::" in notices else FIGURES.format(notices))


def in_form(what: str, file: str, form: str, old: str, new: str, notices: str) -> Bug:
    """In the words of a table."""
    return shared(what, file, form, form.replace(old, new, 1), notices)


ROOTS = "LONG = Form(1024, 34, 6, (34, 23, 12), (33, 24, 15), 25, 9, 36)"
STRAIGHT = "SHORT = Form(2048, 25, 0, (27, 14), (26, 15), 14, 0, 28)"
FEW = "SMALL = Form(512, 33, 8, (33, 22, 11), (32, 23, 14), 24, 10, 34)"
SINES = "LONG = Form(1024, 31, 4, (34, 23, 12), (35, 24, 13), 25, 9, 36)"
SINES_STRAIGHT = "SHORT = Form(2048, 25, 0, (27, 14), (28, 15), 14, 0, 28)"
SINES_FEW = "SMALL = Form(512, 31, 7, (33, 22, 11), (34, 23, 12), 24, 10, 34)"
ROWS = "return tuple(words(form, root, segment(form, row)) for row in range(form.rows))"
GAIN = "for i in range(100)"
ARMS = """    fine = Format(f.frac + 2, f.frac + 1, "FRAC + 1")
    L(21).mul3("inv_12_raw", n["inv_1"], n["inv_2"], Format(f.frac + 3, f.frac + 1, "FRAC + 1"), within=INVERSES)
    limited(d, f, "inv_12", INVERSES, fine, ONE)

    arms, down = Count((1, -1, -1), 2 + f.odd), Shift(3, -1, left=2)"""
LESS = 'Format(f.frac + 1, f.frac - 1, "FRAC - 1")'
LEADING = "np.minimum.reduce([room(u, width) for u in v])"

MUTANTS = [
    # the table of the reciprocal root, and what is computed from it
    in_form("root: c2 a bit shorter", "cores", ROOTS, "12), (33, 24, 15", "11), (33, 24, 14", "rsqrt-31"),
    in_form("root: c1 a bit shorter", "cores", ROOTS, "23, 12), (33, 24", "22, 12), (33, 23", "rsqrt-31"),
    in_form("root: slope a bit shorter", "cores", ROOTS, "25, 9", "24, 8", "rsqrt-31"),
    in_form("root: sum a bit shorter", "cores", ROOTS, "36)", "35)", "rsqrt-31"),
    in_form("root: u's tile a bit shorter", "cores", ROOTS, "34, 6", "34, 7", "rsqrt-31"),
    in_form("straight root: c0 a bit shorter", "cores", STRAIGHT, "(27, 14), (26", "(26, 14), (25", "rsqrt-22"),
    in_form("straight root: half the rows", "cores", STRAIGHT, "2048", "1024", "rsqrt-22"),
    in_form("small root: c0 a bit shorter", "cores", FEW, "(33, 22, 11), (32", "(32, 22, 11), (31", "rsqrt-29-small"),
    shared("root: a row twice", "cores", ROWS, ROWS.replace("row)) for", "row - (row == 400))) for"), "rsqrt-31"),
    shared("root: c2 truncated", "cores",
        ROWS, f"return tuple((*w[:2], *(c & -2 for c in w[2:])) for w in {ROWS[12:]})", "rsqrt-31"),
    shared("root: a quarter of a place too large", "cores",
        "return 1 / (2 * mpmath.sqrt(m))", "return 1 / (2 * mpmath.sqrt(m)) + mpmath.mpf(2) ** -33", "rsqrt-31"),
    shared("root: half a place added", "cores",
        "(3 << form.sum_frac - frac - 3)", "(1 << form.sum_frac - frac - 1)", "rsqrt-24"),
    shared("root: nothing added for tiles", "cores", " - (form.tiles + 1) // 2", "", "rsqrt-29-small"),
    shared("straight roots of 24 bits", "cores", "SHORT_FRAC = 22", "SHORT_FRAC = 24", "rsqrt-24"),
    shared("mantissa: last bit lost", "cores",
        "((value >> down) << up).astype(np.int64)", "((value >> down) << up).astype(np.int64) & -2", "lean-32-nodes"),
    shared("root: below 1/4 as it is", "cores", "np.where(m < second, m | second, m)", "m", "lean-24-nodes"),
    shared("root: rows from 1/2 on", "cores", "lower = m < 1 <<", "lower = m <= 1 <<", "rsqrt-31"),
    # products
    shared("product: no guess", "cores", "(guess << up >> 4)", "0 * guess", "lean-30"),
    shared("product: cut off", "cores", "return outer + mid + 1 >> 2", "return outer + mid - 1 >> 2", "lean-23"),
    shared("product: a carry less", "cores", "b_hi >> drop - b_bits) + 1", "b_hi >> drop - b_bits)", "lean-24"),
    shared("product: tiles of 17 bits", "cores", "b_width - min(tile, 18), 0", "b_width - min(tile, 17), 0", "lean-30"),
    shared("product: two bits not looked at", "cores",
        "max(a_width - 2 * tile + 1, 0)", "max(a_width - 2 * tile + 3, 0)", "lean16-24"),
    shared("product: tiles of 15 bits", "datapaths", "16, widths=range(16", "15, widths=range(16", "lean16-24"),
    # both tables
    shared("c1, c2 rounded down", "quadratic", "nint(abs(value) * 2**frac)", "floor(abs(value) * 2**frac)", "trig-31"),
    shared("c0 rounded down", "quadratic", "mpmath.nint(c0 * 2", "mpmath.floor(c0 * 2", "trig-31"),
    shared("c0 corrected the wrong way", "quadratic", "c0 -= (", "c0 += (", "trig-29-small"),
    shared("c0 not corrected", "quadratic", "segment[1] ** 2 / 8", "segment[1] ** 2 * 0", "rsqrt-31"),
    shared("nodes too far apart", "quadratic", "/ 4 * width", "/ 3.8 * width", "rsqrt-29-small"),
    shared("straight lines through the middle", "quadratic", "[(low + high) / 2,", "[function(middle),", "trig-23"),
    shared("a tile of slope times u lost", "quadratic",
        " + (slope_lo * u_hi >> drop + form.slope_low)", "", "rsqrt-31"),
    shared("tables from 36 bits", "quadratic", "PRECISION = 200", "PRECISION = 36", "trig-31"),
    # the table of sines
    in_form("sine: c2 a bit shorter", "trig", SINES, "12), (35, 24, 13", "11), (35, 24, 12", "trig-31"),
    in_form("sine: half the rows", "trig", SINES, "1024", "512", "trig-31"),
    in_form("straight sine: c0 a bit shorter", "trig", SINES_STRAIGHT, "(27, 14), (28", "(26, 14), (27", "trig-23"),
    in_form("small sine: c1 a bit shorter", "trig", SINES_FEW, "22, 11), (34, 23", "21, 11), (34, 22", "trig-29-small"),
    shared("sine: a row twice", "trig", "segment(form, row)) for", "segment(form, row - (row == 400))) for", "trig-31"),
    shared("sine: cut off", "trig", "y + (1 << dropped - 1) >> dropped", "y >> dropped", "trig-19"),
    shared("sine: pi of 25 bits", "trig",
        "sin(mpmath.pi / 2 * t)", "sin(mpmath.mpf(52707178) / 2**25 * t)", "trig-31"),
    shared("sine: a quarter turn", "trig", "a >> below, form.rows - 1)", "a >> below, form.rows - 2)", "trig-31"),
    shared("straight sines of 25 bits", "trig", "SHORT_FRAC = 23", "SHORT_FRAC = 25", "trig-25"),
    shared("sines of 30 bits", "trig", "FRACS = range(19, 32)", "FRACS = range(19, 31)", "lean-32"),
    # words of the lean datapath
    shared("roots of 21 bits", "nodes", "ROOT_FRACS = 22, 31", "ROOT_FRACS = 21, 31", "lean-18"),
    shared("roots of 30 bits", "nodes", "ROOT_FRACS = 22, 31", "ROOT_FRACS = 22, 30", "lean-32"),
    shared("inner words of 32 bits", "nodes", "INNER_FRAC = 33", "INNER_FRAC = 32", "lean-31"),
    shared("inner words a bit shorter", "nodes", "effective_width(width) + 5", "effective_width(width) + 4", "lean-21"),
    shared("short roots at 19 bits", "nodes", "if width <= 18", "if width <= 19", "lean-19"),
    shared("inv_12 a bit shorter", "lean",
        ARMS, ARMS.replace("f.frac + 1", "f.frac").replace("left=2", "left=3"), "lean-22"),
    shared("root_ab a bit shorter", "lean", '"root_near"], f.inner,', f'"root_near"], {LESS},', "lean-24-nodes"),
    shared("inv_11 a bit shorter", "lean", '["inv_1"], f.inner', f'["inv_1"], {LESS}', "lean-16"),
    shared("root_rho a bit shorter", "lean", '["m_rho"], f.inner', f'["m_rho"], {LESS}', "lean-24-nodes"),
    shared("az_tilt_sq a bit shorter", "lean", '["tilt_sq"], f.inner', f'["tilt_sq"], {LESS}', "lean-32-nodes"),
    shared("half angles: last bit lost", "lean_words", "magnitude(c)) >> 1)", "magnitude(c)) >> 2 << 1)", "lean-25"),
    shared("half sines: last bit lost", "lean_words",
        "0, s >> 1) if self.none else s >> 1", "0, s >> 2 << 1) if self.none else s >> 2 << 1", "lean-24"),
    shared("results cut off", "lean_words", "(words + (1 << (drop - 1))) >> drop", "words >> drop", "lean-16"),
    shared("|c| of negative words exact", "lean_words", "~words, words)", "-words, words)", "lean-24-nodes"),
    # the paper's datapath
    shared("sums: 7 guard bits", "nodes", "GUARD = 8", "GUARD = 7", "paper-24-nodes"),
    shared("sums: 2 guard bits", "nodes", "GUARD = 8", "GUARD = 2", "paper-32"),
    shared("mantissas a bit shorter", "nodes", LEADING, f"np.maximum({LEADING} - 1, 0)", "paper-32"),
    shared("CORDIC: 5 guard bits", "fixed", "SINCOS_GUARD = 6", "SINCOS_GUARD = 5", "cordic-32"),
    shared("CORDIC: gain of 10 iterations", "fixed", GAIN, "for i in range(10)", "cordic-32"),
    shared("CORDIC: an angle", "fixed", "/ mpmath.pi for", "/ mpmath.pi + (i == 20) * 2**-40 for", TABLES),
    shared("CORDIC: an iteration less", "fixed", "in range(width):", "in range(width - 1):", "cordic-17"),
    shared("products, sums cut off", "fixed",
        "(value + (1 << (shift - 1))) >> shift if shift else value", "value >> shift", "paper-24"),
    shared("paper's root one too large", "fixed", "r - (r * r > v)", "r + (r * r < v)", "paper-24"),
    shared("l_sw a bit shorter", "paper", '"s"], d.word(1), within=UNIT', '"s"], d.word(2), within=UNIT', "paper-32"),
    shared("tmp_sqr a bit shorter", "paper", "tmp1, d.word(2)", "tmp1, d.word(3)", "short-32"),
    shared("k_e a bit shorter", "paper", '"dd_j"], fmt=d.word(2)', '"dd_j"], fmt=d.word(3)', "paper-24-nodes"),
    shared("inf_pp a bit shorter", "paper", '"pp_3_sq"], fmt=d.word(5)', '"pp_3_sq"], fmt=d.word(6)', "paper-24"),
    shared("sin_phi a bit shorter", "paper", "cos_h, d.word(1), sc", "cos_h, d.word(2), sc", "paper-24-nodes"),
    shared("arms halved without their last bit", "paper", "(words >> 1) | (words & 1)", "words >> 1", RANGES),
    shared("c3_num a bit shorter", "paper_turns", '"c3_g"], fmt=d.word(1)', '"c3_g"], fmt=d.word(2)', "paper-24-nodes"),
    shared("r_x a bit shorter", "paper_turns", 'i_sq"], fmt=d.word(1)', 'i_sq"], fmt=d.word(2)', "paper-24-nodes"),
    shared("pi_inv a bit shorter", "paper_turns", '["pi_abs"], d.word(2)', '["pi_abs"], d.word(3)', "paper-24-nodes"),
    shared("q12 a bit shorter", "paper_turns", "l_m, d.word(1)", "l_m, d.word(2)", "paper-32"),
    shared("d_12 a bit shorter", "paper_turns", '["d_2"], d.word(-1)', '["d_2"], d.word(0)', "paper-24-nodes"),
    shared("short: l_sw a bit shorter", "short", '"l_sw": 12', '"l_sw": 13', "short-32-regular"),
    shared("short: qe_abs a bit shorter", "short", '"qe_abs": 7', '"qe_abs": 8', "short-32-regular"),
    shared("short: pi_abs a bit shorter", "short", '"pi_abs": 9', '"pi_abs": 10', "short-32"),
]  # fmt: skip

HARMLESS = [
    shared("no word of a table needs 200 bits", "quadratic", "PRECISION = 200", "PRECISION = 100", "trig-31"),
    shared("2 is reached by powers of two alone", "lean", "Limit(f.inner.high)", "Limit(f.inner.high - 1)", "lean-24"),
    shared("4^-40 is nothing beside 2^-48", "fixed", GAIN, "for i in range(40)", "cordic-32"),
    shared("one bit, rounded down or up, is off by as much", "paper_turns",
        "((e << 1) - p + 1) >> 1", "((e << 1) - p) >> 1", "paper-24-nodes"),
    shared("a tie in a result goes either way", "lean_words",
        "half_up(np.where(minus, -1, 1) * q, self.drop)", "np.where(minus, -1, 1) * half_up(q, self.drop)", "lean-24"),
]  # fmt: skip
"""These change no word, or few by a place, and no figure."""

QUICK = "root: c2 a bit shorter", "sine: a row twice", "roots of 21 bits", "d_12 a bit shorter"


def failed(place: Path, test: str) -> bool:
    """Whether the test fails in a copy of the model, by its own assertion."""
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "-p", "no:xdist", "-rf", test]
    environment = os.environ | {"PYTHONPATH": str(place), "PYTHONDONTWRITEBYTECODE": "1", "COLUMNS": "200"}
    ran = subprocess.run(command, cwd=place, env=environment, capture_output=True, text=True, check=False)
    said = ran.stdout + ran.stderr
    assert ran.returncode == 0 or ran.returncode == 1 and f"FAILED {test} - AssertionError" in said, said
    return ran.returncode == 1


@pytest.mark.parametrize(
    "bug",
    [pytest.param(bug, id=bug.what, marks=[] if bug.what in QUICK else pytest.mark.slow) for bug in MUTANTS],
)
def test_is_noticed(bug, tmp_path):
    assert failed(copy_model(tmp_path, bug), bug.fails)


@pytest.mark.slow
@pytest.mark.parametrize("bug", HARMLESS, ids=lambda bug: bug.what)
def test_is_harmless(bug, tmp_path):
    assert not failed(copy_model(tmp_path, bug), bug.fails)
