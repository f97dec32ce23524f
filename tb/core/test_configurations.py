# SPDX-License-Identifier: Apache-2.0
"""Every node equals the model's: digit-recurrence paper datapath, ``lean25``, ``lean16`` and the folded datapaths."""

import numpy as np
import pytest

from model.dataflow import fixed
from model.dataflow.datapaths import CONFIGURATIONS
from model.dataflow.nodes import inner_frac
from model.dataflow.quadratic import SINE, SINE_FRACS
from model.io.stimuli import mixed
from tb.core.corner_targets import nearly_rounded_up, shifted
from tb.sim.env import CORES, simulator
from tb.sim.simulate import Job, simulate

KINDS = [("lean25", 18, CORES[0])]
BUILT = {"lean16": (18, 24), "fold": (20, 24, 32), "fold16": (18, 20, 24)}
if simulator() == "icarus":  # one of each; Verilator's native harness runs the others
    BUILT = {"lean16": (18,), "fold": (24,), "fold16": (18,)}
KINDS += [(path, width, CORES[0]) for path, widths in BUILT.items() for width in widths]
if simulator() == "icarus":  # Verilator takes minutes to compile digit recurrences
    KINDS += [pytest.param("paper", 32, CORES[1], marks=[pytest.mark.slow, pytest.mark.cost(40)])]


@pytest.mark.sim
@pytest.mark.parametrize(("datapath", "width", "kind"), KINDS)
def test_every_node_equals_the_model(datapath, width, kind):
    """Compare every node for targets of every kind; Icarus, a hundred times slower, runs fewer targets."""
    native = simulator() == "verilator"
    words = mixed(300 if native else 40, width, 4)
    if native:
        frac = min(inner_frac(width), SINE_FRACS[-1])
        angles = nearly_rounded_up(width, SINE.form(frac, CONFIGURATIONS[datapath].tile), frac)
        words = np.concatenate([words, shifted(width), angles])
    (run,) = simulate(
        [Job(datapath, words)], simulator=simulator(), datapath=datapath, width=width, cores=kind, native=native
    )
    assert run.bit_mismatches == 0, run.first_mismatch
    assert (run.results == fixed.run(words, width, datapath).results).all()


def test_another_cut_gives_other_results():
    words = mixed(3000, 18, 4)
    assert (fixed.run(words, 18, "lean25").results != fixed.run(words, 18, "lean").results).any()
