# SPDX-License-Identifier: Apache-2.0
"""Test that unsupported parameters stop elaboration with a named error and supported ones do not; test FIFO depths."""

import itertools
import re
import subprocess

import pytest

from model.dataflow import fixed
from model.dataflow.datapaths import MODELS
from model.dataflow.formats import WIDTHS
from tb.sim.env import ROOT, environment, simulator
from tb.sim.sources import header, includes, sources
from tb.units.unit import sets_of

LEAN_W = [{"W": w} for w in (15, 33)] + [{"W": w, "TILE": 16} for w in (15, 25)]
FOLD_W = [{"W": w} for w in (18, 19, 21, 33, 34)] + [{"W": w, "TILE": 16} for w in (16, 17, 19, 25, 26)]
FOLD = {"DATAPATH": 2}
DATAPATHS = ("ik_lean", "ik_paper", "ik_fold", "ik_fold_arm", "ik_arm", "ik_lean_arm")
DIV, SQRT, MUL3 = "NW DW SH QW LAT", "NW SH QW LAT", "AW BW SH OW"
ILLEGAL_SETS = [  # top, module that stops the elaboration, parameter sets
    ("ik_axis", "ik_axis_illegal_TAG_W", [{"TAG_W": 0}, {"TAG_W": -1}, *({"TAG_W": 0, "DATAPATH": d} for d in (0, 2))]),
    ("ik_axis", "ik_axis_illegal_DATAPATH", sets_of("DATAPATH", (-1,), (3,))),
    ("ik_axis", "ik_axis_illegal_DIGIT", [{"DIGIT": -1}, {"DIGIT": 2}, {"DIGIT": 2, "DATAPATH": 0}]),
    ("ik_axis", "ik_axis_illegal_TILE", sets_of("TILE", *((tile,) for tile in (0, 15, 17, 19, 20, 24, 26)), W=24)),
    ("ik_axis", "ik_axis_illegal_TILE", sets_of("TILE DATAPATH W", (17, 0, 32), (25, 2, 32), (17, 2, 24))),
    ("ik_axis", "ik_axis_illegal_W", sets_of("W DATAPATH", *itertools.product((-1, 0, 3, 15, 33, 64), (0, 1)))),
    *((top, f"{top}_illegal_W", [parameters | FOLD for parameters in FOLD_W]) for top in ("ik_axis", "ik_arm")),
    ("ik_axis", "ik_axis_illegal_W", sets_of("W", (15,), (25,), (32,), TILE=16)),
    ("ik_axi", "ik_axi_illegal_ARM", sets_of("ARM", (2,), (-1,))),
    ("ik_axi", "ik_axi_illegal_DATAPATH", sets_of("DATAPATH ARM", (-1, 0), (3, 0), (0, 1), (3, 1))),
    ("ik_axi", "ik_axi_illegal_DATA_W", sets_of("DATA_W", (16,), (33,), (96,), (256,))),
    ("ik_axi", "ik_axi_illegal_ADDR_W", sets_of("ADDR_W ARM", (11, 0), (65, 0), (12, 1))),
    ("ik_axi", "ik_axi_illegal_LOG2_BURST", sets_of("LOG2_BURST DATA_W ARM", (0, 64, 0), (6, 64, 0), (5, 32, 1))),
    ("ik_axi", "ik_axis_illegal_DIGIT", sets_of("DIGIT DATAPATH", (2, 1), (2, 0))),  # stopped by the core inside
    ("ik_axi", "ik_axis_illegal_TILE", sets_of("TILE", (17,), (20,))),
    ("ik_axi", "ik_axis_illegal_W", [{"W": 15}, {"W": 33}, {"TILE": 16}, {"W": 18} | FOLD]),
    ("ik_axi", "ik_arm_illegal_W", [{"W": 18, "ARM": 1} | FOLD]),
    ("ik_lean", "ik_lean_illegal_W", [{"W": 2}, *LEAN_W[1:]]),
    ("ik_paper", "ik_paper_illegal_W", LEAN_W[:2]),
    ("ik_paper", "ik_paper_illegal_DIGIT", sets_of("DIGIT", (2,), (-1,))),
    *((arm, f"{arm}_illegal_W", LEAN_W) for arm in ("ik_arm", "ik_lean_arm")),
    *((fold, f"{fold}_illegal_W", FOLD_W) for fold in ("ik_fold", "ik_fold_arm")),
    *((fold, f"{fold}_illegal_TILE", sets_of("TILE", (17,), (25,))) for fold in ("ik_fold", "ik_fold_arm")),
    *((top, f"{top}_illegal_TILE", sets_of("TILE", (17,), (26,))) for top in ("ik_lean", "ik_arm", "ik_lean_arm")),
    *((top, f"{top}_illegal_TAG_W", [{"TAG_W": 0}]) for top in DATAPATHS),
    ("ik_arm", "ik_arm_illegal_DATAPATH", sets_of("DATAPATH", (-1,), (0,), (3,))),
    ("ik_arm", "ik_arm_illegal_TAG_W", [{"TAG_W": 0} | FOLD]),
    ("ik_arm", "ik_arm_illegal_TILE", sets_of("TILE", (17,), (25,), **FOLD)),
    ("ik_arm", "ik_arm_illegal_CHOOSE", sets_of("CHOOSE DATAPATH", (2, 1), (-1, 1), (2, 2))),
    ("ik_arm", "ik_arm_illegal_EPS", sets_of("EPS", (0,), (1025,), CHOOSE=1)),
    ("ik_delay", "ik_delay_illegal_N", [{"N": -1}]),
    ("ik_ring", "ik_ring_illegal_N", [{"N": 2}]),
    ("ik_vector", "ik_vector_illegal_W", sets_of("W", (4,), (33,))),
    ("ik_even", "ik_even_illegal_width", sets_of("VW MW", (2, 20), (33, 20), (66, 34), (64, 51))),
    ("ik_mul", "ik_mul_illegal_width", [{"AW": 36}]),
    ("ik_mul3", "ik_mul3_illegal_width", sets_of(MUL3, (36, 33, 31, 33), (33, 36, 30, 33), (1, 9, 4, 9))),
    ("ik_mul3", "ik_mul3_illegal_width", sets_of(f"{MUL3} TILE", (9, 9, 2, 9, 8), (5, 5, 8, 3, 4), (9, 9, 4, 9, 1))),
    ("ik_div", "ik_div_digit_illegal_LAT", sets_of(DIV, (6, 5, 2, 5, 3), (32, 32, 30, 32, 17), DIGIT=1)),
    ("ik_div", "ik_div_digit_illegal_LAT", sets_of(DIV, (2, 2, 0, 2, 2), DIGIT=1)),
    ("ik_div", "ik_div_digit_illegal_width", sets_of(DIV, (1, 5, 4, 5, 9), (5, 1, 4, 5, 9), (5, 5, 4, 1, 9), DIGIT=1)),
    ("ik_root", "ik_root_digit_illegal_LAT", sets_of(SQRT, (10, 5, 8, 4), (32, 30, 32, 16), (10, 0, 2, 1), DIGIT=1)),
    ("ik_root", "ik_root_digit_illegal_width", sets_of(SQRT, (1, 5, 8, 9), (10, 5, 1, 9), DIGIT=1)),
]
ILLEGAL = [pytest.param(top, sets[:1], name) for top, name, sets in ILLEGAL_SETS]
ILLEGAL += [pytest.param(top, sets[1:], name, marks=pytest.mark.slow) for top, name, sets in ILLEGAL_SETS if sets[1:]]
"""`make test` uses only the first set of each row."""

