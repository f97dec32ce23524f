# SPDX-License-Identifier: Apache-2.0
"""The climb to the worst targets: it climbs, and says so when a hand is beyond its tolerance."""

import numpy as np

from model.bounds import tolerances
from scripts import climb


def test_later_rounds_find_worse_targets_and_their_errors(capsys):
    assert climb.main(["--width", "16", "--rounds", "1"]) == 0
    first = capsys.readouterr().out
    assert climb.main(["--width", "16", "--rounds", "40"]) == 0
    later = capsys.readouterr().out
    error = [float(line.split(" = 16: ")[1].split()[0]) for line in (first, later)]
    assert error[1] > error[0]
    words = np.array([[int(word) for word in later.strip().rsplit(": ", 1)[1].split(", ")]])
    assert f"{climb.hand_errors(words, 16)[0]:.3e}" == f"{error[1]:.3e}"


def test_a_hand_beyond_its_tolerance_fails(monkeypatch, capsys):
    monkeypatch.setattr(tolerances, "sought", lambda width: 1e-5)
    assert climb.main(["--width", "16", "--rounds", "1"]) == 1
    assert "tolerance 1e-05" in capsys.readouterr().out
