# SPDX-License-Identifier: Apache-2.0
"""Tests of soak_memory without a simulator: counts, the stop at a failure, the replay of a piece."""

from pathlib import Path

import pytest

from scripts import soak_memory
from tb.axi.instances import CORE, named
from tb.sim.simulate import SimulationError


@pytest.fixture
def ran(monkeypatch, tmp_path):
    """Replace the simulation and record its calls; piece 2 of seed 7 fails."""
    calls = []

    def apart(modules, sim, env, **options):
        calls.append((env["IK_AXI_SEED"], options["parameters"], env.get("IK_AXI_CORE")))
        if env["IK_AXI_SEED"] == "7000003":
            raise SimulationError("result 3 of 5 differs")
        Path(env["IK_AXI_DONE"]).write_text("40 900\n60 1100\n")

    monkeypatch.setattr(soak_memory, "apart", apart)
    monkeypatch.setattr(soak_memory, "ECHO_PLACE", tmp_path)
    return calls


def test_counts(ran, command):
    status, out, _ = command(soak_memory.main, "--jobs", "401", "--seed", "3", "--processes", "1")
    assert status == 0 and out[-1] == "500 jobs, 10000 targets, seed 3, verilator: all right"
    assert len({seed for seed, *_ in ran}) == 5
    assert [(parameters, echo) for _, parameters, echo in ran[:4]] == [*((p, None) for p in CORE), (ran[3][1], "echo")]


def test_a_failure_stops_the_run_and_is_replayed(ran, command):
    status, out, err = command(soak_memory.main, "--jobs", "1000", "--seed", "7", "--processes", "1")
    assert status == 1 and out == [] and len(ran) == 3
    assert f"soak_memory: seed 7, piece 2, core {named(CORE[2])}:" in err and "result 3 of 5 differs" in err
    again = err[-1].partition("scripts.soak_memory ")[2].split()
    ran.clear()
    assert command(soak_memory.main, *again, "--processes", "1")[0] == 1
    assert [seed for seed, *_ in ran] == ["7000003"]
