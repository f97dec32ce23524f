# SPDX-License-Identifier: Apache-2.0
"""Test the proof of the accuracy: it passes, and each planted change makes a lemma fail or a limit grow."""

import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import pytest

from tb.formal import accuracy, task
from tb.sim.env import ROOT
from tb.sim.seeded_bugs import Bug

pytestmark = pytest.mark.needs("fpga")


def test_proof_at_two_word_lengths():
    with ThreadPoolExecutor(2) as pool:
        outcome = task.run(accuracy.questions((18, 32)), [accuracy.algebra(*accuracy.FALSE)], pool, print)
    assert outcome.failed == []


LEAN, ARM, ROOTS = "model/dataflow/lean.py", "model/dataflow/arm.py", "model/dataflow/quadratic.py"
FORMATS, MUL3, CORDIC = (f"model/dataflow/{name}.py" for name in ("formats", "mul3", "angles"))
CONSTANTS, LIMIT, HAND = "model/bounds/accuracy.py", "lean, W=32", "arm, W=32"
BUGS = (
    Bug("coordinate's shift", LEAN, "ShiftUp(word, count, -2)", "ShiftUp(word, count, -1)", "x/R"),
    Bug("law of cosines' shift", LEAN, "-4 - f.odd", "-3 - f.odd", "K/P"),
    Bug("inv_2 in the law of cosines", LEAN, "Mul3(inv_1, inv_1)", "Mul3(inv_1, inv_2)", "1/(d1 |p|)"),
    Bug("sine's roots", LEAN, 'Mul3(roots["far"], roots["near"])', 'Mul3(roots["far"], roots["far"])', "sin a"),
    Bug("azimuth's larger part", LEAN, "u_x, u_y >= 0)", "u_x, u_y < 0)", "pair az"),
    Bug("parts of the tilt swapped", LEAN, '("i", "s", "c_minus")', '("i", "c", "c_minus")', "four products"),
    Bug("squared length", LEAN, 'Mul3(az_tilt_sq, n["bend_sq"])', 'Mul3(az_tilt_sq, n["tilt_sq"])', "lengths"),
    Bug("Qe's sign", LEAN, '("i", -1, (0, -1), ELBOW_I)', '("i", 1, (0, -1), ELBOW_I)', "qe"),
    Bug("results rounded down", LEAN, "f.result, rounding=HALF_UP", "f.result, rounding=FLOOR", LIMIT),
    Bug("a table entry", ROOTS, "* 2 ** form.c_frac[0])", "* 2 ** form.c_frac[0]) + (c0 < 0.5005) * 64", LIMIT),
    Bug("rounding constant of roots", ROOTS, "- (form.tiles + 1) // 2", "- (form.tiles + 9) // 2", LIMIT),
    Bug("a root an ulp worse", CONSTANTS, "iv.mpf([-ulp, 0])", "iv.mpf([-2 * ulp, 0])", LIMIT),
    Bug("inner words a bit shorter", FORMATS, "INNER_FRAC = 33", "INNER_FRAC = 32", LIMIT),
    Bug("roots a bit shorter", FORMATS, "ROOT_FRACS = 22, 31", "ROOT_FRACS = 22, 30", LIMIT),
    Bug("products without the estimate", MUL3, "(7 / 16 if up > 0 else 1)", "1", LIMIT),
    Bug("a sign of G", ARM, "wj+ jw- ki- ik+", "wj+ jw- ki- ik-", "Qs G, j"),
    Bug("Qw rounded", ARM, '"rounding": HALF_UP, "within": PART', '"rounding": (-1.0, 0.0), "within": PART', HAND),
    Bug("a word of the CORDIC's table", CORDIC, "return (*words, ", "return (words[0] + 4, *words[1:], ", HAND),
    Bug("an iteration less", CORDIC, "min(width + 1, head + 16)", "min(width, head + 15)", HAND),
)
"""Changes, each with the beginning of the name of a question that fails."""

ASK = """
from sys import argv
from tb.formal import accuracy, task
asked = [question for question in accuracy.questions((32,)) if question.name.startswith(argv[1])]
assert asked, "no such question"
print("failed" if any(task.answer(question)[1] for question in asked) else "proved")
"""


@pytest.mark.parametrize("bug", BUGS, ids=lambda bug: bug.what)
def test_planted_change(bug, tmp_path):
    for part in ("model", "tb", "rtl"):
        shutil.copytree(ROOT / part, tmp_path / part, ignore=shutil.ignore_patterns("__pycache__"))
    file = tmp_path / bug.file
    file.write_text(bug.seeded(file.read_text()))
    command = [sys.executable, "-c", ASK, bug.fails]
    asked = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert asked.stdout == "failed\n", asked.stderr
