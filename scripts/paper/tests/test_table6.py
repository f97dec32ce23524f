# SPDX-License-Identifier: Apache-2.0
"""Table 6: the software agrees with the model and the page with its figures. No test asserts a time."""

import json
import platform
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from model.dataflow.fixed import latency
from model.io.stimuli import random_reachable
from model.io.trajectories import make
from model.io.words import RESULT_FIELDS, from_words
from model.reference import equations
from model.reference.lean_equations import solve_lean
from scripts.fpga.designs import FIGURES as FPGA
from scripts.paper.table6 import compiled, hardware, measure, others
from scripts.paper.table6.arrays import lean_of
from scripts.paper.table6.compiled import EQUATIONS, FLAGS, REALS, WAYS, Software
from scripts.paper.table6.contenders import Contender, columns, found, hand_errors, in_jax, in_numba
from scripts.paper.table6.page import page

needs_cc = pytest.mark.skipif(not shutil.which("cc"), reason="no C compiler")


@pytest.fixture(scope="module")
def targets():
    return from_words(random_reachable(3000, 32, 7), 0, 32, "random")


@pytest.fixture(scope="module")
def software(tmp_path_factory):
    return Software(tmp_path_factory.mktemp("table6"))


def by_model(targets, solve=solve_lean):
    nodes = solve(*columns(targets))
    return np.stack([nodes[name] for name in RESULT_FIELDS], axis=1)


def off(answers, expected):
    """Return the largest difference between answers (N, 6) and the expected ones. Either sign of Qs is accepted:
    rounding decides the sign where k is nearly 0."""
    answers = np.asarray(answers, dtype=float)
    sign = np.sign((answers[:, :4] * expected[:, :4]).sum(axis=1))[:, None]
    return max(np.abs(sign * answers[:, :4] - expected[:, :4]).max(), np.abs(answers[:, 4:] - expected[:, 4:]).max())


# -- software --------------------------------------------------------------------------------------


@needs_cc
@pytest.mark.parametrize("way", WAYS)
def test_lean_c_gives_the_models_answers(software, targets, way):
    for given in (targets, make("reach")):
        bound = software.way("lean", way, "double", columns(given))
        assert off(bound(2), by_model(given)) < 1e-12


@needs_cc
@pytest.mark.parametrize("way", WAYS)
def test_paper_c_is_as_exact_as_the_models_equations(software, way):
    """C and the model agree away from singular poses; the model computes three sums in another form, which only
    matters near them."""
    given = make("reach")
    bound = software.way("paper", way, "double", columns(given))
    assert off(bound(1), by_model(given, equations.solve)) < 1e-12


@needs_cc
@pytest.mark.parametrize("real", REALS)
@pytest.mark.parametrize("equations_", EQUATIONS)
def test_ways_agree(software, equations_, real):
    """Chain, batch and vectors agree within rounding: a compiler may fuse products and sums differently."""
    given = make("reach")
    answers = [np.array(software.way(equations_, way, real, columns(given))(1), dtype=float) for way in WAYS]
    assert np.isfinite(answers[0]).all()
    for other in answers[1:]:
        assert off(other, answers[0]) < (1e-13 if real == "double" else 2e-5)


@needs_cc
@pytest.mark.parametrize("way, loops", [("batch", 0), ("vector", 4)])
def test_only_vectors_are_vectors(tmp_path, way, loops):
    """gcc reports the loops over targets (two sets of equations, two types) as vectorized only in the vector build."""
    if "gcc" not in Path(compiled.compiler()).resolve().name or platform.machine() not in ("x86_64", "aarch64"):
        pytest.skip("asks gcc")
    name, extra = WAYS[way]
    words = [*FLAGS, *extra, "-fopt-info-vec", "-c", "-o", str(tmp_path / "out.o"), str(compiled.SOURCE)]
    said = subprocess.run([compiled.compiler(), *words], capture_output=True, text=True, check=True).stderr
    body = (compiled.SOURCE.parent / "ways.h").read_text().splitlines()
    start = next(n for n, line in enumerate(body, 1) if f"WAY({name})" in line)
    end = next(n for n in range(start, len(body)) if body[n - 1] == "}")
    lines = [int(line.split(":")[1]) for line in said.splitlines() if "ways.h" in line and "loop vectorized" in line]
    assert sum(start < line < end for line in lines) >= loops and (loops or not lines), said


@needs_cc
def test_watched_chain_answers_and_tells_times(software, targets):
    bound = software.watched(columns(targets))
    ns = bound.watched()
    assert ns.shape == (len(targets),) and (ns >= 0).all() and ns.any()
    assert off(bound(0), by_model(targets)) < 1e-12  # times = 0 returns the previous answers


def test_plain_arrays_give_the_models_answers(targets):
    assert off(np.stack(lean_of(np, np.float64)(*columns(targets)), axis=1), by_model(targets)) < 1e-12
    single = lean_of(np, np.float32)(*(c.astype(np.float32) for c in columns(targets)))
    assert {c.dtype for c in single} == {np.dtype(np.float32)}
    assert hand_errors(np.stack(single, axis=1), targets).max() < 1e-5