LEGAL = [  # top, parameter sets
    ("ik_axis", [{"W": 16, "TAG_W": 1}, {"W": 32}, {"DIGIT": 1}, {"W": 16, "DATAPATH": 0}, {"W": 16, "TILE": 25}]),
    ("ik_axis", [{"W": 32, "DATAPATH": 0, "DIGIT": 1}, {"W": 24, "TILE": 16, "DATAPATH": 0}]),
    ("ik_axis", [{"W": 20} | FOLD, {"W": 32, "TAG_W": 1} | FOLD]),
    *((top, [{"W": w, "TILE": 16} for w in (16, 24)]) for top in ("ik_axis", "ik_arm")),
    *((top, [{"W": w, "TILE": 16} | FOLD for w in (18, 24)]) for top in ("ik_axis", "ik_arm")),
    ("ik_axi", sets_of("ADDR_W LOG2_BURST ARM", (12, 1, 0), (13, 4, 1), DATA_W=32)),
    ("ik_axi", [{"DATA_W": 128, "ADDR_W": 64, "LOG2_BURST": 5, "DATAPATH": 0}, {"W": 16, "TILE": 25}]),
    ("ik_axi", [{"W": 24, "TILE": 16}, {"W": 24, "TILE": 16, "LOG2_BURST": 5, "ARM": 1}]),
    ("ik_axi", [{"W": 20} | FOLD, {"ARM": 1} | FOLD, {"W": 18, "TILE": 16, "LOG2_BURST": 1, "ARM": 1} | FOLD]),
    ("ik_lean", [{"W": 3, "TAG_W": 1}, {"W": 24, "TILE": 16}, {"TILE": 25}]),
    ("ik_paper", [{"W": 16, "TAG_W": 1, "DIGIT": 1}]),
    ("ik_arm", [{"W": 16, "TAG_W": 1}, {"W": 32}, {"TILE": 25}, {"W": 20} | FOLD]),
    ("ik_arm", [{"W": w, "EPS": eps, "CHOOSE": 1} for w, eps in ((16, 1024), (32, 1))]),
    ("ik_fold", [{"W": 20, "TAG_W": 1}, {"W": 18, "TILE": 16}, {"W": 32}]),
    ("ik_fold_arm", [{"W": 32, "TAG_W": 1}]),
]
READ = () if simulator() == "icarus" else pytest.mark.slow
"""Mark of the LEGAL sets: slow with Verilator, because `make lint` reads nearly the same sets."""


