# SPDX-License-Identifier: Apache-2.0
"""Test the proof of the accuracy: it passes, and each planted change makes a lemma fail or the limit grow."""

from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

import pytest

from model.bounds import accuracy as constants
from model.bounds import arm_accuracy
from model.dataflow import angles, arm, fixed, formats, lean, mul3, quadratic
from model.dataflow.expressions import FLOOR
from tb.formal import accuracy, task

pytestmark = pytest.mark.needs("fpga")
WIDTH = 24
CACHED = (fixed.dataflow, constants.accuracy, constants.cells, quadratic.table_rows, quadratic.columns,
          quadratic.row_error, quadratic.rsqrt_error, quadratic.half_sincos_error, arm_accuracy.arm_accuracy,
          angles.head, angles.table)  # fmt: skip


@pytest.fixture
def fresh(monkeypatch):
    """Clear what is cached of the dataflow, before and after a change; only the datapath ``lean`` is proved."""
    monkeypatch.setattr(accuracy, "STATED", {"lean": accuracy.STATED["lean"]})

    def clear():
        for function in CACHED:
            function.cache_clear()

    clear()
    yield monkeypatch
    monkeypatch.undo()
    clear()


def fails(name: str) -> bool:
    """Return whether a question fails whose name begins with ``name``, at the word length :data:`WIDTH`."""
    questions = [question for question in accuracy.questions((WIDTH,)) if question.name.startswith(name)]
    assert questions
    return any(task.answer(question)[1] for question in questions)


def test_proof_at_two_word_lengths():
    with ThreadPoolExecutor(2) as pool:
        outcome = task.run(accuracy.questions((18, 32)), accuracy.questions(false=True), pool, print)
    assert outcome.failed == []


LIMIT = f"lean, W={WIDTH}"
EQUATIONS = {
    # change of model/dataflow/lean.py: old text, new text -> a question that fails
    "coordinate's shift": ("ShiftUp(word, count, -2)", "ShiftUp(word, count, -1)", "u_x"),
    "law of cosines' shift": ("-4 - f.odd", "-3 - f.odd", "cos_a"),
    "sine's shift": ("(-1, e_s), constant=2 + f.odd", "(-1, e_s), constant=3 + f.odd", "sin a"),
    "inv_2 in the law of cosines": ("Mul3(inv_1, inv_1)", "Mul3(inv_1, inv_2)", "1/(d1 |p|)"),
    "parts of the tilt swapped": ('("i", "s", "c_minus")', '("i", "c", "c_minus")', "i_0"),
    "sum and difference swapped": ('("k", "c", "s_plus")', '("k", "c", "s_minus")', "k_0"),
    "azimuth's larger part": ("u_x, u_y >= 0)", "u_x, u_y < 0)", "pair az"),
    "squared length without the bend": ('Mul3(az_tilt_sq, n["bend_sq"])', 'Mul3(az_tilt_sq, n["tilt_sq"])', "lengths"),
    "Qe's sign": ('("i", -1, (0, -1), ELBOW_I)', '("i", 1, (0, -1), ELBOW_I)', "qe"),
    "results rounded down": ("k_minus), f.result, rounding=HALF_UP", "k_minus), f.result, rounding=FLOOR", LIMIT),
    "sine from another root": ('Mul3(roots["far"], roots["near"])', 'Mul3(roots["far"], roots["far"])', "sin a"),
}  # fmt: skip


@pytest.mark.parametrize("change", EQUATIONS)
def test_changed_equation(change, fresh):
    old, new, name = EQUATIONS[change]
    source = Path(lean.__file__).read_text()
    assert source.count(old) == 1
    changed = dict(lean.__dict__)
    exec(source.replace(old, new), changed)  # the changed functions use each other
    for function in ("guard", "direction", "triangle", "turn", "last_rotation", "root", "limited"):
        fresh.setattr(lean, function, changed[function])
    assert fails(name)


def wider(function, low, high):
    """Return a function whose result, a range of an error, is wider by ``low`` and ``high``."""

    def widened(*arguments, **more):
        ends = function(*arguments, **more)
        return ends[0] + low, ends[1] + high

    return widened


def one_entry(rows, column, change):
    """Return the function ``rows`` of a table's rows with one entry of the last row changed."""

    def entries(table, form):
        *others, last = rows(table, form)
        return *others, (*last[:column], last[column] + change, *last[column + 1 :])

    entries.cache_clear = rows.cache_clear
    return entries


ULP = 2.0 ** -formats.root_frac(WIDTH)
ERRORS = {
    "a table entry, c0": lambda to: to.setattr(quadratic, "table_rows", one_entry(quadratic.table_rows, 0, 64)),
    "a table entry, c1": lambda to: to.setattr(quadratic, "table_rows", one_entry(quadratic.table_rows, 1, 64)),
    "rounding constant of roots": lambda to: [to.setattr(m, "rounding", lambda *_: 0) for m in (quadratic, constants)],
    "roots an ulp worse": lambda to: to.setattr(constants, "row_error", wider(quadratic.row_error, -ULP, 0)),
    "inner words a bit shorter": lambda to: to.setattr(formats, "INNER_FRAC", WIDTH + 4),
    "roots a bit shorter": lambda to: to.setattr(formats, "ROOT_FRACS", (22, formats.root_frac(WIDTH) - 1)),
    "products without the estimate": lambda to: to.setattr(mul3, "mul3_error", wider(mul3.mul3_error, -0.16, 0)),
}  # fmt: skip


@pytest.mark.parametrize("change", ERRORS)
def test_larger_error(change, fresh):
    ERRORS[change](fresh)
    assert fails(LIMIT)


def table_word(to):
    first, *others = angles.table(WIDTH)
    to.setattr(angles, "table", lambda width: (first + 4, *others))


def cordic(less: int, to):
    head, last = angles.iterations(WIDTH)
    to.setattr(angles, "iterations", lambda width: (head - less, last - 1 + less))


ARM = {
    "a sign of G": (lambda to: to.setitem(arm.PRODUCTS, "j", "wj+ jw- ki- ik-"), "g_j"),
    "Qw rounded down": (lambda to: to.setattr(arm, "HALF_UP", FLOOR), f"arm, W={WIDTH}"),
    "a word of the CORDIC's table": (table_word, f"arm, W={WIDTH}"),
    "an iteration less": (partial(cordic, 0), f"arm, W={WIDTH}"),
    "X constant an iteration earlier": (partial(cordic, 1), f"arm, W={WIDTH}"),
}


@pytest.mark.parametrize("change", ARM)
def test_changed_arm(change, fresh):
    apply, name = ARM[change]
    apply(fresh)
    assert fails(name)