@pytest.mark.parametrize("package", ["numba", "jax"])
def test_compiled_arrays_give_the_models_answers(targets, package):
    if not found(package):
        pytest.skip(f"{package} is not installed")
    for contender in (in_numba if package == "numba" else in_jax)():
        if contender.lacks:
            assert contender.lacks == "no GPU here"
            continue
        errors = contender.bind(targets).errors()
        assert errors.max() < (1e-12 if "double" in contender.key else 1e-5)


@pytest.mark.parametrize("contender", list(others.others()), ids=lambda contender: contender.key)
def test_others_reach_the_hand(contender):
    if contender.lacks:
        pytest.skip(contender.lacks)
    assert contender.bind(others.first(make("reach"), 5)).errors().max() < 1e-5


# -- hardware and quoted figures -------------------------------------------------------------------


@pytest.mark.sim
@pytest.mark.cost(20)
def test_clocks_are_counted_by_the_rtl():
    told = hardware.stream_to_stream("lean")
    assert (told["first"], told["last"]) == (latency("lean", 32), latency("lean", 32) + 100)
    assert told["reach_error"] < 1e-8
    assert 0 < hardware.random_error(random_reachable(500, 32, 3), "lean") < 2e-8


# -- the command and its page ----------------------------------------------------------------------


def figures():
    return json.loads(measure.FIGURES.read_text())


def test_page_is_of_its_figures():
    written = measure.PAGE.read_text()
    assert written == page(figures(), json.loads(FPGA.read_text())), "run: python -m scripts.paper.table6 --page"


def test_clocks_on_the_page_are_those_of_the_present_core():
    """The logic around the datapath adds the same clocks to both datapaths."""
    around = {}
    for row in figures()["hardware"]:
        around.setdefault(row["path"], set()).add(row["first"] - latency(row["datapath"], row["width"]))
    stale = "the RTL has changed: run `python -m scripts.paper.table6 --hardware`"
    assert around[hardware.STREAMS] == {0} and {len(clocks) for clocks in around.values()} == {1}, stale


@pytest.mark.sim
@pytest.mark.cost(20)
def test_clocks_from_memory_are_those_of_the_present_core():
    path = next(path for path in hardware.PATHS if path.startswith("memory"))
    kept = next(row for row in figures()["hardware"] if (row["datapath"], row["path"]) == ("lean", path))
    told = hardware.PATHS[path]("lean")
    stale = "the RTL has changed: run `python -m scripts.paper.table6 --hardware`"
    assert told | {"reach_error": measure.figure(told["reach_error"])} == {name: kept[name] for name in told}, stale


def test_missing_software_has_a_row(targets):
    reach = make("reach")
    told = measure.row(Contender("x", "X", "some solver", None, "not installed"), reach, targets)
    assert told == {"key": "x", "group": "X", "name": "some solver", "lacks": "not installed"}
    kept = figures()
    kept["software"].append(told)
    line = "| X | some solver | not installed | - | - | - | - | - |"
    assert line in page(kept, json.loads(FPGA.read_text()))


def test_a_target_without_an_answer_is_counted_and_is_no_error(targets):
    few = others.first(targets, 4)
    answers = by_model(few)
    answers[1] = np.nan
    bound = type("Bound", (), {"errors": lambda self: hand_errors(answers, few)})()
    error, unanswered = measure.accuracy(bound)
    assert unanswered == 1 and error < 1e-12


@needs_cc
def test_only_writes_nothing(command):
    keys = ["c-lean-float-vector", "numpy-float"]
    before = measure.FIGURES.read_text(), measure.PAGE.read_text()
    status, out, err = command(measure.main, "--targets", "50", "--only", keys[0], "--only", keys[1])
    assert status == 0 and [line.split()[0] for line in out] == keys
    assert "[2/2] numpy: lean, float ..." in err
    assert (measure.FIGURES.read_text(), measure.PAGE.read_text()) == before


@needs_cc
def test_unknown_key_is_one_line(command):
    status, out, err = command(measure.main, "--only", "fortran")
    assert (status, out) == (2, []) and len(err) == 1 and "c-lean-double-chain" in err[0]


def test_no_compiler_is_one_line(command, monkeypatch):
    monkeypatch.setenv("PATH", "")
    status, out, err = command(measure.main, "--only", "c-")
    assert (status, out) == (2, []) and err == [
        "table6: no C compiler: cc is not in PATH (on Debian: apt-get install gcc)"
    ]


@needs_cc
def test_what_the_compiler_refuses_is_one_line(command, monkeypatch, tmp_path):
    broken = tmp_path / "software.c"
    broken.write_text("int main(void) { return nonsense; }\n")
    monkeypatch.setattr(compiled, "SOURCE", broken)
    status, out, err = command(measure.main, "--only", "c-")
    assert (status, out, len(err)) == (2, [], 1) and "cannot compile software.c" in err[0] and "nonsense" in err[0]