def elaborated(top: str, parameters: dict[str, int]) -> tuple[int, set[str]]:
    """Return the exit status of the simulator that SIM names, and the modules that it reports as missing."""
    folders = [f"-I{folder}" for folder in includes()]
    if simulator() == "icarus":
        command = ["iverilog", "-g2001", "-t", "null", "-s", top]
        command += [f"-P{top}.{name}={value}" for name, value in parameters.items()]
    else:
        # `make lint` covers warnings
        command = ["verilator_bin", "--lint-only", "-Wno-fatal", "--default-language", "1364-2001", "--top-module", top]
        command += [*(f"-G{name}={value}" for name, value in parameters.items()), str(ROOT / "rtl" / "lint.vlt")]
    command += [*folders, *map(str, sources())]
    done = subprocess.run(command, env=environment(), capture_output=True, text=True, check=False)
    return done.returncode, set(re.findall(r"(?:Unknown module type: |containing module: ')(\w+)", done.stderr))


def title(value) -> str:
    if isinstance(value, list):
        return title(value[0]) + f" and {len(value) - 1} more" * (len(value) > 1)
    return ",".join(f"{k}={v}" for k, v in value.items()) if isinstance(value, dict) else value


@pytest.mark.sim
@pytest.mark.parametrize(("top", "sets", "name"), ILLEGAL, ids=title)
def test_stops_with_its_name(top, sets, name):
    for parameters in sets:
        status, missing = elaborated(top, parameters)
        assert status != 0 and name in missing, parameters
        if top in ("ik_axis", "ik_arm"):
            assert missing == {name}, f"{parameters}: the reason is one name, not all that goes wrong below"


@pytest.mark.sim
@pytest.mark.parametrize(
    ("top", "parameters"), [pytest.param(top, one, marks=READ) for top, sets in LEGAL for one in sets], ids=title
)
def test_elaborates(top, parameters):
    assert elaborated(top, parameters) == (0, set())


PARTS = ("ik_axis", "ik_axi", "ik_arm", "ik_credit_fifo", "ik_lean", "ik_lean_arm", "ik_paper")
"""Modules that define T_OUT and LOG2; the FIFO test compiles only the headers of other modules."""


def test_fifo_has_a_slot_for_each_clock_and_not_twice_as_many(tmp_path):
    """Check that the FIFO has at least T_OUT + 3 slots, but less than twice that, and check constants of ``ik_axi``.

    A slot is reserved for T_OUT + 3 clocks: T_OUT in the core, two in the FIFO, one in which the result leaves. Fewer
    slots cause gaps. LATENCY and LOG2_PLACES of ``ik_axi`` must match the core; for a folded core, LATENCY must match
    the model.
    """
    lines, displays = ["module top;"], []
    for path in (path for path in MODELS.values() if path.period == 1 or not path.chooses):
        for width in (w for w in path.widths if w in WIDTHS):
            values = ", ".join(f".{k}({v})" for k, v in {"W": width, **path.parameters}.items())
            u, v = f"{path.name}_{width}", f"memory_{path.name}_{width}"
            if not path.chooses:  # ik_axi does not
                lines.append(f"ik_axi #({values.replace(', .CHOOSE(0)', '')}, .ARM({int(path.side != ())})) {v} ();")
            if path.period > 1:
                holds = [f"{v}.LATENCY == {fixed.latency(path.name, width)}"]
            else:
                lines.append(f"{path.top} #({values}) {u} ();")
                last, log2 = "T_LAST" if path.side else "T_OUT", f"{u}.g_fifo.u_credits.LOG2"
                out, slots = f"{u}.g_{path.rtl}.u_core.{last}", f"(1 << {log2})"
                holds = [f"{out} + 3 <= {slots}", f"{slots} < 2 * ({out} + 3)"]
                holds += [] if path.chooses else [f"{v}.LATENCY == {out} + 2", f"{v}.LOG2_PLACES == {log2}"]
            displays.append(f'initial $display("{u} %0d", {" && ".join(holds)});')
    (tmp_path / "top.v").write_text("\n".join([*lines, *displays, "endmodule", ""]))
    for path in sources():
        text = path.read_text()
        (tmp_path / path.name).write_text(text if path.stem in PARTS else header(text))
    folders = [f"-I{folder}" for folder in includes()]
    build = ["iverilog", "-g2001", "-s", "top", "-o", tmp_path / "top", *folders, *tmp_path.glob("*.v")]
    subprocess.run(build, env=environment(), check=True, capture_output=True)
    command = ["vvp", "-n", tmp_path / "top"]
    done = subprocess.run(command, env=environment(), check=True, capture_output=True, text=True).stdout.splitlines()
    assert len(done) == len(displays) and [line for line in done if not line.endswith(" 1")] == []
