# SPDX-License-Identifier: Apache-2.0
"""Unsupported parameters stop elaboration with a named error; neighbouring supported values elaborate."""

import re
import subprocess

import pytest

from tb.sim.env import ROOT, environment, simulator
from tb.sim.sources import includes, sources

AXIS = {
    "illegal_TAG_W": [{"TAG_W": 0}, {"TAG_W": -1}, {"TAG_W": 0, "DATAPATH": 0}, {"TAG_W": 0, "DATAPATH": 2}],
    "illegal_DATAPATH": [{"DATAPATH": -1}, {"DATAPATH": 3}],
    "illegal_DIGIT": [{"DIGIT": -1}, {"DIGIT": 2}, {"DIGIT": 2, "DATAPATH": 0}],
    "illegal_TILE": [
        *({"TILE": tile, "W": 24} for tile in (0, 15, 17, 19, 20, 24, 26)),
        {"TILE": 17, "DATAPATH": 0},
        {"TILE": 25, "DATAPATH": 2},
        {"TILE": 17, "DATAPATH": 2, "W": 24},
    ],
    "illegal_W": [
        *({"W": w, "DATAPATH": lean} for w in (-1, 0, 3, 15, 33, 64) for lean in (0, 1)),
        *({"W": w, "DATAPATH": 2} for w in (16, 18, 19, 21, 31, 33, 34)),
        *({"W": w, "TILE": 16, "DATAPATH": 2} for w in (16, 17, 19, 25, 26)),
        *({"W": w, "TILE": 16} for w in (15, 25, 32)),
    ],
}
AXI = {
    "illegal_DATAPATH": [{"DATAPATH": lean} for lean in (-1, 2, 3)],
    "illegal_DATA_W": [{"DATA_W": bits} for bits in (16, 33, 96, 256)],
    "illegal_ADDR_W": [{"ADDR_W": bits} for bits in (11, 65)],
    "illegal_LOG2_BURST": [{"LOG2_BURST": log2} for log2 in (0, 6)],
}
PASSED_ON = {
    "illegal_DIGIT": [{"DIGIT": 2}, {"DIGIT": 2, "DATAPATH": 0}],
    "illegal_TILE": [{"TILE": 17}, {"TILE": 20}],
    "illegal_W": [{"W": 15}, {"W": 33}, {"TILE": 16}],
}
"""Illegal parameters of ``ik_axi`` that the core inside reports."""
LEAN = {
    "illegal_W": [{"W": 2}, {"W": 33}, *({"W": w, "TILE": 16} for w in (15, 25))],
    "illegal_TAG_W": [{"TAG_W": 0}],
    "illegal_TILE": [{"TILE": 17}, {"TILE": 20}, {"TILE": 26}],
}
PAPER = {
    "illegal_W": [{"W": 15}, {"W": 33}],
    "illegal_TAG_W": [{"TAG_W": 0}],
    "illegal_DIGIT": [{"DIGIT": 2}, {"DIGIT": -1}],
}
FOLD = {
    "illegal_W": [
        *({"W": w} for w in (18, 19, 21, 33, 34)),
        *({"W": w, "TILE": 16} for w in (16, 17, 19, 25, 26)),
    ],
    "illegal_TAG_W": [{"TAG_W": 0}],
    "illegal_TILE": [{"TILE": 17}, {"TILE": 25}],
}

ILLEGAL = [
    # only the first of each name is in the quick gate
    pytest.param(top, parameters, f"{named}_{name}", marks=pytest.mark.slow if k else ())
    for top, named, table in (
        ("ik_axis", "ik_axis", AXIS),
        ("ik_axi", "ik_axi", AXI),
        ("ik_axi", "ik_axis", PASSED_ON),
        ("ik_lean", "ik_lean", LEAN),
        ("ik_paper", "ik_paper", PAPER),
        ("ik_fold", "ik_fold", FOLD),
    )
    for name, sets in table.items()
    for k, parameters in enumerate(sets)
]
LEGAL = [
    *(("ik_axis", parameters) for parameters in (
        {"W": 16, "TAG_W": 1}, {"W": 32}, {"W": 16, "DATAPATH": 0}, {"W": 32, "DATAPATH": 0, "DIGIT": 1}, {"DIGIT": 1},
        {"W": 16, "TILE": 25},
        {"W": 16, "TILE": 16}, {"W": 24, "TILE": 16}, {"W": 24, "TILE": 16, "DATAPATH": 0},
        {"W": 20, "DATAPATH": 2}, {"W": 32, "DATAPATH": 2, "TAG_W": 1}, {"W": 18, "DATAPATH": 2, "TILE": 16},
        {"W": 24, "DATAPATH": 2, "TILE": 16},
    )),
    *(("ik_axi", parameters) for parameters in (
        {"DATA_W": 32, "ADDR_W": 12, "LOG2_BURST": 1}, {"DATA_W": 128, "ADDR_W": 64, "LOG2_BURST": 5, "DATAPATH": 0},
        {"W": 16, "TILE": 25}, {"W": 24, "TILE": 16},
    )),
    ("ik_lean", {"W": 3, "TAG_W": 1}), ("ik_lean", {"W": 24, "TILE": 16}), ("ik_lean", {"TILE": 25}),
    ("ik_paper", {"W": 16, "TAG_W": 1, "DIGIT": 1}),
    ("ik_fold", {"W": 20, "TAG_W": 1}), ("ik_fold", {"W": 18, "TILE": 16}), ("ik_fold", {"W": 32}),
]  # fmt: skip


def elaborated(top: str, parameters: dict[str, int]) -> tuple[int, set[str]]:
    """Return the exit status of the simulator that SIM names, and the modules it reports as missing."""
    folders = [f"-I{folder}" for folder in includes()]
    if simulator() == "icarus":
        command = ["iverilog", "-g2001", "-t", "null", "-s", top]
        command += [f"-P{top}.{name}={value}" for name, value in parameters.items()]
    else:
        # `make lint` covers warnings
        command = ["verilator_bin", "--lint-only", "-Wno-fatal", "--default-language", "1364-2001", "--top-module", top]
        command += [*(f"-G{name}={value}" for name, value in parameters.items()), str(ROOT / "rtl" / "lint.vlt")]
    done = subprocess.run(
        [*command, *folders, *map(str, sources())], env=environment(), capture_output=True, text=True, check=False
    )
    return done.returncode, set(re.findall(r"(?:Unknown module type: |containing module: ')(\w+)", done.stderr))


def title(value) -> str:
    return ",".join(f"{k}={v}" for k, v in value.items()) if isinstance(value, dict) else value


@pytest.mark.sim
@pytest.mark.parametrize(("top", "parameters", "name"), ILLEGAL, ids=title)
def test_stops_with_its_name(top, parameters, name):
    status, missing = elaborated(top, parameters)
    assert status != 0 and name in missing
    if top == "ik_axis":
        assert missing == {name}, "the reason is one name, not all that goes wrong below"


@pytest.mark.sim
@pytest.mark.parametrize(("top", "parameters"), LEGAL, ids=title)
def test_elaborates(top, parameters):
    assert elaborated(top, parameters) == (0, set())
